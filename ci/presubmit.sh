#!/usr/bin/env bash
# What a change must pass before it is looked at: layers, names, comparisons, links, format of the sources, changed sources each
# by itself, shell scripts.
# ci/presubmit.sh [--all]; --all runs clang-tidy over the whole engine as well (nightly). Under CI a missing tool fails.
set -euo pipefail
cd "$(dirname "$0")/.."

skipped=()
have() {
  command -v "$1" >/dev/null && return
  skipped+=("$2: $1 is not installed")
  false
}

./ci/check_layers.py
./ci/check_names.py
./ci/check_twins.py
./ci/check_nan.py
./ci/check_links.py
if git grep -nE '\.dump\(' -- 'engine/*.cc' 'engine/*.h' 'reports/*.cc' 'reports/*.h' ':!engine/base/json_text.h'; then
  echo "presubmit: dump() throws where a text is no UTF-8: take JsonText() of base/json_text.h"
  exit 1
fi
if have clang-format "format"; then
  git ls-files '*.cc' '*.h' | xargs clang-format --dry-run -Werror
fi
# Sources that are compiled together see one another's includes; a changed one of the program has to do with its own.
if [ -d build/generated ]; then
  git diff HEAD --name-only --diff-filter=d -- 'engine/*.cc' 'reports/*.cc' | xargs -r -P "$(nproc)" -n 1 "${CXX:-g++}" -std=c++20 -fsyntax-only -Wall -Wextra -Wshadow -Werror \
    -I. -Iengine -Ibuild/generated -Igolden -isystem /usr/include/eigen3 -isystem /usr/include/hdf5/serial
fi
git grep -lE '^#!.*\b(ba)?sh$' -- . | xargs -n 1 bash -n
if have shellcheck "shell scripts beyond their syntax"; then
  git grep -lE '^#!.*\b(ba)?sh$' -- . | xargs shellcheck --severity=warning
fi
if [ "${1:-}" = "--all" ] && have clang-tidy "clang-tidy"; then
  git ls-files 'engine/*.cc' | xargs -P "$(nproc)" -n 1 clang-tidy -p build --quiet --warnings-as-errors='*'
fi
for what in "${skipped[@]}"; do echo "presubmit: not checked: $what"; done
if [ ${#skipped[@]} -gt 0 ] && [ -n "${CI:-}" ]; then exit 1; fi
echo "presubmit: ok"
