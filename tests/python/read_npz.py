"""Reads the frames of a run with NumPy and checks shapes, types, order and totals. It needs numpy only:

    python3 -m venv venv && venv/bin/pip install numpy
    lahar run dam-break --frames 5 --format npz -o RUN
    venv/bin/python tests/python/read_npz.py RUN
"""

import csv
import json
import pathlib
import sys

import numpy as np

run = pathlib.Path(sys.argv[1])
record = json.loads((run / "run.json").read_text())
rows = list(csv.DictReader((run / "diagnostics.csv").open()))
frames = sorted((run / "frames").glob("*.npz"))
assert frames and len(rows) == record["frames"] == len(frames), (len(rows), record["frames"], len(frames))

d = record["dimension"]
real = np.dtype(record["precision"].replace("f", "<f").replace("32", "4").replace("64", "8"))
scalars = ["J", "plastic_J", "pressure", "mass", "volume0", "material", "body", "id"]
shapes = {"position": (d,), "velocity": (d,), "affine": (d, d), "deformation_gradient": (d, d)}
shapes |= {name: () for name in scalars}

for index, (path, row) in enumerate(zip(frames, rows)):
    assert path.name == f"{index:06}.npz"
    with np.load(path) as frame:
        n = len(frame["id"])
        assert n == int(row["particles"])
        assert frame["time"].shape == () and float(frame["time"]) == float(row["time"])
        assert (np.diff(frame["id"].astype(np.int64)) > 0).all(), "rows by ascending id"
        for name in frame.files:
            if name != "time":
                assert frame[name].shape == (n, *shapes[name]), (name, frame[name].shape)
                assert np.isfinite(frame[name]).all(), name
        assert frame["position"].dtype == np.dtype("<f8") and frame["velocity"].dtype == real
        mass = frame["mass"].astype(np.float64)
        assert abs(mass.sum() - float(row["mass"])) < 1e-6 * mass.sum()
        momentum = (mass[:, None] * frame["velocity"]).sum(axis=0)
        scale = (mass * np.linalg.norm(frame["velocity"], axis=1)).sum() + 1e-300
        recorded = np.array([float(row["momentum_" + axis]) for axis in "xyz"[:d]])
        assert np.abs(momentum - recorded).max() < 1e-5 * scale + 1e-12, (momentum, recorded)

print(f"{len(frames)} frames of {n} particles read: fields {', '.join(np.load(frames[-1]).files)}")
