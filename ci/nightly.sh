#!/usr/bin/env bash
# The long campaigns: the whole suite under the sanitizers, with clang++, at -O2 and -O3, with and without FMA; clang-tidy
# over everything; margins of all checks and their spread over the builds; the benchmarks beside their peers. Results go to
# out/nightly/. Needs clang, valgrind, gcovr; SciPy and Octave take part where they are installed.
set -uo pipefail
cd "$(dirname "$0")/.." || exit
mkdir -p out/nightly
rm -f out/nightly/run*.json  # what an earlier night left must not be compared
export CI=${CI:-true}  # what a person's machine may skip fails here
failed=0
step() {  # step NAME COMMAND...
  local name=$1
  shift
  echo "== $name"
  "$@" >"out/nightly/$name.log" 2>&1 || { echo "   failed, see out/nightly/$name.log"; failed=1; }
}
suite() {  # suite FOLDER CMAKE_OPTIONS
  CMAKE_OPTIONS=$2 ./ci/build.sh "$1" all nightly_tests &&
    ctest --test-dir "$1" -C Nightly --output-on-failure --no-tests=error -j "$(nproc)"
}
step setup ./ci/setup.sh
step gcc-O2 suite build ""
step sanitize suite build-sanitize "-DDYNOPROOF_SANITIZE=FULL -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-O1"
step cut-runs ./ci/cut_runs.sh build-sanitize/dynoproof
step gcc-O3 suite build-O3 "-DCMAKE_CXX_FLAGS_RELEASE=-O3"
step gcc-fma suite build-fma "-DCMAKE_CXX_FLAGS=-mfma -DCMAKE_CXX_FLAGS_RELEASE=-O2"
command -v clang++ >/dev/null && step clang suite build-clang "-DCMAKE_CXX_COMPILER=clang++"
command -v clang++ >/dev/null && step fuzz ./ci/fuzz.sh 450  # an hour over the eight readers
step bit-flips env DYNOPROOF_BIT_FLIPS=all ./build/tests/trace_test --gtest_filter='BitFlips.*'
step kills ./tests/acceptance/kill_points_test.py build/dynoproof build/tests/libdie_on.so --kills 300 --json out/nightly/kill_points.json
step tidy ./ci/presubmit.sh --all
DYNOPROOF_COVERAGE=out/nightly/coverage.json step coverage ./ci/coverage.sh
step run ./build/dynoproof run --out out/nightly --json out/nightly/run.json --junit out/nightly/junit.xml --html out/nightly/report.html
step package ./ci/check_package.sh build
step harness-only ./ci/harness_only.sh
step margins ./ci/margins.py out/nightly/run.json
cat out/nightly/margins.log
builds=(out/nightly/run.json)  # the same scenarios from other compilers and options: same verdicts, and how far apart
for name in O3 fma clang; do
  [ "$name" != clang ] || command -v clang++ >/dev/null || continue
  step "run-$name" "./build-$name/dynoproof" run --out "out/nightly/$name" --json "out/nightly/run-$name.json"
  builds+=("out/nightly/run-$name.json")
done
step spread ./ci/spread.py "${builds[@]}"
cat out/nightly/spread.log
step comparer ./ci/comparer_rates.py build out/nightly "${builds[@]}"
cat out/nightly/comparer.log
# Every scenario by either solver, whichever it names: golden traces, oracles and limits hold for both.
for solver in realtime reference; do
  step "solver-$solver" ./build/dynoproof run --solver "$solver" --out "out/nightly/$solver" --json "out/nightly/solver-$solver.json"
done
step reproduce ./build/dynoproof reproduce all --json out/nightly/claims.json --html out/nightly/atlas.html
step peers ./bench/peers.py build
step budgets ./ci/check_budgets.py --time --json out/nightly/budgets.json
step waiting ./ci/waiting.py --json out/nightly/waiting.json
cat out/nightly/waiting.log
step bench ./build/dynoproof bench --json out/nightly/bench.json
# Campaigns begin anew every night: rows of another build are refused.
rm -rf out/nightly/campaigns
campaign() {  # campaign NAME [JOBS]
  step "$1" ./build/dynoproof sweep "bench/campaigns/$1.toml" --out out/nightly/campaigns --json "out/nightly/$1.json" --jobs "${2:-$(nproc)}"
}
campaign suppression
campaign suppression_probing
campaign r2r_spread
step machine_bandwidth ./bench/machine_bandwidth.py build/dynoproof
step machine_robustness ./bench/machine_robustness.py build/dynoproof
step worst_load ./build/bench/worst_load --json out/nightly/worst_load.json
# Other cases every night; each diagnosis uses all cores.
printf 'include = ["%s/bench/campaigns/blind.toml"]\nseed = %s\n' "$PWD" "$(date +%Y%m%d)" >out/nightly/blind.toml
step reidentify ./bench/reidentify.py --json out/nightly/reidentify.json
step stories ./build/tests/stories_test
step blind ./build/dynoproof sweep out/nightly/blind.toml --jobs 1 --out out/nightly/campaigns --json out/nightly/blind.json
step gate-proved ./bench/ab.py --prove build --json out/nightly/gate.json
exit $failed
