#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""list_messages.py FOLDER...: prints, as a template for gettext, the messages of errors that the sources in the folders make.

A message is put together with +; each part that is no literal becomes a place, {1} to {9}, as host::TranslateComposed finds it again in
the finished message. Messages are what stands in Error{code, ...} and in calls of the functions below, which make errors of a text.
"""
import pathlib
import re
import sys

MAKERS = {"Invalid", "Refuse", "Refused", "Fail", "fail", "refuse", "Failed", "Complain", "Failure", "Away", "Unusable",
          "Usage", "WrongUse", "AtLine", "Note", "Throw", "Unwritable", "Undecodable", "Changed", "Unknown", "Mismatch"}
LEAST_SIGNS = 3  # as kLeastLetters of src/platform/host/src/catalogue.h
TOKEN = re.compile(
    r'(?P<comment>//[^\n]*|/\*.*?\*/)|(?P<raw>R"(?P<end>[^(]*)\(.*?\)(?P=end)")|(?P<text>"(?:[^"\\\n]|\\.)*")'
    r"|(?P<letter>'(?:[^'\\]|\\.)+')|(?P<name>[A-Za-z_]\w*)|(?P<number>\d[\w.']*)|(?P<sign>::|->|<<|>>|<=|>=|==|!=|&&|\|\||\+=|.)"
    r"|(?P<space>\s+)", re.S)


def tokens_of(source):
    source = re.sub(r"^[ \t]*#[^\n]*", "", source, flags=re.M)
    return [(m.lastgroup, m.group()) for m in TOKEN.finditer(source)
            if m.lastgroup not in ("comment", "space") and not m.group().isspace()]


def closing_places(tokens):
    pairs, stack = {}, []
    for i, (kind, text) in enumerate(tokens):
        if kind == "sign" and text in "([{":
            stack.append(i)
        elif kind == "sign" and text in ")]}" and stack:
            pairs[stack.pop()] = i
    return pairs


def arguments_of(tokens, pairs, opening):
    """The stretches between the commas of a call, each as (begin, end)."""
    begin, i, end = opening + 1, opening + 1, pairs[opening]
    while i < end:
        if i in pairs:
            i = pairs[i]
        elif tokens[i][1] == ",":
            yield begin, i
            begin = i + 1
        i += 1
    yield begin, end


def literal(tokens, begin, end):
    """The text of a stretch that is only literals, or std::string of such; else None."""
    part = tokens[begin:end]
    if len(part) > 5 and [t for _, t in part[:3]] == ["std", "::", "string"] and part[3][1] == "(":
        part = part[4:-1]
    if part and all(kind == "text" for kind, _ in part):
        return "".join(text[1:-1] for _, text in part)
    return None


def alternatives(tokens, pairs, begin, end):
    """Both ends of c ? a : b, or the stretch itself."""
    while begin in pairs and pairs[begin] == end - 1 and tokens[begin][1] == "(":
        begin, end = begin + 1, end - 1
    question, i = None, begin
    while i < end:
        if i in pairs:
            i = pairs[i]
        elif tokens[i][1] == "?" and question is None:
            question = i
        elif tokens[i][1] == ":" and question is not None:
            yield from alternatives(tokens, pairs, question + 1, i)
            yield from alternatives(tokens, pairs, i + 1, end)
            return
        i += 1
    yield begin, end


def pattern_of(tokens, pairs, begin, end):
    pattern, places, start, i = "", 0, begin, begin
    operands = []
    while i < end:
        if i in pairs:
            i = pairs[i]
        elif tokens[i][1] == "+":
            operands.append((start, i))
            start = i + 1
        i += 1
    operands.append((start, end))
    for one in operands:
        text = literal(tokens, *one)
        if text is not None:
            pattern += text
        elif pattern.endswith("}"):
            continue  # two places that touch are one
        else:
            places += 1
            pattern += "{%d}" % places
    return pattern


def messages_of(source):
    tokens = tokens_of(source)
    pairs = closing_places(tokens)
    for i, (kind, name) in enumerate(tokens[:-1]):
        if i + 1 not in pairs or kind != "name" or (name not in MAKERS and name != "Error"):
            continue
        for argument in arguments_of(tokens, pairs, i + 1):
            for one in alternatives(tokens, pairs, *argument):
                pattern = pattern_of(tokens, pairs, *one)
                fixed = re.sub(r"\{\d\}", "", pattern)
                if "{{" not in pattern and " " in fixed and len(fixed.replace(" ", "")) >= LEAST_SIGNS and re.search("[a-z]{2}", fixed):
                    yield pattern


def print_template(folders, texts_of):
    """As a template for gettext, once each, what texts_of(source, path, folder) yields of the folders' sources; tests are left out."""
    printed = set()
    print('msgid ""\nmsgstr ""\n"Content-Type: text/plain; charset=UTF-8\\n"')
    for folder in folders:
        for path in sorted(pathlib.Path(folder).rglob("*.cpp")):
            if "test" in path.parts:
                continue
            for text in texts_of(path.read_text(encoding="utf-8"), path, folder):
                if text not in printed:
                    printed.add(text)
                    print('\nmsgid "%s"\nmsgstr ""' % text)


if __name__ == "__main__":
    print_template(sys.argv[1:], lambda source, path, folder: messages_of(source))
