#!/usr/bin/env python3
"""Kills runs by SIGKILL at many moments, resumes them, and compares every file with that of an unbroken run.

    tests/reliability/kill.py path/to/lahar [--kills 50] [--seed 1] [--keep]

The scenes are in 2D and 3D with several materials, probes, a film and a checkpoint every third frame, on 1 and 2 threads.
Some kills are aimed: before the folder has any file, while a file (a frame, a checkpoint, run.json, start.json) has its
temporary name, and right after a checkpoint. The others come after a random time. A resumed run may be killed again. The
script needs Python's standard library only.
"""

import argparse
import filecmp
import json
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

HEAD = """
title = "Kill test"
duration = {duration}
frame_rate = 60
gravity = {gravity}
dimension = {dimension}
dx = {dx}
[domain]
min = {low}
max = {high}
walls = "separate"
[materials.water]
preset = "water"
sound_speed = 25.0
[materials.jelly]
preset = "jelly"
[materials.snow]
preset = "snow"
[[bodies]]
name = "column"
material = "water"
shape = {{ box = {{ min = {low}, max = {column} }} }}
sampling = "jittered"
[[bodies]]
name = "ball"
material = "jelly"
shape = {{ ball = {{ center = {ball}, radius = 0.1 }} }}
velocity = {throw}
[[bodies]]
name = "snow"
particles = "snow.csv"
material = "snow"
[[forces]]
acceleration = {field}
[[probes]]
name = "wall"
pressure = {{ at = {gauge} }}
rate = 200
[[probes]]
name = "floor"
force = {{ on = "bottom" }}
[output]
formats = ["npz", "vtk", "png", "gif"]
picture_size = [160, 120]
checkpoint_every = 3
"""


def scene(folder, dimension):
    """Writes a scene with its list of particles and returns its path."""
    folder.mkdir()
    flat = dimension == 2

    def vector(*values):
        return str(list(values[:dimension]))

    text = HEAD.format(
        dimension=dimension,
        duration=0.25 if flat else 0.15,
        dx=0.02 if flat else 0.05,
        gravity=vector(0.0, -9.81, 0.0),
        low=vector(0.0, 0.0, 0.0),
        high=vector(1.0, 0.6, 0.4) if not flat else vector(1.0, 0.6),
        column=vector(0.3, 0.4, 0.4),
        ball=vector(0.6, 0.3, 0.2),
        throw=vector(-1.0, 0.5, 0.0),
        gauge=vector(1.0, 0.05, 0.2),
        # Toward the starting position of each particle, which is part of the state.
        field='["4*(X-x)", "0"]' if flat else '["4*(X-x)", "0", "0"]',
    )
    (folder / "kill.toml").write_text(text)
    rows = ["x,y,volume" if flat else "x,y,z,volume"]
    for i in range(12):
        for j in range(12):
            place = [0.75 + 0.01 * i, 0.3 + 0.01 * j] + ([] if flat else [0.2])
            rows.append(",".join(f"{number:.6g}" for number in place + [1e-4 if flat else 4e-6]))
    (folder / "snow.csv").write_text("\n".join(rows) + "\n")
    return folder / "kill.toml"


def files(run):
    """Returns the files that must be the same: all but checkpoints/ and run.json."""
    found = [path.relative_to(run) for path in run.rglob("*") if path.is_file()]
    return sorted(path for path in found if path.parts[0] != "checkpoints" and path != pathlib.Path("run.json"))


CLOCK = ["seconds", "startup_seconds", "phase_seconds", "particle_steps_per_second", "threads"]


def record(run):
    """Returns run.json without the entries that depend on the clock."""
    whole = json.loads((run / "run.json").read_text())
    return {key: value for key, value in whole.items() if key not in CLOCK}


def differences(one, other):
    """Returns the names of files that differ between two runs."""
    if files(one) != files(other):
        return [f"files: {sorted(set(files(one)) ^ set(files(other)))}"]
    found = [str(path) for path in files(one) if not filecmp.cmp(one / path, other / path, shallow=False)]
    if record(one) != record(other):
        found.append("run.json")
    return found


def partial(run, where):
    """Returns true while a file in the folder `where` is being written."""
    try:
        return any(name.endswith(".partial") for name in os.listdir(run / where))
    except FileNotFoundError:
        return False


def checkpoints(run):
    """Returns the names of the checkpoints of a run."""
    try:
        return [name for name in os.listdir(run / "checkpoints") if name.endswith(".checkpoint")]
    except FileNotFoundError:
        return []


AIMS = {
    "before the first file": lambda run: run.exists(),
    "while start.json is written": lambda run: partial(run, "checkpoints") and not (run / "run.json").exists(),
    "while run.json is written": lambda run: partial(run, "."),
    "before the first checkpoint": lambda run: (run / "frames").exists(),
    "while a frame is written": lambda run: partial(run, "frames"),
    "while a picture is written": lambda run: partial(run, "images"),
    "while a checkpoint is written": lambda run: (run / "frames").exists() and partial(run, "checkpoints"),
    "right after a checkpoint": lambda run: len(checkpoints(run)) > 0,
    "with two checkpoints": lambda run: len(checkpoints(run)) > 1,
}


def start(command, run, wanted):
    """Runs `command` and kills it as soon as `wanted(run)` is true. Returns false if it ended before."""
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    while process.poll() is None:
        if wanted(run):
            process.send_signal(signal.SIGKILL)
            process.wait()
            return True
    errors = process.stderr.read().decode()
    if process.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))} ended with {process.returncode}:\n{errors}")
    return False


def after(seconds):
    """Returns a condition that becomes true after some seconds."""
    end = time.monotonic() + seconds

    def wanted(_):
        if time.monotonic() >= end:
            return True
        time.sleep(0.0005)
        return False

    return wanted


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("lahar", type=pathlib.Path)
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", action="store_true", help="leave the folders")
    arguments = parser.parse_args()
    lahar, chance = arguments.lahar.resolve(), random.Random(arguments.seed)
    root = pathlib.Path(tempfile.mkdtemp(prefix="lahar-kill-"))

    cases = []
    for dimension in (2, 3):
        path = scene(root / f"scene-{dimension}d", dimension)
        whole = root / f"whole-{dimension}d"
        began = time.monotonic()
        if start([lahar, "run", path, "-o", whole, "--threads", "1"], whole, lambda _: False):
            sys.exit("an unbroken run was killed")
        cases.append((dimension, path, whole, time.monotonic() - began))

    kills, resumed, hit, wrong = 0, 0, {}, []
    aims = list(AIMS)
    number = 0
    while kills < arguments.kills:
        dimension, path, whole, seconds = cases[number % 2]
        threads = str(1 + number // 2 % 2)
        run = root / f"run-{number}"
        # Every other run is first killed at an aimed moment, in turn.
        aim = aims[number // 2 % len(aims)] if number % 4 < 2 else "at random"
        wanted = AIMS.get(aim) or after(chance.uniform(0.0, seconds))
        story = []
        command = [lahar, "run", path, "-o", run, "--threads", threads]
        while start(command, run, wanted):
            kills += 1
            hit[aim] = hit.get(aim, 0) + 1
            story.append(aim)
            begun = (run / "run.json").exists() or (run / "checkpoints/start.json").exists()
            if begun:
                resumed += 1
                command = [lahar, "resume", run, "--threads", chance.choice("12")]
            aim = "at random"
            # One run in three is killed again.
            again = chance.random() < 0.33 and kills < arguments.kills
            wanted = after(chance.uniform(0.0, seconds)) if again else lambda _: False
        found = differences(whole, run)
        left = [str(path.relative_to(run)) for path in run.rglob("*.partial")]
        if found or left:
            wrong.append((run, story, found + left))
            print(f"DIFFERENT: {run}, {dimension}D, killed {story}: {found + left}")
        elif not arguments.keep:
            shutil.rmtree(run)
        number += 1

    for aim, count in sorted(hit.items()):
        print(f"{count:4} killed {aim}")
    print(f"{kills} kills in {number} runs, {resumed} resumes: {len(wrong)} runs differ from the unbroken one")
    if not arguments.keep and not wrong:
        shutil.rmtree(root)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
