#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the engine with the thread sanitizer and runs the tests in which our own threads meet.
#   check_threads.sh ROOT FOLDER   FOLDER: where it is built; kept, so that the next time is quick
# oneTBB is not built for the sanitizer, which then sees races inside it: tests that share loops out are left out.
set -euo pipefail
root=$1 folder=$2
command -v clang++ >/dev/null || { echo "there is no clang++ here" >&2; exit 77; }

cmake -S "$root" -B "$folder" --preset tsan \
  -DTROCAR_MODULES="core;roles;math;geometry;collision;tissue;tissue_cuda;instrument;rigid;surgery;training;device;haptics;images;meshing;contours;anatomy;scene;simulation;record;agent;session"
ninja -C "$folder" core_tests session_tests
"$folder/core_tests" --gtest_filter='NewestSlot.*'
"$folder/session_tests" --gtest_filter='RunnerTest.*'
