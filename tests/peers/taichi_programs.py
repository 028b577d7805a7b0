"""Taichi's own example programs from its wheel, without their windows: they start on given particles, step, and are read.

They are not copied. A program's file is loaded as it is, but for its resolution if another is asked for, with `ti.init` and
the windows replaced by dummies.
"""

import importlib.util
import pathlib
import tempfile

import numpy as np
import taichi as ti

FOLDER = tempfile.TemporaryDirectory()
EXAMPLES = pathlib.Path(ti.__file__).parent / "examples"


class Nothing:
    """A dummy for a window: every attribute exists and does nothing, and the window counts as closed."""

    running = False

    def __getattr__(self, name):
        return Nothing()

    def __call__(self, *arguments, **names):
        return Nothing()

    def __bool__(self):
        return True

    # The only event of a closed window is its closing.
    @property
    def event(self):
        closing = Nothing()
        closing.key = ti.GUI.ESCAPE
        return closing


def exact_svd():
    """Makes Taichi's 2 x 2 singular value decomposition exact: it drops off-diagonal entries of the stretch below 1e-15
    instead of below 1e-5."""
    file = pathlib.Path(ti.__file__).parent / "_funcs.py"
    text = file.read_text()
    assert text.count("< 1e-5") == 1
    copy = pathlib.Path(FOLDER.name) / "funcs_exact.py"
    copy.write_text(text.replace("< 1e-5", "< 1e-15"))
    spec = importlib.util.spec_from_file_location("funcs_exact", copy)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    ti.svd = module.svd


def load(path, precision, replace=None):
    """Returns the module of an example, without its windows and its choice of a machine."""
    ti.init(arch=ti.cpu, default_fp=ti.f64 if precision == "f64" else ti.f32, cpu_max_num_threads=1, log_level=ti.ERROR)
    text = (EXAMPLES / path).read_text()
    if replace:
        assert replace[0] in text
        text = text.replace(*replace)
    kept = ti.init, ti.GUI, ti.ui.Window, ti.ui.Camera
    gui = type("GUI", (Nothing,), {name: getattr(ti.GUI, name) for name in ("ESCAPE", "EXIT", "PRESS", "LEFT", "RIGHT", "UP", "DOWN", "LMB", "RMB")})
    ti.init, ti.GUI, ti.ui.Window, ti.ui.Camera = Nothing(), gui, Nothing(), Nothing()
    gui.__new__ = lambda cls, *arguments, **names: object.__new__(cls)
    gui.__init__ = lambda self, *arguments, **names: None
    try:
        # Kernels are compiled at their first call, from the file, which therefore stays.
        file = pathlib.Path(tempfile.mkdtemp(dir=FOLDER.name)) / path.split("/")[-1]
        file.write_text(text)
        spec = importlib.util.spec_from_file_location(file.stem, file)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    finally:
        ti.init, ti.GUI, ti.ui.Window, ti.ui.Camera = kept
    return module


class Program:
    """One of the programs on given particles."""

    def __init__(self, name, start, precision):
        """`start`: position [n, D], velocity [n, D], in the program's order of particles."""
        path, names, replace, preset = PROGRAMS[name]
        self.module = load(path, precision, replace)
        self.names = names
        position, velocity = start["position"], start["velocity"]
        if preset is not None:
            self.module.init_vols(self.module.presets[preset])
        elif hasattr(self.module, "initialize"):
            self.module.initialize()
        elif hasattr(self.module, "reset"):
            self.module.reset()
        count, dimension = position.shape
        real = np.float64 if precision == "f64" else np.float32
        identity = np.broadcast_to(np.eye(dimension, dtype=real), (count, dimension, dimension))
        values = {"x": position, "v": velocity, "C": 0 * identity, "J": np.ones(count), "F": identity, "Jp": np.ones(count)}
        for letter, name in names.items():
            getattr(self.module, name).from_numpy(np.ascontiguousarray(values[letter].astype(real)))

    def substep(self):
        self.module.substep(*getattr(self.module, "GRAVITY", ()))

    def read(self, letter):
        return getattr(self.module, self.names[letter]).to_numpy().astype(np.float64)

    def frames(self, steps):
        """{substep: {position, velocity, J}}."""
        frames = {}
        for step in range(1, steps[-1] + 2):
            self.substep()
            if "F" in self.names and step - 1 in frames:
                # Their F is advanced at the beginning of a substep.
                frames[step - 1]["J"] = np.linalg.det(self.read("F"))
            if step in steps:
                frames[step] = {"position": self.read("x"), "velocity": self.read("v")}
                if "J" in self.names:
                    frames[step]["J"] = self.read("J")
        return frames


_PLAIN = {letter: letter for letter in ("x", "v", "C")}
_F = {letter: f"F_{letter}" for letter in ("x", "v", "C")}
_SOLIDS = {**_PLAIN, "F": "F", "Jp": "Jp"}
_GGUI = {**_F, "F": "F_dg", "Jp": "F_Jp"}
_SIZE = "dim, n_grid, steps, dt = 3, 32, 25, 4e-4"

# Name of our scene: file of the example, its fields, (text, replacement), preset.
PROGRAMS = {
    "mpm88": ("simulation/mpm88.py", {**_PLAIN, "J": "J"}, None, None),
    "mpm99": ("simulation/mpm99.py", _SOLIDS, None, None),
    "mpm128": ("simulation/mpm128.py", _SOLIDS, None, None),
    "mpm3d": ("simulation/mpm3d.py", {**_F, "J": "F_J"}, None, None),
    "mpm3d-64": ("simulation/mpm3d.py", {**_F, "J": "F_J"}, (_SIZE, "dim, n_grid, steps, dt = 3, 64, 25, 2e-4"), None),
    "mpm3d-128": ("simulation/mpm3d.py", {**_F, "J": "F_J"}, (_SIZE, "dim, n_grid, steps, dt = 3, 128, 25, 8e-5"), None),
    "mpm3d-ggui-single-dam": ("ggui_examples/mpm3d_ggui.py", _GGUI, None, 0),
    "mpm3d-ggui-double-dam": ("ggui_examples/mpm3d_ggui.py", _GGUI, None, 1),
    "mpm3d-ggui-water-snow-jelly": ("ggui_examples/mpm3d_ggui.py", _GGUI, None, 2),
}
