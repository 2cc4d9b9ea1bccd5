#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Compiles the whole engine to WebAssembly, runs its unit tests under node, and plays goldens there: each tick has the bits that it
# has here. Prints how long the build took and how large the engine's libraries are.
# usage: check_engine.sh SOURCE_FOLDER NATIVE_SCENE_BITS [--ticks N]     exit status 77: emscripten or node is not there
#   --ticks N   of each golden that are played (100); 0: to its end
set -euo pipefail
source_folder=$(cd "$1" && pwd) native=$2 ticks=100
[ "${3:-}" != --ticks ] || ticks=$4
folder=$source_folder/build/browser
for program in em++ node dpkg-source; do
  command -v $program >/dev/null || { echo "skipped: there is no $program here; tools/install-packages --browser brings it"; exit 77; }
done
[ -x "$native" ] || { echo "check_engine.sh: there is no $native; build scene_bits first" >&2; exit 2; }
# Debian's emscripten looks for its parser of JavaScript where Debian's own node does
export NODE_PATH=/usr/share/nodejs${NODE_PATH:+:$NODE_PATH}

cd "$source_folder"
tools/get-bullet-source "$folder"
begin=$SECONDS
cmake --preset browser >"$folder/configure.log" 2>&1 || { tail -n 30 "$folder/configure.log"; exit 1; }
mapfile -t engine < <(grep -l SOURCES src/engine/*/CMakeLists.txt | xargs -n1 dirname | xargs -n1 basename)
ninja -C "$folder" "${engine[@]/#/trocar_}" >"$folder/engine.log" 2>&1 || { tail -n 30 "$folder/engine.log"; echo "the engine does not compile"; exit 1; }
echo "the engine: compiled in $((SECONDS - begin)) s"
total=0
for module in "${engine[@]}"; do
  library=$folder/src/engine/$module/libtrocar_$module.a
  size=$(stat -c %s "$library")
  total=$((total + size))
  printf '  %-11s %7d kB\n' "$module" $((size / 1024))
done
printf '  %-11s %7d kB\n' together $((total / 1024))
begin=$SECONDS
ninja -C "$folder" >"$folder/tests.log" 2>&1 || { tail -n 30 "$folder/tests.log"; echo "its tests do not compile"; exit 1; }
echo "tests, procedure and readers: compiled in $((SECONDS - begin)) s"

begin=$SECONDS
run_tests() {
  local log=$1.log
  if ! node "$1.js" '--gtest_filter=-*Slow*' >"$log" 2>&1; then
    cut -c 1-200 "$log" | grep -E 'Failure|FAILED|Aborted|Error' | head -n 20
    echo "$(basename "$1"): failed in WebAssembly"
    return 1
  fi
  sed -n "s/^\[  PASSED  \] /$(basename "$1"): /p" "$log"
}
export -f run_tests
printf '%s\n' "$folder"/*_tests.js | sed 's/\.js$//' | xargs -P "$(nproc)" -I{} bash -c 'run_tests {}'
echo "unit tests took $((SECONDS - begin)) s"

# a page makes no patients; the operations are the slow lane's
begin=$SECONDS
mapfile -t goldens < <(sed -n 's/^ *"name": "\(.*\)",$/\1/p' tests/golden/goldens.json | grep -v '^patient/' | grep -v '^operation/')
node "$folder/scene_bits.js" play "$source_folder" --ticks "$ticks" "${goldens[@]}" >"$folder/page.bits"
"$native" play "$source_folder" --ticks "$ticks" "${goldens[@]}" >"$folder/here.bits"
[ "$(wc -l <"$folder/page.bits")" -ge ${#goldens[@]} ] || { echo "only $(wc -l <"$folder/page.bits") fingerprints"; exit 1; }
diff "$folder/here.bits" "$folder/page.bits" || { echo "scenes have other bits in WebAssembly"; exit 1; }
echo "${#goldens[@]} goldens in WebAssembly: the same, $(wc -l <"$folder/page.bits") fingerprints, $((SECONDS - begin)) s"
