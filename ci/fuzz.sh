#!/usr/bin/env bash
# Every reader under libFuzzer, from the stored corpus on. ci/fuzz.sh SECONDS [READER...]; SECONDS for each, one after the
# other. A finding ends with exit 1 and lies in out/fuzz/READER/. What was found worth keeping lies in out/fuzz/READER/corpus
# and is where the next call goes on; out/fuzz/runs has a line for each: reader, seconds, files, findings. Needs clang.
#
# HDF5 is read in the fuzzing process itself, where its course is seen. The library dies of damaged files, for which the
# program has a process apart: such a file is no finding if that process makes a sentence of it.
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

# sort_file READER FILE: whether a file that ended a process is a finding. The innermost frame that is neither the C library's nor
# a sanitizer's tells whose fault it is; whatever it was, the program must survive the file.
sort_file() {
  local reader=$1 file=$2 first
  TMPDIR=$scratch ASAN_OPTIONS=detect_leaks=0 timeout 120 "build-fuzz/tests/fuzz/fuzz_$reader" -timeout=60 \
    -rss_limit_mb=4096 "$file" >"$scratch/alone" 2>&1 || true
  first=$(grep -m1 -oE '^ *#[0-9]+ .*(libhdf5|dynoproof::)' "$scratch/alone" || true)
  if grep -qE '^fuzz: |runtime error: ' "$scratch/alone" || [[ $first == *dynoproof::* ]]; then
    cat "$scratch/alone"
    return 1
  fi
  TMPDIR=$scratch ASAN_OPTIONS=detect_leaks=0 DYNOPROOF_READ_APART=1 timeout 300 "build-fuzz/tests/fuzz/fuzz_$reader" \
    -timeout=200 -rss_limit_mb=4096 "$file" >"$scratch/alone" 2>&1 || { cat "$scratch/alone"; return 1; }
}

for reader in "${readers[@]}"; do
  out=out/fuzz/$reader
  mkdir -p "$out/corpus"
  how=(-timeout=60) leaks=1  # for one small file for ever
  case $reader in hdf5 | mat)
    how=(-fork=1 -ignore_crashes=1 -ignore_timeouts=1 -ignore_ooms=1 -timeout=10)
    leaks=0 ;; # the library leaves things behind when it gives up
  esac
  ended=0 began=$(date +%s)
  TMPDIR=$scratch ASAN_OPTIONS=detect_leaks=$leaks "build-fuzz/tests/fuzz/fuzz_$reader" -max_total_time="$seconds" "${how[@]}" -rss_limit_mb=4096 \
    -max_len=16384 -artifact_prefix="$out/" -print_final_stats=1 "$out/corpus" "tests/fuzz/corpus/$reader" >"$out/log" 2>&1 ||
    ended=$?
  runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$out/log")
  [ -n "$runs" ] || runs=$(grep -oE '^#[0-9]+' "$out/log" | tail -n 1 | tr -d '#')
  took=$(($(date +%s) - began))
  # Where processes may end, the exit code says only that some did.
  if [ "${runs:-0}" -eq 0 ] || { [ $leaks -eq 1 ] && [ $ended -ne 0 ]; }; then
    echo "$reader: a finding, see $out/log"
    tail -n 25 "$out/log"
    failed=1
    echo "$reader $took ${runs:-0} 1" >>out/fuzz/runs
    continue
  fi
  # What is not sorted in as long as it took to find is left for the next call.
  survived=0 found=0 until=$(($(date +%s) + seconds))
  while IFS= read -r file && [ "$(date +%s)" -lt $until ]; do
    if sort_file "$reader" "$file"; then
      survived=$((survived + 1))
      rm "$file"
    else
      echo "$reader: a finding: $file"
      found=$((found + 1))
    fi
  done < <(find "$out" -maxdepth 1 -name '*-*' -type f)
  echo "$reader $took $runs $found" >>out/fuzz/runs
  if [ $found -gt 0 ]; then
    failed=1
  else
    echo "$reader: $runs files, no finding; of $survived the HDF5 library died, not the program"
  fi
done
exit $failed
