#!/usr/bin/env bash
# Configures and builds. ci/build.sh [FOLDER [TARGET...]] with cmake options in CMAKE_OPTIONS.
# DYNOPROOF_PRECOMPILE=1: precompiled headers instead of a compiler cache, which helps only where it has seen the project.
set -euo pipefail
cd "$(dirname "$0")/.."

folder=${1:-build}
shift || true
launcher=()
if [ -n "${DYNOPROOF_PRECOMPILE:-}" ]; then
  launcher=(-DDYNOPROOF_PRECOMPILE=ON)
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
