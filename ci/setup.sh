#!/usr/bin/env bash
# Installs what is missing of the Debian packages that building and testing need. Does nothing, and needs no rights,
# where all are there.
set -euo pipefail

packages=(
  build-essential cmake ninja-build ccache git ca-certificates python3 python3-yaml python3-numpy
  libeigen3-dev libsundials-dev libhdf5-dev zlib1g-dev libmatio-dev pkgconf libtomlplusplus-dev libfmt-dev libcli11-dev nlohmann-json3-dev libpugixml-dev
  libgtest-dev libgmock-dev libbenchmark-dev libboost-dev libceres-dev libmuparser-dev libzip-dev libsqlite3-dev libssl-dev musl-dev
)
missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
done
# npm, of whatever origin, fetches what draws the report's pictures; Slurm is what campaigns on a cluster are tested with;
# clang-format and shellcheck are what ci/presubmit.sh asks; the browser looks at the report. Their absence does not stop
# this script: without npm the pictures are drawn plainly, without Slurm its test is skipped, presubmit says what it could not
# check, and the tests in the browser fail where CI is set and are else skipped.
wanted=()
command -v npm >/dev/null || wanted+=(npm)
for tool in clang-format shellcheck; do command -v "$tool" >/dev/null || wanted+=("$tool"); done
command -v slurmctld >/dev/null || [ -x /usr/sbin/slurmctld ] || wanted+=(slurm-wlm munge)
[ -x "${DYNOPROOF_BROWSER:-/usr/bin/chromium}" ] || wanted+=(chromium)
[ ${#missing[@]} -eq 0 ] && [ ${#wanted[@]} -eq 0 ] && exit 0

echo "installing: ${missing[*]} ${wanted[*]}"
sudo=""
[ "$(id -u)" -eq 0 ] || sudo="sudo"
export DEBIAN_FRONTEND=noninteractive
install() { $sudo apt-get install -y -qq --no-install-recommends "$@" >/dev/null; }
if [ ${#missing[@]} -gt 0 ]; then
  $sudo apt-get update -qq
  install "${missing[@]}"
fi
if [ ${#wanted[@]} -gt 0 ]; then
  [ ${#missing[@]} -gt 0 ] || $sudo apt-get update -qq || true
  # Nobody here wants the services of these packages started. The file says so for as long as this script lives: if it is
  # killed, the next package that asks gets its leave, and the file goes.
  policy=${DYNOPROOF_POLICY_FILE:-/usr/sbin/policy-rc.d}
  if [ ! -e "$policy" ]; then
    printf '#!/bin/sh\n[ -d /proc/%s ] && exit 101\nrm -f "$0"\n' $$ | $sudo tee "$policy" >/dev/null && $sudo chmod +x "$policy"
    trap '$sudo rm -f "$policy"' EXIT
  fi
  for package in "${wanted[@]}"; do
    install "$package" || echo "setup: $package could not be installed, what needs it is left out"
  done
fi
