#!/usr/bin/env bash
# Configures and builds. ci/build.sh [FOLDER [TARGET...]] with cmake options in CMAKE_OPTIONS.
set -euo pipefail
cd "$(dirname "$0")/.."

folder=${1:-build}
shift || true
launcher=()
command -v ccache >/dev/null && launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
# shellcheck disable=SC2086  # CMAKE_OPTIONS is a list
cmake -S . -B "$folder" -G Ninja "${launcher[@]}" ${CMAKE_OPTIONS:-} >"$folder.configure.log" 2>&1 ||
  { cat "$folder.configure.log"; exit 2; }
mv "$folder.configure.log" "$folder/configure.log"
cmake --build "$folder" -- "${@:-all}"
