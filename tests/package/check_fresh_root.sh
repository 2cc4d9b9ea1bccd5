#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_fresh_root.sh REPOSITORY MIRROR trocar.deb trocar-data.deb libtrocar-dev.deb
# Installs the packages into a Debian that debootstrap has just made, starts the programs, builds a program against the
# libraries, upgrades, purges, and compares the files before and after. Ends with 77 where no such system can be made.
set -euo pipefail
repository=$1 mirror=$2
shift 2
skip() { echo "check_fresh_root: left out: $1"; exit 77; }
[ "$(id -u)" -eq 0 ] || skip "a fresh system needs root rights"
command -v debootstrap >/dev/null || skip "debootstrap is not installed"
. /etc/os-release

work=$(mktemp -d)
fresh=$work/root
cleanup() {
  umount "$fresh/proc" "$fresh/dev/shm" 2>/dev/null || true
  # never through a mount that would not go
  if ! grep -q " $fresh/" /proc/mounts; then rm -rf "$work"; fi
}
trap cleanup EXIT
debootstrap --variant=minbase "$VERSION_CODENAME" "$fresh" "$mirror" >"$work/debootstrap.log" 2>&1 ||
  skip "debootstrap could not make a system from $mirror: $(tail -n 1 "$work/debootstrap.log")"
mkdir -p "$fresh/dev/shm"
mount -t proc proc "$fresh/proc"
mount -t tmpfs tmpfs "$fresh/dev/shm"
cp /etc/resolv.conf "$fresh/etc/resolv.conf" 2>/dev/null || true
# nobody needs this system after a power cut: without waiting for the disk it is there in a quarter of the time
echo force-unsafe-io >"$fresh/etc/dpkg/dpkg.cfg.d/check"
printf 'Dpkg::Use-Pty "0";\nAPT::Install-Recommends "0";\n' >"$fresh/etc/apt/apt.conf.d/90check"

# each command alone: a home that does not exist yet, English, no display
inside() { chroot "$fresh" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive "$@"; }
# all files but those that apt and dpkg keep for themselves
list_files() {
  (cd "$fresh" && find . -xdev \( -path ./proc -o -path ./var/cache -o -path ./var/lib/apt -o -path ./var/lib/dpkg \
    -o -path ./var/log -o -path ./tmp -o -path ./packages \) -prune -o -print | sort)
}

mkdir "$fresh/packages"
cp "$@" "$fresh/packages/"
inside apt-get -q update >/dev/null
# what Trocar depends on is installed first, so that the comparison shows Trocar's own files alone
dependencies=$(for package in "$@"; do dpkg-deb -f "$package" Depends; done | tr ',' '\n' |
  sed 's/|.*//; s/(.*)//; s/ //g' | grep -v '^trocar-data$' | sort -u)
# shellcheck disable=SC2086
inside apt-get -q -y install $dependencies cmake g++ ninja-build libgl1-mesa-dri libegl-mesa0 >"$work/apt.log" 2>&1 || {
  tail -n 20 "$work/apt.log"
  exit 1
}
list_files >"$work/before"

echo "-- install"
inside sh -c 'apt-get -q -y install /packages/*.deb' >"$work/apt.log" 2>&1 || { cat "$work/apt.log"; exit 1; }
echo "-- start"
inside trocar --version
inside trocar doctor --json >"$work/doctor.json" || true # there is no display here, and doctor says so
grep -A1 '"name": "data"' "$work/doctor.json" | grep -q '"state": "good"' || { cat "$work/doctor.json"; exit 1; }
grep -A1 '"name": "images"' "$work/doctor.json" || true
inside trocar doctor || true
mkdir -p "$fresh/packages/tree/tests"
cp -r "$repository/debian" "$fresh/packages/tree/"
cp -r "$repository/tests/outside_program" "$fresh/packages/tree/tests/"
inside sh /packages/tree/debian/tests/programs
inside sh /packages/tree/debian/tests/libraries
inside rm -rf /root/.cache

echo "-- upgrade"
# the same packages under the next version: what a user's apt sees
for package in "$@"; do
  dpkg-deb -R "$package" "$work/unpacked"
  sed -i -E 's/^(Version: .*)$/\1+next/; s/\(= ([^)]*)\)/(= \1+next)/' "$work/unpacked/DEBIAN/control"
  dpkg-deb --root-owner-group -b "$work/unpacked" "$fresh/packages/next-$(basename "$package")" >/dev/null
  rm -rf "$work/unpacked"
done
inside sh -c 'apt-get -q -y install /packages/next-*.deb' >"$work/apt.log" 2>&1 || { cat "$work/apt.log"; exit 1; }
inside dpkg-query -W -f '${Package} ${Version}\n' trocar trocar-data libtrocar-dev
[ "$(inside dpkg-query -W -f '${Version}\n' trocar trocar-data libtrocar-dev | grep -c '+next$')" -eq 3 ]
inside trocar simulate /usr/share/trocar/scenes/retraction.json --ticks 2 >/dev/null

echo "-- purge"
inside apt-get -q -y purge trocar trocar-data libtrocar-dev >"$work/apt.log" 2>&1 || { cat "$work/apt.log"; exit 1; }
list_files >"$work/after"
# caches of icons and of the linker are made by triggers of other packages
if ! diff "$work/before" "$work/after" >"$work/left" && grep -q '^[<>]' "$work/left"; then
  echo "check_fresh_root: not as before after the purge:"
  cat "$work/left"
  exit 1
fi
echo "check_fresh_root: installed, started, upgraded and purged; nothing was left"
