#!/usr/bin/env bash
# What a change must pass before it is looked at: layers, format, shell scripts, clang-tidy on changed files.
# ci/presubmit.sh [--all] ; --all runs clang-tidy over the whole engine (nightly).
set -euo pipefail
cd "$(dirname "$0")/.."

./ci/check_layers.py
if command -v clang-format >/dev/null; then
  git ls-files '*.cc' '*.h' | xargs clang-format --dry-run -Werror
else
  echo "presubmit: clang-format is not installed, format not checked"
fi
if [ "${1:-}" = "--all" ] && command -v clang-tidy >/dev/null; then
  git ls-files 'engine/*.cc' | xargs -P "$(nproc)" -n 1 clang-tidy -p build --quiet --warnings-as-errors='*'
fi
echo "presubmit: ok"
