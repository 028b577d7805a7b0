"""The benchmark's column of fluid as other programs are given it: the same particles a cell, shape, motion and time step."""

import time

import numpy as np

# Walls stand this many cells inside a program's grid.
PAD = 3


class Scene:
    """A column of fluid that collapses in a box, in `dim` dimensions with `cells` cells a metre.

    The scenes of crates/lahar-scene/scenes/bench: the box is 1 m a side (2 m by 1 m in 2D), the column fills the half of
    each side (not of the depth in 3D); linear J-based pressure, quadratic kernel, APIC, f32.
    """

    def __init__(self, dim, cells, sound_speed, dt):
        self.dim, self.cells, self.dt = dim, cells, dt
        self.dx = 1.0 / cells
        box, column, self.rate = ((1, 1, 1), (0.5, 0.5, 1), 5.0) if dim == 3 else ((2, 1), (1, 0.5), 2.0)
        self.size = tuple(side * cells + 2 * PAD for side in box)
        self.density, self.gravity = 1000.0, 9.81
        self.modulus = self.density * sound_speed**2
        self.ppc = 2**dim
        self.volume = self.dx**dim / self.ppc
        count = [int(round(2 * side * cells)) for side in column]
        random = np.random.default_rng(1)
        places = np.stack(np.meshgrid(*[np.arange(n) for n in count], indexing="ij"), axis=-1).reshape(-1, dim)
        x = (places + random.uniform(0, 1, places.shape)) / 2 * self.dx
        self.velocity = np.zeros_like(x)
        self.velocity[:, 0] = self.rate * x[:, 0]
        self.velocity[:, 1] = -self.rate * x[:, 1]
        self.position = x + PAD * self.dx
        # Cell by cell, as a program that never sorts is best given them.
        cell = places // 2
        order = np.lexsort(cell.T[::-1])
        self.position = self.position[order].astype(np.float32)
        self.velocity = self.velocity[order].astype(np.float32)
        self.count = len(x)


def measure(scene, substeps, wait, state, seconds):
    """Particle-steps per second of a run of about so many seconds, after as much to warm up."""
    substeps(2)
    wait()
    began = time.perf_counter()
    substeps(4)
    wait()
    steps = max(4, round(seconds * 4 / (time.perf_counter() - began)))
    substeps(steps)
    wait()
    began = time.perf_counter()
    substeps(steps)
    wait()
    rate = scene.count * steps / (time.perf_counter() - began)
    # What flies apart is not worth its speed.
    x, v, J = state()
    assert np.isfinite(x).all() and np.abs(v).max() < 50 and np.abs(J.mean() - 1) < 0.1, "the fluid is no longer one"
    return rate
