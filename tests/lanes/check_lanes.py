#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that each test of a build folder has the label of exactly one lane, and that no test waits for an environment
variable to run: check_lanes.py BUILD_FOLDER SOURCE_FOLDER LANE..."""

import json
import pathlib
import subprocess
import sys
import tempfile


def find_lane_complaints(tests, lanes):
    """One line for each test (name, labels) that is not in exactly one lane."""
    complaints = []
    for name, labels in tests:
        found = [label for label in labels if label in lanes]
        if len(found) != 1:
            complaints.append(f"{name}: {'no lane' if not found else 'lanes ' + ', '.join(found)}; cmake/lanes.cmake says which there are")
    return complaints


def find_hidden_tests(sources):
    """Test files (path, text) that skip a test unless a variable asks for it."""
    # in two parts, so that this file does not find itself
    variable = "TROCAR_SLOW" + "_TESTS"
    return [f"{path}: a test must not hide behind {variable}; end the suite's name in Slow or Whole"
            for path, text in sources
            for line in text.splitlines() if variable in line and "SKIP" in line]


def read_tests(build):
    # from a folder of its own: ctest empties the log of the folder that it is called in, and this runs as one of its tests
    with tempfile.TemporaryDirectory() as folder:
        pathlib.Path(folder, "CTestTestfile.cmake").write_text(f'subdirs("{pathlib.Path(build).resolve()}")\n', encoding="utf-8")
        shown = subprocess.run(["ctest", "--test-dir", folder, "--show-only=json-v1"], capture_output=True, text=True, check=True)
    tests = []
    for test in json.loads(shown.stdout)["tests"]:
        properties = {entry["name"]: entry["value"] for entry in test.get("properties", [])}
        if not test["name"].endswith("_NOT_BUILT"):
            tests.append((test["name"], properties.get("LABELS", [])))
    return tests


def main():
    build, source, *lanes = sys.argv[1:]
    # negative controls: what must be found is found
    assert find_lane_complaints([("a", ["core"]), ("b", ["fast", "slow"]), ("c", ["core", "fast"])], ["fast", "slow"]) \
        == ["a: no lane; cmake/lanes.cmake says which there are", "b: lanes fast, slow; cmake/lanes.cmake says which there are"]
    assert len(find_hidden_tests([("x.cpp", 'if (!getenv("TROCAR_SLOW' + '_TESTS")) GTEST_SKIP();')])) == 1
    tests = read_tests(build)
    complaints = find_lane_complaints(tests, lanes)
    root = pathlib.Path(source)
    files = [path for folder in ("src", "tests") if (root / folder).exists()
             for path in (root / folder).rglob("*_test.cpp")]
    complaints += find_hidden_tests((path.relative_to(root), path.read_text(encoding="utf-8")) for path in files)
    print("\n".join(complaints))
    print(f"{len(tests)} tests, {len(complaints)} complaints")
    return 1 if complaints or len(tests) < 2 else 0


if __name__ == "__main__":
    sys.exit(main())
