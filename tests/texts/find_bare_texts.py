#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""find_bare_texts.py REPOSITORY [--control]: names literals of windows and commands that read like prose and are not translated.

Prose is what has a space between words, or begins with a capital and goes on with small letters. It must stand in a call that
translates or marks it, in a message of an error (list_messages.py finds those), in a table that list_texts prints, or in a call whose
texts nobody sees in a window. A command's help is translated as a whole; what a command prints must go through Say, and prose in
printf and its like is bare. What is none of these, and yet no text for a person, stands in bare_texts.txt.
"""
import pathlib
import re
import sys

from list_console import console_texts_of
from list_messages import MAKERS, closing_places, tokens_of

FOLDERS = ["src/program/app", "src/program/gui", "src/program/centre", "src/program/editor", "src/program/rehearsal", "src/judge/report"]
TRANSLATES = {"Translate", "TranslateIn", "TranslateWith", "TranslateCount", "Mark", "Card", "AddLine"}
UNSEEN = {"Log", "printf", "fprintf", "puts", "fputs", "snprintf", "sscanf", "strftime", "TROCAR_ASSERT", "static_assert", "add_css_class",
          "set_css_classes", "SetStyle", "SetClass", "getenv", "select_font_face", "set_markup", "g_setenv", "Raw", "Text", "TextOr", "Has",
          "find_first_of", "find_first_not_of", "find_last_not_of", "BeginGroup", "Edit", "set_name"}
COMMANDS = ["src/program/cli"]
# list_console.py lists these; VisitHelpTexts translates the help
SAYS = {"Say", "FormatFields", "ProgressBar"}
HELPS = {"add_subcommand", "add_option", "add_flag", "add_option_function", "add_flag_function", "add_option_group", "footer", "type_name", "group",
         "check", "description", "AddThreadsOption", "AddJsonFlag", "AddSizeOption", "AddCacheOption", "AddPseudonymOption"}
PRINTS = {"printf", "fprintf", "puts", "fputs"}
# tables that tests/texts/list_texts.cpp prints, help of the command line, pages of machines, and reports for programs
TABLES = {"simulator_commands.cpp", "replay_commands.cpp", "centre_commands.cpp", "contour_commands.cpp", "patient_commands.cpp",
          "settings_form.cpp", "home.cpp", "options.cpp", "contour_script.cpp", "unattended_play.cpp", "play_screenshot.cpp",
          "report_files.cpp", "xapi.cpp", "xapi_delivery.cpp", "http_client.cpp", "page_style.cpp", "page_style.h", "pdf_canvas.cpp",
          "run_command.cpp", "command_list.cpp", "errors_command.cpp"}
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


def bare_texts_of(source, is_command=False):
    unseen = (UNSEEN - PRINTS) | SAYS | HELPS if is_command else UNSEEN
    tokens = tokens_of(source)
    calls = enclosing_calls(tokens, closing_places(tokens))
    said = set(console_texts_of(source)) if is_command else set()
    for (kind, text), around in zip(tokens, calls):
        names = set(around)
        if is_command and names & PRINTS:
            text = re.sub(r"%[-+.\d]*(?:ll|z|t)?[a-z]|\\n", " ", text)
        if kind != "text" or not PROSE.search(text[1:-1]) or re.search(r"%[.\d]*[a-z]|^\"<|http", text) or text[1:-1] in said:
            continue
        if names & (TRANSLATES | unseen | MAKERS | {"Error"}):
            continue
        yield text[1:-1]


def main():
    repository = pathlib.Path(sys.argv[1])
    known = set((repository / "tests/texts/bare_texts.txt").read_text(encoding="utf-8").splitlines())
    sources = {}
    for folder in FOLDERS + COMMANDS:
        for path in sorted((repository / folder).rglob("*")):
            if path.suffix in (".cpp", ".h") and "test" not in path.parts and path.name not in TABLES:
                sources[path] = path.read_text(encoding="utf-8")
    if "--control" in sys.argv:
        found = list(bare_texts_of('void F() { label.set_text("Nobody said this in Spanish"); Say(host::Translate("Said")); }'))
        printed = list(bare_texts_of('void F() { std::printf("%zu clips lie here\\n", n); Say("{1} clips lie there\\n", n); Print("Nobody " + x); '
                                     'command->add_option("--n", n, "How many lie here"); }', True))
        sys.exit(0 if found == ["Nobody said this in Spanish"] and printed == ["  clips lie here ", "Nobody "] else 1)
    commands = [repository / folder for folder in COMMANDS]
    bare = [(path, text) for path, source in sources.items()
            for text in bare_texts_of(source, any(folder in path.parents for folder in commands)) if text not in known]
    for path, text in bare:
        print(f"{path.relative_to(repository)}: \"{text}\"")
    if bare:
        print("wrap what a person sees in host::Translate and add it to po/es.po; name what nobody sees in tests/texts/bare_texts.txt")
    sys.exit(1 if bare else 0)


if __name__ == "__main__":
    main()
