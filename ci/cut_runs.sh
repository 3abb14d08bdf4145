#!/usr/bin/env bash
# Every shipped scenario, ended long before its checks find what they look for: after 0.01 s and after 0.3 s. None of that
# may be read beyond its end. ci/cut_runs.sh PROGRAM, best one that is built with the sanitizers. Ends with 1 where a run died.
set -uo pipefail
cd "$(dirname "$0")/.." || exit

program=${1:?usage: ci/cut_runs.sh PROGRAM}
# What the sanitizers find ends by a signal: their own exit code is that of a check that fell short.
export ASAN_OPTIONS=abort_on_error=1 UBSAN_OPTIONS=abort_on_error=1:print_stacktrace=1
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
declare -A ended=([0]=0 [1]=0 [2]=0 [4]=0)  # 2: shorter than its own time steps
died=0
while IFS= read -r file; do
  for seconds in 0.01 0.3; do
    timeout 600 "$program" run "$file" --set run.duration_s=$seconds --out "$scratch" >"$scratch/log" 2>&1
    code=$?
    if [ -n "${ended[$code]:-}" ]; then
      ended[$code]=$((ended[$code] + 1))
    else
      echo "$file cut to $seconds s ends with $code:"
      tail -n 30 "$scratch/log"
      died=1
    fi
  done
done < <(find scenarios -name '*.toml' ! -name '_*' | sort)
ran=$((ended[0] + ended[1] + ended[4]))
echo "$ran cut runs: ${ended[0]} held, ${ended[1]} fell short, ${ended[4]} undecided; ${ended[2]} refused"
[ "$ran" -gt 0 ] || { echo "nothing ran"; died=1; }
exit $died
