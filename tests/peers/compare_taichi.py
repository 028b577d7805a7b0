"""Compares our scenes with Taichi's programs on the same particles, substep by substep."""

import argparse

import numpy as np

import lahar
from taichi_programs import PROGRAMS, Program, exact_svd

# Bodies of our scenes in the program's order: name, particles, lower corner, upper corner, velocity.
BODIES = {
    "mpm88": [("square", 8192, (0.2, 0.2), (0.6, 0.6), (0.0, -1.0))],
    "mpm99": [(name, 3000, (0.3 + 0.1 * k, 0.05 + 0.32 * k), (0.5 + 0.1 * k, 0.25 + 0.32 * k), (0.0, 0.0)) for k, name in enumerate(["liquid", "jelly", "snow"])],
    "mpm3d": [("cube", 8192, (0.15,) * 3, (0.55,) * 3, (0.0,) * 3)],
    "mpm3d-64": [("cube", 65536, (0.15,) * 3, (0.55,) * 3, (0.0,) * 3)],
    "mpm3d-128": [("cube", 524288, (0.15,) * 3, (0.55,) * 3, (0.0,) * 3)],
    "mpm3d-ggui-single-dam": [("water", 65536, (0.55, 0.05, 0.55), (0.95, 0.45, 0.95), (0.0,) * 3)],
    "mpm3d-ggui-double-dam": [
        ("first", 32768, (0.05, 0.05, 0.05), (0.35, 0.45, 0.35), (0.0,) * 3),
        ("second", 32768, (0.65, 0.05, 0.65), (0.95, 0.45, 0.95), (0.0,) * 3),
    ],
    "mpm3d-ggui-water-snow-jelly": [
        ("water", 21845, (0.6, 0.05, 0.6), (0.85, 0.3, 0.85), (0.0,) * 3),
        ("snow", 21845, (0.35, 0.35, 0.35), (0.6, 0.6, 0.6), (0.0,) * 3),
        ("jelly", 21846, (0.05, 0.6, 0.05), (0.3, 0.85, 0.3), (0.0,) * 3),
    ],
}
BODIES["mpm128"] = BODIES["mpm99"]

STARTS = ["its own", "thrown", "squeezed"]


def start(scene, kind, seed, precision):
    """Returns particles by body, placed at random as the program does. "thrown" gives them velocities of up to 2 m/s;
    "squeezed" puts them into boxes of two thirds of the size."""
    random = np.random.default_rng(seed)
    bodies = {}
    for name, count, low, high, velocity in BODIES[scene]:
        low, high = np.array(low), np.array(high)
        if kind == "squeezed":
            low, high = low + (high - low) / 6, high - (high - low) / 6
        position = low + random.random((count, len(low))) * (high - low)
        v = np.tile(velocity, (count, 1))
        if kind == "thrown":
            v = v + random.uniform(-2.0, 2.0, len(low)) + random.uniform(-0.2, 0.2, position.shape)
        if precision == "f32":
            position, v = position.astype(np.float32), v.astype(np.float32)
        bodies[name] = {"position": position.astype(np.float64), "velocity": v.astype(np.float64)}
    return bodies


def together(bodies):
    return {key: np.concatenate([body[key] for body in bodies.values()]) for key in ("position", "velocity")}


def reordered(frames, order):
    """Returns the frames by particle, from those of a program whose row i is particle order[i]."""
    back = np.argsort(order)
    return {step: {key: rows[back] for key, rows in frame.items()} for step, frame in frames.items()}


def compare(program, scene, precision, kinds, steps, itself, seed):
    ours_to_theirs, theirs_to_themselves = [], []
    for number, kind in enumerate(kinds):
        bodies = start(scene, kind, seed + number, precision)
        ours = lahar.run(program, scene, bodies, steps, precision)
        whole = together(bodies)
        theirs = Program(scene, whole, precision).frames(steps)
        ours_to_theirs += [((kind, step), lahar.differences(ours[step], theirs[step])) for step in steps]
        if itself:
            # Each group of particles in reverse: the same sums in another order.
            order = np.concatenate([np.arange(len(p)) + 0 for p in [whole["position"]]])
            first = 0
            for body in bodies.values():
                count = len(body["position"])
                order[first : first + count] = first + np.arange(count)[::-1]
                first += count
            other = Program(scene, {key: rows[order] for key, rows in whole.items()}, precision).frames(steps)
            other = reordered(other, order)
            theirs_to_themselves += [((kind, step), lahar.differences(other[step], theirs[step])) for step in steps]
    lahar.table(f"{scene}, {precision}: ours and Taichi's", ours_to_theirs)
    if itself:
        lahar.table(f"{scene}, {precision}: Taichi's and Taichi's with the particles in another order", theirs_to_themselves)


def main():
    words = argparse.ArgumentParser(description=__doc__)
    words.add_argument("--lahar", default="lahar", help="the program")
    words.add_argument("--scenes", nargs="+", default=[scene for scene in PROGRAMS if scene != "mpm3d-128"], choices=list(PROGRAMS))
    words.add_argument("--precision", nargs="+", default=["f64", "f32"], choices=["f64", "f32"])
    words.add_argument("--starts", nargs="+", default=STARTS, choices=STARTS)
    words.add_argument("--steps", nargs="+", type=int, default=[25, 50, 100, 200, 350, 500], help="substeps to compare at; multiples of the first")
    words.add_argument("--itself", action="store_true", help="also Taichi's program against itself, particles in another order")
    words.add_argument("--seed", type=int, default=1)
    words.add_argument("--exact-svd", action="store_true", help="without the threshold of 1e-5 in Taichi's 2D decomposition")
    given = words.parse_args()
    if given.exact_svd:
        exact_svd()
    for scene in given.scenes:
        for precision in given.precision:
            compare(given.lahar, scene, precision, given.starts, given.steps, given.itself, given.seed)


if __name__ == "__main__":
    main()
