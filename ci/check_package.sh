#!/usr/bin/env bash
# Builds the Debian package of a build folder and tries it in a system that has nothing else: installed with what it says
# it needs, and a plugin built with what it suggests. ci/check_package.sh [BUILD]. Needs root, debootstrap and the mirror of
# the running release; says so and ends with 0 where it has them not. Leaves the package in BUILD/package/ and nothing else.
set -euo pipefail
cd "$(dirname "$0")/.."

build=${1:-build}
mirror=${DYNOPROOF_MIRROR:-http://deb.debian.org/debian}
skip() { echo "check_package: NOT TRIED: $1"; exit 0; }
[ "$(id -u)" -eq 0 ] || skip "a clean system is made by root only"
# shellcheck disable=SC1091
release=$(. /etc/os-release && [ "$ID" = debian ] && echo "$VERSION_CODENAME") || skip "this is no Debian"
if ! command -v debootstrap >/dev/null; then
  { apt-get update -qq && apt-get install -y -qq --no-install-recommends debootstrap >/dev/null; } ||
    skip "debootstrap cannot be installed"
fi

./ci/build.sh "$build" dynoproof
rm -rf "$build/package"
cpack --config "$build/CPackConfig.cmake" -B "$build/package" >"$build/package.log" 2>&1 || { cat "$build/package.log"; exit 1; }
rm -rf "$build/package/_CPack_Packages"
package=$(echo "$build"/package/*.deb)
dpkg-deb --info "$package"

root=$(mktemp -d)
chmod 755 "$root"  # apt fetches as a user of its own
trap 'umount "$root/proc" 2>/dev/null; rm -rf --one-file-system "$root"' EXIT
debootstrap --variant=minbase "$release" "$root" "$mirror" >"$build/package.log" 2>&1 || { tail -5 "$build/package.log"; exit 1; }
mount -t proc proc "$root/proc" 2>/dev/null || skip "/proc cannot be mounted here"
inside() { env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root DEBIAN_FRONTEND=noninteractive chroot "$root" "$@"; }
cp "$package" "$root/tmp/dynoproof.deb"
inside apt-get update -qq
inside apt-get install -y -qq -o Dpkg::Use-Pty=0 --no-install-recommends /tmp/dynoproof.deb >/dev/null
# Not one path of this tree: neither in the package nor, with the chroot, in reach.
inside sh -ec '
  cd /root
  dynoproof --version
  dynoproof list >/dev/null
  dynoproof describe drive_line >/dev/null
  dynoproof run heavy_duty/alternative_setup_1 --html report.html
  dynoproof reproduce 5.6.1-notch-1 --html atlas.html
  test -s /usr/share/doc/dynoproof/copyright
  dynoproof new law soft_stop >/dev/null'
# shellcheck disable=SC2046  # a list of packages
inside apt-get install -y -qq -o Dpkg::Use-Pty=0 --no-install-recommends make $(dpkg-deb --field "$package" Suggests | tr -d ,) >/dev/null
inside sh -ec '
  cd /root
  cmake -S soft_stop -B soft_stop/build >/dev/null && cmake --build soft_stop/build >/dev/null
  dynoproof describe soft_stop --plugin soft_stop/build/soft_stop.so
  apt-get purge -y -qq dynoproof >/dev/null
  test ! -e /usr/share/dynoproof -a ! -e /usr/bin/dynoproof'
echo "check_package: $package installs, runs and goes"
