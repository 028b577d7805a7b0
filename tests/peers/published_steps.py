"""The published steps of mls-mpm88.cpp and of incremental_mpm's three stages, in NumPy: an oracle for programs that cannot
be run here. It computes in double precision, with all particles at once, on one dense grid.

Grids are [n, n] with node i at x = (i + offset) dx; weights are quadratic B-splines over 3 x 3 nodes.
"""

import numpy as np


def stencil(x, dx, offset):
    """Returns nodes [p, 9, 2], weights [p, 9] and lever arms [p, 9, 2] of particles at x."""
    base = np.floor(x / dx - offset - 0.5).astype(int)
    fx = x / dx - offset - base
    w = np.stack([0.5 * (1.5 - fx) ** 2, 0.75 - (fx - 1.0) ** 2, 0.5 * (fx - 0.5) ** 2], axis=1)
    shifts = np.array([(i, j) for i in range(3) for j in range(3)])
    nodes = base[:, None, :] + shifts[None]
    weights = w[:, shifts[:, 0], 0] * w[:, shifts[:, 1], 1]
    return nodes, weights, (shifts[None] - fx[:, None, :]) * dx


def to_grid(shape, nodes, values):
    """Returns the grid with the sums of values [p, 9, ...] over particles."""
    grid = np.zeros((*shape, *values.shape[2:]))
    np.add.at(grid, (nodes[..., 0], nodes[..., 1]), values)
    return grid


def around(grid, nodes, weights):
    """Returns the weighted sums of a grid's values over the nodes of each particle."""
    return np.einsum("pk,pk...->p...", weights, grid[nodes[..., 0], nodes[..., 1]])


class Steps:
    """The steps that all programs share: P2G with an affine momentum, grid, G2P. Each program is a subclass."""

    offset = 0.0

    def __init__(self, position, velocity):
        count = len(position)
        self.x, self.v = position.copy(), velocity.copy()
        self.c = np.zeros((count, 2, 2))
        self.f = np.tile(np.eye(2), (count, 1, 1))
        self.jp = np.ones(count)
        self.m = np.ones(count)
        self.j = None

    def p2g(self, q):
        """Sums particles to the grid. `q` is what a particle adds to its momentum per lever arm [p, 2, 2]."""
        self.nodes, self.w, self.r = stencil(self.x, self.dx, self.offset)
        self.mass = to_grid(self.shape, self.nodes, self.w * self.m[:, None])
        momentum = (self.m[:, None] * self.v)[:, None, :] + np.einsum("pab,pkb->pka", q, self.r)
        self.grid = to_grid(self.shape, self.nodes, self.w[..., None] * momentum)
        there = self.mass > 0.0
        self.grid[there] /= self.mass[there][:, None]
        self.grid[there] += self.dt * np.array([0.0, self.gravity])

    def g2p(self):
        self.v = around(self.grid, self.nodes, self.w)
        at_nodes = self.grid[self.nodes[..., 0], self.nodes[..., 1]]
        self.c = 4.0 / self.dx**2 * np.einsum("pk,pka,pkb->pab", self.w, at_nodes, self.r)
        self.x = self.x + self.dt * self.v

    def move_f(self):
        return (np.eye(2) + self.dt * self.c) @ self.f

    def frames(self, steps):
        frames = {}
        for step in range(1, steps[-1] + 1):
            self.substep()
            if step in steps:
                j = np.linalg.det(self.f) if self.j is None else self.j
                frames[step] = {"position": self.x.copy(), "velocity": self.v.copy(), "J": j.copy()}
        return frames


class MlsMpm88(Steps):
    """mls-mpm88.cpp: snow between sticky walls at 0.05, on a floor that lets go."""

    n, dt, gravity = 80, 1e-4, -200.0
    dx = 1.0 / n
    shape = (n + 1, n + 1)
    young, nu, hardening = 1e4, 0.2, 10.0

    def substep(self):
        h = np.exp(self.hardening * (1.0 - self.jp))
        mu = self.young / (2 * (1 + self.nu)) * h
        la = self.young * self.nu / ((1 + self.nu) * (1 - 2 * self.nu)) * h
        j = np.linalg.det(self.f)
        u, _, vt = np.linalg.svd(self.f)
        stress = 2 * mu[:, None, None] * (self.f - u @ vt) @ self.f.transpose(0, 2, 1)
        stress += (la * (j - 1) * j)[:, None, None] * np.eye(2)
        self.p2g(self.m[:, None, None] * self.c - self.dt * 4 / self.dx**2 * stress)
        at = np.arange(self.n + 1) / self.n
        x, y = np.meshgrid(at, at, indexing="ij")
        # 0.95 is a node. In single precision 1 - 0.05 equals it; in double precision the tolerance makes it so.
        self.grid[(x < 0.05) | (x > 1 - 0.05 + 1e-9) | (y > 1 - 0.05 + 1e-9)] = 0.0
        self.grid[..., 1] = np.where(y < 0.05, np.maximum(self.grid[..., 1], 0.0), self.grid[..., 1])
        self.g2p()
        f = self.move_f()
        u, sigma, vt = np.linalg.svd(f)
        sigma = np.clip(sigma, 1 - 2.5e-2, 1 + 7.5e-3)
        self.f = u @ (sigma[..., None] * vt)
        self.jp = np.clip(self.jp * np.linalg.det(f) / np.linalg.det(self.f), 0.6, 20.0)


class Incremental(Steps):
    """The steps that the three stages share: cells of size 1 with their centers as nodes, slip walls of two cells, a clamp."""

    offset, dx = 0.5, 1.0
    shape = (64, 64)
    volume0 = None

    def walls(self):
        index = np.arange(64)
        held = (index < 2) | (index > 61)
        self.grid[held, :, 0] = 0.0
        self.grid[:, held, 1] = 0.0

    def density(self):
        nodes, w, _ = stencil(self.x, self.dx, self.offset)
        mass = to_grid(self.shape, nodes, w * self.m[:, None])
        return around(mass, nodes, w)

    def substep(self):
        volume, stress = self.stress()
        self.p2g(self.m[:, None, None] * self.c - (4.0 * self.dt * volume)[:, None, None] * stress)
        self.walls()
        self.g2p()
        self.x = np.clip(self.x, 1.0, 62.0)
        self.after()

    def after(self):
        pass


class Intro(Incremental):
    dt, gravity = 1.0, -0.05

    def stress(self):
        return np.zeros(len(self.x)), np.zeros_like(self.c)

    def after(self):
        self.j = np.full(len(self.x), np.nan)


class NeoHookean(Incremental):
    dt, gravity, la, mu = 0.1, -0.3, 10.0, 20.0

    def stress(self):
        if self.volume0 is None:
            self.volume0 = self.m / self.density()
        j = np.linalg.det(self.f)
        ft = self.f.transpose(0, 2, 1)
        inverse = np.linalg.inv(ft)
        p = self.mu * (self.f - inverse) + (self.la * np.log(j))[:, None, None] * inverse
        return self.volume0 * j, p @ ft / j[:, None, None]

    def after(self):
        self.f = self.move_f()


class Fluid(Incremental):
    dt, gravity = 0.2, -0.3
    rest_density, viscosity, stiffness, power = 4.0, 0.1, 10.0, 4

    def stress(self):
        density = self.density()
        self.j = self.rest_density / density
        pressure = np.maximum(-0.1, self.stiffness * ((density / self.rest_density) ** self.power - 1.0))
        strain = self.c.copy()
        strain[:, 0, 1] = strain[:, 1, 0] = self.c[:, 0, 1] + self.c[:, 1, 0]
        return self.m / density, self.viscosity * strain - pressure[:, None, None] * np.eye(2)

    def after(self):
        ahead = self.x + self.v
        self.v = self.v + np.where(ahead < 3.0, 3.0 - ahead, 0.0) + np.where(ahead > 60.0, 60.0 - ahead, 0.0)


PROGRAMS = {"mls-mpm88": MlsMpm88, "incremental-mpm-1": Intro, "incremental-mpm-2": NeoHookean, "incremental-mpm-3": Fluid}
