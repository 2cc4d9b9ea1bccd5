#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""find_bare_texts.py REPOSITORY [--control]: names literals of the windows' sources that read like prose and are not translated.

Prose is what has a space between words, or begins with a capital and goes on with small letters. It must stand in a call that
translates or marks it, in a message of an error (list_messages.py finds those), in a table that list_texts prints, or in a call whose
texts nobody sees in a window. What is none of these, and yet no text for a person, stands in bare_texts.txt.
"""
import pathlib
import re
import sys

from list_messages import MAKERS, closing_places, tokens_of

FOLDERS = ["src/app", "src/gui", "src/centre", "src/editor", "src/report"]
TRANSLATES = {"Translate", "TranslateIn", "TranslateWith", "TranslateCount", "Mark", "Card", "AddLine"}
UNSEEN = {"Log", "printf", "fprintf", "puts", "fputs", "snprintf", "sscanf", "strftime", "TROCAR_ASSERT", "static_assert", "add_css_class",
          "set_css_classes", "SetStyle", "SetClass", "getenv", "select_font_face", "set_markup", "g_setenv", "Raw", "Text", "TextOr", "Has",
          "find_first_of", "find_first_not_of", "find_last_not_of", "BeginGroup", "Edit", "set_name"}
# tables that tests/texts/list_texts.cpp prints, help of the command line, pages of machines, and reports for programs
TABLES = {"simulator_commands.cpp", "replay_commands.cpp", "centre_commands.cpp", "contour_commands.cpp", "patient_commands.cpp",
          "settings_form.cpp", "home.cpp", "options.cpp", "contour_script.cpp", "unattended_play.cpp", "play_screenshot.cpp",
          "report_files.cpp", "xapi.cpp", "xapi_delivery.cpp", "http_client.cpp", "page_style.cpp", "page_style.h", "pdf_canvas.cpp"}
PROSE = re.compile(r"[A-Za-z]{2,}[,;:.]? +[A-Za-z]{2,}|^[A-Z][a-z]{2,}")


def enclosing_calls(tokens, pairs):
    """For each token the names before the brackets around it, from the inside out."""
    stack, calls = [], []
    closers = {end: begin for begin, end in pairs.items()}
    for i, _ in enumerate(tokens):
        if i in closers:
            stack.pop()
        calls.append([name for name, _ in reversed(stack)])
        if i in pairs:
            at = i - 1
            if at >= 0 and tokens[at][1] == ">":  # make_managed<Gtk::Label>(
                while at > 0 and tokens[at][1] != "<":
                    at -= 1
                at -= 1
            stack.append((tokens[at][1] if at >= 0 and tokens[at][0] == "name" else "", i))
    return calls


def bare_texts_of(source):
    tokens = tokens_of(source)
    calls = enclosing_calls(tokens, closing_places(tokens))
    for (kind, text), around in zip(tokens, calls):
        if kind != "text" or not PROSE.search(text[1:-1]) or re.search(r"%[.\d]*[a-z]|^\"<|http", text):
            continue
        names = set(around)
        if names & (TRANSLATES | UNSEEN | MAKERS | {"Error"}):
            continue
        yield text[1:-1]


def main():
    repository = pathlib.Path(sys.argv[1])
    known = set((repository / "tests/texts/bare_texts.txt").read_text(encoding="utf-8").splitlines())
    sources = {}
    for folder in FOLDERS:
        for path in sorted((repository / folder).rglob("*")):
            if path.suffix in (".cpp", ".h") and "test" not in path.parts and path.name not in TABLES:
                sources[path] = path.read_text(encoding="utf-8")
    if "--control" in sys.argv:
        found = list(bare_texts_of('void F() { label.set_text("Nobody said this in Spanish"); Say(core::Translate("Said")); }'))
        sys.exit(0 if found == ["Nobody said this in Spanish"] else 1)
    bare = [(path, text) for path, source in sources.items() for text in bare_texts_of(source) if text not in known]
    for path, text in bare:
        print(f"{path.relative_to(repository)}: \"{text}\"")
    if bare:
        print("wrap what a person sees in core::Translate and add it to po/es.po; name what nobody sees in tests/texts/bare_texts.txt")
    sys.exit(1 if bare else 0)


if __name__ == "__main__":
    main()
