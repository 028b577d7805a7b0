"""The benchmark's column of fluid for other programs: the same particles per cell, shape, motion and time step."""

import time

import numpy as np

# Walls stand this many cells inside a program's grid.
PAD = 3


class Scene:
    """A column of fluid that collapses in a box, in `dim` dimensions with `cells` cells per meter.

    The scenes of crates/lahar-scene/scenes/bench: the box has sides of 1 m (2 m by 1 m in 2D), and the column
    fills half of each side but the depth. Pressure is linear in J; quadratic kernel, APIC, f32.
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
        # Cell by cell, which is best for a program that never sorts.
        cell = places // 2
        order = np.lexsort(cell.T[::-1])
        self.position = self.position[order].astype(np.float32)
        self.velocity = self.velocity[order].astype(np.float32)
        self.count = len(x)


def measure(scene, substeps, wait, state, seconds):
    """Returns the particle-steps per second of a run of about `seconds`, after a warm-up of the same length."""
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
    # The speed of a run that has blown up means nothing.
    x, v, J = state()
    assert np.isfinite(x).all() and np.abs(v).max() < 50 and np.abs(J.mean() - 1) < 0.1, "the fluid has blown up"
    return rate
