#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Compiles the elementary functions and the tissue solvers with g++ and clang++ at -O1, -O2 and -O3 (the former also at -O0, and for
# processors with fused multiply-add) and compares what they find, bit by bit.
# usage: check_bits.sh SOURCE_FOLDER SCRATCH_FOLDER [COMPILER...]     exit status 77: a compiler is missing
set -euo pipefail
source_folder=$1 scratch=$2
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
  "$1" -std=c++20 -fno-math-errno -fno-trapping-math -w "-I$source_folder"/src/{math/include,math/src,math/test,core/include} \
    "${@:2}" "$source_folder"/tests/bits/elementary_bits.cpp "$source_folder"/src/math/src/elementary_*.cpp -o "$scratch/elementary_bits"
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

tissue=$source_folder/src/tissue
sources=("$source_folder/tests/bits/solve_bits.cpp" "$tissue"/src/*.cpp "$source_folder"/src/core/src/{assert,simd_level,state_archive}.cpp
  "$source_folder"/src/math/src/pose.cpp "$source_folder"/src/geometry/src/{distance,mesh_measures,mesh_topology,primitives}.cpp)
# what CMakeLists.txt gives them, but for the optimisation
flags=(-std=c++20 -ffp-contract=off -fno-math-errno -fno-trapping-math -DNDEBUG -w -I"$tissue/src")
for module in tissue geometry math core; do flags+=(-I"$source_folder/src/$module/include"); done

first=
for compiler in "${compilers[@]}"; do
  for level in "${levels[@]}"; do
    folder=$scratch/$compiler$level
    rm -rf "$folder"
    mkdir -p "$folder"
    running=0
    for file in "${sources[@]}"; do
      own=()
      if [ "$architecture" = x86_64 ]; then
        case $file in
          *kernels_avx2.cpp) own=(-mavx2 -mfma) ;;
          *kernels_avx512.cpp)
            own=(-mavx512f -mavx512vl -mavx512dq -mavx512bw -mfma -mprefer-vector-width=512) ;;
        esac
      fi
      # as many at a time as there are processors
      [ $running -lt "$(nproc)" ] || { wait -n; running=$((running - 1)); }
      "$compiler" "${flags[@]}" "$level" "${own[@]}" -c "$file" -o "$folder/$(basename "$file" .cpp).o" &
      running=$((running + 1))
    done
    for ((; running > 0; --running)); do wait -n; done
    "$compiler" "$folder"/*.o -ltbb -lpthread -o "$folder/solve_bits"
    "$folder/solve_bits" > "$folder/bits"
    [ -s "$folder/bits" ] || { echo "$compiler $level: nothing was printed"; exit 1; }
    if [ -z "$first" ]; then
      first=$folder/bits
      cat "$first"
    elif ! diff "$first" "$folder/bits"; then
      echo "$compiler $level finds other bits than the first"
      exit 1
    else
      echo "$compiler $level: the same"
    fi
    rm -f "$folder"/*.o
  done
done
