#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that nothing of which no standard fixes the bits is in the engine: what its libraries import, which instructions they
hold, and which parts of the standard library its sources name.

  check_banned_code.py imports SOURCE_FOLDER BUILD_FOLDER     functions of the C library, instructions
  check_banned_code.py sources SOURCE_FOLDER
  check_banned_code.py conversions SOURCE_FOLDER BUILD_FOLDER what the compiler finds in a build of its own: conversions of
                                                              floating-point numbers to integers outside to_integer.h
  check_banned_code.py control SOURCE_FOLDER SCRATCH_FOLDER   seeded mistakes must be found (COMPILER in the environment's CXX)

The engine is every module of tools/layers.txt that assessment, agent, record or environment can see. What is used with a reason
stands in allowed.txt; an entry there that nothing uses any more is a mistake too.
"""

import concurrent.futures
import fnmatch
import os
import pathlib
import platform
import re
import shutil
import subprocess
import sys
import tempfile

ROOTS = ("agent", "record", "environment", "assessment")
ALLOWED = "tests/banned_code/allowed.txt"

# Of the mathematical library, what IEEE 754 fixes to the bit, or what only takes numbers apart; the same with f, l and f64 at
# the end. All else that it exports is banned. fma is fixed, too, but where hardware lacks it a thousand times slower; fmin and
# fmax leave the sign of zero open.
EXACT = {"sqrt", "fabs", "floor", "ceil", "trunc", "rint", "nearbyint", "round", "roundeven", "lrint", "llrint", "lround", "llround",
         "fmod", "remainder", "remquo", "frexp", "ldexp", "scalbn", "scalbln", "modf", "copysign", "nextafter", "nexttoward",
         "nextup", "nextdown", "logb", "ilogb", "llogb", "fdim", "finite", "isinf", "isnan", "signbit"}
# fegetround and the like: known only to whom the mathematical library cannot be asked
KNOWN = {"sin", "cos", "sincos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "asinh", "acosh", "atanh", "exp",
         "exp2", "exp10", "expm1", "log", "log1p", "log2", "log10", "pow", "cbrt", "hypot", "lgamma", "lgamma_r", "tgamma", "erf",
         "erfc", "fma", "fmin", "fmax", "j0", "j1", "jn", "y0", "y1", "yn", "cexp", "clog", "cpow", "csqrt", "csin", "ccos",
         "fesetround", "fesetenv", "fegetround"}
# others: of the C library what is random or keeps no order; of the C++ library its random numbers; of the compiler's
# library products and quotients of complex numbers, whole powers, and numbers of 80 and 128 bits
OTHER_IMPORTS = re.compile(
    r"^(rand|rand_r|random|srand|srandom|[demjln]rand48|qsort|qsort_r|time"
    r"|_ZNSt13random_device.*|_ZNSt3__113random_device.*"
    r"|__(mul|div)[hsdxt]c3|__powi[sdxt]f2|__(add|sub|mul|div|neg|extend\w*|trunc\w*|fix\w*|float\w*|cmp|lt|gt|le|ge|eq|ne|unord)[tx]f\w*"
    r"|_ZGV[a-zA-Z].*_(sin|cos|exp|log|pow|tan|atan).*)$")

# fused multiply-add, approximations, and where double is not what is computed with
INSTRUCTIONS = {
    "x86_64": re.compile(r"^(vf(n?m(add|sub)|maddsub|msubadd)\w*|v?r(sqrt|cp)(14|28)?[ps][sdh]|vexp2p[sd]|vrndscale\w*xxx"
                         r"|f(ld|ild|st|ist|bld|bst|add|iadd|sub|isub|mul|imul|div|idiv|sqrt|sin|cos|ptan|patan|2xm1|yl2x|scale|prem"
                         r"|rndint|abs|chs|com|ucom|icom|tst|xam|xch|cmov|xtract)(?!env)(?!cw)(?!sw)\w*)$"),
    "aarch64": re.compile(r"^(fn?m(add|sub)|fml[as]l?2?|fcmla|fr(sqrt|ecp)[esx])$"),
}

# an integer's type
INTEGER = (r"(?:std::)?(?:u?int(?:_fast|_least)?(?:8|16|32|64)_t|u?intmax_t|u?intptr_t|size_t|ptrdiff_t|time_t"
           r"|(?:(?:un)?signed|long|int|short|char)(?:\s+(?:long|int|short|char))*)")

# what a compiler calls where a conversion may be out of range, with -fsanitize=float-cast-overflow
CONVERSION = "__ubsan_handle_float_cast_overflow"
SANITIZE = "-fsanitize=float-cast-overflow"

# what a source names; the pattern matches the name alone
SOURCES = {
    # order or choice that is left open
    "sort": r"\bstd::(?:ranges::)?sort\b", "nth_element": r"\bstd::(?:ranges::)?nth_element\b",
    "partial_sort": r"\bstd::(?:ranges::)?partial_sort(?:_copy)?\b", "partition": r"\bstd::(?:ranges::)?partition\b",
    "heap": r"\bstd::(?:ranges::)?(?:(?:make|push|pop|sort)_heap|priority_queue)\b",
    "unordered": r"\bunordered_(?:multi)?(?:map|set)\b", "hash": r"\bstd::hash\b", "qsort": r"\bqsort(?:_r)?\b",
    # random numbers
    "shuffle": r"\bstd::(?:ranges::)?shuffle\b", "sample": r"\bstd::(?:ranges::)?sample\b",
    "distribution": r"\bstd::\w+_distribution\b", "random_device": r"\brandom_device\b",
    "random_engine": r"\bstd::(?:default_random_engine|knuth_b)\b", "generate_canonical": r"\bgenerate_canonical\b",
    "rand": r"\b(?:std::)?s?rand\s*\(", "drand48": r"\b[demjln]rand48\b",
    # sums in an order that is left open, and what the libraries compute with other steps
    "reduce": r"\bstd::(?:transform_)?reduce\b", "execution": r"\bstd::execution\b",
    "parallel_reduce": r"\bparallel_reduce\b", "parallel_sort": r"\bparallel_sort\b", "parallel_scan": r"\bparallel_scan\b",
    "per_thread": r"\b(?:enumerable_thread_specific|combinable|concurrent_\w+)\b",
    "atomic_float": r"\bstd::atomic<(?:double|float)>", "lerp": r"\bstd::lerp\b", "midpoint": r"\bstd::midpoint\b",
    "complex": r"\bstd::complex\b", "valarray": r"\bstd::valarray\b", "long_double": r"\blong\s+double\b",
    "float_control": r"\b_MM_SET_(?:FLUSH_ZERO|DENORMALS_ZERO)_MODE\b|\bfesetround\b|\bffast-math\b|\bFP_CONTRACT\b",
    # what of it can be seen without the types, which a compiler knows: see check_conversions
    "to_integer": r"\b(?:std::|::)?l?lr(?:ound|int)f?\s*\("
                  rf"|\bstatic_cast<\s*{INTEGER}\s*>\s*\(\s*(?:(?:std::|::)(?:floor|ceil|trunc|round|rint|nearbyint|sqrt|fabs|fmod)f?\s*\("
                  r"|[^();]*(?<![\w.])\d+\.\d)",
    # as an import it shows only where a compiler leaves the call
    "elementary": r"\b(?:std::|::)(?:sin|cos|tan|asin|acos|atan|atan2|sinh|cosh|tanh|asinh|acosh|atanh|exp|exp2|expm1|log|log1p|log2"
                  r"|log10|pow|cbrt|hypot|lgamma|tgamma|erf|erfc|fma|fmin|fmax|sincos)f?\s*\(",
}


def read_allowed(text):
    """(kind, where, what) -> reason."""
    allowed = {}
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip() or line.startswith("#"):
            continue
        words = line.split(None, 3)
        if len(words) != 4 or words[0] not in ("import", "instruction", "source"):
            sys.exit(f"{ALLOWED}:{number}: a line is: import|instruction|source WHERE WHAT REASON")
        if (key := tuple(words[:3])) in allowed:
            sys.exit(f"{ALLOWED}:{number}: {' '.join(key)} stands there twice")
        allowed[key] = words[3]
    return allowed


def find_modules(layers):
    """What the roots see, by tools/layers.txt."""
    sees = {}
    for line in layers.splitlines():
        if match := re.match(r"^(\w+)\s*->\s*([\w ]*)", line):
            sees[match.group(1)] = match.group(2).split()
    modules, left = set(), list(ROOTS)
    while left:
        if (module := left.pop()) not in modules:
            modules.add(module)
            left += sees[module]
    return [module for module in sees if module in modules]


def list_mathematical_names():
    """What the mathematical library exports and IEEE 754 does not fix."""
    names = set(KNOWN)
    path = subprocess.run([os.environ.get("CC", "gcc"), "-print-file-name=libm.so.6"], capture_output=True, text=True,
                          check=False).stdout.strip() if os.name == "posix" else ""
    if path and pathlib.Path(path).exists():
        for line in run(["nm", "-D", "--defined-only", path]).splitlines():
            name = line.split()[-1].split("@")[0]
            names.add(name)
    exact = {name + ending for name in EXACT for ending in ("", "f", "l", "f32", "f64", "f128", "f32x", "f64x")}
    every = {name + ending for name in names for ending in ("", "f", "l")} | {f"__{name}_finite" for name in names}
    return {name for name in every if name not in exact and not re.match(r"^(__fpclassify|__isinf|__isnan|__finite|__signbit|_LIB)", name)}


def run(command):
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def find_imports(library, banned):
    """Names that the library's objects import and that are banned, with one object that does."""
    found, member = {}, library.name
    for line in run(["nm", "-u", library]).splitlines():
        if line.endswith(":"):
            member = line[:-1]
        elif line.split():
            name = line.split()[-1].split("@")[0]
            if name in banned or OTHER_IMPORTS.match(name):
                found.setdefault(name, member)
    return found


def find_instructions(library, machine=platform.machine()):
    """Banned instructions, with one function and how many there are."""
    pattern, found, function = INSTRUCTIONS.get(machine), {}, "?"
    if pattern is None:
        return found
    with tempfile.TemporaryDirectory() as folder:
        # as one object: of a library with thousands of sections objdump takes minutes
        whole = pathlib.Path(folder, "whole.so")
        subprocess.run(["ld", "-shared", "-S", "--defsym=__dso_handle=0", "--whole-archive", library, "-o", whole], check=True)
        # grep leaves functions' names and lines that may be meant
        with subprocess.Popen(["objdump", "-d", "--no-show-raw-insn", whole], stdout=subprocess.PIPE) as listing, \
                subprocess.Popen(["grep", "-aE", "^[0-9a-f]+ <|\t(vf|f|v?r(sqrt|cp|ecp)|vexp2)"], stdin=listing.stdout,
                                 stdout=subprocess.PIPE, text=True, env={**os.environ, "LC_ALL": "C"}) as lines:
            listing.stdout.close()
            for line in lines.stdout:
                if line.startswith("0"):
                    function = line.split("<", 1)[-1].rstrip(">:\n")
                    continue
                mnemonic = line.split("\t")[1].split(None, 1)[0]
                if pattern.match(mnemonic):
                    count, first = found.get(mnemonic, (0, function))
                    found[mnemonic] = (count + 1, first)
        if listing.returncode != 0:
            sys.exit(f"objdump failed on {library}")
    return found


def demangle(names):
    text = subprocess.run(["c++filt"], input="\n".join(names), capture_output=True, text=True, check=True).stdout
    return dict(zip(names, text.splitlines()))


def strip_comments(text):
    """Code alone, with its lines where they were; texts in quotes are empty."""
    pattern = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:[^"\\\n]|\\.)*"|\'(?:[^\'\\\n]|\\.)+\'', re.DOTALL)
    return pattern.sub(lambda match: '""' + "\n" * match.group(0).count("\n") if match.group(0)[0] in "\"R"
                       else re.sub(r"[^\n]", "", match.group(0)) if match.group(0)[0] == "/" else match.group(0), text)


def find_sources(text):
    """(line number, name) of each banned name."""
    code = strip_comments(text)
    # includes say nothing of a use
    code = re.sub(r"(?m)^\s*#\s*include.*$", "", code)
    return sorted((code.count("\n", 0, match.start()) + 1, name)
                  for name, pattern in SOURCES.items() for match in re.finditer(pattern, code))


def compare(found, allowed, kinds):
    """found: (kind, where, what) -> message. What stands in `allowed` may be a pattern."""
    used, complaints = set(), []
    for key, message in sorted(found.items()):
        reasons = [entry for entry in allowed if entry[0] == key[0] and fnmatch.fnmatchcase(key[1], entry[1])
                   and fnmatch.fnmatchcase(key[2], entry[2])]
        used.update(reasons)
        if not reasons:
            complaints.append(message)
    complaints += [f"{ALLOWED}: {' '.join(key)}: nothing uses it any more; take it off the list"
                   for key in sorted(allowed) if key[0] in kinds and key not in used]
    return complaints


def folder_of(source, module):
    """src/WING/MODULE"""
    folders = list((source / "src").glob(f"*/{module}"))
    if len(folders) != 1:
        raise SystemExit(f"{source}: there are {len(folders)} folders of the module {module} in the wings of src/")
    return folders[0].relative_to(source)


def check_imports(source, build):
    modules = find_modules((source / "tools/layers.txt").read_text())
    folders = {module: folder_of(source, module) for module in modules}
    libraries = [(module, build / folders[module] / f"libtrocar_{module}.a") for module in modules]
    missing = [module for module, library in libraries if not library.exists()
               and "SOURCES" in (source / folders[module] / "CMakeLists.txt").read_text()]
    if missing:
        return [f"{build}: the libraries of {', '.join(missing)} are not built"]
    libraries = [(module, library) for module, library in libraries if library.exists()]
    banned, found = list_mathematical_names(), {}
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        # the largest first
        order = sorted(libraries, key=lambda entry: -entry[1].stat().st_size)
        instructions = dict(zip([module for module, _ in order], pool.map(lambda entry: find_instructions(entry[1]), order)))
    for module, library in libraries:
        for name, member in find_imports(library, banned).items():
            text = demangle([name])[name]
            found["import", module, name] = f"{module}: {member} imports {text}, whose bits no standard fixes"
        for mnemonic, (count, function) in instructions[module].items():
            found["instruction", module, mnemonic] = \
                f"{module}: {count} times the instruction {mnemonic}, first in {demangle([function])[function]}"
    complaints = compare(found, read_allowed((source / ALLOWED).read_text()), ("import", "instruction"))
    print(f"{len(libraries)} libraries, {len(found)} findings, {len(complaints)} complaints")
    return complaints


def check_sources(source):
    modules, found, looked_at = find_modules((source / "tools/layers.txt").read_text()), {}, 0
    for module in modules:
        for path in sorted((source / folder_of(source, module)).rglob("*")):
            name = path.relative_to(source).as_posix()
            # a program of its own that hands over pictures and volumes is an engine's part as well
            if path.suffix not in (".cpp", ".h", ".cu") or "/test/" in name or "/bench/" in name:
                continue
            looked_at += 1
            for line, what in find_sources(path.read_text(encoding="utf-8")):
                found.setdefault(("source", name, what), f"{name}:{line}: {what}: {WHY.get(what, 'its order or its bits are not fixed')}")
    complaints = compare(found, read_allowed((source / ALLOWED).read_text()), ("source",))
    if looked_at < 100:
        complaints.append(f"only {looked_at} files were found in {source}")
    print(f"{looked_at} files of {len(modules)} modules, {len(found)} findings, {len(complaints)} complaints")
    return complaints


def find_conversions(folder):
    """Where in a folder of objects a conversion may be out of range: "file:line", or a function where no line is known."""
    found = set()
    objects = sorted(folder.rglob("*.o"))
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        imports = list(pool.map(lambda path: CONVERSION in run(["nm", "-u", path]), objects))
    for path in (path for path, converts in zip(objects, imports) if converts):
        function = line = "?"
        for text in run(["objdump", "-drl", "--no-show-raw-insn", path]).splitlines():
            if match := re.match(r"^[0-9a-f]+ <(.*)>:$", text):
                function = line = match.group(1)
            elif match := re.match(r"^(\S.*:\d+)(?: \(discriminator \d+\))?$", text):
                line = match.group(1).removeprefix("./")
            elif CONVERSION in text:
                found.add(line if line != function else demangle([function])[function])
    return found, len(objects)


def check_conversions(source, build):
    """Compiles the engine with a sanitizer's calls wherever a conversion might be out of range, and looks for calls. The
    functions of to_integer.h look at the range themselves and have none."""
    compiler = shutil.which("clang++") or shutil.which("g++")
    modules = find_modules((source / "tools/layers.txt").read_text())
    configure = ["cmake", "-S", source, "-B", build, "-G", "Ninja", f"-DCMAKE_CXX_COMPILER={compiler}", "-DCMAKE_BUILD_TYPE=Release",
                 f"-DCMAKE_CXX_FLAGS={SANITIZE}", "-DCMAKE_CXX_FLAGS_RELEASE=-O1 -g1", f"-DTROCAR_MODULES={';'.join(modules)}",
                 "-DTROCAR_BUILD_TESTS=OFF", "-DTROCAR_BUILD_IMPORT=OFF", "-DTROCAR_PYTHON=OFF", "-DTROCAR_CUDA=OFF"]
    targets = [f"trocar_{module}" for module in modules
               if "SOURCES" in (source / folder_of(source, module) / "CMakeLists.txt").read_text()]
    for command in (configure, ["ninja", "-C", build, *targets]):
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        if done.returncode != 0:
            return [*done.stdout.splitlines()[-30:], "the engine could not be compiled"]
    places, objects = find_conversions(build)
    places = {place for place in places if not place.startswith("/usr/")}  # what a header of another library does is its own
    complaints = [f"{place}: a floating-point number becomes an integer: take a function of trocar/base/to_integer.h" for place in sorted(places)]
    if objects < len(targets):
        complaints.append(f"only {objects} objects were found in {build}")
    print(f"{objects} objects of {len(modules)} modules, {len(complaints)} complaints")
    return complaints


WHY = {"sort": "where keys are equal its order is not fixed; say in allowed.txt why none are, or why it does not matter",
       "to_integer": "what does not fit is not defined; take a function of trocar/base/to_integer.h",
       "elementary": "take it from trocar/math/elementary.h, or min and max from trocar/math"}

CONTROL = """
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>
double CallsExp(double x) { return std::exp(x); }
double Fuses(double a, double b, double c) { return a * b + c; }
long double Wide(long double a, long double b) { return a * b; }
unsigned Draws() { return std::random_device()(); }
double Exact(double x) { return std::fmod(std::floor(std::sqrt(x)), 3.0); }
// std::nth_element in a comment, and in a text:
const char* text = "std::shuffle";
void Sorts(std::vector<int>& v) { std::sort(v.begin(), v.end()); }
long Rounds(double x) { return std::lround(x); }
int Floors(double x) { return static_cast<int>(std::floor(x)); }
std::size_t Halves(double x) { return static_cast<std::size_t>(x * 0.5); }
double Widens(int i) { return static_cast<double>(i * 2) + static_cast<int>(i + 2); }
"""

# what only a compiler sees; the conversions of to_integer.h and of constants are none
CONVERSIONS = """
#include "trocar/base/to_integer.h"
int Truncates(float x) { return static_cast<int>(x); }
unsigned char Narrows(double x) { return x; }
template <typename To> To Converts(double x) { return To(x); }
template long Converts<long>(double);
int Checks(double x) {
  return trocar::base::TruncateTo<int>(x) + trocar::base::FloorTo<short>(x) + trocar::base::RoundTo<unsigned char>(x) +
         trocar::base::CeilTo<int>(x);
}
int Constant() { return static_cast<int>(2.5); }
float Widens(long i) { return static_cast<float>(i); }
"""


def control(source, scratch):
    complaints = []

    def expect(what, seen, wanted):
        if seen != wanted:
            complaints.append(f"control: {what}: found {seen}, not {wanted}")

    scratch.mkdir(parents=True, exist_ok=True)
    (scratch / "control.cpp").write_text(CONTROL)
    is_x86 = platform.machine() == "x86_64"
    compiler = [os.environ.get("CXX", "g++"), "-std=c++20", "-O2", "-fPIC", "-c", scratch / "control.cpp", "-o"]
    subprocess.run([*compiler, scratch / "fused.o", "-ffp-contract=fast", *(["-mfma"] if is_x86 else [])], check=True)
    subprocess.run([*compiler, scratch / "plain.o", "-ffp-contract=off"], check=True)
    names = set(find_imports(scratch / "plain.o", list_mathematical_names()))
    expect("imports", {"exp"} <= names and any("random_device" in name for name in names), True)
    expect("exact functions", names & {"sqrt", "floor", "fmod"}, set())
    fused, plain = (set(find_instructions(scratch / f"{name}.o")) for name in ("fused", "plain"))
    if is_x86:
        expect("fused multiply-add", any(name.startswith("vfmadd") for name in fused), True)
        expect("fused multiply-add where there is none", any(name.startswith("vfm") for name in plain), False)
        expect("x87", {"fldt", "fmulp"} <= plain or "fldt" in plain, True)
    expect("names in sources", [name for _, name in find_sources(CONTROL)],
           ["elementary", "long_double", "long_double", "long_double", "random_device", "sort", "to_integer", "to_integer", "to_integer"])
    # by each compiler that is there
    for name in filter(shutil.which, ("clang++", "g++")):
        folder = scratch / f"conversions_{name}"
        folder.mkdir(exist_ok=True)
        (folder / "conversions.cpp").write_text(CONVERSIONS)
        for optimisation in ("-O1", "-O2"):
            subprocess.run([name, "-std=c++20", optimisation, "-g1", SANITIZE, "-I", source / "src/engine/base/include", "-c",
                            folder / "conversions.cpp", "-o", folder / "conversions.o"], check=True)
            places, _ = find_conversions(folder)
            expect(f"conversions by {name} {optimisation}", sorted(place.rsplit("/", 1)[-1] for place in places),
                   [f"conversions.cpp:{line}" for line in (3, 4, 5)])
    keys = {("source", "a.cpp", "sort"): "found"}
    expect("a use without a reason", len(compare(keys, {}, ("source",))), 1)
    expect("a use with a reason", compare(keys, {("source", "a.cpp", "sort"): "whole numbers"}, ("source",)), [])
    expect("a use with a pattern", compare(keys, {("source", "*.cpp", "so*"): "whole numbers"}, ("source",)), [])
    expect("a reason without a use", len(compare({}, {("source", "a.cpp", "sort"): "whole numbers"}, ("source",))), 1)
    expect("modules", find_modules("a -> \nb -> a\nagent -> b  # x\nrecord -> a\nenvironment ->\nassessment -> agent\nc -> a\n"),
           ["a", "b", "agent", "record", "environment", "assessment"])
    return complaints


def main():
    action, source = sys.argv[1], pathlib.Path(sys.argv[2])
    if action == "imports":
        complaints = check_imports(source, pathlib.Path(sys.argv[3]))
    elif action == "sources":
        complaints = check_sources(source)
    elif action == "conversions":
        complaints = check_conversions(source, pathlib.Path(sys.argv[3]))
    elif action == "control":
        complaints = control(source, pathlib.Path(sys.argv[3]))
    else:
        sys.exit(__doc__)
    print("\n".join(complaints))
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
