"""Compares our scenes with the published steps of mls-mpm88.cpp and incremental_mpm on the same particles."""

import argparse

import numpy as np

import lahar
from published_steps import PROGRAMS

STARTS = ["its own", "thrown", "jittered"]


def lattice(low, high, spacing):
    at = np.arange(low, high, spacing)
    return np.stack(np.meshgrid(at, at, indexing="ij"), axis=-1).reshape(-1, 2)


def start(scene, kind, seed):
    """Returns particles by body. "thrown" gives each its own velocity; "jittered" moves them by up to a quarter of a cell."""
    random = np.random.default_rng(seed)
    if scene == "mls-mpm88":
        centers = [(0.55, 0.45), (0.45, 0.65), (0.55, 0.85)]
        bodies = {f"square-{k + 1}": np.array(center) + random.uniform(-0.08, 0.08, (500, 2)) for k, center in enumerate(centers)}
        scale = 2.0
    else:
        spacing, low, high = (1.0, 24.0, 40.0) if scene.endswith("1") else (0.5, 16.0, 48.0)
        bodies = {"square": lattice(low, high, spacing)}
        if kind == "jittered":
            bodies["square"] += random.uniform(-0.25, 0.25, bodies["square"].shape) * spacing
        scale = 0.5
    made = {}
    for name, position in bodies.items():
        velocity = np.zeros_like(position)
        if scene.endswith("mpm-1"):
            velocity = np.array([0.0, 1.375]) + random.uniform(-0.25, 0.25, position.shape)
        if kind == "thrown":
            velocity = velocity + random.uniform(-scale, scale, 2)
        made[name] = {"position": position, "velocity": velocity}
        if scene != "mls-mpm88":
            made[name]["mass"] = np.ones(len(position))
    return made


def compare(program, scene, precision, kinds, steps, itself, seed):
    rows, of_itself = [], []
    for number, kind in enumerate(kinds):
        bodies = start(scene, kind, seed + number)
        ours = lahar.run(program, scene, bodies, steps, precision)
        whole = [np.concatenate([body[key] for body in bodies.values()]) for key in ("position", "velocity")]
        theirs = PROGRAMS[scene](*whole).frames(steps)
        rows += [((kind, step), lahar.differences(ours[step], theirs[step])) for step in steps]
        if itself:
            # Each coordinate moves to the next number in double or in single precision.
            real = np.float64 if precision == "f64" else np.float32
            beside = np.nextafter(whole[0].astype(real), real(1e9)).astype(np.float64)
            other = PROGRAMS[scene](beside, whole[1]).frames(steps)
            of_itself += [((kind, step), lahar.differences(other[step], theirs[step])) for step in steps]
    lahar.table(f"{scene}, {precision}: ours and the published steps", rows)
    if itself:
        lahar.table(f"{scene}, {precision}: the published steps, and these from a start one rounding away", of_itself)


def main():
    words = argparse.ArgumentParser(description=__doc__)
    words.add_argument("--lahar", default="lahar", help="the program")
    words.add_argument("--scenes", nargs="+", default=list(PROGRAMS), choices=list(PROGRAMS))
    words.add_argument("--precision", nargs="+", default=["f64", "f32"], choices=["f64", "f32"])
    words.add_argument("--starts", nargs="+", default=STARTS, choices=STARTS)
    words.add_argument("--steps", nargs="+", type=int, default=[10, 50, 100, 200, 300], help="substeps to compare at; multiples of the first")
    words.add_argument("--itself", action="store_true", help="also the published steps from a start one rounding away")
    words.add_argument("--seed", type=int, default=1)
    given = words.parse_args()
    for scene in given.scenes:
        for precision in given.precision:
            compare(given.lahar, scene, precision, given.starts, given.steps, given.itself, given.seed)


if __name__ == "__main__":
    main()
