//! Contact laws: what a boundary does to nodes' velocities.

use super::Contact;
use crate::math::{Real, Scalar, Vector};

/// A node on the plane of a wall and its two neighbours across it.
///
/// ```text
///    beyond    plane    inside
///  ────●─────────●─────────●────▶ inward
///              wall
/// ```
#[derive(Clone, Copy, Debug)]
pub(crate) struct Column<T, const D: usize> {
    pub(crate) beyond: ColumnNode<T, D>,
    pub(crate) plane: ColumnNode<T, D>,
    pub(crate) inside: ColumnNode<T, D>,
}

/// A node as a wall sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ColumnNode<T, const D: usize> {
    /// \[kg\]
    pub(crate) mass: T,
    /// After forces \[m/s\].
    pub(crate) velocity: Vector<T, D>,
    /// Before forces \[m/s\]; what FLIP takes the change from.
    pub(crate) before: Vector<T, D>,
}

/// The mean of `own` at a node of mass `near` and of `image`, the mirror image of what a node of mass `far`
/// has, weighted by mass.
#[inline(always)]
fn folded<R: Real, const D: usize>(
    near: R,
    own: Vector<R, D>,
    far: R,
    image: Vector<R, D>,
) -> Vector<R, D> {
    let share = far / (near + far);
    own + (image - own) * share
}

/// `v` in a mirror across `axis`: the sign of that component changed, or of all if the wall is `sticky`.
#[inline(always)]
fn mirrored<R: Real, const D: usize>(
    mut v: Vector<R, D>,
    axis: usize,
    sticky: bool,
) -> Vector<R, D> {
    if sticky {
        return -v;
    }
    v[axis] = -v[axis];
    v
}

impl Contact {
    /// What a wall on its plane does to the column of nodes across it: the material beyond meets
    /// its mirror image. Both are one body then, whose velocity across the plane is zero there, and
    /// which is as smooth at the wall as anywhere. `inward` as in [`Self::constrain`].
    ///
    /// The image pulls as well as it pushes. So `Separate` lets go of a column, and leaves it as it
    /// is to the bit, unless the impulse that the wall would give to it points inward. With P2G and G2P
    /// as they are that impulse is −m₀ v₀ − 2 m₁m₋/(m₁+m₋) (v₁ + v₋), v along the inward normal and
    /// −, 0, 1 for beyond, plane, inside.
    ///
    /// Along the wall, `Sticky` mirrors velocities with the other sign, so that they are zero on the
    /// plane; friction takes at most μ times the wall's impulse from the node on the plane.
    ///
    /// Where the wall acts; elsewhere (lanes are columns of their own) what `column` holds then means nothing.
    #[inline(always)]
    pub(crate) fn fold<R: Real, const D: usize>(
        self,
        column: &mut Column<R, D>,
        axis: usize,
        inward: f64,
    ) -> R::Mask {
        let (far, middle, near) = (column.beyond, column.plane, column.inside);
        let zero = near.mass.zero();
        let together = near.mass + far.mass;
        let there = !(middle.mass.le(zero) | together.le(zero));
        let reduced = near.mass * (far.mass / together);
        let impulse = (middle.mass * middle.velocity[axis]
            + (reduced + reduced) * (near.velocity[axis] + far.velocity[axis]))
            * zero.lit(-inward);
        let acts = match self {
            Self::Open => there & !there,
            Self::Separate { .. } => there & !impulse.le(zero),
            Self::Sticky | Self::Slip { .. } => there,
        };

        let sticky = self == Self::Sticky;
        let image = mirrored(far.velocity, axis, sticky);
        let velocity = folded(near.mass, near.velocity, far.mass, image);
        let image = mirrored(far.before, axis, sticky);
        let before = folded(near.mass, near.before, far.mass, image);
        let plane = &mut column.plane;
        match self {
            Self::Sticky => plane.velocity = Vector([zero; D]),
            Self::Open => {}
            Self::Slip { friction } | Self::Separate { friction } => {
                plane.velocity[axis] = zero;
                if friction > 0.0 {
                    let taken = zero.lit(friction) * impulse.max(zero) / plane.mass;
                    plane.velocity = slowed(plane.velocity, taken);
                }
            }
        }
        plane.before[axis] = zero;
        column.inside = ColumnNode {
            mass: together,
            velocity,
            before,
        };
        column.beyond = ColumnNode {
            mass: together,
            velocity: mirrored(velocity, axis, sticky),
            before: mirrored(before, axis, sticky),
        };
        acts
    }

    /// The velocity of a node inside a wall across `axis`, whose material side is towards
    /// `inward` (+1: the wall is at the low end, −1: at the high end). `velocity` is relative to
    /// the wall \[m/s\].
    ///
    /// With v_n the velocity into the wall and v_t the rest: sticky v = 0; slip v_n = 0;
    /// separate v_n = 0 only where it points into the wall. What the wall took, Δv_n, lets Coulomb
    /// friction take at most μ Δv_n of v_t.
    #[inline(always)]
    pub(crate) fn constrain<T: Scalar, const D: usize>(
        self,
        mut velocity: Vector<T, D>,
        axis: usize,
        inward: f64,
    ) -> Vector<T, D> {
        let zero = T::default();
        let normal = velocity[axis] * T::from_f64(inward);
        let friction = match self {
            Self::Open => return velocity,
            Self::Sticky => return Vector([zero; D]),
            Self::Separate { .. } if normal > zero => return velocity,
            Self::Slip { friction } | Self::Separate { friction } => friction,
        };
        velocity[axis] = zero;
        if friction > 0.0 {
            velocity = slowed(velocity, T::from_f64(friction) * Real::abs(normal));
        }
        velocity
    }
}

/// `velocity` made shorter by `taken` \[m/s\], or zero if it is not that long.
#[inline(always)]
pub(crate) fn slowed<R: Real, const D: usize>(velocity: Vector<R, D>, taken: R) -> Vector<R, D> {
    let speed = velocity.norm();
    velocity * R::select(speed.gt(taken), (speed - taken) / speed, taken.zero())
}
