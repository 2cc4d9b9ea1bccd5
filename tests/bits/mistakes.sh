# SPDX-License-Identifier: Apache-2.0
# Mistakes that comparisons of bits must notice; check_bits.sh and check_scenes.sh put one at a time into a copy of the sources.
mistakes=(fused_multiply_add function_of_the_c_library unstable_sort)

# make_mistake NAME SOURCES: in SOURCES/src; the file that is changed is kept for undo_mistake
make_mistake() {
  local file from to instead=no
  case $1 in
    fused_multiply_add) # rounded once, as a processor with FMA would
      file=engine/math/include/trocar/math/lane_arithmetic.h from='inline Lanes MulAdd(Lanes a, Lanes b, Lanes c) {'
      to='for (int lane = 0; lane < TROCAR_LANES; ++lane) c[lane] = __builtin_fmaf(a[lane], b[lane], c[lane]); return c;' ;;
    function_of_the_c_library)
      file=engine/math/src/elementary_exponential.cpp from='double Exp(double x) noexcept {' to='return __builtin_exp(x);' ;;
    functions_of_the_c_library) # those that every tick calls
      file=engine/math/src/elementary_trigonometric.cpp from='SineCosine SinCos(double x) noexcept {'
      to='return {__builtin_sin(x), __builtin_cos(x)};' ;;
    unstable_sort) # neighbours that are equal stay as they come
      file=engine/tissue/src/tissue_model.cpp from='return a.other != b.other ? a.other < b.other : a.spring < b.spring;'
      to='return a.other % 8 < b.other % 8;' instead=yes ;;
  esac
  cp "$2/src/$file" "$2/src/$file.right"
  python3 - "$2/src/$file" "$from" "$to" $instead <<'PYTHON'
import pathlib
import sys
path, old, new, instead = pathlib.Path(sys.argv[1]), *sys.argv[2:]
text = path.read_text()
if text.count(old) != 1:
    sys.exit(f"{path}: \"{old}\" is not there once; say in tests/bits/mistakes.sh what is")
path.write_text(text.replace(old, new if instead == "yes" else f"{old}\n  {new}"))
PYTHON
}

# undo_mistake SOURCES
undo_mistake() {
  find "$1/src" -name '*.right' -exec bash -c 'mv "$1" "${1%.right}"; touch "${1%.right}"' _ {} \;
}

# copy_sources FROM TO FOLDER_OR_FILE...
copy_sources() {
  local from=$1 to=$2
  shift 2
  rm -rf "$to"
  mkdir -p "$to"
  (cd "$from" && tar -cf - "$@") | tar -xf - -C "$to"
}
