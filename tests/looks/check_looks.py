# SPDX-License-Identifier: Apache-2.0
"""check_looks.py REPOSITORY [--control]: every text of the high-contrast look has a contrast of at least 7 to 1 on its ground (WCAG 2.1,
success criterion 1.4.6), and every size of a font follows the desktop's (rem). With --control both are spoilt, and the check must notice."""
import pathlib
import re
import sys

LEAST = 7.0
GROUND = "#000000"  # of the windows


def luminance(colour):
    parts = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(a, b):
    high, low = sorted((luminance(a), luminance(b)), reverse=True)
    return (high + 0.05) / (low + 0.05)


def find_faults(strong, sheets):
    faults, pairs = [], 0
    strong = re.sub(r"/\*.*?\*/", "", strong, flags=re.S)
    for selector, body in re.findall(r"([^{}]+)\{([^{}]*)\}", strong):
        colour = re.search(r"(?<![-\w])color:\s*(#[0-9a-fA-F]{6})", body)
        if not colour:
            continue
        ground = re.search(r"background:\s*(#[0-9a-fA-F]{6})", body)
        # a label within a chosen row stands on the row's ground
        on = ground.group(1) if ground else "#ffff00" if ":selected" in selector else GROUND
        pairs += 1
        ratio = contrast(colour.group(1), on)
        if ratio < LEAST:
            faults.append(f"{selector.strip()}: {colour.group(1)} on {on} is only {ratio:.1f} to 1")
    if pairs < 12:
        faults.append("hardly a colour was looked at")
    for name, text in sheets.items():
        faults += [f"{name}: a font in pixels does not follow the desktop's size: {size}" for size in re.findall(r"font-size:\s*[\d.]+px", text)]
    return faults


def main():
    looks = pathlib.Path(sys.argv[1]) / "assets" / "looks"
    sheets = {path.name: path.read_text(encoding="utf-8") for path in sorted(looks.glob("*.css"))}
    strong = sheets["high-contrast.css"]
    if "--control" in sys.argv:
        spoilt = strong.replace("color: #ffffff", "color: #777777", 1)
        pixels = {"window.css": sheets["window.css"].replace("font-size: 0.975rem", "font-size: 13px", 1)}
        if not find_faults(spoilt, sheets) or not find_faults(strong, pixels):
            sys.exit("a spoilt look was not noticed")
        return
    faults = find_faults(strong, sheets)
    if faults:
        sys.exit("\n".join(faults))


main()
