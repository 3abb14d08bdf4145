#!/usr/bin/env bash
# Installs what is missing, builds, and runs the test suite; arguments go to ctest.
set -euo pipefail
cd "$(dirname "$0")/.."

./ci/setup.sh
./ci/build.sh build all
# One more than there are processors: some tests wait for a browser or a cluster.
exec ctest --test-dir build --output-on-failure --no-tests=error -j "$(($(nproc) + 1))" "$@"
