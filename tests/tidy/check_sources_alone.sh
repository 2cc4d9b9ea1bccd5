#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Each source by itself, not in the units in which it is built, so that one that lacks an include is found.
# usage: check_sources_alone.sh SOURCE_FOLDER SCRATCH_FOLDER
set -euo pipefail
cd "$1"
command -v clang-tidy > /dev/null || { echo "skipped: there is no clang-tidy here; tools/install-packages --test brings it"; exit 77; }
cmake --preset relwithassert -B "$2" -DTROCAR_UNITY=OFF > /dev/null
# ITK's headers refuse clang-tidy's compiler
files=$(tools/list-compiled "$2" | grep -v '/import/read_picture.cpp$')
xargs -P "$(nproc)" -n 8 clang-tidy -p "$2" --quiet <<< "$files" 2>&1 | { ! grep -E '(warning|error):'; }
