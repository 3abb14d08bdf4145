#!/usr/bin/env bash
# Has this change made the program slower? Builds BASE (a commit) beside this tree and runs the benchmarks of both in turn
# (bench/ab.py says how a verdict comes about). ci/perf_gate.sh BASE [--json FILE] [--markdown FILE]
# Ends with 0 same or better, 4 inconclusive, 5 worse or a benchmark is missing.
set -euo pipefail
cd "$(dirname "$0")/.."

[ $# -ge 1 ] || { echo "usage: ci/perf_gate.sh BASE [--json FILE] [--markdown FILE]" >&2; exit 2; }
base=$(git rev-parse --verify --quiet "$1^{commit}") || { echo "perf_gate: $1 is no commit here" >&2; exit 2; }
shift
./ci/setup.sh
./ci/build.sh build core_bench
tree=build-base/tree
if git diff --quiet "$base" -- CMakeLists.txt engine bench; then
  echo "perf_gate: the sources of $base are these; both sides run this build"
  base_build=build
else
  mkdir -p build-base
  git worktree remove --force "$tree" 2>/dev/null || true
  git worktree prune
  git worktree add --quiet --detach "$tree" "$base"
  trap 'git worktree remove --force "$tree"' EXIT
  (cd "$tree" && ./ci/build.sh ../build core_bench)
  base_build=build-base/build
fi
# Not exec: the worktree must go.
./bench/ab.py "$base_build" build "$@"
