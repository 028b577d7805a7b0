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

impl<T: Scalar, const D: usize> Column<T, D> {
    /// The mean of the node inside and the image of the one beyond, weighted by mass.
    #[inline(always)]
    fn folded(
        &self,
        of: impl Fn(&ColumnNode<T, D>) -> Vector<T, D>,
        image: impl Fn(Vector<T, D>) -> Vector<T, D>,
    ) -> Vector<T, D> {
        let (near, far) = (&self.inside, &self.beyond);
        let share = far.mass / (near.mass + far.mass);
        let own = of(near);
        own + (image(of(far)) - own) * share
    }
}

/// `v` with the sign of its component along `axis` changed: its image in a mirror across that axis.
#[inline(always)]
fn mirrored<T: Scalar, const D: usize>(mut v: Vector<T, D>, axis: usize) -> Vector<T, D> {
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
    /// Whether it has changed anything.
    #[inline(always)]
    pub(crate) fn fold<T: Scalar, const D: usize>(
        self,
        column: &mut Column<T, D>,
        axis: usize,
        inward: f64,
    ) -> bool {
        let zero = T::default();
        let (far, middle, near) = (&column.beyond, &column.plane, &column.inside);
        let together = near.mass + far.mass;
        if middle.mass <= zero || together <= zero {
            return false;
        }
        let reduced = near.mass * (far.mass / together);
        let impulse = (middle.mass * middle.velocity[axis]
            + (reduced + reduced) * (near.velocity[axis] + far.velocity[axis]))
            * T::from_f64(-inward);
        let friction = match self {
            Self::Open => return false,
            Self::Separate { .. } if impulse <= zero => return false,
            Self::Sticky => 0.0,
            Self::Slip { friction } | Self::Separate { friction } => friction,
        };

        let sticky = self == Self::Sticky;
        let image = |v: Vector<T, D>| if sticky { -v } else { mirrored(v, axis) };
        let velocity = column.folded(|node| node.velocity, image);
        let before = column.folded(|node| node.before, image);
        let plane = &mut column.plane;
        if sticky {
            plane.velocity = Vector([zero; D]);
        } else {
            plane.velocity[axis] = zero;
            if friction > 0.0 {
                let taken = T::from_f64(friction) * impulse.max(zero) / plane.mass;
                plane.velocity = slowed(plane.velocity, taken);
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
            velocity: image(velocity),
            before: image(before),
        };
        true
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
pub(crate) fn slowed<T: Scalar, const D: usize>(velocity: Vector<T, D>, taken: T) -> Vector<T, D> {
    let speed = velocity.norm();
    let kept = if speed > taken {
        (speed - taken) / speed
    } else {
        T::default()
    };
    velocity * kept
}
