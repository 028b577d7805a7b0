//! What a collider does to the nodes around its surface, wherever that runs between them.
//!
//! ```text
//!      ○     ○     ○     free: at least half a cell outside; they move by themselves
//!   ───●─────●─────●──── surface
//!      ●     ●     ●     held: their motion along the normal is that of the free ones, continued
//!      ●     ●     ●       linearly through zero on the surface
//! ```
//!
//! Lengths in cells. Velocities here are relative to the collider. φ is the distance from it, n the
//! unit vector out of it. A held node g follows the free nodes i around a point on its normal:
//!
//!   n·u_g = Σ_i b_gi n·u_i,  b_gi = φ_g a_gi / Σ_j a_gj φ_j                                (14)
//!
//! with a_gi the linear weights of that point. Momenta go the other way, so that nothing is made:
//! the free nodes carry what the held ones bring, and its mass,
//!
//!   (m_i + Σ_g m_g |b_gi| B_g n nᵀ) u_i' = m_i u_i + Σ_g b_gi m_g n (n·u_g),  B_g = Σ_i |b_gi|   (15)

use super::Contact;
use super::collider::Moving;
use super::impulse::Taken;
use super::walls::Walls;
use crate::math::{Matrix, Vector};

/// Nodes nearer than this, and all inside, are held.
const HELD: f64 = 0.5;

/// How far outside the point may be that a held node follows: it need not be further, since no
/// smooth kernel reaches further than this beyond a plane.
const FARTHEST: f64 = 1.5;

/// A free node with less of a held one's mass than this does not lead it: at the edge of the material
/// it would carry nothing.
const LIGHTEST: f64 = 1e-9;

/// Particles are let be that are less than this inside: rounding puts them there.
const SKIN: f64 = 1e-6;

/// Nodes farther than this have no part in it.
pub(crate) const BAND: f64 = FARTHEST + 2.0;

/// A node near a collider.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NearNode<const D: usize> {
    pub(crate) node: [i64; D],
    /// φ.
    pub(crate) distance: f64,
    /// n, as the node sees it.
    pub(crate) normal: Vector<f64, D>,
    /// The collider's velocity there \[m/s\].
    pub(crate) moving: Vector<f64, D>,
    /// The mass that particles brought \[kg\].
    pub(crate) brought: f64,
    /// The mass that it has, walls' images included \[kg\].
    pub(crate) mass: f64,
    /// After forces and walls \[m/s\].
    pub(crate) velocity: Vector<f64, D>,
    /// What FLIP takes the change from \[m/s\].
    pub(crate) before: Vector<f64, D>,
}

/// The node `node` of a grid with `walls`, as `collider` sees it; lengths in cells, its velocity in
/// cells a second. `None` if it has no part in what happens. Masses and velocities are for the caller
/// to fill in.
pub(crate) fn near<const D: usize>(
    collider: &Moving<D>,
    node: [i64; D],
    walls: &Walls<D>,
) -> Option<NearNode<D>> {
    // What is beyond a wall on its plane is an image, and sees the collider's image.
    let mut at = node.map(|n| n as f64);
    let mut mirrored = [false; D];
    for plane in &walls.planes {
        if (node[plane.axis] - plane.node) * i64::from(plane.inward) < 0 {
            at[plane.axis] = (2 * plane.node - node[plane.axis]) as f64;
            mirrored[plane.axis] = true;
        }
    }
    let zero = Vector([0.0; D]);
    let (distance, normal) = collider.start.distance_from(at, zero);
    if distance > BAND {
        return None;
    }
    let image =
        |v: Vector<f64, D>| Vector::from_fn(|axis| if mirrored[axis] { -v[axis] } else { v[axis] });
    Some(NearNode {
        node,
        distance,
        normal: image(normal),
        moving: image(collider.velocity(at, zero)),
        brought: 0.0,
        mass: 0.0,
        velocity: zero,
        before: zero,
    })
}

/// Room for what [`hold`] works out, kept from substep to substep.
#[derive(Clone, Debug, Default)]
pub(crate) struct Room<const D: usize> {
    /// The nodes as they were.
    free: Vec<NearNode<D>>,
    changed: Vec<bool>,
    leaders: Vec<(usize, f64)>,
    held: Vec<Held<D>>,
    /// Of each node: the mass carried, the momentum brought, and the same before forces.
    brought: Vec<Brought<D>>,
}

/// What held nodes bring to a free one, (15): mass, momentum, momentum before forces.
type Brought<const D: usize> = (Matrix<f64, D>, Vector<f64, D>, Vector<f64, D>);

/// A held node and whom it follows.
#[derive(Clone, Debug)]
struct Held<const D: usize> {
    index: usize,
    /// Which of the list of leaders are its own.
    leaders: core::ops::Range<usize>,
    /// Σ b, Σ |b|.
    sum: f64,
    size: f64,
}

/// Lets a collider with `contact` act on `nodes`, all there are within [`BAND`]; `find` says which of
/// them is at a node, if one is. `blend` is FLIP's. What it takes is added to `taken`.
pub(crate) fn hold<const D: usize>(
    nodes: &mut [NearNode<D>],
    find: impl Fn([i64; D]) -> Option<usize>,
    contact: Contact,
    blend: f64,
    taken: &mut Taken<D>,
    room: &mut Room<D>,
) {
    let friction = match contact {
        Contact::Open => return,
        Contact::Sticky => 0.0,
        Contact::Slip { friction } | Contact::Separate { friction } => friction,
    };
    let sticky = contact == Contact::Sticky;
    let Room {
        free,
        changed,
        leaders,
        held: all_held,
        brought: sums,
    } = room;
    free.clear();
    free.extend_from_slice(nodes);
    for node in nodes.iter_mut() {
        node.velocity -= node.moving;
        node.before -= node.moving;
    }
    changed.clear();
    changed.resize(nodes.len(), false);

    // Who follows whom.
    leaders.clear();
    all_held.clear();
    for (index, held) in nodes.iter().enumerate() {
        if held.distance >= HELD {
            continue;
        }
        let first = leaders.len();
        follow(held, nodes, &find, leaders);
        let own = &leaders[first..];
        let pulled: f64 = own
            .iter()
            .map(|&(i, b)| b * nodes[i].velocity.dot(held.normal))
            .sum();
        let leaves = held.velocity.dot(held.normal) - pulled >= 0.0;
        if leaves && matches!(contact, Contact::Separate { .. }) {
            leaders.truncate(first);
            continue;
        }
        all_held.push(Held {
            index,
            sum: own.iter().map(|&(_, b)| b).sum(),
            size: own.iter().map(|&(_, b)| b.abs()).sum(),
            leaders: first..leaders.len(),
        });
    }

    // (15), solved for the change.
    let zero = Vector([0.0; D]);
    sums.clear();
    sums.resize(nodes.len(), (Matrix([zero; D]), zero, zero));
    for held in &*all_held {
        let g = nodes[held.index];
        let onto = |v: Vector<f64, D>| {
            if sticky {
                v
            } else {
                g.normal * v.dot(g.normal)
            }
        };
        for &(i, b) in &leaders[held.leaders.clone()] {
            let carried = g.mass * b.abs() * held.size;
            let (mass, momentum, before) = &mut sums[i];
            *mass += projector(g.normal, sticky) * carried;
            *momentum += onto(g.velocity) * (b * g.mass) - onto(nodes[i].velocity) * carried;
            *before += onto(g.before) * (b * g.mass) - onto(nodes[i].before) * carried;
            changed[i] = true;
        }
    }
    for (i, node) in nodes.iter_mut().enumerate() {
        if changed[i] {
            let (carried, momentum, before) = sums[i];
            let mass = carried + Matrix::scaled_identity(node.mass);
            node.velocity += solved(mass, momentum);
            node.before += solved(mass, before);
        }
    }

    // (14), and friction.
    for held in &*all_held {
        let g = nodes[held.index];
        let along = |of: fn(&NearNode<D>) -> Vector<f64, D>| {
            let mut followed = zero;
            for &(i, b) in &leaders[held.leaders.clone()] {
                followed += of(&nodes[i]) * b;
            }
            if sticky {
                followed
            } else {
                let own = of(&g);
                own + g.normal * (followed - own).dot(g.normal)
            }
        };
        let mut velocity = along(|node| node.velocity);
        let before = along(|node| node.before);
        if friction > 0.0 {
            let impulse = (velocity - g.velocity).dot(g.normal) * (1.0 - held.sum); // of the mass g.mass
            let normal = g.normal * velocity.dot(g.normal);
            velocity =
                normal + super::contact::slowed(velocity - normal, friction * impulse.max(0.0));
        }
        nodes[held.index].velocity = velocity;
        nodes[held.index].before = before;
        changed[held.index] = true;
    }

    for ((node, free), changed) in nodes.iter_mut().zip(&*free).zip(&*changed) {
        if !*changed {
            *node = *free;
            continue;
        }
        node.velocity += node.moving;
        node.before += node.moving;
        let change = (node.velocity - free.velocity) - (node.before - free.before) * blend;
        let at = node.node.map(|n| n as f64);
        taken.add(at, change * -node.brought); // (13)
    }
}

/// Adds whom `held` follows, with their b of (14). Alone, it follows nobody: then it is held fast.
fn follow<const D: usize>(
    held: &NearNode<D>,
    nodes: &[NearNode<D>],
    find: impl Fn([i64; D]) -> Option<usize>,
    leaders: &mut Vec<(usize, f64)>,
) {
    let phi = held.distance;
    let height = (1.0 + phi).max(-phi).min(FARTHEST);
    let offset = held.normal * (height - phi);
    let first = leaders.len();
    let (mut weights, mut heights) = (0.0, 0.0);
    for corner in 0..1_usize << D {
        let mut weight = 1.0;
        let node: [i64; D] = core::array::from_fn(|axis| {
            let low = offset[axis].floor();
            let part = offset[axis] - low;
            let high = corner >> axis & 1 == 1;
            weight *= if high { part } else { 1.0 - part };
            held.node[axis] + low as i64 + i64::from(high)
        });
        if weight <= 0.0 {
            continue;
        }
        let Some(index) = find(node) else { continue };
        let leader = &nodes[index];
        if leader.distance >= HELD && leader.mass > LIGHTEST * held.mass {
            leaders.push((index, weight));
            weights += weight;
            heights += weight * leader.distance;
        }
    }
    // Never more than mirrored.
    let scale = phi / heights.max(phi.abs() * weights);
    for (_, weight) in &mut leaders[first..] {
        *weight *= scale;
    }
}

/// n nᵀ, or I.
fn projector<const D: usize>(n: Vector<f64, D>, all: bool) -> Matrix<f64, D> {
    if all {
        Matrix::identity(1.0)
    } else {
        Matrix::from_fn(|i, j| n[i] * n[j])
    }
}

/// x of A x = b, with A symmetric and positive definite: elimination needs no pivots.
fn solved<const D: usize>(mut a: Matrix<f64, D>, mut b: Vector<f64, D>) -> Vector<f64, D> {
    for k in 0..D {
        for i in k + 1..D {
            let factor = a[(i, k)] / a[(k, k)];
            for j in k..D {
                a[(i, j)] -= factor * a[(k, j)];
            }
            b[i] -= factor * b[k];
        }
    }
    for k in (0..D).rev() {
        for j in k + 1..D {
            b[k] -= a[(k, j)] * b[j];
        }
        b[k] /= a[(k, k)];
    }
    b
}

/// Times that a particle between several colliders and walls is put out of each of them, one after the
/// other.
const ROUNDS: usize = 8;

/// Puts a particle at `x` from `base` (in cells, at the end of the substep) with velocity `v` \[m/s\]
/// that is inside of any of `colliders` on their surface, without what of `v` goes into them; `hold` is
/// `Walls::hold`, `dx` \[m\]. Calls `pushed(number of the collider, where, change of v)`. Whether it
/// was inside of any.
pub(crate) fn put_out<const D: usize>(
    colliders: &[Moving<D>],
    hold: &[(Option<f64>, Option<f64>); D],
    base: [f64; D],
    (x, v): (&mut Vector<f64, D>, &mut Vector<f64, D>),
    dx: f64,
    mut pushed: impl FnMut(usize, Vector<f64, D>, Vector<f64, D>),
) -> bool {
    let mut was_inside = false;
    for _ in 0..ROUNDS {
        let mut is_inside = false;
        for (number, collider) in colliders.iter().enumerate() {
            let (distance, n) = collider.end.distance_from(base, *x);
            if !(distance < -SKIN) {
                continue;
            }
            is_inside = true;
            *x -= n * distance;
            let into = (*v - collider.velocity(base, *x) * dx).dot(n).min(0.0);
            *v -= n * into;
            pushed(number, Vector(base) + *x, n * -into);
        }
        if !is_inside {
            break;
        }
        was_inside = true;
        for axis in 0..D {
            let (low, high) = hold[axis];
            x[axis] = x[axis]
                .max(low.map_or(f64::NEG_INFINITY, |low| low - base[axis]))
                .min(high.map_or(f64::INFINITY, |high| high - base[axis]));
        }
    }
    was_inside
}
