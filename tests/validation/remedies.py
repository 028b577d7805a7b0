#!/usr/bin/env python3
"""Prints the table of docs/water.md: the errors of the water cases with each remedy of the default fluid left out.

    cargo build --release && python3 tests/validation/remedies.py target/release/lahar

Every case runs as `lahar validate --quick` runs it, with some keys of its scene changed.
"""

import json
import pathlib
import re
import subprocess
import sys
import tempfile

SCENES = pathlib.Path(__file__).parents[2] / "crates/lahar-scene/scenes/validation"

CASES = {
    "F4": "f4-tank",
    "F5": "f5-standing-wave",
    "F7": "f7-elliptic-drop",
    "F8": "f8-rotating-square",
    "F9": "f9-jet",
    "D1": "d1-martin-moyce",
    "D2": "d2-koshizuka-oka",
    "D4": "d3-wall-impact",
}

# MATERIAL and BODY stand for the names in the case's scene.
VARIANTS = {
    "default": [],
    "without (7i)": ["materials.MATERIAL.volume_correction=0"],
    "without (7h)": ["materials.MATERIAL.volume_smoothing=0"],
    "without both": ["materials.MATERIAL.volume_correction=0", "materials.MATERIAL.volume_smoothing=0"],
    "volumes alike": ["bodies.BODY.volume=alike"],
    "no start pressure": ["bodies.BODY.pressure=none"],
    "FLIP .99": ["transfer=flip", "flip_blend=0.99"],
    "cfl .4": ["cfl=0.4"],
}


def findings(program, case, settings):
    """Returns the findings of `lahar validate` with these keys set."""
    text = (SCENES / f"{CASES[case]}.toml").read_text()
    material = re.search(r"^\[materials\.(\S+)\]", text, re.M).group(1)
    body = re.search(r"^\[\[bodies\]\]\s*\nname = \"(\S+)\"", text, re.M).group(1)
    command = [program, "validate", case, "--quick", "--json"]
    for setting in settings:
        command += ["--set", setting.replace("MATERIAL", material).replace("BODY", body)]
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(command + ["-o", folder + "/out"], capture_output=True, text=True)
    if not done.stdout.strip():
        return {}
    rows = json.loads(done.stdout)
    return {(row["case"], row["quantity"]): row for row in rows if row["case"] == case}


def shown(row):
    """Returns a cell of the table, in bold if the error meets its target."""
    if row is None:
        return "-"
    error = row["error"]
    text = f"{100 * error:.2g} %" if abs(error) >= 1e-5 else "0"
    return f"**{text}**" if row["pass"] else text


def main():
    program = sys.argv[1]
    columns = {}
    for name, settings in VARIANTS.items():
        columns[name] = {}
        for case in CASES:
            print(name, case, file=sys.stderr, flush=True)
            columns[name].update(findings(program, case, settings))
    print("| case | quantity | target | " + " | ".join(VARIANTS) + " |")
    print("|---|---|---|" + "---|" * len(VARIANTS))
    for key, row in columns["default"].items():
        if row["target"] is not None:
            values = " | ".join(shown(columns[name].get(key)) for name in VARIANTS)
            print(f"| {key[0]} | {key[1]} | {100 * row['target']:.2g} % | {values} |")


if __name__ == "__main__":
    main()
