//! The contact law of a wall on its plane: it folds the material beyond the plane over, onto its mirror image inside.

use crate::boundary::contact::shortened;
use crate::math::{Real, Vector};
use crate::setup::Contact;

/// A node on the plane of a wall and its two neighbors across the wall.
///
/// ```text
///    beyond  on_plane  inside
///  ────●─────────●─────────●────▶ inward
///              wall
/// ```
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triple<T, const D: usize> {
    pub(crate) beyond: TripleNode<T, D>,
    pub(crate) on_plane: TripleNode<T, D>,
    pub(crate) inside: TripleNode<T, D>,
}

/// One node of a triple.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TripleNode<T, const D: usize> {
    /// Mass of the node \[kg\].
    pub(crate) mass: T,
    /// Velocity after forces \[m/s\].
    pub(crate) velocity: Vector<T, D>,
    /// Velocity before forces \[m/s\]; FLIP adds the change since then to particles.
    pub(crate) before: Vector<T, D>,
}

/// Returns the mean of `own`, at a node of mass `near`, and of `image`, the mirror image of the velocity at a node of mass
/// `far`, weighted by mass.
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

/// Returns `v` in a mirror across `axis`: the sign of that component changed, or of all if the wall is `sticky`.
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
    /// Lets a wall on its plane act on a triple of nodes across it: the material beyond meets its mirror image. Both are
    /// one body then, whose velocity across the plane is zero there, and which is as smooth at the wall as anywhere.
    /// `inward` is +1 for the low end of `axis`, −1 for the high end.
    ///
    /// The image pulls as well as it pushes. So `Separate` lets go of a triple, and leaves it as it is to the bit,
    /// unless the impulse of the wall on it points inward. With P2G and G2P as they are that impulse is
    /// −m₀ v₀ − 2 m₁m₋/(m₁+m₋) (v₁ + v₋), where v is along the inward normal and −, 0, 1 stand for beyond, on the plane
    /// and inside.
    ///
    /// Along the wall, `Sticky` mirrors velocities with the other sign, so that they are zero on the plane. Friction
    /// takes at most μ times the wall's impulse from the node on the plane.
    ///
    /// Returns the lanes in which the wall acts, each lane being a triple of its own. In the others `triple` is
    /// unspecified afterwards.
    #[inline(always)]
    pub(crate) fn fold<R: Real, const D: usize>(
        self,
        triple: &mut Triple<R, D>,
        axis: usize,
        inward: f64,
    ) -> R::Mask {
        let (far, middle, near) = (triple.beyond, triple.on_plane, triple.inside);
        let zero = near.mass.zero();
        let together = near.mass + far.mass;
        let have_mass = !(middle.mass.le(zero) | together.le(zero));
        let reduced = near.mass * (far.mass / together);
        let impulse = (middle.mass * middle.velocity[axis]
            + (reduced + reduced) * (near.velocity[axis] + far.velocity[axis]))
            * zero.lit(-inward);
        let acts = match self {
            Self::Open => have_mass & !have_mass,
            Self::Separate { .. } => have_mass & !impulse.le(zero),
            Self::Sticky | Self::Slip { .. } => have_mass,
        };

        let sticky = self == Self::Sticky;
        let image = mirrored(far.velocity, axis, sticky);
        let velocity = folded(near.mass, near.velocity, far.mass, image);
        let image = mirrored(far.before, axis, sticky);
        let before = folded(near.mass, near.before, far.mass, image);
        let on_plane = &mut triple.on_plane;
        match self {
            Self::Sticky => on_plane.velocity = Vector([zero; D]),
            Self::Open => {}
            Self::Slip { friction } | Self::Separate { friction } => {
                on_plane.velocity[axis] = zero;
                if friction > 0.0 {
                    let amount = zero.lit(friction) * impulse.max(zero) / on_plane.mass;
                    on_plane.velocity = shortened(on_plane.velocity, amount);
                }
            }
        }
        on_plane.before[axis] = zero;
        triple.inside = TripleNode {
            mass: together,
            velocity,
            before,
        };
        triple.beyond = TripleNode {
            mass: together,
            velocity: mirrored(velocity, axis, sticky),
            before: mirrored(before, axis, sticky),
        };
        acts
    }
}
