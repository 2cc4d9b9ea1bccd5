#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""list_console.py FOLDER...: prints, as a template for gettext, what the sources in the folders print on the console.

That are the patterns of Say, headings of tables (the first row in the declaration of a vector of vectors of strings), the first column of
FormatFields, labels of progress bars, notes, and what the doctor and the patient's linter find. Line ends and spaces around a pattern are no part of it, as in SaidText.
"""
import re
import sys

from list_messages import LEAST_SIGNS, alternatives, arguments_of, closing_places, literal, pattern_of, print_template, tokens_of

TABLE = ["std", "::", "vector", "<", "std", "::", "vector", "<", "std", "::", "string", ">>"]
FINDS = {"doctor_checks.cpp"}  # whose texts are shown with TranslateComposed


def has_word(text):
    return re.search(r"[A-Za-z]{2}", re.sub(r"\{\d\}", "", text)) is not None


def heading_of(tokens, pairs, i):
    """Literals of the first row of a table that is declared or set at token i: NAME = {{...}}."""
    if [text for _, text in tokens[i + 1:i + 4]] != ["=", "{", "{"]:
        return
    for begin, end in arguments_of(tokens, pairs, i + 3):
        text = literal(tokens, begin, end)
        if text is not None:
            yield text


def firsts_of(tokens, pairs, opening):
    """Literals that begin the rows of FormatFields({{"name", ...}, ...})."""
    for begin, end in arguments_of(tokens, pairs, opening):
        if begin in pairs and tokens[begin][1] == "{":
            for row, _ in arguments_of(tokens, pairs, begin):
                if tokens[row][1] == "{":
                    yield tokens[row + 1][1][1:-1]


def found_texts_of(tokens, pairs):
    """What stands in braces, after an equals sign and in return statements: texts with a space, as patterns."""
    stretches = []
    for i, (_, text) in enumerate(tokens):
        if text == "{" and i in pairs:
            stretches += list(arguments_of(tokens, pairs, i))
        elif text in ("=", "return"):
            end = i + 1
            while end < len(tokens) and tokens[end][1] != ";":
                end = pairs.get(end, end) + 1
            stretches.append((i + 1, end))
    for begin, end in stretches:
        if any(text == ";" for _, text in tokens[begin:end]) or begin == end or tokens[begin][1] == "{":
            continue
        for one in alternatives(tokens, pairs, begin, end):
            pattern = pattern_of(tokens, pairs, *one)
            fixed = re.sub(r"\{\d\}", "", pattern)
            if " " in fixed.strip() and len(fixed.replace(" ", "")) >= LEAST_SIGNS and re.search("[a-z]{2}", fixed):
                yield pattern


def console_texts_of(source, finds=False, notes=True):
    tokens = tokens_of(source)
    pairs = closing_places(tokens)
    tables = set()
    for i, (kind, name) in enumerate(tokens):
        if kind != "name":
            continue
        if [text for _, text in tokens[max(i - len(TABLE), 0):i]] == TABLE:
            tables.add(name)
        if name in tables:
            yield from filter(has_word, heading_of(tokens, pairs, i))
        called = i + 1 in pairs and tokens[i + 1][1] == "("
        if name == "Say" and called:
            for one in alternatives(tokens, pairs, *next(arguments_of(tokens, pairs, i + 1))):
                text = literal(tokens, *one)
                if text is not None:
                    text = re.sub(r"^( |\\n)+|( |\\n)+$", "", text)
                    if has_word(text):
                        yield text
        elif name in ("progress", "report_progress") and called:  # what a long work is doing
            begin, end = next(arguments_of(tokens, pairs, i + 1))
            yield from filter(has_word, [pattern_of(tokens, pairs, begin, end)])
        elif name == "Add" and called and tokens[i + 2][1].startswith('"L-'):  # a finding of the patient's linter
            for one in alternatives(tokens, pairs, *list(arguments_of(tokens, pairs, i + 1))[2]):
                pattern = pattern_of(tokens, pairs, *one)
                if has_word(pattern):
                    yield pattern
        elif name == "push_back" and notes and called and tokens[i - 2][1] in ("notes", "lines"):
            pattern = pattern_of(tokens, pairs, *next(arguments_of(tokens, pairs, i + 1)))
            if len(re.sub(r"\{\d\}|[^a-z]", "", pattern)) >= LEAST_SIGNS:
                yield pattern
        elif name == "add" and called:  # a measure of a patient: name, value, unit, what it is
            texts = [literal(tokens, *one) for one in arguments_of(tokens, pairs, i + 1)]
            if len(texts) > 3 and texts[0] and texts[3]:
                yield texts[3]
        elif name == "FormatFields" and called:
            yield from filter(has_word, firsts_of(tokens, pairs, i + 1))
        elif name == "ProgressBar" and i + 2 in pairs and tokens[i + 1][0] == "name":
            begin, end = next(arguments_of(tokens, pairs, i + 2))
            if any(kind == "text" for kind, _ in tokens[begin:end]):
                yield pattern_of(tokens, pairs, begin, end)
    if finds:
        yield from found_texts_of(tokens, pairs)


if __name__ == "__main__":
    print_template(sys.argv[1:], lambda source, path, folder: console_texts_of(source, path.name in FINDS, not folder.startswith("bench")))
