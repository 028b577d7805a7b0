"""Reads the frames of a run with other programs and compares them bit by bit with the NumPy arrays of the same frames:

    python3 -m venv venv && venv/bin/pip install -r tests/python/requirements.txt
    lahar run dam-break --frames 2 --format npz,vtk,ply,bgeo -o RUN
    venv/bin/python tests/python/read_exports.py RUN

VTK reads .vtp; plyfile, meshio and trimesh read .ply; the .pvd is read as XML. splashsurf reads the positions of .bgeo, if
the frame has no matrices, which it does not support; all attributes are read by NumPy records, laid out as the format says.
"""

import pathlib
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

import meshio
import numpy as np
import plyfile
import trimesh
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

VECTORS, MATRICES = ["velocity"], ["affine", "deformation_gradient"]
LETTERS = {"velocity": "v", "affine": "C", "deformation_gradient": "F"}


def same(name, ours, theirs, dtype=None):
    """Checks that two arrays have the same bits, NaN included."""
    ours = np.ascontiguousarray(ours if dtype is None else ours.astype(dtype))
    theirs = np.ascontiguousarray(theirs)
    assert ours.shape == theirs.shape, (name, ours.shape, theirs.shape)
    assert ours.dtype == theirs.dtype, (name, ours.dtype, theirs.dtype)
    assert ours.tobytes() == theirs.tobytes(), (name, ours, theirs)


def in_space(name, values):
    """Returns the values filled up to three dimensions."""
    n, d = len(values), values.shape[-1]
    if name in VECTORS or name == "position":
        full = np.zeros((n, 3), values.dtype)
        full[:, :d] = values
    elif name in MATRICES:
        full = np.zeros((n, 3, 3), values.dtype)
        if name == "deformation_gradient":
            full[:] = np.eye(3)
        full[:, :d, :d] = values
        full = full.reshape(n, 9)
    else:
        full = values
    return full


def read_vtk(path, frame, fields):
    """Compares a .vtp file with a frame."""
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    data = reader.GetOutput()
    n = len(frame["position"])
    assert data.GetNumberOfPoints() == data.GetNumberOfVerts() == n
    same("points", in_space("position", frame["position"]), vtk_to_numpy(data.GetPoints().GetData()))
    points = data.GetPointData()
    names = {points.GetArrayName(i) for i in range(points.GetNumberOfArrays())}
    assert names == set(fields), (names, fields)
    for name in fields:
        same(name, in_space(name, frame[name]), vtk_to_numpy(points.GetArray(name)))
    time = vtk_to_numpy(data.GetFieldData().GetArray("TimeValue"))
    assert time[0] == frame["time"]


def read_ply(path, frame, fields):
    """Compares a .ply file with a frame."""
    d = frame["position"].shape[1]
    columns = {axis: in_space("position", frame["position"])[:, i] for i, axis in enumerate("xyz")}
    for name in fields:
        values, letter = frame[name], LETTERS.get(name, name)
        if name in VECTORS:
            columns |= {f"{letter}{'xyz'[i]}": values[:, i] for i in range(d)}
        elif name in MATRICES:
            columns |= {f"{letter}{i + 1}{j + 1}": values[:, i, j] for i in range(d) for j in range(d)}
        else:
            columns[name] = values
    vertex = plyfile.PlyData.read(str(path))["vertex"]
    assert {p.name for p in vertex.properties} == set(columns)
    mesh = meshio.read(path)
    for name, values in columns.items():
        same(name, values, np.asarray(vertex[name]))
        if name not in "xyz":
            same(name, values, mesh.point_data[name])
    same("points", in_space("position", frame["position"]), np.asarray(mesh.points))
    cloud = trimesh.load(path)
    assert np.array_equal(cloud.vertices, in_space("position", frame["position"]))


def read_bgeo(path, frame, fields):
    """Compares a .bgeo file with a frame."""
    n = len(frame["position"])
    position = in_space("position", frame["position"]).astype("<f4")
    if not set(MATRICES) & set(fields):
        with tempfile.TemporaryDirectory() as scratch:
            out = pathlib.Path(scratch) / "points.vtk"
            tool = pathlib.Path(sys.executable).with_name("pysplashsurf")
            subprocess.run([tool, "convert", "--particles", path, "-o", out], check=True, capture_output=True)
            same("points", position, meshio.read(out).points.astype("<f4"))

    data = path.read_bytes()
    assert data[:5] == b"BgeoV"
    version, points, *counts = np.frombuffer(data, ">i4", 9, 5).tolist()
    assert version == 5 and points == n and counts[:3] == [0, 0, 0] and counts[4:] == [0, 0, 1]
    at, record = 5 + 9 * 4, [("P", ">f4", 4)]
    def attribute(at):
        length = int.from_bytes(data[at : at + 2], "big")
        name = data[at + 2 : at + 2 + length].decode()
        at += 2 + length
        size, kind = int.from_bytes(data[at : at + 2], "big"), int.from_bytes(data[at + 2 : at + 6], "big")
        kind = {0: ">f4", 1: ">i4", 5: ">f4"}[kind]
        return at + 6 + 4 * size, (name, kind) if size == 1 else (name, kind, size)
    for _ in range(counts[3]):
        at, line = attribute(at)
        record.append(line)
    rows = np.frombuffer(data, np.dtype(record), n, at)
    at, whole = attribute(at + rows.nbytes)
    assert whole == ("time", ">f4")
    assert np.frombuffer(data, ">f4", 1, at)[0] == np.float32(frame["time"])
    assert data[at + 4 :] == b"\x00\xff"
    assert set(rows.dtype.names) == {"P"} | {"v" if name == "velocity" else name for name in fields}
    same("P", np.hstack([position, np.ones((n, 1), "<f4")]), rows["P"].astype("<f4"))
    for name in fields:
        kind = "<i4" if frame[name].dtype.kind == "u" else "<f4"
        same(name, in_space(name, frame[name]), rows["v" if name == "velocity" else name].astype(kind), kind)


run = pathlib.Path(sys.argv[1])
readers = {"vtp": read_vtk, "ply": read_ply, "bgeo": read_bgeo}
listed = [(float(e.get("timestep")), e.get("file")) for e in ElementTree.parse(run / "particles.pvd").iter("DataSet")]
paths = sorted((run / "frames").glob("*.npz"))
assert paths and len(listed) == len(paths)
for path, (time, file) in zip(paths, listed):
    with np.load(path) as arrays:
        frame = {name: arrays[name] for name in arrays.files}
    assert time == frame["time"] and run / file == path.with_suffix(".vtp")
    fields = [name for name in frame if name not in ("time", "position")]
    for ending, read in readers.items():
        read(path.with_suffix("." + ending), frame, fields)
print(f"{len(paths)} frames of {len(frame['position'])} particles equal in {', '.join(readers)}: {', '.join(fields)}")
