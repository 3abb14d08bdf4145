#!/usr/bin/env bash
# Lines of engine/ that the tests labelled fast pass through. ci/coverage.sh [FOLDER...]: by the tests of tests/FOLDER alone.
# Prints the share of each layer; out/coverage.json (or $DYNOPROOF_COVERAGE) is what `history add` keeps. Needs gcovr.
set -euo pipefail
cd "$(dirname "$0")/.."

command -v gcovr >/dev/null || { echo "coverage: gcovr is not installed"; exit 2; }
targets=(fast_tests) which=.
if [ $# -gt 0 ]; then
  targets=("${@/%/_test}")
  which="^($(IFS='|'; echo "$*"))/"
fi
# Without optimisation a line is what was written as one; assertions stay.
CMAKE_OPTIONS="-DCMAKE_BUILD_TYPE=Coverage -DCMAKE_CXX_FLAGS=--coverage" ./ci/build.sh build-coverage "${targets[@]}"
find build-coverage -name '*.gcda' -delete  # what earlier runs passed through must not count
ctest --test-dir build-coverage --output-on-failure --no-tests=error -L fast -R "$which" -j "$(nproc)"
json=${DYNOPROOF_COVERAGE:-out/coverage.json}
mkdir -p "$(dirname "$json")"
gcovr -r . --filter 'engine/' -j "$(nproc)" --json-summary "$json" build-coverage
python3 - "$json" <<'END'
import collections, json, sys

layers = collections.defaultdict(lambda: [0, 0])
for file in json.load(open(sys.argv[1]))["files"]:
    for name in ("all", file["filename"].split("/")[1]):
        layers[name][0] += file["line_covered"]
        layers[name][1] += file["line_total"]
for name, (covered, total) in sorted(layers.items()):
    print(f"{name:16} {100 * covered / total:5.1f} % of {total} lines")
END
