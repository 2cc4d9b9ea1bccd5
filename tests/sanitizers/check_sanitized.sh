#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the engine with sanitizers and runs tests.
#   check_sanitized.sh memory|threads ROOT FOLDER   FOLDER: where it is built; kept, so that the next time is quick
# memory: addresses and undefined behaviour, all tests of the modules that know no window, no OpenGL and no image library.
# threads: the tests in which our own threads meet; oneTBB is not built for that sanitizer, which
# then sees races inside it, so tests that share loops out are left out.
set -euo pipefail
kind=$1 root=$2 folder=$3
command -v clang++ >/dev/null || { echo "there is no clang++ here" >&2; exit 77; }
modules="base;roles;math;geometry;collision;tissue;rod;instrument;rigid;surgery;patient;scene;simulation;cholecystectomy;procedures;host;tissue_cuda;files;training;device;haptics"

case $kind in
  memory)
    cmake -S "$root" -B "$folder" --preset asan -DTROCAR_MODULES="$modules"
    ninja -C "$folder"
    ctest --test-dir "$folder" -L '^fast$' -j2 --output-on-failure --no-tests=error
    ;;
  threads)
    cmake -S "$root" -B "$folder" --preset tsan \
      -DTROCAR_MODULES="$modules;images;meshing;contours;anatomy;record;agent;net;session"
    ninja -C "$folder" host_tests session_tests
    "$folder/host_tests" --gtest_filter='NewestSlot.*'
    "$folder/session_tests" --gtest_filter='RunnerTest.*'
    ;;
  *) echo "check_sanitized.sh: memory or threads, not $kind" >&2; exit 2 ;;
esac
