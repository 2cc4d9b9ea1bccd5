#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""find_raw_output.py REPOSITORY [--control]: names places where a stranger's text could leave the program in another form than the printable one.

Three kinds. A text of the JSON library that is written without saying what becomes of bytes that are no UTF-8 (it throws):
host::FormatJson does. What is printed with printf and its like and is not the literal itself: Print, PrintLine, Say and PrintJson make
values printable within their line. Markup of GTK, in which a name could be a tag.
"""
import pathlib
import re
import sys

FOLDERS = ["src", "python"]
# numbers, for which there is nothing to say; and who must not throw or allocate
DUMPS = {"src/platform/host/include/trocar/host/json_text.h", "src/judge/training/src/trace_file.cpp", "src/judge/training/src/metric_definition.cpp",
         "src/judge/training/src/attempt_metrics.cpp"}
PRINTS = {"src/engine/base/src/assert.cpp", "src/platform/host/src/console.cpp", "src/platform/host/src/progress_bar.cpp", "src/platform/host/src/secret_prompt.cpp",
          "src/platform/host/src/printable_output.cpp", "src/program/cli/src/run_command.cpp", "src/program/editor/widgets/contour_run.cpp",
          "src/program/editor/widgets/patient_editor_run.cpp", "src/program/app/widgets/play_screenshot.cpp", "src/program/app/widgets/main.cpp"}
MARKUP = {"src/program/editor/widgets/contour_cards.cpp"}  # of a colour

KINDS = [
    ("JSON that throws at bytes that are no UTF-8; host::FormatJson writes it", DUMPS, re.compile(r"\.dump\(")),
    ("printed as it is; Print, PrintLine, PrintErrorLine, Say or PrintJson print it", PRINTS,
     re.compile(r"\b(?:printf|fputs|puts)\((?!\s*(?:\"(?:[^\"\\]|\\.)*\"\s*)+[,)])|\bprintf\([^;]*%s|\bfprintf\(\s*(?:stdout|stderr)\b|\bstd::(?:cout|cerr)\s*<<")),
    ("markup of GTK; set_text shows a name as it is", MARKUP, re.compile(r"\b(?:set_markup|set_tooltip_markup|set_use_markup|use_markup)\b")),
]


def without_comments(source):
    return re.sub(r"//[^\n]*|/\*.*?\*/", "", source, flags=re.DOTALL)


def raw_outputs_of(name, source):
    source = without_comments(source)
    for meaning, allowed, pattern in KINDS:
        if name in allowed:
            continue
        for found in pattern.finditer(source):
            yield f"{name}: {' '.join(source[found.start():found.start() + 80].split())}: {meaning}"


def main():
    repository = pathlib.Path(sys.argv[1])
    if "--control" in sys.argv:
        seeded = ['text += json.dump(2);', 'std::printf("%s\\n", name.c_str());', 'std::fputs(text.c_str(), stdout);',
                  'std::fprintf(stderr, "%s", why.c_str());', 'std::cout << name;', 'label->set_markup(name);']
        missed = [line for line in seeded if not list(raw_outputs_of("src/new.cpp", f"void F() {{ {line} }}"))]
        harmless = 'void F() { PrintLine(name); std::fputs("a (text)\\n" "b", stdout); std::snprintf(text, 3, "%s", name); } // json.dump()'
        wrong = list(raw_outputs_of("src/new.cpp", harmless))
        print("\n".join(["missed: " + line for line in missed] + wrong))
        return 1 if missed or wrong else 0
    faults, seen = [], 0
    for folder in FOLDERS:
        for path in sorted((repository / folder).rglob("*")):
            name = path.relative_to(repository).as_posix()
            if path.suffix not in (".cpp", ".h") or "/test/" in name or "/check/" in name:
                continue
            seen += 1
            faults += raw_outputs_of(name, path.read_text(encoding="utf-8"))
    print("\n".join(faults) if faults else f"{seen} sources: nothing leaves in another form")
    return 1 if faults or seen < 500 else 0


if __name__ == "__main__":
    sys.exit(main())
