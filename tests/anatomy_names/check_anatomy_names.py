#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that no organ, duct, vessel, region or landmark is named in a string outside of the table of roles:
check_anatomy_names.py SOURCE_FOLDER [--control]."""

import pathlib
import re
import sys

TABLE = "src/engine/roles/include/trocar/roles/roles.h"

# Tables of other people's words that contain the same ones. Nothing is compared with an organ's name there.
OTHER_TABLES = {
    "src/platform/files/src/operation_parameters_file.cpp": "fields of an operation's parameters: what liver and gallbladder give and take",
    "src/learn/dataset/src/class_tables.cpp": "classes of public data sets as those write them",
    "src/picture/view/src/labels.cpp": "classes of segmentation as files and Python write them",
    "src/procedure/cholecystectomy/src/triplet.cpp": "targets as CholecT50 writes them",
    "src/program/presenter/src/patient_list.cpp": "parameters of a generated patient whose findings a list shows",
    "src/imaging/anatomy/src/patient_parameters.cpp": "parameters of a generated patient, one of which asks for a subvesical duct",
    "src/imaging/anatomy/src/structure_names.cpp": "what segmentations of others call their segments, in many languages",
}

# In the table, and words of other things as well: "held" of a grasp, "other" of anything.
AMBIGUOUS = {"held", "other"}

# Parts of names: somebody who looks for them in a name guesses a role.
PARTS = {"cystic", "hepatic", "subvesical", "aberrant"}


def read_names(text):
    """All names of the table."""
    names = set()
    for table in re.findall(r"kNames\[\] = \{(.*?)\};", text, re.DOTALL):
        names.update(re.findall(r'"([a-z_]+)"', table))
    return names - AMBIGUOUS


def find_names(text, names):
    """(line number, name) of each string that is one of the names; comments may name what they like."""
    found = []
    for number, line in enumerate(text.splitlines(), 1):
        code = re.sub(r'("(?:[^"\\]|\\.)*")|//.*', lambda match: match.group(1) or "", line)
        found += [(number, literal) for literal in re.findall(r'"([^"\\]*)"', code) if literal in names]
    return found


def check(source):
    names = read_names((source / TABLE).read_text())
    if "gallbladder" not in names or "cystic_duct" not in names or "fundus" not in names:
        return [f"{TABLE}: no table of names was found"]
    complaints, looked_at = [], 0
    for folder in ("src", "samples"):
        for path in sorted((source / folder).rglob("*")):
            name = path.relative_to(source).as_posix()
            if path.suffix not in (".cpp", ".h", ".cu") or "/test/" in name or name == TABLE or name in OTHER_TABLES:
                continue
            looked_at += 1
            complaints += [f"{name}:{line}: \"{literal}\": ask for the role, or take the name from {TABLE}"
                           for line, literal in find_names(path.read_text(), names | PARTS)]
    for name in OTHER_TABLES:
        if not find_names((source / name).read_text(), names):
            complaints.append(f"{name}: names nothing any more; take it off the list in check_anatomy_names.py")
    if looked_at < 100:
        complaints.append(f"only {looked_at} files were found in {source}")
    return complaints


def control():
    """Seeded mistakes must be found, and nothing else."""
    names = {"gallbladder", "cystic_duct"} | PARTS
    cases = [('if (organ.name == "gallbladder") return;', 1), ('const bool is = name.find("cystic") == 0;', 1),
             ('FindOrgan("gallbladder"), FindTube("cystic_duct")', 2), ('std::string name;  ///< "gallbladder"', 0),
             ('Say("the gallbladder bleeds");', 0), ('Say("http://x"); Find("gallbladder");', 1), ('FindOrgan(kGallbladder)', 0)]
    return [f"control: {code} gave {len(find_names(code, names))}, not {wanted}"
            for code, wanted in cases if len(find_names(code, names)) != wanted]


def main():
    source = pathlib.Path(sys.argv[1])
    complaints = control() if "--control" in sys.argv[2:] else check(source)
    for complaint in complaints:
        print(complaint)
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
