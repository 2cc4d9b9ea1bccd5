#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Compiles the elementary functions and the tissue solvers for other processors and compares what they find, bit by bit, with what
# this one finds: WebAssembly under node, without and with its vectors (SIMD128), and ARM under qemu, whose vectors are NEON's.
# usage: check_processors.sh SOURCE_FOLDER SCRATCH_FOLDER [wasm] [aarch64]     exit status 77: nothing of what was asked is there
set -euo pipefail
source_folder=$(cd "$1" && pwd)
mkdir -p "$2"
scratch=$(cd "$2" && pwd)
shift 2
processors=("${@:-wasm}")
[ $# -gt 0 ] || processors=(wasm aarch64)

tissue=$source_folder/src/engine/tissue
elementary=("$source_folder"/tests/bits/elementary_bits.cpp "$source_folder"/src/engine/math/src/elementary_*.cpp)
solvers=("$source_folder"/tests/bits/solve_bits.cpp "$tissue"/src/*.cpp "$source_folder"/src/engine/base/src/{assert,simd_level,state_archive}.cpp
  "$source_folder"/src/engine/math/src/{pose,elementary_*}.cpp "$source_folder"/src/engine/geometry/src/{distance,mesh_measures,mesh_topology,primitives}.cpp)
flags=(-std=c++20 -O2 -ffp-contract=off -fno-math-errno -fno-trapping-math -DNDEBUG -w)
for module in tissue geometry math base; do flags+=(-I"$source_folder/src/engine/$module/include"); done
for folder in tissue/src math/src math/test; do flags+=(-I"$source_folder/src/engine/$folder"); done

# objects_of FOLDER FILE...: where the objects of these sources lie
objects_of() {
  local file
  for file in "${@:2}"; do echo "$1/$(basename "$file" .cpp).o"; done
}

# build FOLDER ENDING COMPILER FLAG...: both programs, as many files at a time as there are processors
build() {
  local folder=$1 ending=$2 compiler=("${@:3}") file running=0
  mkdir -p "$folder"
  while read -r file; do
    local own=()
    case $ending$file in
      *.js*_avx* | .qemu*_avx*) ;; # empty there
      *_avx2.cpp) own=(-mavx2) ;;
      *_avx512.cpp) own=(-mavx512f -mavx512vl -mavx512dq -mavx512bw -mprefer-vector-width=512) ;;
    esac
    [ $running -lt "$(nproc)" ] || { wait -n; running=$((running - 1)); }
    "${compiler[@]}" "${flags[@]}" ${own[@]+"${own[@]}"} -c "$file" -o "$(objects_of "$folder" "$file")" &
    running=$((running + 1))
  done < <(printf '%s\n' "${elementary[@]}" "${solvers[@]}" | sort -u)
  for (( ; running > 0; --running)); do wait -n; done
  "${compiler[@]}" $(objects_of "$folder" "${elementary[@]}") -o "$folder/elementary_bits$ending" ${link[@]+"${link[@]}"}
  "${compiler[@]}" $(objects_of "$folder" "${solvers[@]}") -o "$folder/solve_bits$ending" ${link[@]+"${link[@]}"}
}

# compare WHAT FOLDER ENDING RUNNER...: with this processor's bits
compare() {
  local what=$1 folder=$2 ending=$3 runner=("${@:4}") name
  for name in elementary solve; do
    "${runner[@]}" "$folder/${name}_bits$ending" >"$folder/$name"
    diff "$scratch/here/$name" "$folder/$name" || { echo "$what: other bits than on this processor"; return 1; }
  done
  echo "$what: the same, $(cat "$folder"/{elementary,solve} | wc -l) fingerprints"
}

can_compare() {
  case $1 in
    wasm) command -v em++ >/dev/null && command -v node >/dev/null ||
      { echo "skipped: no em++ or no node; apt-get install emscripten"; return 1; } ;;
    aarch64) command -v aarch64-linux-gnu-g++ >/dev/null && command -v qemu-aarch64 >/dev/null ||
      { echo "skipped: no aarch64-linux-gnu-g++ or no qemu-aarch64; apt-get install g++-aarch64-linux-gnu qemu-user"; return 1; } ;;
    *) echo "check_processors.sh: there is no processor \"$1\"; wasm and aarch64 are known" >&2; exit 2 ;;
  esac
}

wanted=()
for processor in "${processors[@]}"; do can_compare "$processor" && wanted+=("$processor"); done
[ ${#wanted[@]} -gt 0 ] || exit 77

rm -rf "$scratch/here" "$scratch"/wasm* "$scratch/aarch64"
one_thread=(-DTROCAR_BITS_ONE_THREAD)
link=()
build "$scratch/here" "" g++ "${one_thread[@]}"
"$scratch/here/elementary_bits" >"$scratch/here/elementary"
"$scratch/here/solve_bits" >"$scratch/here/every_level"
grep '^baseline' "$scratch/here/every_level" >"$scratch/here/solve"
cat "$scratch"/here/{elementary,solve}
for level in avx2 avx512; do
  sed -n "s/^$level /baseline /p" "$scratch/here/every_level" >"$scratch/here/$level"
  [ ! -s "$scratch/here/$level" ] || diff "$scratch/here/solve" "$scratch/here/$level" ||
    { echo "$level: other bits than with the baseline"; exit 1; }
done

for processor in "${wanted[@]}"; do
  case $processor in
    wasm)
      for vectors in "" -msimd128; do
        link=(-sALLOW_MEMORY_GROWTH -sENVIRONMENT=node -sSINGLE_FILE)
        # why the second flag stands in cmake/browser.cmake
        build "$scratch/wasm$vectors" .js em++ $vectors ${vectors:+-fno-slp-vectorize} "${one_thread[@]}" -isystem "$source_folder/cmake/older_libcxx"
        compare "WebAssembly${vectors:+ with vectors}" "$scratch/wasm$vectors" .js node
      done
      ;;
    aarch64)
      link=()
      build "$scratch/aarch64" .qemu aarch64-linux-gnu-g++ "${one_thread[@]}" -static
      compare "ARM" "$scratch/aarch64" .qemu qemu-aarch64
      ;;
  esac
done
