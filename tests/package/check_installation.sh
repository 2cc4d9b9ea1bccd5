#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_installation.sh REPOSITORY BUILD_FOLDER CMAKE: installs into a folder of its own, and looks whether programs find their data
# there, man pages and desktop files are sound, and a project outside the tree builds against the libraries.
set -euo pipefail
repository=$1 build=$2 cmake=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# a build that was made for tests has no man pages yet
"$cmake" --build "$build" --target installation >"$work/log" 2>&1 || { tail -n 20 "$work/log"; exit 1; }
DESTDIR=$work/root "$cmake" --install "$build" --prefix /usr >"$work/log" 2>&1 || { tail -n 20 "$work/log"; exit 1; }
root=$work/root/usr

echo "-- programs and data"
unset TROCAR_DATA_DIR
"$root/bin/trocar" --version
cd "$work" # nothing of the source tree is near
"$root/bin/trocar" doctor --json >doctor.json || true
grep -q "\"found\": \"$root/share/trocar" doctor.json || { cat doctor.json; exit 1; }
LANGUAGE=es LC_ALL=C.UTF-8 "$root/bin/trocar" errors >errors.txt
grep -q 'no se puede leer' errors.txt || { echo "Spanish is missing"; exit 1; }
# commands of the programs in libexec
"$root/bin/trocar" bench --list | grep -q '^ *tissue' || { echo "trocar-research does not start"; exit 1; }
"$root/bin/trocar" play --list | grep -q peg_transfer || { echo "trocar-training finds no tasks"; exit 1; }
"$root/bin/trocar" anatomy generate --seed 3 -o generated >/dev/null
if python3 -c 'import h5py, numpy' 2>/dev/null; then
  "$root/bin/trocar" dataset --layout trocar --task peg_transfer --size 64x48 --every 0.5 --most-seconds 1 -o set
  "$root/bin/trocar" dataset verify set
fi
for page in "$root"/share/man/man1/*.1 "$root"/share/man/es/man1/*.1; do
  [ -z "$(man --warnings -E UTF-8 -l -Tutf8 -Z "$page" 2>&1 >/dev/null)" ] || { echo "$page is no sound page"; exit 1; }
done
[ "$(ls "$root"/share/man/man1 | wc -l)" -gt 20 ]
[ "$(ls "$root"/share/man/man1)" = "$(ls "$root"/share/man/es/man1)" ] || { echo "manual pages without Spanish"; exit 1; }
grep -q 'vesícula biliar' "$root"/share/man/es/man1/trocar.1
if command -v desktop-file-validate >/dev/null; then desktop-file-validate "$root"/share/applications/*.desktop; fi
if command -v appstreamcli >/dev/null; then appstreamcli validate --no-net "$root"/share/metainfo/*.xml; fi

echo "-- a program outside the tree"
"$cmake" -G Ninja -S "$repository/tests/outside_program" -B "$work/outside" -DCMAKE_PREFIX_PATH="$root" \
  -DCMAKE_BUILD_TYPE=Release >"$work/log" 2>&1 || { tail -n 20 "$work/log"; exit 1; }
"$cmake" --build "$work/outside" >"$work/log" 2>&1 || { tail -n 20 "$work/log"; exit 1; }
hash=$("$work/outside/outside_program" "$root/share/trocar/scenes/retraction.json" 20)
"$root/bin/trocar" simulate "$root/share/trocar/scenes/retraction.json" --ticks 20 --json >simulated.json
grep -q "\"hash\": \"$hash\"" simulated.json ||
  { echo "its state hash $hash is not the program's"; exit 1; }

echo "-- a program that links the engine alone"
"$cmake" -G Ninja -S "$repository/tests/outside_program" -B "$work/engine" -DCMAKE_PREFIX_PATH="$root" -DENGINE_ALONE=ON \
  -DCMAKE_BUILD_TYPE=Release >"$work/log" 2>&1 || { tail -n 20 "$work/log"; exit 1; }
"$cmake" --build "$work/engine" -v >"$work/log" 2>&1 || { tail -n 20 "$work/log"; exit 1; }
"$work/engine/engine_program"
allowed='linux-vdso|ld-linux|libBullet|libLinearMath|libstdc\+\+|libm\.|libgcc_s|libc\.'
! ldd "$work/engine/engine_program" | grep -vE "$allowed" || { echo "the engine needs these libraries, too"; exit 1; }
! grep -oE '(-l|lib)(ITK|itk|gdcm|gtk|sqlite|spdlog|fmt|tbb|sodium|png|zstd)[^ ]*' "$work/log" ||
  { echo "the engine is linked with these libraries"; exit 1; }

echo "check_installation: whole; state hash $hash"
