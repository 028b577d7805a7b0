"""Runs a scene of lahar on given particles, reads its frames, and measures their differences from another program's."""

import json
import pathlib
import subprocess
import tempfile

import numpy as np


def run(program, scene, bodies, steps, precision="f64", settings=(), threads=1):
    """Runs `scene` and returns {substep: {field: array}}, rows by particle.

    `bodies` maps the names of the scene's bodies to their start: a dictionary of arrays `position` [n, D] and, if
    wanted, `velocity`, `mass`, `volume0`, ...; None leaves the scene's own particles. `steps` are multiples of the
    first. `settings` are further "key=value" of the scene.
    """
    every = steps[0]
    assert all(step % every == 0 for step in steps), steps
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        words = [program, "run", scene, "-o", str(folder / "run"), "--format", "npz", "--threads", str(threads)]
        words += ["--frames", str(steps[-1] // every), "--json"]
        overrides = [f"precision={precision}", f"substeps_per_frame={every}", *settings]
        for name, start in bodies.items():
            if start is not None:
                np.savez(folder / f"{name}.npz", **start)
                zero = [0.0] * start["position"].shape[1]
                overrides.append(f"bodies.{name}.particles={folder / name}.npz")
                overrides += [f"bodies.{name}.{key}={zero}" for key in ("velocity", "velocity_spread")]
        for override in overrides:
            words += ["--set", override]
        done = subprocess.run(words, capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError(f"{' '.join(words)}\n{done.stderr}")
        json.loads(done.stdout)
        frames = {}
        for step in [0, *steps]:
            with np.load(folder / "run" / "frames" / f"{step // every:06d}.npz") as file:
                frames[step] = {name: file[name].astype(np.float64) for name in file.files if file[name].ndim}
        return frames


def moments(position):
    """Returns m1 .. m4, the means of the powers of all coordinates."""
    return np.array([np.mean(position**power) for power in (1, 2, 3, 4)])


COLUMNS = ["moments", "center", "x rms", "x max", "v max", "J max"]


def differences(ours, theirs):
    """Returns the differences of moments (relative, the worst), center of mass [m], positions (root mean square and worst)
    [m], velocities (worst) [m/s] and J (worst). Both have the same particles in the same rows."""
    x, y = ours["position"], theirs["position"]
    apart = np.linalg.norm(x - y, axis=1)
    return [
        np.max(np.abs(moments(x) / moments(y) - 1.0)),
        np.max(np.abs(x.mean(axis=0) - y.mean(axis=0))),
        np.sqrt(np.mean(apart**2)),
        apart.max(),
        np.abs(ours["velocity"] - theirs["velocity"]).max(),
        np.abs(ours["J"] - theirs["J"]).max() if theirs.get("J") is not None else np.nan,
    ]


def table(title, rows):
    """Prints rows of (words, numbers) as a table in Markdown."""
    print(f"\n{title}\n")
    print("| " + " | ".join(["start", "substep", *COLUMNS]) + " |")
    print("|" + "---|" * (len(COLUMNS) + 2))
    for words, numbers in rows:
        print("| " + " | ".join([*map(str, words), *(f"{x:.1e}" for x in numbers)]) + " |", flush=True)
