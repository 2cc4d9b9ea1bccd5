#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_build_depends.sh REPOSITORY [--control]: what tools/install-packages installs to build against, debian/control asks for, too.
# With --control a library is taken away from the latter, and the check must notice.
set -euo pipefail
repository=$1
control=$(<"$repository/debian/control")
[ "${2:-}" != --control ] || control=${control//libhdf5-dev/}
# the list itself; nothing is installed
source <(sed -n '/^libraries=(/,/^)/p' "$repository/tools/install-packages")
[ "${#libraries[@]}" -gt 10 ]
depends=$(sed -n '/^Build-Depends:/,/^[A-Z][a-z-]*:/p' <<<"$control" | sed '1s/^Build-Depends://')
missing=()
for library in "${libraries[@]}"; do
  grep -qE "(^|[[:space:]])$library([,[:space:]]|\$)" <<<"$depends" || missing+=("$library")
done
if [ "${2:-}" = --control ]; then
  [ "${missing[*]}" = libhdf5-dev ] || { echo "noticed: ${missing[*]:-nothing}"; exit 1; }
  exit 0
fi
[ ${#missing[@]} -eq 0 ] || { echo "debian/control does not ask for ${missing[*]}"; exit 1; }
