#!/usr/bin/env bash
# Installs what is missing of the Debian packages that building and testing need. Does nothing, and needs no rights,
# where all are there.
set -euo pipefail

packages=(
  build-essential cmake ninja-build ccache git ca-certificates
  libeigen3-dev libsundials-dev libhdf5-dev libtomlplusplus-dev libfmt-dev libcli11-dev nlohmann-json3-dev libpugixml-dev
  libgtest-dev libgmock-dev libbenchmark-dev libboost-dev
)
missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0

echo "installing: ${missing[*]}"
sudo=""
[ "$(id -u)" -eq 0 ] || sudo="sudo"
export DEBIAN_FRONTEND=noninteractive
$sudo apt-get update -qq
$sudo apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
