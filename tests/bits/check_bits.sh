#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Compiles the elementary functions and the tissue solvers with g++ and clang++ at -O1, -O2 and -O3 (the former also at -O0, and for
# processors with fused multiply-add) and compares what they find, bit by bit.
# Where it compares several optimisations, it also puts one mistake at a time into a copy of the sources, which must be noticed.
# usage: check_bits.sh SOURCE_FOLDER SCRATCH_FOLDER [COMPILER...]     exit status 77: a compiler is missing
set -euo pipefail
source_folder=$1 scratch=$2
. "$source_folder/tests/bits/mistakes.sh"
shift 2
compilers=("${@:-g++}")
[ $# -gt 0 ] || compilers=(g++ clang++)
levels=(${TROCAR_BITS_LEVELS:--O1 -O2 -O3})
for compiler in "${compilers[@]}"; do
  command -v "$compiler" > /dev/null || { echo "skipped: there is no $compiler here; tools/install-packages brings it"; exit 77; }
done

architecture=$(uname -m)
# elementary_bits COMPILER FLAG...: what the program prints
elementary_bits() {
  "$1" -std=c++20 -fno-math-errno -fno-trapping-math -w "-I$source_folder"/src/engine/{math/include,math/src,math/test,base/include} \
    "${@:2}" "$source_folder"/tests/bits/elementary_bits.cpp "$source_folder"/src/engine/math/src/elementary_*.cpp -o "$scratch/elementary_bits"
  "$scratch/elementary_bits"
}
mkdir -p "$scratch"
machines=("")
fused=-mfma
[ "$architecture" = x86_64 ] && grep -qw fma /proc/cpuinfo && machines+=("$fused -mavx2") || fused=
elementary_bits "${compilers[0]}" -ffp-contract=off -O1 > "$scratch/elementary"
[ -s "$scratch/elementary" ] || { echo "the elementary functions: nothing was printed"; exit 1; }
cat "$scratch/elementary"
for compiler in "${compilers[@]}"; do
  for level in -O0 "${levels[@]}"; do
    for machine in "${machines[@]}"; do
      elementary_bits "$compiler" -ffp-contract=off "$level" $machine | diff "$scratch/elementary" - ||
        { echo "elementary functions: $compiler $level $machine gives other bits than the first"; exit 1; }
      echo "elementary functions, $compiler $level $machine: the same"
    done
  done
done
# a control: where products and sums are fused, it must be noticed
if [ -n "$fused" ]; then
  elementary_bits "${compilers[0]}" -ffp-contract=fast -O2 "$fused" > "$scratch/elementary_fused"
  ! cmp -s "$scratch/elementary" "$scratch/elementary_fused" ||
    { echo "elementary functions: fused multiply-add was not noticed"; exit 1; }
fi

# what CMakeLists.txt gives them, but for the optimisation
flags=(-std=c++20 -ffp-contract=off -fno-math-errno -fno-trapping-math -DNDEBUG -w)
solver_sources() {
  printf '%s\n' "$1"/tests/bits/solve_bits.cpp "$1"/src/engine/tissue/src/*.cpp "$1"/src/engine/base/src/{assert,simd_level,state_archive}.cpp "$1"/src/platform/host/src/threads.cpp \
    "$1"/src/engine/math/src/{pose,elementary_*}.cpp "$1"/src/engine/geometry/src/{distance,mesh_measures,mesh_topology,primitives}.cpp
}
# solve_bits SOURCES FOLDER COMPILER FLAG...: compiles as many files at a time as there are processors, and prints what the program does
solve_bits() {
  local sources=$1 folder=$2 compiler=$3 running=0 file own includes=()
  rm -rf "$folder"
  mkdir -p "$folder"
  for file in engine/{tissue,geometry,math,base} platform/host; do includes+=(-I"$sources/src/$file/include"); done
  for file in $(solver_sources "$sources"); do
    own=()
    if [ "$architecture" = x86_64 ]; then
      case $file in
        *kernels_avx2.cpp) own=(-mavx2) ;;
        *kernels_avx512.cpp)
          own=(-mavx512f -mavx512vl -mavx512dq -mavx512bw -mprefer-vector-width=512) ;;
      esac
    fi
    [ $running -lt "$(nproc)" ] || { wait -n; running=$((running - 1)); }
    "$compiler" "${flags[@]}" "${includes[@]}" -I"$sources"/src/engine/{tissue,math}/src "${@:4}" ${own[@]+"${own[@]}"} \
      -c "$file" -o "$folder/$(basename "$file" .cpp).o" &
    running=$((running + 1))
  done
  for ((; running > 0; --running)); do wait -n; done
  "$compiler" "$folder"/*.o -ltbb -lpthread -o "$folder/solve_bits"
  rm -f "$folder"/*.o
  "$folder/solve_bits"
}

first=
for compiler in "${compilers[@]}"; do
  for level in "${levels[@]}"; do
    found=$scratch/$compiler$level.bits
    solve_bits "$source_folder" "$scratch/$compiler$level" "$compiler" "$level" > "$found"
    [ -s "$found" ] || { echo "$compiler $level: nothing was printed"; exit 1; }
    if [ -z "$first" ]; then
      first=$found
      cat "$first"
      # each level of vector instructions finds what the baseline finds
      for simd in avx2 avx512; do
        ! grep -q "^$simd " "$first" || diff <(sed -n 's/^baseline //p' "$first") <(sed -n "s/^$simd //p" "$first") ||
          { echo "$simd finds other bits than the baseline"; exit 1; }
      done
    elif ! diff "$first" "$found"; then
      echo "$compiler $level finds other bits than the first"
      exit 1
    else
      echo "$compiler $level: the same"
    fi
  done
done

# controls
[ ${#levels[@]} -gt 1 ] || exit 0
for mistake in "${mistakes[@]}"; do
  copy=$scratch/mistaken
  copy_sources "$source_folder" "$copy" src/engine/{tissue,geometry,math,base} src/platform/host tests/bits
  make_mistake "$mistake" "$copy"
  if [ "$mistake" = function_of_the_c_library ]; then
    source_folder=$copy elementary_bits "${compilers[0]}" -ffp-contract=off -O1 > "$scratch/$mistake"
    same=$scratch/elementary
  else
    solve_bits "$copy" "$scratch/mistaken_build" "${compilers[0]}" "${levels[0]}" > "$scratch/$mistake"
    same=$first
  fi
  ! cmp -s "$same" "$scratch/$mistake" || { echo "control: ${mistake//_/ } was not noticed"; exit 1; }
  echo "control: ${mistake//_/ } is noticed"
done
