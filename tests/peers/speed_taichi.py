"""MLS-MPM in Taichi on the CPU: as its examples are written, and tuned.

As written: one loop over particles adds to the nodes by atomics; velocity and mass are two fields.
Tuned: particles are sorted by block and cell every few substeps; velocity and mass are one vector, on blocks of nodes; the
scatter is serial on one thread and goes over colored blocks on several, without atomics.
"""

import taichi as ti

BLOCK = 4
# Substeps between two sorts, in which particles move less than a cell.
SORT_EVERY = 20


def make(scene, tuned, threads):
    """Returns substeps(n), wait() and state(), which is x, v, J, of a program on the scene's particles."""
    ti.init(arch=ti.cpu, default_fp=ti.f32, cpu_max_num_threads=threads, log_level=ti.ERROR, offline_cache=True)
    D, dx, dt, n = scene.dim, scene.dx, scene.dt, scene.count
    inv_dx, mass, gravity = 1.0 / dx, scene.density * scene.volume, scene.gravity
    stress_scale = 4.0 * inv_dx * inv_dx * dt * scene.volume * scene.modulus
    size = tuple(-(-side // BLOCK) * BLOCK for side in scene.size)
    blocks = tuple(side // BLOCK for side in size)
    wall_low, wall_high = 3, tuple(side - 3 for side in scene.size)

    x, v = ti.Vector.field(D, ti.f32, n), ti.Vector.field(D, ti.f32, n)
    C, J = ti.Matrix.field(D, D, ti.f32, n), ti.field(ti.f32, n)
    axes = ti.ijk if D == 3 else ti.ij
    if tuned:
        node = ti.Vector.field(D + 1, ti.f32)
        ti.root.dense(axes, blocks).dense(axes, (BLOCK,) * D).place(node)
    else:
        node_v, node_m = ti.Vector.field(D, ti.f32, size), ti.field(ti.f32, size)
    x.from_numpy(scene.position)
    v.from_numpy(scene.velocity)
    C.fill(0.0)
    J.fill(1.0)

    @ti.func
    def stencil(p):
        at = x[p] * inv_dx
        base = ti.cast(at - 0.5, ti.i32)
        f = at - base
        w = ti.Matrix.rows([0.5 * (1.5 - f) ** 2, 0.75 - (f - 1.0) ** 2, 0.5 * (f - 0.5) ** 2])
        return base, f, w

    @ti.func
    def affine(p):
        a = mass * C[p]
        for i in ti.static(range(D)):
            a[i, i] -= stress_scale * (J[p] - 1.0)
        return a

    @ti.func
    def stopped(I, u):
        for i in ti.static(range(D)):
            if I[i] <= wall_low and u[i] < 0:
                u[i] = 0.0
            if I[i] >= wall_high[i] and u[i] > 0:
                u[i] = 0.0
        return u

    @ti.func
    def move(p, new_v, new_C):
        v[p], C[p] = new_v, new_C
        J[p] *= 1.0 + dt * new_C.trace()
        y = x[p] + dt * new_v
        for i in ti.static(range(D)):
            y[i] = ti.min(ti.max(y[i], 2.0 * dx), (wall_high[i] + 1) * dx)
        x[p] = y

    @ti.kernel
    def step_as_written():
        for I in ti.grouped(node_m):
            node_v[I] = ti.zero(node_v[I])
            node_m[I] = 0.0
        for p in x:
            base, f, w = stencil(p)
            a = affine(p)
            for offset in ti.static(ti.grouped(ti.ndrange(*((3,) * D)))):
                weight = 1.0
                for i in ti.static(range(D)):
                    weight *= w[offset[i], i]
                node_v[base + offset] += weight * (mass * v[p] + a @ ((offset - f) * dx))
                node_m[base + offset] += weight * mass
        for I in ti.grouped(node_m):
            if node_m[I] > 0:
                u = node_v[I] / node_m[I]
                u[1] -= dt * gravity
                node_v[I] = stopped(I, u)
        for p in x:
            base, f, w = stencil(p)
            new_v, new_B = ti.zero(v[p]), ti.zero(C[p])
            for offset in ti.static(ti.grouped(ti.ndrange(*((3,) * D)))):
                weight = 1.0
                for i in ti.static(range(D)):
                    weight *= w[offset[i], i]
                u = node_v[base + offset]
                new_v += weight * u
                new_B += weight * u.outer_product(offset - f)
            move(p, new_v, 4.0 * inv_dx * new_B)

    if not tuned:

        def substeps(count):
            for _ in range(count):
                step_as_written()

        return substeps, ti.sync, lambda: (x.to_numpy(), v.to_numpy(), J.to_numpy())

    cells = 1
    for side in size:
        cells *= side
    a_block = BLOCK**D
    x2, v2 = ti.Vector.field(D, ti.f32, n), ti.Vector.field(D, ti.f32, n)
    C2, J2 = ti.Matrix.field(D, D, ti.f32, n), ti.field(ti.f32, n)
    cell_of, first, next_free = ti.field(ti.i32, n), ti.field(ti.i32, cells + 1), ti.field(ti.i32, cells + 1)
    of_color, in_color = ti.field(ti.i32, (2**D, cells // a_block)), ti.field(ti.i32, 2**D)

    @ti.func
    def cell_number(p):
        c = ti.cast(x[p] * inv_dx, ti.i32)
        block, inside = 0, 0
        for i in ti.static(range(D)):
            block = block * blocks[i] + c[i] // BLOCK
            inside = inside * BLOCK + c[i] % BLOCK
        return block * a_block + inside

    @ti.kernel
    def count_cells():
        for c in next_free:
            next_free[c] = 0
        for p in x:
            cell_of[p] = cell_number(p)
            next_free[cell_of[p]] += 1

    @ti.kernel
    def find_places():
        for c in in_color:
            in_color[c] = 0
        ti.loop_config(serialize=True)
        for once in range(1):
            total = 0
            for b in range(cells // a_block):
                before = total
                for c in range(b * a_block, (b + 1) * a_block):
                    first[c] = total
                    total += next_free[c]
                    next_free[c] = first[c]
                if total > before:
                    color, rest = 0, b
                    for i in ti.static(range(D)):
                        side = ti.static(blocks[D - 1 - i])
                        color = 2 * color + rest % side % 2
                        rest //= side
                    of_color[color, in_color[color]] = b
                    in_color[color] += 1
            first[cells] = total + 0 * once

    @ti.kernel
    def put_in_place():
        for p in x:
            q = ti.atomic_add(next_free[cell_of[p]], 1)
            x2[q], v2[q], C2[q], J2[q] = x[p], v[p], C[p], J[p]
        for p in x:
            x[p], v[p], C[p], J[p] = x2[p], v2[p], C2[p], J2[p]

    @ti.func
    def spread(p):
        base, f, w = stencil(p)
        a = affine(p) * dx
        at_base = mass * v[p] - a @ f
        for offset in ti.static(ti.grouped(ti.ndrange(*((3,) * D)))):
            weight = 1.0
            for i in ti.static(range(D)):
                weight *= w[offset[i], i]
            momentum = weight * (at_base + a @ ti.cast(offset, ti.f32))
            for i in ti.static(range(D)):
                node[base + offset][i] = node[base + offset][i] + momentum[i]
            node[base + offset][D] = node[base + offset][D] + weight * mass

    @ti.kernel
    def clear():
        for I in ti.grouped(node):
            node[I] = ti.zero(node[I])

    @ti.kernel
    def scatter_serial():
        ti.loop_config(serialize=True)
        for p in range(n):
            spread(p)

    @ti.kernel
    def scatter_color(color: ti.i32):
        ti.loop_config(block_dim=1)
        for k in range(in_color[color]):
            b = of_color[color, k]
            for p in range(first[b * a_block], first[(b + 1) * a_block]):
                spread(p)

    @ti.kernel
    def update():
        for I in ti.grouped(node):
            m = node[I][D]
            if m > 0:
                u = ti.Vector([node[I][i] / m for i in range(D)])
                u[1] -= dt * gravity
                u = stopped(I, u)
                for i in ti.static(range(D)):
                    node[I][i] = u[i]

    @ti.kernel
    def gather():
        for p in x:
            base, f, w = stencil(p)
            new_v, new_B = ti.zero(v[p]), ti.zero(C[p])
            for offset in ti.static(ti.grouped(ti.ndrange(*((3,) * D)))):
                weight = 1.0
                for i in ti.static(range(D)):
                    weight *= w[offset[i], i]
                u = weight * ti.Vector([node[base + offset][i] for i in range(D)])
                new_v += u
                new_B += u.outer_product(offset - f)
            move(p, new_v, 4.0 * inv_dx * new_B)

    substeps_done = [0]

    def substeps(count):
        for _ in range(count):
            if substeps_done[0] % SORT_EVERY == 0:
                count_cells()
                find_places()
                put_in_place()
            substeps_done[0] += 1
            clear()
            if threads == 1:
                scatter_serial()
            else:
                for color in range(2**D):
                    scatter_color(color)
            update()
            gather()

    return substeps, ti.sync, lambda: (x.to_numpy(), v.to_numpy(), J.to_numpy())
