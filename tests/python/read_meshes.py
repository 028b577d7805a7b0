"""Reads the meshes of `lahar mesh` with trimesh, meshio and VTK. Checks that they are closed, that their triangles face
outward, and that they have the volume of the run's particles.

    python3 -m venv venv && venv/bin/pip install -r tests/python/requirements.txt
    lahar run SCENE --frames 2 --format npz -o RUN
    lahar mesh RUN --format ply,obj,vtk
    venv/bin/python tests/python/read_meshes.py RUN 0.02

The last argument is the largest relative error of the volume.
"""

import json
import pathlib
import sys
import xml.etree.ElementTree as ElementTree

import meshio
import numpy as np
import trimesh
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

run, most = pathlib.Path(sys.argv[1]), float(sys.argv[2])
materials = list(json.loads((run / "run.json").read_text())["scene"]["materials"])
for number, name in enumerate(materials):
    paths = sorted((run / "meshes" / name).glob("*.ply"))
    listed = ElementTree.parse(run / "meshes" / f"{name}.pvd").iter("DataSet")
    listed = {e.get("file"): float(e.get("timestep")) for e in listed}
    assert paths and len(listed) == len(paths)
    for path in paths:
        with np.load(run / "frames" / f"{path.stem}.npz") as frame:
            own = frame["material"] == number
            volume = (frame["volume0"][own].astype(float) * frame["J"][own]).sum()
            assert listed[f"{name}/{path.stem}.vtp"] == frame["time"]
            center = frame["position"][own].mean(axis=0)
        mesh = trimesh.load(path, process=False)
        assert mesh.is_watertight and mesh.is_winding_consistent, path
        off = mesh.volume / volume - 1
        assert abs(off) <= most, (path, off)
        assert np.linalg.norm(mesh.center_mass - center) < 0.02 * volume ** (1 / 3), path
        obj = meshio.read(path.with_suffix(".obj"))
        assert np.array_equal(obj.points.astype(np.float32), mesh.vertices.astype(np.float32))
        assert np.array_equal(obj.cells_dict["triangle"], mesh.faces)
        reader = vtkXMLPolyDataReader()
        reader.SetFileName(str(path.with_suffix(".vtp")))
        reader.Update()
        data = reader.GetOutput()
        assert np.array_equal(vtk_to_numpy(data.GetPoints().GetData()), mesh.vertices.astype(np.float32))
        faces = vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        assert np.array_equal(faces, mesh.faces)
        print(f"{path.stem} {name}: {len(faces)} triangles, volume {off:+.2%}, {mesh.body_count} piece(s)")
