#!/usr/bin/env bash
# Installs what is missing, builds, runs every scenario (or those given; all arguments go to `dynoproof run`) and writes
# traces, scores and the report to out/.
set -uo pipefail
cd "$(dirname "$0")/.." || exit

./ci/setup.sh || exit 2
./ci/build.sh build dynoproof || exit 2
mkdir -p out
./build/dynoproof run --out out --junit out/junit.xml --markdown out/report.md --json out/report.json --html out/report.html \
  --jobs "${DYNOPROOF_JOBS:-$(nproc)}" "$@"
code=$?
echo
echo "report: $PWD/out/report.html (also report.md, report.json, junit.xml; traces: out/<id>.h5)"
exit $code
