# SPDX-License-Identifier: Apache-2.0
# Shared by ./run, ./test, .ci/run and tools/install-python, which source it. Expects $root, the repository.

say() { printf '\n== %s\n' "$*"; }

# configure PRESET [cmake arguments]: only when there is nothing to build from; ninja repeats it where CMake files change
configure() {
  local folder="$root/build/$1" fresh=()
  if [ -f "$folder/CMakeCache.txt" ] &&
    ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "$folder/CMakeCache.txt"; then
    fresh=(--fresh) # the folder was moved or copied here
  fi
  if [ ! -f "$folder/build.ninja" ] || [ ${#fresh[@]} -gt 0 ]; then
    say "configuring build/$1"
    (cd "$root" && cmake "${fresh[@]}" --preset "$1" "${@:2}")
  elif [ -n "$(find "$root/src" "$root/tests" -name '*.cpp' -newer "$folder/build.ninja" -print -quit)" ]; then
    cmake "$folder" >/dev/null # sorts changed files into units anew (cmake/unity_build.cmake)
  fi
}

# what is opened is built, and nothing else: docs/decisions/0073-what-is-opened-is-built.md
configure_release() { configure release -DTROCAR_BUILD_TESTS=OFF -DTROCAR_PARTS_WHEN_CALLED=ON; }

# build PRESET [targets]
build() {
  say "building build/$1"
  ninja -C "$root/build/$1" "${@:2}"
}
