//! The contact law of a collider on the nodes around its surface, which runs between them.
//!
//! ```text
//!      ○     ○     ○     free nodes: at least half a cell outside
//!   ───●─────●─────●──── surface
//!      ●     ●     ●     followers: their motion along the normal is that of the free nodes, continued
//!      ●     ●     ●       linearly through zero on the surface
//! ```
//!
//! Lengths are in cells, and velocities relative to the collider. φ is the distance from it, n the unit vector out of it.
//! A follower g is led by the free nodes i around a point on its normal:
//!
//!   n·u_g = Σ_i b_gi n·u_i,  b_gi = φ_g a_gi / Σ_j a_gj φ_j                                (14)
//!
//! with a_gi the linear weights of that point. So that momentum is conserved, the leaders carry the mass and the momentum
//! of their followers:
//!
//!   (m_i + Σ_g m_g |b_gi| B_g n nᵀ) u_i' = m_i u_i + Σ_g b_gi m_g n (n·u_g),  B_g = Σ_i |b_gi|   (15)

use super::placed::Moving;
use crate::boundary::contact::shortened;
use crate::boundary::impulse::Impulse;
use crate::boundary::walls::Walls;
use crate::math::{Matrix, Vector};
use crate::setup::Contact;

/// Nodes nearer to the surface than this \[cells\], and all nodes inside, are followers.
const FREE_FROM: f64 = 0.5;

/// The largest distance from the surface of the point that leads a follower \[cells\]. No smooth kernel reaches further
/// than this beyond a plane.
const FARTHEST: f64 = 1.5;

/// The smallest mass of a leader, as a share of its follower's. At the edge of the material a lighter one would carry
/// nothing.
const LIGHTEST: f64 = 1e-9;

/// Nodes farther from the surface than this \[cells\] neither follow nor lead.
pub(crate) const BAND: f64 = FARTHEST + 2.0;

/// A node near a collider.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NearNode<const D: usize> {
    pub(crate) node: [i64; D],
    /// φ, the distance from the collider \[cells\].
    pub(crate) distance: f64,
    /// n, the unit vector out of the collider.
    pub(crate) normal: Vector<f64, D>,
    /// The collider's velocity there \[m/s\].
    pub(crate) moving: Vector<f64, D>,
    /// The mass that particles have brought \[kg\].
    pub(crate) brought: f64,
    /// The mass that it has, including that of images behind walls \[kg\].
    pub(crate) mass: f64,
    /// The velocity after forces and walls \[m/s\].
    pub(crate) velocity: Vector<f64, D>,
    /// The velocity before forces \[m/s\].
    pub(crate) before: Vector<f64, D>,
}

/// Returns node `node` of a grid with `walls`, as seen by `collider`: with the velocity of the collider there in cells
/// per second, and without masses and velocities of its own. Returns `None` if it is outside of the [`BAND`].
pub(crate) fn near<const D: usize>(
    collider: &Moving<D>,
    node: [i64; D],
    walls: &Walls<D>,
) -> Option<NearNode<D>> {
    // A node beyond a wall on its plane is a mirror image, and sees the image of the collider.
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

/// Buffers of [`constrain`], which live from substep to substep.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scratch<const D: usize> {
    /// The nodes as they were before.
    before: Vec<NearNode<D>>,
    changed: Vec<bool>,
    /// Leaders and their b of (14), follower after follower.
    leaders: Vec<(usize, f64)>,
    followers: Vec<Follower>,
    /// The load of each node.
    loads: Vec<Load<D>>,
}

/// The sums of (15) over the followers of one leader.
#[derive(Clone, Copy, Debug)]
struct Load<const D: usize> {
    mass: Matrix<f64, D>,
    momentum: Vector<f64, D>,
    /// The momentum before forces.
    before: Vector<f64, D>,
}

/// A node that is led by others.
#[derive(Clone, Debug)]
struct Follower {
    index: usize,
    /// Its part of the list of leaders.
    leaders: core::ops::Range<usize>,
    /// The sum Σ b over its leaders.
    sum: f64,
    /// The sum Σ |b| over its leaders.
    size: f64,
}

/// Lets a collider with `contact` act on `nodes`, which are all nodes within the [`BAND`]. `find` finds the place of a
/// node among them; `blend` is FLIP's. Adds the impulse on the collider to `total`.
pub(crate) fn constrain<const D: usize>(
    nodes: &mut [NearNode<D>],
    find: impl Fn([i64; D]) -> Option<usize>,
    contact: Contact,
    blend: f64,
    total: &mut Impulse<D>,
    scratch: &mut Scratch<D>,
) {
    if contact == Contact::Open {
        return;
    }
    scratch.before.clear();
    scratch.before.extend_from_slice(nodes);
    for node in nodes.iter_mut() {
        node.velocity -= node.moving;
        node.before -= node.moving;
    }
    scratch.changed.clear();
    scratch.changed.resize(nodes.len(), false);
    scratch.find_followers(nodes, find, contact);
    scratch.load_leaders(nodes, contact);
    scratch.lead_followers(nodes, contact);

    let before = scratch.before.iter();
    for ((node, before), changed) in nodes.iter_mut().zip(before).zip(&scratch.changed) {
        if !*changed {
            *node = *before;
            continue;
        }
        node.velocity += node.moving;
        node.before += node.moving;
        let change = (node.velocity - before.velocity) - (node.before - before.before) * blend;
        let at = node.node.map(|n| n as f64);
        total.add(at, change * -node.brought); // (13)
    }
}

impl<const D: usize> Scratch<D> {
    /// Finds the followers among `nodes`, and their leaders. A follower that leaves a collider with `Separate` contact is
    /// let go.
    fn find_followers(
        &mut self,
        nodes: &[NearNode<D>],
        find: impl Fn([i64; D]) -> Option<usize>,
        contact: Contact,
    ) {
        let Self {
            leaders, followers, ..
        } = self;
        leaders.clear();
        followers.clear();
        for (index, follower) in nodes.iter().enumerate() {
            if follower.distance >= FREE_FROM {
                continue;
            }
            let first = leaders.len();
            find_leaders(follower, nodes, &find, leaders);
            let own = &leaders[first..];
            let pulled: f64 = own
                .iter()
                .map(|&(i, b)| b * nodes[i].velocity.dot(follower.normal))
                .sum();
            let leaves = follower.velocity.dot(follower.normal) - pulled >= 0.0;
            if leaves && matches!(contact, Contact::Separate { .. }) {
                leaders.truncate(first);
                continue;
            }
            followers.push(Follower {
                index,
                sum: own.iter().map(|&(_, b)| b).sum(),
                size: own.iter().map(|&(_, b)| b.abs()).sum(),
                leaders: first..leaders.len(),
            });
        }
    }

    /// Changes the velocities of leaders by the mass and momentum of their followers: (15), solved for the change.
    fn load_leaders(&mut self, nodes: &mut [NearNode<D>], contact: Contact) {
        let sticky = contact == Contact::Sticky;
        let zero = Vector([0.0; D]);
        let no_load = Load {
            mass: Matrix([zero; D]),
            momentum: zero,
            before: zero,
        };
        self.loads.clear();
        self.loads.resize(nodes.len(), no_load);
        for follower in &self.followers {
            let g = nodes[follower.index];
            let onto = |v: Vector<f64, D>| {
                if sticky {
                    v
                } else {
                    g.normal * v.dot(g.normal)
                }
            };
            for &(i, b) in &self.leaders[follower.leaders.clone()] {
                let carried = g.mass * b.abs() * follower.size;
                let load = &mut self.loads[i];
                load.mass += projector(g.normal, sticky) * carried;
                load.momentum +=
                    onto(g.velocity) * (b * g.mass) - onto(nodes[i].velocity) * carried;
                load.before += onto(g.before) * (b * g.mass) - onto(nodes[i].before) * carried;
                self.changed[i] = true;
            }
        }
        let loads = self.loads.iter().zip(&self.changed);
        for (node, (load, _)) in nodes
            .iter_mut()
            .zip(loads)
            .filter(|(_, (_, changed))| **changed)
        {
            let mass = load.mass + Matrix::scaled_identity(node.mass);
            node.velocity += solved(mass, load.momentum);
            node.before += solved(mass, load.before);
        }
    }

    /// Sets the velocities of followers to those that their leaders give them, (14), with friction.
    fn lead_followers(&mut self, nodes: &mut [NearNode<D>], contact: Contact) {
        let sticky = contact == Contact::Sticky;
        let friction = match contact {
            Contact::Open | Contact::Sticky => 0.0,
            Contact::Slip { friction } | Contact::Separate { friction } => friction,
        };
        for follower in &self.followers {
            let g = nodes[follower.index];
            let led = |of: fn(&NearNode<D>) -> Vector<f64, D>| {
                let mut followed = Vector([0.0; D]);
                for &(i, b) in &self.leaders[follower.leaders.clone()] {
                    followed += of(&nodes[i]) * b;
                }
                if sticky {
                    followed
                } else {
                    let own = of(&g);
                    own + g.normal * (followed - own).dot(g.normal)
                }
            };
            let mut velocity = led(|node| node.velocity);
            let velocity_before = led(|node| node.before);
            if friction > 0.0 {
                let impulse = (velocity - g.velocity).dot(g.normal) * (1.0 - follower.sum); // per mass g.mass
                let normal = g.normal * velocity.dot(g.normal);
                velocity = normal + shortened(velocity - normal, friction * impulse.max(0.0));
            }
            nodes[follower.index].velocity = velocity;
            nodes[follower.index].before = velocity_before;
            self.changed[follower.index] = true;
        }
    }
}

/// Adds the leaders of `follower` to `leaders`, with their b of (14). A follower without leaders does not move.
fn find_leaders<const D: usize>(
    follower: &NearNode<D>,
    nodes: &[NearNode<D>],
    find: impl Fn([i64; D]) -> Option<usize>,
    leaders: &mut Vec<(usize, f64)>,
) {
    let phi = follower.distance;
    let height = (1.0 + phi).max(-phi).min(FARTHEST);
    let offset = follower.normal * (height - phi);
    let first = leaders.len();
    let (mut weights, mut heights) = (0.0, 0.0);
    for corner in 0..1_usize << D {
        let mut weight = 1.0;
        let node: [i64; D] = core::array::from_fn(|axis| {
            let low = offset[axis].floor();
            let part = offset[axis] - low;
            let high = corner >> axis & 1 == 1;
            weight *= if high { part } else { 1.0 - part };
            follower.node[axis] + low as i64 + i64::from(high)
        });
        if weight <= 0.0 {
            continue;
        }
        let Some(index) = find(node) else { continue };
        let leader = &nodes[index];
        if leader.distance >= FREE_FROM && leader.mass > LIGHTEST * follower.mass {
            leaders.push((index, weight));
            weights += weight;
            heights += weight * leader.distance;
        }
    }
    // A follower is never faster than a mirror image.
    let scale = phi / heights.max(phi.abs() * weights);
    for (_, weight) in &mut leaders[first..] {
        *weight *= scale;
    }
}

/// Returns n nᵀ, or I if `all`.
fn projector<const D: usize>(n: Vector<f64, D>, all: bool) -> Matrix<f64, D> {
    if all {
        Matrix::identity(1.0)
    } else {
        Matrix::from_fn(|i, j| n[i] * n[j])
    }
}

/// Solves A x = b for x, with A symmetric and positive definite: elimination needs no pivots.
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
