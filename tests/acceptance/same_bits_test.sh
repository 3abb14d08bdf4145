#!/usr/bin/env bash
# A trace has the same bytes whatever variants of sine and exponential the machine's libm would choose.
# same_bits_test.sh PROGRAM
set -euo pipefail

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
scenarios=(r2r/soft_rotor_setup_1 backlash/chirp_left suppression/adaptive)
run() {  # run FOLDER [ENVIRONMENT...]: of a run cut short nothing but its trace is wanted
  env "${@:2}" "$program" run "${scenarios[@]}" --set run.duration_s=0.3 --out "$folder/$1" >"$folder/$1.log" 2>&1 || true
}
program=$1
run plain GLIBC_TUNABLES=
run other GLIBC_TUNABLES=glibc.cpu.hwcaps=-FMA,-AVX2,-AVX2_Usable,-FMA_Usable
compared=0
for scenario in "${scenarios[@]}"; do
  cmp "$folder/plain/$scenario.h5" "$folder/other/$scenario.h5" || { cat "$folder/plain.log"; exit 1; }
  compared=$((compared + 1))
done
[ "$compared" -eq "${#scenarios[@]}" ]
echo "$compared traces are the same, byte by byte"
