"""Writes crates/lahar-scene/tests/scene/lineage.csv: the results of the programs on the particles of our scenes, for tests that
run without them. Taichi's programs run in double precision; the others by their published steps."""

import argparse
import pathlib

import numpy as np

import lahar
import published_steps
from taichi_programs import PROGRAMS, Program

TABLE = pathlib.Path(__file__).resolve().parents[2] / "crates/lahar-scene/tests/scene/lineage.csv"

# The substeps to record, by scene.
STEPS = {
    "mpm88": [1, 500, 800, 1200],
    "mpm99": [1, 50, 200, 500],
    "mpm128": [1, 50, 200, 500],
    "mpm3d": [1, 50, 200, 500],
    "mpm3d-ggui-single-dam": [1, 20, 40],
    "mpm3d-ggui-double-dam": [1, 20, 40],
    "mpm3d-ggui-water-snow-jelly": [1, 20, 40],
    "mls-mpm88": [1, 300, 560, 600],
    "incremental-mpm-1": [1, 50, 100, 300],
    "incremental-mpm-2": [1, 50, 100, 200],
    "incremental-mpm-3": [1, 50, 100, 200],
}


def row(frame):
    """Returns moments m1 .. m4 of the coordinates, center of mass [m], root mean square of the speed [m/s] and range of J."""
    x, v, j = frame["position"], frame["velocity"], frame["J"]
    center = [*x.mean(axis=0), 0.0][:3]
    speed = np.sqrt(np.mean(np.sum(v**2, axis=1)))
    return [*lahar.moments(x), *center, speed, np.min(j), np.max(j)]


def main():
    words = argparse.ArgumentParser(description=__doc__)
    words.add_argument("--lahar", default="lahar", help="the program")
    given = words.parse_args()
    lines = [
        "# Made by tests/peers/make_tables.py: the programs on the particles of our scenes, in double precision. Taichi's",
        "# examples of the wheel 1.7.4; mls-mpm88.cpp and incremental_mpm by their published steps. m1 .. m4: means of the",
        "# powers of all coordinates; center of mass; root mean square of the speed; smallest and largest J.",
        "scene,step,m1,m2,m3,m4,x,y,z,speed,J_min,J_max",
    ]
    for scene, steps in STEPS.items():
        own = lahar.run(given.lahar, scene, {}, [1])[0]
        start = {key: own[key] for key in ("position", "velocity")}
        if scene in PROGRAMS:
            frames = Program(scene, start, "f64").frames(steps)
        else:
            frames = published_steps.PROGRAMS[scene](start["position"], start["velocity"]).frames(steps)
        for step in steps:
            lines.append(f"{scene},{step}," + ",".join(f"{x:.12g}" for x in row(frames[step])))
            print(lines[-1], flush=True)
    TABLE.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
