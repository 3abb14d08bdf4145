#!/usr/bin/env bash
# Does the harness stand without the thesis? Copies the tree, deletes engine/thesis/ with the scenarios, golden data and
# campaigns that belong to it (engine/thesis/README.md says which), builds what is left and runs its tests.
# ci/harness_only.sh [FOLDER]: where the copy goes, build-harness by default; it is made anew.
set -euo pipefail
cd "$(dirname "$0")/.."

copy=${1:-build-harness}
rm -rf "$copy"
mkdir -p "$copy"
git ls-files -z | tar --null --files-from=- -cf - | tar -xf - -C "$copy"
cd "$copy"
rm -r engine/thesis tests/thesis tests/mutants
# The common parts that start with "_" stay: the scenarios of diagnosis are made of them.
for family in heavy_duty r2r backlash coupling suppression pressure; do
  find "scenarios/$family" -name '[!_]*.toml' -delete
  rm -rf "golden/$family"
done
rm golden/published.toml golden/figures.toml golden/coverage.toml golden/independent.py
rm bench/campaigns/suppression.toml bench/campaigns/suppression_probing.toml bench/campaigns/r2r_spread.toml
rm bench/campaigns/machine_bandwidth.toml bench/campaigns/machine_bandwidth_runs.toml bench/machine_bandwidth.py
rm bench/campaigns/machine_robustness.toml bench/machine_robustness.py
rm bench/worst_load.cc bench/core_bench.cc
git init -q .  # the tree's scripts ask git for the files; the copy lies inside another one
git add -A
./ci/build.sh build all
ctest --test-dir build --output-on-failure --no-tests=error -j "$(nproc)"
