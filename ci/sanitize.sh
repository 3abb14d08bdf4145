#!/usr/bin/env bash
# Address and undefined-behaviour sanitizers over the tests labelled fast. ci/sanitize.sh [FOLDER...]: those of tests/FOLDER.
set -euo pipefail
cd "$(dirname "$0")/.."

./ci/setup.sh
targets=(fast_tests) which=.
if [ $# -gt 0 ]; then
  targets=("${@/%/_test}")
  which="^($(IFS='|'; echo "$*"))/"
fi
CMAKE_OPTIONS="-DDYNOPROOF_SANITIZE=ON -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-O1" \
  ./ci/build.sh build-sanitize "${targets[@]}"
ctest --test-dir build-sanitize --output-on-failure --no-tests=error -L fast -R "$which" -j "$(nproc)"
