#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Plays scenes, tasks and operations with builds of other compilers, standard libraries and optimisations and with each level of
# vector instructions, and compares their states, bit by bit, with those of the first build.
# usage: check_scenes.sh SOURCE_FOLDER SCRATCH_FOLDER [--build FOLDER] [--ticks N] [--whole] [--control] [RECORDING...] -- BUILD...
#   BUILD        COMPILER:OPTIMISATION[:libc++], as g++:-O2 or clang++:-O2:libc++; each is built in a folder of its own
#   --build      a build folder that is there already, whose scene_bits is the first; without it the first BUILD is
#   --ticks N    of each golden, 0 for all of them (default: 200)
#   --whole      also whole operations to their end: minutes each
#   --control    also builds with one mistake each, which must be noticed: fused multiply-add, a function of the C library's,
#                an unstable sort
#   RECORDING    each build must verify it
# exit status 77: nothing could be compared because compilers are missing
set -euo pipefail
source_folder=$(cd "$1" && pwd)
mkdir -p "$2"
scratch=$(cd "$2" && pwd)
shift 2
first_folder='' ticks=200 whole=no control=no recordings=()
while [ $# -gt 0 ] && [ "$1" != -- ]; do
  case $1 in
    --build) first_folder=$2; shift ;;
    --ticks) ticks=$2; shift ;;
    --whole) whole=yes ;;
    --control) control=yes ;;
    -*) echo "check_scenes.sh: unknown option $1" >&2; exit 2 ;;
    *) recordings+=("$1") ;;
  esac
  shift
done
[ $# -eq 0 ] || shift
builds=("$@")

# no tests, no windows, no programs: what scene_bits is linked with
modules="base;roles;math;geometry;collision;tissue;instrument;rigid;surgery;patient;scene;simulation;cholecystectomy;procedures;host;files;training;images;meshing;contours;anatomy;record;agent"

# find_libcxx: compiler and linker options for libc++: the system's, or, because Debian's package of its headers takes the place
# of one that GStreamer's need, the packages' content in the scratch folder
find_libcxx() {
  if echo '#include <version>' | clang++ -stdlib=libc++ -x c++ -fsyntax-only - 2>/dev/null; then
    libcxx_compile="-stdlib=libc++" libcxx_link="-stdlib=libc++"
    return
  fi
  local version root=$scratch/libcxx
  version=$(clang++ -dumpversion) version=${version%%.*}
  if [ ! -d "$root/usr/lib/llvm-$version/include/c++/v1" ]; then
    mkdir -p "$root"
    (cd "$root" && apt-get download -q "libc++-$version-dev" "libc++abi-$version-dev" 2>&1 && for file in *.deb; do dpkg -x "$file" .; done) \
      >"$scratch/libcxx_log" || return 1
  fi
  libcxx_compile="-Wno-unused-command-line-argument -nostdinc++ -isystem $root/usr/lib/llvm-$version/include/c++/v1"
  libcxx_link="-nostdlib++ $root/usr/lib/llvm-$version/lib/libc++.a $root/usr/lib/llvm-$version/lib/libc++abi.a -lpthread"
}

# make_build BUILD FOLDER [SOURCES]: scene_bits of a build
make_build() {
  local compiler optimisation library options=() compile link=
  IFS=: read -r compiler optimisation library <<<"$1"
  command -v "$compiler" >/dev/null || { echo "skipped: there is no $compiler here; tools/install-packages --test brings it"; return 77; }
  compile=
  if [ "$library" = libc++ ]; then
    find_libcxx || { echo "skipped: there is no libc++ here, and apt-get cannot fetch it ($scratch/libcxx_log)"; return 77; }
    compile="-isystem $source_folder/cmake/older_libcxx $libcxx_compile" link=$libcxx_link
    options+=(-DTROCAR_HEADER_ONLY_SPDLOG=ON)
  fi
  cmake -S "${3:-$source_folder}" -B "$2" -G Ninja -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE=Release \
    -DCMAKE_CXX_FLAGS="$compile" -DCMAKE_CXX_FLAGS_RELEASE="$optimisation -DNDEBUG" -DCMAKE_CXX_STANDARD_LIBRARIES="$link" \
    -DTROCAR_MODULES="$modules" -DTROCAR_BUILD_TESTS=OFF -DTROCAR_BUILD_BITS=ON -DTROCAR_BUILD_IMPORT=OFF -DTROCAR_PYTHON=OFF \
    -DTROCAR_CUDA=OFF ${options[@]+"${options[@]}"} >"$2.log" 2>&1 && ninja -C "$2" scene_bits >>"$2.log" 2>&1 ||
    { tail -n 30 "$2.log"; echo "$1: cannot be built"; return 1; }
}

# play FOLDER FILE: all fingerprints
play() {
  TROCAR_DATA_DIR=$source_folder "$1/scene_bits" play "$source_folder" --ticks "$ticks" >"$2" || return 1
  [ $whole = no ] || "$1/scene_bits" play "$source_folder" --lane whole >>"$2"
}

# compare WHAT FILE: with the first build's; names where each golden parts from it
failed=0 compared=0
compare() {
  compared=$((compared + 1))
  if cmp -s "$scratch/first" "$2"; then
    echo "$1: the same, $(wc -l <"$2") fingerprints"
    return
  fi
  echo "$1: OTHER BITS than the first"
  # the first line of each golden that differs
  { diff "$scratch/first" "$2" || true; } | sed -n 's/^> //p' | awk '!seen[$1]++ {print "  " $1 " from tick " $2 " on at the latest"}'
  failed=$((failed + 1))
}

verify() {
  [ ${#recordings[@]} -eq 0 ] || "$1/scene_bits" verify "$source_folder" "${recordings[@]}" || failed=$((failed + 1))
}

first_name='the build at hand'
if [ -z "$first_folder" ]; then
  [ ${#builds[@]} -gt 0 ] || { echo "check_scenes.sh: neither --build nor a BUILD" >&2; exit 2; }
  first_name=${builds[0]} first_folder=$scratch/first_build
  make_build "$first_name" "$first_folder" || exit $?
  builds=("${builds[@]:1}")
fi
TROCAR_SIMD=baseline play "$first_folder" "$scratch/first"
[ -s "$scratch/first" ] || { echo "$first_name: nothing was printed"; exit 1; }
echo "$first_name, baseline: $(wc -l <"$scratch/first") fingerprints"
verify "$first_folder"

# every level of vector instructions that this processor has, and the C library's functions for processors without fused
# multiply-add, which have other last bits than those for processors with it
if [ "$(uname -m)" = x86_64 ]; then
  for level in avx2 avx512; do
    grep -qw "${level/avx512/avx512f}" /proc/cpuinfo || { echo "skipped: this processor has no $level"; continue; }
    TROCAR_SIMD=$level play "$first_folder" "$scratch/$level"
    compare "$first_name, $level" "$scratch/$level"
  done
  GLIBC_TUNABLES=glibc.cpu.hwcaps=-FMA,-AVX2,-FMA4 play "$first_folder" "$scratch/without_fma"
  compare "$first_name, a C library without fused multiply-add" "$scratch/without_fma"
fi

for build in ${builds[@]+"${builds[@]}"}; do
  folder=$scratch/${build//:/_}
  status=0
  make_build "$build" "$folder" || status=$?
  [ $status -ne 77 ] || continue
  [ $status -eq 0 ] || { failed=$((failed + 1)); continue; }
  play "$folder" "$folder.txt"
  compare "$build" "$folder.txt"
  verify "$folder"
done

# controls: a copy of the sources with one mistake at a time, each built from where the one before stood
if [ $control = yes ]; then
  . "$source_folder/tests/bits/mistakes.sh"
  copy=$scratch/mistaken
  copy_sources "$source_folder" "$copy" CMakeLists.txt src cmake assets scenes docs/metrics.json tests/bits tests/golden tools
  for mistake in "${mistakes[@]}"; do
    [ "$mistake" != function_of_the_c_library ] || mistake=functions_of_the_c_library
    make_mistake "$mistake" "$copy"
    make_build g++:-O2 "$scratch/mistaken_build" "$copy" || { failed=$((failed + 1)); continue; }
    play "$scratch/mistaken_build" "$scratch/mistaken.txt"
    undo_mistake "$copy"
    compared=$((compared + 1))
    if cmp -s "$scratch/first" "$scratch/mistaken.txt"; then
      echo "control: ${mistake//_/ } was not noticed"
      failed=$((failed + 1))
    else
      echo "control: ${mistake//_/ } is noticed"
    fi
  done
fi

[ "$failed" -eq 0 ] || { echo "$failed of $compared comparisons failed"; exit 1; }
[ "$compared" -gt 0 ] || exit 77
echo "$compared comparisons: the same bits in all"
