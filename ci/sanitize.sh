#!/usr/bin/env bash
# Address and undefined-behaviour sanitizers over the tests labelled fast.
set -euo pipefail
cd "$(dirname "$0")/.."

./ci/setup.sh
CMAKE_OPTIONS="-DDYNOPROOF_SANITIZE=ON -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-O1" \
  ./ci/build.sh build-sanitize fast_tests
ctest --test-dir build-sanitize --output-on-failure --no-tests=error -L fast -j "$(nproc)"
