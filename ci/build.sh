#!/usr/bin/env bash
# Configures and builds. ci/build.sh [FOLDER [TARGET...]] with cmake options in CMAKE_OPTIONS.
# A compiler cache helps only where it has seen the project: under one that is empty a new folder gets precompiled headers
# in its place, and sources of a layer and tests that are compiled ten together, and keeps both. DYNOPROOF_PRECOMPILE=1 asks for these in any case.
# DYNOPROOF_ONCE=1: nothing is changed here afterwards, so that laws and other plugins are compiled together, too.
set -euo pipefail
cd "$(dirname "$0")/.."

folder=${1:-build}
shift || true
precompiles() {
  [ -z "${DYNOPROOF_PRECOMPILE:-}" ] || return 0
  case ${CMAKE_OPTIONS:-} in *clang*) return 1 ;; esac  # the warnings that these need turned off are GCC's
  if [ -e "$folder/CMakeCache.txt" ]; then
    grep -q '^DYNOPROOF_PRECOMPILE:BOOL=ON' "$folder/CMakeCache.txt"
    return
  fi
  local kept
  kept=$(ccache --print-stats 2>/dev/null | awk '$1 == "files_in_cache" { print $2 }') || true
  [ "${kept:-0}" -lt 500 ]
}
launcher=()
if precompiles; then
  launcher=(-DDYNOPROOF_PRECOMPILE=ON ${DYNOPROOF_ONCE:+-DDYNOPROOF_ONCE=ON})
elif command -v ccache >/dev/null; then
  launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
  # What was compiled in one folder serves any other: paths in the sources are relative (-ffile-prefix-map), and so they are
  # in what the cache compares.
  export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1
fi
# shellcheck disable=SC2086  # CMAKE_OPTIONS is a list
cmake -S . -B "$folder" -G Ninja "${launcher[@]}" ${CMAKE_OPTIONS:-} >"$folder.configure.log" 2>&1 ||
  { cat "$folder.configure.log"; exit 2; }
mv "$folder.configure.log" "$folder/configure.log"
cmake --build "$folder" -- "${@:-all}"
