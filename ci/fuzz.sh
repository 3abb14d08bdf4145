#!/usr/bin/env bash
# Every reader under libFuzzer, from the stored corpus on. ci/fuzz.sh SECONDS [READER...]; SECONDS for each, one after the
# other. A finding ends with exit 1 and lies in out/fuzz/READER/. What was found worth keeping lies in out/fuzz/READER/corpus
# and is where the next call goes on. Needs clang.
set -euo pipefail
cd "$(dirname "$0")/.."

seconds=${1:?usage: ci/fuzz.sh SECONDS [READER...]}
shift
readers=("$@")
[ ${#readers[@]} -gt 0 ] || mapfile -t readers < <(find tests/fuzz/corpus -mindepth 1 -maxdepth 1 -printf '%f\n' | sort)
CMAKE_OPTIONS="-DDYNOPROOF_FUZZ=ON -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-O1" \
  ./ci/build.sh build-fuzz "${readers[@]/#/fuzz_}"

scratch=$(mktemp -d)  # each target writes its input there; libFuzzer ends without clearing up
trap 'rm -rf "$scratch"' EXIT
failed=0
for reader in "${readers[@]}"; do
  out=out/fuzz/$reader
  mkdir -p "$out/corpus"
  # 60 s for one small file is for ever; the process that reads HDF5 is stopped after 20 s by its own limit.
  if TMPDIR=$scratch "build-fuzz/tests/fuzz/fuzz_$reader" -max_total_time="$seconds" -timeout=60 -rss_limit_mb=4096 \
    -max_len=16384 -artifact_prefix="$out/" -print_final_stats=1 "$out/corpus" "tests/fuzz/corpus/$reader" >"$out/log" 2>&1; then
    runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$out/log")
    echo "$reader: $runs files, no finding"
  else
    echo "$reader: a finding, see $out/log"
    tail -n 25 "$out/log"
    failed=1
  fi
done
exit $failed
