#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Whether the documents are true where a program can tell.

  check_documents.py ROOT [--program TROCAR] [--window TROCAR-WINDOW]    prints what is wrong; exit status 1 where something is
  check_documents.py ROOT ... --control                                  seeds one mistake after the other; each must be found
"""
import argparse
import functools
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

MOST_COMMANDS = 6
WINDOW = ("trocar-window",)
STATUSES = ("Accepted", "Superseded by ", "Measured and rejected")


def pages(root):
    found = [root / name for name in ("README.md", "CHANGELOG.md", "CONTRIBUTING.md")]
    found += sorted((root / "src").glob("*/README.md"))
    return found + sorted((root / "docs").rglob("*.md"))


def without_code(text):
    """Fenced blocks and code spans hold no links."""
    return re.sub(r"`[^`\n]*`", "", re.sub(r"^```.*?^```", "", text, flags=re.S | re.M))


def anchors(text):
    """Names that GitHub gives to headings."""
    found = set()
    for title in re.findall(r"^#+ (.*)$", re.sub(r"^```.*?^```", "", text, flags=re.S | re.M), flags=re.M):
        title = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", title).strip().lower()
        name = re.sub(r"[^\w\- ]", "", title).replace(" ", "-")
        count = 0
        while (name if count == 0 else f"{name}-{count}") in found:
            count += 1
        found.add(name if count == 0 else f"{name}-{count}")
    return found


def links(text):
    return re.findall(r"\]\(([^)\s]+)\)", without_code(text))


def check_links(root):
    for page in pages(root):
        for link in links(page.read_text()):
            if re.match(r"[a-z]+:", link):
                continue
            path, _, anchor = link.partition("#")
            target = page if not path else page.parent / path
            if not target.exists():
                yield f"{page.relative_to(root)}: {link} leads nowhere"
            elif anchor and (target.suffix != ".md" or anchor not in anchors(target.read_text())):
                yield f"{page.relative_to(root)}: {link} names no heading"


def check_door(root):
    """The reader gets from docs/README.md to each page."""
    door = root / "docs/README.md"
    seen, waiting = {door.resolve()}, [door]
    while waiting:
        page = waiting.pop()
        for link in links(page.read_text()):
            target = (page.parent / link.partition("#")[0]).resolve()
            if target.suffix == ".md" and target.exists() and target not in seen:
                seen.add(target)
                waiting.append(target)
    for page in pages(root):
        if page.resolve() not in seen:
            yield f"{page.relative_to(root)}: no way leads here from docs/README.md"


def check_readme(root):
    text = (root / "README.md").read_text()
    table = re.search(r"^\| command \|.*\n\|[-| ]+\n((?:\|.*\n)*)", text, flags=re.M)
    rows = len(table[1].splitlines()) if table else 0
    if not 1 <= rows <= MOST_COMMANDS:
        yield f"README.md: {rows} commands in the table, 1 to {MOST_COMMANDS} are wanted"
    listed = set(re.findall(r"^([a-z_]+/(?:[a-z_]+/)?) ", text, flags=re.M))
    for folder in sorted(listed):
        if not (root / folder).is_dir():
            yield f"README.md: there is no folder {folder}"
    for folder in sorted(path.name for path in (root / "src").iterdir() if path.is_dir()):
        if f"src/{folder}/" not in listed:
            yield f"README.md: the folder src/{folder}/ is not in the list"
        wing = root / "src" / folder
        rooms = {path.name for path in wing.iterdir() if path.is_dir()}
        page = wing / "README.md"
        told = set(re.findall(r"^\| \[?`(\w+)/?`", page.read_text(), flags=re.M)) if page.exists() else set()
        for room in sorted(rooms ^ told):
            yield f"src/{folder}/README.md: {room} is {'not in its list' if room in rooms else 'in its list and not there'}"
    samples = [path.read_text() for path in (root / "samples").glob("*.cpp")]
    blocks = re.findall(r"^```cpp\n(.*?)^```", text, flags=re.S | re.M)
    if not blocks:
        yield "README.md: there is no sample"
    for block in blocks:
        if not any(block in sample for sample in samples):
            yield "README.md: the sample is not a part of any file in samples/, which are compiled"


def check_changelog(root):
    text = (root / "CHANGELOG.md").read_text()
    first = re.search(r"^## .*?(?=^## |\Z)", text, flags=re.S | re.M)
    if first is None or not first[0].startswith("## Unreleased\n"):
        yield "CHANGELOG.md: the first section is not Unreleased"
        return
    for heading in ("Added", "Changed", "Fixed"):
        if f"\n### {heading}\n\n" not in first[0]:
            yield f"CHANGELOG.md: Unreleased has no heading {heading} with an empty line below"


def check_decisions(root):
    folder = root / "docs/decisions"
    index = (folder / "README.md").read_text()
    rows = {}
    for number, date, status in re.findall(r"^\| \[?(\d{4})\S* \|[^|]*\| ([\d-]+) \| (.*) \|$", index, flags=re.M):
        if number in rows:
            yield f"docs/decisions/README.md: {number} is there twice"
        if not status.startswith(STATUSES):
            yield f"docs/decisions/README.md: {number} has the status {status}"
        rows[number] = (date, status)
    for page in sorted(folder.glob("[0-9]*.md")):
        name, text = page.relative_to(root), page.read_text()
        date = re.search(r"^Date: (\d{4}-\d{2}-\d{2})$", text, flags=re.M)
        status = re.search(r"^Status: (.+)$", text, flags=re.M)
        if date is None:
            yield f"{name}: there is no line Date: YYYY-MM-DD"
        if status is None or not status[1].startswith(STATUSES):
            yield f"{name}: there is no line Status: with one of {', '.join(STATUSES)}"
        row = rows.get(page.name[:4])
        if row is None:
            yield f"{name}: it is not in the list of decisions"
        elif date and status and row != (date[1], status[1]):
            yield f"{name}: the list of decisions has another date or status"


@functools.cache
def read_sources(folders):
    """(paths from the root, words) of the source files below these folders. The control's copies share them."""
    files, words = set(), set()
    for folder in folders:
        for path in folder.rglob("*"):
            if path.suffix in (".h", ".cpp", ".cu", ".cuh"):
                files.add("/" + str(path.relative_to(folder.parent)))
                words.update(re.findall(r"\w+", path.read_text()))
    return files, words


def check_names(root):
    """Source files, and names such as SolveReport::error or Suite.Test, that the documents mention are there."""
    folders = [root / name for name in ("src", "tests", "samples", "fuzz")]
    files, words = read_sources(tuple(folder.resolve() for folder in folders if folder.is_dir()))
    for page in pages(root):
        name = page.relative_to(root)
        text = re.sub(r"^```.*?^```", "", page.read_text(), flags=re.S | re.M)
        for span in sorted(set(re.findall(r"`([^`\n]+)`", text))):
            if re.fullmatch(r"[\w/]+\.(h|cpp|cu|cuh)", span):
                # a module's name may stand before a file of it
                pattern = re.compile(".*/" + "/(?:.*/)?".join(map(re.escape, span.split("/"))))
                if not any(pattern.fullmatch(path) for path in files):
                    yield f"{name}: there is no file {span}"
            elif re.fullmatch(r"[A-Z]\w+::\w+(\(\))?|[A-Z]\w+\.[A-Z]\w+", span):
                for word in re.findall(r"\w+", span):
                    if word not in words:
                        yield f"{name}: nothing is called {word} ({span})"


# --- commands


def ask_help(program, command):
    """(subcommands, options) of a command."""
    text = subprocess.run([program, *command, "--help"], capture_output=True, text=True, check=True).stdout
    part = re.search(r"^Subcommands:\n((?:  .*\n)*)", text, flags=re.M)
    subcommands = set(re.findall(r"^  ([a-z0-9-]+) ", part[1], flags=re.M)) if part else set()
    options = set()
    part = re.search(r"^Options:\n((?:  .*\n)*)", text, flags=re.M)
    for line in part[1].splitlines() if part else []:
        name = re.match(r"  (-[^ =:]+)", line)
        if name:
            options.update(name[1].split(","))
    return subcommands, options


def ask_commands(program, window):
    """{command words: (subcommands, options)} of the whole program; the window's stand under WINDOW."""
    tree, waiting = {}, [()]
    if window:
        tree[WINDOW] = ask_help(window, ())
    while waiting:
        command = waiting.pop()
        tree[command] = ask_help(program, command)
        waiting += [(*command, word) for word in tree[command][0]]
    return tree


def written_commands(text):
    """(whether it is the window's, what follows) of `trocar` and `trocar-window` in code spans and at the beginning of lines in blocks."""
    blocks = "".join(re.findall(r"^```\w*\n(.*?)^```", text, flags=re.S | re.M)).replace("\\\n", " ")
    for line in blocks.splitlines():
        line = re.split(r"  +#|\s{4,}", line.strip())[0]
        for part in line.split("&&"):
            found = re.match(r"(?:[A-Z_]+=\S+ )*(?:build/release/)?trocar(-window)? (.*)", part.strip())
            if found:
                yield bool(found[1]), found[2]
    spans = re.sub(r"^```.*?^```", "", text, flags=re.S | re.M)
    for span in re.findall(r"`([^`]+)`", spans):
        found = re.match(r"(?:build/release/)?trocar(-window)? (.*)", " ".join(span.split()))
        if found:
            yield bool(found[1]), found[2]


def check_commands(root, tree):
    named = set()
    for page in pages(root):
        name = page.relative_to(root)
        for is_window, line in written_commands(page.read_text()):
            words, command = line.split(), WINDOW if is_window else ()
            if command not in tree:
                continue
            while words and words[0] in tree[command][0]:
                command = (*command, words.pop(0))
            if page.name == "commands.md":
                named.add(command)
            subcommands, options = tree[command]
            # capitals stand for a name, an ellipsis for anything
            if subcommands and words and re.fullmatch(r"[a-z][a-z0-9-]*", words[0]):
                yield f"{name}: trocar {line}: there is no {words[0]}"
                continue
            for word in words:
                option = re.match(r"--?[a-z][a-z-]*", word)
                if option and option[0] not in options:
                    yield f"{name}: trocar{'-window' if is_window else ''} {line}: there is no option {option[0]}"
    for command in sorted(tree):
        is_leaf = not tree[command][0]
        # what the experiments share stands in one row
        if is_leaf and command not in named and command[0] not in ("reproduce", *WINDOW):
            yield f"docs/commands.md: trocar {' '.join(command)} is missing"


def check(root, tree):
    found = []
    for complaints in (check_links(root), check_door(root), check_readme(root), check_changelog(root), check_decisions(root),
                       check_names(root)):
        found += complaints
    if tree:
        found += check_commands(root, tree)
    return found


# --- control


def edit(path, old, new):
    text = path.read_text()
    assert old in text, f"{path} has no {old!r}"
    path.write_text(text.replace(old, new, 1))


def append(path, text):
    path.write_text(path.read_text() + text)


# what is wrong, how it is seeded, and what the complaint must say
CONTROLS = (
    ("a link to a page that is not there", lambda r: append(r / "docs/tissue.md", "[x](missing.md)\n"), "leads nowhere"),
    ("a link to a heading that is not there", lambda r: append(r / "docs/tissue.md", "[x](solver.md#none)\n"), "names no heading"),
    ("a page that no link leads to", lambda r: (r / "docs/lost.md").write_text("# Lost\n"), "no way leads here"),
    ("a room that its wing does not list", lambda r: edit(r / "src/engine/README.md", "| `rigid`", "| `stiff`"), "rigid is not in its list"),
    ("a seventh command", lambda r: edit(r / "README.md", "| `trocar doctor` |", "| `trocar errors` | x |\n| `trocar doctor` |"), "commands in the table"),
    ("a folder that is not there", lambda r: edit(r / "README.md", "src/platform/ ", "src/heart/ "), "there is no folder"),
    ("a folder that is not listed", lambda r: edit(r / "README.md", "src/platform/ ", "src/engine/ "), "is not in the list"),
    ("a sample that nobody compiles", lambda r: edit(r / "README.md", "int main() {", "int main(int) {"), "sample"),
    ("a changelog without Unreleased", lambda r: edit(r / "CHANGELOG.md", "## Unreleased", "## 9.9.9"), "not Unreleased"),
    ("a changelog without Fixed", lambda r: edit(r / "CHANGELOG.md", "### Fixed", "### Mended"), "heading Fixed"),
    ("a decision without a date", lambda r: edit(r / "docs/decisions/0001-modules-and-arrows.md", "Date: ", "Day: "), "no line Date"),
    ("a decision with a wrong status", lambda r: edit(r / "docs/decisions/0001-modules-and-arrows.md", "Status: ", "Status: un"), "no line Status"),
    ("a decision that is not listed", lambda r: edit(r / "docs/decisions/README.md", "| [0001]", "| [9001]"), "not in the list of decisions"),
    ("a source file that is not there", lambda r: append(r / "docs/tissue.md", "`no_such_file.h`\n"), "there is no file"),
    ("a name that is not there", lambda r: append(r / "docs/tissue.md", "`SolveReport::no_such_member`\n"), "nothing is called"),
    ("a date that differs", lambda r: edit(r / "docs/decisions/0001-modules-and-arrows.md", "Date: 20", "Date: 19"), "another date or status"),
)
COMMAND_CONTROLS = (
    ("a command that is not there", lambda r: append(r / "docs/tissue.md", "`trocar operate`\n"), "there is no operate"),
    ("a subcommand in a block that is not there", lambda r: append(r / "docs/tissue.md", "```\ntrocar anatomy shrink -o x\n```\n"), "there is no shrink"),
    ("an option that is not there", lambda r: append(r / "docs/tissue.md", "`trocar demo --fast`\n"), "there is no option --fast"),
    ("a window's option that is not there", lambda r: append(r / "docs/tissue.md", "`trocar-window --fast`\n"), "trocar-window --fast: there is no option"),
    ("a command without a row", lambda r: edit(r / "docs/commands.md", "`trocar doctor`", "`trocar errors`"), "trocar doctor is missing"),
)


def run_controls(root, tree):
    failed = 0
    controls = CONTROLS + (COMMAND_CONTROLS if tree else ())
    if not tree or WINDOW not in tree:
        controls = tuple(control for control in controls if "window" not in control[0])
    for what, seed, complaint in controls:
        with tempfile.TemporaryDirectory() as folder:
            copy = Path(folder)
            for entry in root.iterdir():
                if entry.name == "docs":
                    shutil.copytree(entry, copy / "docs")
                elif entry.suffix == ".md":
                    shutil.copy(entry, copy / entry.name)
                elif entry.name == "src":
                    # the pages of the wings are copies, or a mistake would be seeded in this tree
                    for wing in entry.iterdir():
                        (copy / "src" / wing.name).mkdir(parents=True)
                        for part in wing.iterdir():
                            if part.suffix == ".md":
                                shutil.copy(part, copy / "src" / wing.name / part.name)
                            else:
                                os.symlink(part, copy / "src" / wing.name / part.name)
                elif entry.name not in (".git", "build", "out"):
                    os.symlink(entry, copy / entry.name)
            seed(copy)
            found = check(copy, tree)
            if not any(complaint in line for line in found):
                failed += 1
                print(f"not found: {what}; instead: {found}")
    print(f"{len(controls) - failed} of {len(controls)} seeded mistakes are found")
    return failed


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("root", type=Path)
    parser.add_argument("--program")
    parser.add_argument("--window")
    parser.add_argument("--control", action="store_true")
    options = parser.parse_args()
    root = options.root.resolve()
    tree = ask_commands(options.program, options.window) if options.program else None
    if options.control:
        return 1 if run_controls(root, tree) else 0
    found = check(root, tree)
    for line in found:
        print(line)
    print(f"{len(pages(root))} pages, {len(found)} complaints")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
