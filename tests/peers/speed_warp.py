"""MLS-MPM in NVIDIA's Warp on its CPU device, which has one thread; 3D."""

import numpy as np
import warp as wp

wp.config.quiet = True


@wp.func
def weights(f: float):
    return wp.vec3(0.5 * (1.5 - f) * (1.5 - f), 0.75 - (f - 1.0) * (f - 1.0), 0.5 * (f - 0.5) * (f - 0.5))


@wp.kernel
def scatter(
    x: wp.array(dtype=wp.vec3),
    v: wp.array(dtype=wp.vec3),
    c: wp.array(dtype=wp.mat33),
    j: wp.array(dtype=float),
    node: wp.array3d(dtype=wp.vec4),
    dx: float,
    mass: float,
    stress_scale: float,
):
    p = wp.tid()
    at = x[p] / dx
    bx, by, bz = int(at[0] - 0.5), int(at[1] - 0.5), int(at[2] - 0.5)
    f = at - wp.vec3(float(bx), float(by), float(bz))
    wx, wy, wz = weights(f[0]), weights(f[1]), weights(f[2])
    s = stress_scale * (j[p] - 1.0)
    a = dx * (mass * c[p] - wp.diag(wp.vec3(s, s, s)))
    at_base = mass * v[p] - a * f
    for i in range(3):
        for k in range(3):
            for l in range(3):
                w = wx[i] * wy[k] * wz[l]
                m = w * (at_base + a * wp.vec3(float(i), float(k), float(l)))
                wp.atomic_add(node, bx + i, by + k, bz + l, wp.vec4(m[0], m[1], m[2], w * mass))


@wp.func
def stopped(u: float, i: int, low: int, high: int):
    if (i <= low and u < 0.0) or (i >= high and u > 0.0):
        return 0.0
    return u


@wp.kernel
def update(node: wp.array3d(dtype=wp.vec4), impulse: float, low: int, hx: int, hy: int, hz: int):
    i, k, l = wp.tid()
    n = node[i, k, l]
    if n[3] > 0.0:
        node[i, k, l] = wp.vec4(
            stopped(n[0] / n[3], i, low, hx),
            stopped(n[1] / n[3] - impulse, k, low, hy),
            stopped(n[2] / n[3], l, low, hz),
            n[3],
        )


@wp.kernel
def gather(
    x: wp.array(dtype=wp.vec3),
    v: wp.array(dtype=wp.vec3),
    c: wp.array(dtype=wp.mat33),
    j: wp.array(dtype=float),
    node: wp.array3d(dtype=wp.vec4),
    dx: float,
    dt: float,
    low: wp.vec3,
    high: wp.vec3,
):
    p = wp.tid()
    at = x[p] / dx
    bx, by, bz = int(at[0] - 0.5), int(at[1] - 0.5), int(at[2] - 0.5)
    f = at - wp.vec3(float(bx), float(by), float(bz))
    wx, wy, wz = weights(f[0]), weights(f[1]), weights(f[2])
    new_v = wp.vec3(0.0)
    b = wp.mat33(0.0)
    for i in range(3):
        for k in range(3):
            for l in range(3):
                n = node[bx + i, by + k, bz + l]
                u = wx[i] * wy[k] * wz[l] * wp.vec3(n[0], n[1], n[2])
                new_v = new_v + u
                b = b + wp.outer(u, wp.vec3(float(i), float(k), float(l)) - f)
    new_c = (4.0 / dx) * b
    v[p] = new_v
    c[p] = new_c
    j[p] = j[p] * (1.0 + dt * wp.trace(new_c))
    x[p] = wp.min(wp.max(x[p] + dt * new_v, low), high)


def make(scene):
    """Returns substeps(n), wait() and state(), which is x, v, J, of a program on the scene's particles."""
    wp.init()
    dx, dt, n = scene.dx, scene.dt, scene.count
    mass = scene.density * scene.volume
    stress_scale = 4.0 / dx / dx * dt * scene.volume * scene.modulus
    walls = [3] + [side - 3 for side in scene.size]
    low, high = wp.vec3(2.0 * dx), wp.vec3(*[(side + 1) * dx for side in walls[1:]])
    with wp.ScopedDevice("cpu"):
        x, v = wp.array(scene.position, dtype=wp.vec3), wp.array(scene.velocity, dtype=wp.vec3)
        c, j = wp.zeros(n, dtype=wp.mat33), wp.array(np.ones(n, np.float32), dtype=float)
        node = wp.zeros(scene.size, dtype=wp.vec4)

    def substeps(count):
        with wp.ScopedDevice("cpu"):
            for _ in range(count):
                node.zero_()
                wp.launch(scatter, dim=n, inputs=[x, v, c, j, node, dx, mass, stress_scale])
                wp.launch(update, dim=scene.size, inputs=[node, dt * scene.gravity, *walls])
                wp.launch(gather, dim=n, inputs=[x, v, c, j, node, dx, dt, low, high])

    return substeps, wp.synchronize, lambda: (x.numpy(), v.numpy(), j.numpy())
