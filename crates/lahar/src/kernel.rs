//! B-splines: the weights between particles and nodes.
//!
//! In cells, on one axis: a particle's *base* node is the lowest of the [`BSpline::NODES`] it
//! touches, and `frac` ∈ [0, 1) is the distance of the particle from the first place that has this base.
//! So the particle sits `s = frac + OFFSET` cells above its base node:
//!
//! ```text
//! linear      0     1            s = frac         ∈ [0, 1)
//! quadratic   0     1     2      s = frac + 1/2   ∈ [1/2, 3/2)
//! cubic       0     1     2   3  s = frac + 1     ∈ [1, 2)
//! ```

use crate::math::Real;

/// The largest number of nodes that a kernel touches per axis; weights beyond [`BSpline::NODES`] are 0.
pub const STENCIL: usize = 4;

/// A B-spline on one axis; the weight of a node is the product over axes.
pub trait BSpline: Copy + Send + Sync + 'static {
    /// Nodes touched per axis.
    const NODES: usize;
    /// `s − frac`, see the module's page \[cells\].
    const OFFSET: f64;
    /// The node, counted from the base, that moments are taken about. It is the one nearest to the middle, so that their
    /// rounding is least.
    const CENTER: usize;
    /// D⁻¹ dx² of equation (3): Σ w r rᵀ = dx²/`INVERSE_INERTIA` I. Infinite for the linear kernel, whose inertia depends
    /// on the particle's place.
    const INVERSE_INERTIA: f64;

    /// Returns the weights w of nodes base + 0, 1, 2, 3.
    fn weights<R: Real>(frac: R) -> [R; STENCIL];

    /// Returns dx ∂w/∂x_p of nodes base + 0, 1, 2, 3: the derivative by the particle's position in cells.
    fn gradients<R: Real>(frac: R) -> [R; STENCIL];
}

/// The B-spline of degree 1.
#[derive(Clone, Copy, Debug)]
pub struct Linear;

/// The B-spline of degree 2.
#[derive(Clone, Copy, Debug)]
pub struct Quadratic;

/// The B-spline of degree 3.
#[derive(Clone, Copy, Debug)]
pub struct Cubic;

impl BSpline for Linear {
    const NODES: usize = 2;
    const OFFSET: f64 = 0.0;
    const CENTER: usize = 0;
    const INVERSE_INERTIA: f64 = f64::INFINITY;

    #[inline(always)]
    fn weights<R: Real>(frac: R) -> [R; STENCIL] {
        let zero = frac.zero();
        [frac.one() - frac, frac, zero, zero]
    }

    #[inline(always)]
    fn gradients<R: Real>(frac: R) -> [R; STENCIL] {
        let zero = frac.zero();
        [-frac.one(), frac.one(), zero, zero]
    }
}

impl BSpline for Quadratic {
    const NODES: usize = 3;
    const OFFSET: f64 = 0.5;
    const CENTER: usize = 1;
    const INVERSE_INERTIA: f64 = 4.0;

    #[inline(always)]
    fn weights<R: Real>(frac: R) -> [R; STENCIL] {
        let half = frac.lit(0.5);
        let (below, middle) = (frac.one() - frac, frac - half);
        [
            half * below * below,
            frac.lit(0.75) - middle * middle,
            half * frac * frac,
            frac.zero(),
        ]
    }

    #[inline(always)]
    fn gradients<R: Real>(frac: R) -> [R; STENCIL] {
        let one = frac.one();
        [frac - one, one - (frac + frac), frac, frac.zero()]
    }
}

impl BSpline for Cubic {
    const NODES: usize = 4;
    const OFFSET: f64 = 1.0;
    const CENTER: usize = 1;
    const INVERSE_INERTIA: f64 = 3.0;

    #[inline(always)]
    fn weights<R: Real>(frac: R) -> [R; STENCIL] {
        let (half, sixth, two_thirds) = (frac.lit(0.5), frac.lit(1.0 / 6.0), frac.lit(2.0 / 3.0));
        let below = frac.one() - frac;
        [
            sixth * below * below * below,
            two_thirds + half * frac * frac * (frac - frac.lit(2.0)),
            two_thirds + half * below * below * (below - frac.lit(2.0)),
            sixth * frac * frac * frac,
        ]
    }

    #[inline(always)]
    fn gradients<R: Real>(frac: R) -> [R; STENCIL] {
        let (half, three_halves, two) = (frac.lit(0.5), frac.lit(1.5), frac.lit(2.0));
        let below = frac.one() - frac;
        [
            -half * below * below,
            frac * (three_halves * frac - two),
            below * (two - three_halves * below),
            half * frac * frac,
        ]
    }
}
