//! What a model remembers of a particle's deformation, and how it lies in storage.
//!
//! Differences from rest are stored, J − 1 and H = F − I: in `f32`, J itself drifts (.04 % of a
//! tank's height in 5·10⁴ substeps), and small strains drown in the rounding of the 1.

use crate::math::near_one::power_minus_one;
use crate::math::{Matrix, Real};

/// A particle's strain in one number or register `R`.
pub trait Strain<R: Real, const D: usize>: Copy {
    /// Columns of storage.
    const COLUMNS: usize;
    /// The column that is J − 1, if that is all this strain keeps.
    const JACOBIAN_COLUMN: Option<usize> = None;
    /// Whether it keeps plastic flow, J_P.
    const IS_PLASTIC: bool = false;
    /// No deformation, in the lanes of `like`.
    fn rest(like: R) -> Self;
    /// From the columns, in order.
    fn read(column: impl FnMut(usize) -> R) -> Self;
    /// To the columns, in order.
    fn write(&self, column: impl FnMut(usize, R));
    /// The strain of the deformation gradient I + H, as little of it as this one keeps.
    fn from_displacement_gradient(h: Matrix<R, D>) -> Self;
    /// This strain after plastic flow by J_P; for models without any, this strain.
    #[inline(always)]
    fn with_plastic_jacobian_minus_one(self, _plastic: R) -> Self {
        self
    }
    /// H = F − I; for strains that keep J only, (J^(1/D) − 1) I, and −I for J < 0.
    fn displacement_gradient(&self) -> Matrix<R, D>;
    /// J − 1.
    fn jacobian_minus_one(&self) -> R;
    /// J_P − 1, zero for models without plastic flow.
    #[inline(always)]
    fn plastic_jacobian_minus_one(&self) -> R {
        self.jacobian_minus_one().zero()
    }
}

/// The relative change of volume: J − 1.
#[derive(Clone, Copy, Debug)]
pub struct Dilatation<R> {
    /// J − 1.
    pub jacobian_minus_one: R,
}

/// The displacement gradient H = F − I.
#[derive(Clone, Copy, Debug)]
pub struct DisplacementGradient<R, const D: usize> {
    /// H = F − I of the elastic part.
    pub h: Matrix<R, D>,
}

/// The elastic displacement gradient and the plastic change of volume.
#[derive(Clone, Copy, Debug)]
pub struct PlasticGradient<R, const D: usize> {
    /// H = F_E − I.
    pub h: Matrix<R, D>,
    /// J_P − 1, J_P the determinant of the plastic deformation gradient.
    pub plastic_jacobian_minus_one: R,
    /// J_P − 1 as hardening reads it; see [`crate::material::HardeningFrom`].
    pub hardening_jacobian_minus_one: R,
}

impl<R: Real, const D: usize> DisplacementGradient<R, D> {
    /// F ← (I + A) F, A = Δt ∂v/∂x: equation (7) before any return mapping.
    #[inline(always)]
    pub fn moved(self, increment: Matrix<R, D>) -> Self {
        Self {
            h: self.h + (increment + increment * self.h), // (7)
        }
    }
}

/// FFᵀ − I, from H.
#[inline(always)]
pub(super) fn left_strain<R: Real, const D: usize>(h: Matrix<R, D>) -> Matrix<R, D> {
    (h + h.transpose()) + h * h.transpose()
}

/// No less than the largest eigenvalue of FFᵀ; that eigenvalue in 2D and at rest.
///
/// Mean plus √(D−1) standard deviations of the eigenvalues (H. Wolkowicz & G. Styan, "Bounds for
/// eigenvalues using traces", Linear Algebra Appl. 29, 1980).
#[inline(always)]
pub(super) fn largest_squared_stretch<R: Real, const D: usize>(h: Matrix<R, D>) -> R {
    let strain = left_strain(h);
    let mean = strain.trace() * h[(0, 0)].lit(1.0 / D as f64);
    let deviator = strain - Matrix::scaled_identity(mean);
    let spread = deviator.squared_norm() * mean.lit((D as f64 - 1.0) / D as f64);
    mean.one() + mean + spread.sqrt()
}

impl<R: Real, const D: usize> Strain<R, D> for Dilatation<R> {
    const COLUMNS: usize = 1;
    const JACOBIAN_COLUMN: Option<usize> = Some(0);
    #[inline(always)]
    fn rest(like: R) -> Self {
        Self {
            jacobian_minus_one: like.zero(),
        }
    }
    #[inline(always)]
    fn read(mut column: impl FnMut(usize) -> R) -> Self {
        Self {
            jacobian_minus_one: column(0),
        }
    }
    #[inline(always)]
    fn write(&self, mut column: impl FnMut(usize, R)) {
        column(0, self.jacobian_minus_one);
    }
    #[inline(always)]
    fn from_displacement_gradient(h: Matrix<R, D>) -> Self {
        Self {
            jacobian_minus_one: h.determinant_of_identity_plus_minus_one(),
        }
    }
    #[inline(always)]
    fn displacement_gradient(&self) -> Matrix<R, D> {
        let e = self.jacobian_minus_one;
        Matrix::scaled_identity(power_minus_one(e.max(-e.one()), 1.0 / D as f64))
    }
    #[inline(always)]
    fn jacobian_minus_one(&self) -> R {
        self.jacobian_minus_one
    }
}

impl<R: Real, const D: usize> Strain<R, D> for DisplacementGradient<R, D> {
    const COLUMNS: usize = D * D;
    #[inline(always)]
    fn rest(like: R) -> Self {
        Self {
            h: Matrix::scaled_identity(like.zero()),
        }
    }
    #[inline(always)]
    fn read(mut column: impl FnMut(usize) -> R) -> Self {
        Self {
            h: Matrix::from_fn(|i, j| column(j * D + i)),
        }
    }
    #[inline(always)]
    fn write(&self, mut column: impl FnMut(usize, R)) {
        for j in 0..D {
            for i in 0..D {
                column(j * D + i, self.h[(i, j)]);
            }
        }
    }
    #[inline(always)]
    fn from_displacement_gradient(h: Matrix<R, D>) -> Self {
        Self { h }
    }
    #[inline(always)]
    fn displacement_gradient(&self) -> Matrix<R, D> {
        self.h
    }
    #[inline(always)]
    fn jacobian_minus_one(&self) -> R {
        self.h.determinant_of_identity_plus_minus_one()
    }
}

impl<R: Real, const D: usize> Strain<R, D> for PlasticGradient<R, D> {
    const COLUMNS: usize = D * D + 2;
    const IS_PLASTIC: bool = true;
    #[inline(always)]
    fn rest(like: R) -> Self {
        let zero = like.zero();
        Self {
            h: Matrix::scaled_identity(zero),
            plastic_jacobian_minus_one: zero,
            hardening_jacobian_minus_one: zero,
        }
    }
    #[inline(always)]
    fn read(mut column: impl FnMut(usize) -> R) -> Self {
        Self {
            h: Matrix::from_fn(|i, j| column(j * D + i)),
            plastic_jacobian_minus_one: column(D * D),
            hardening_jacobian_minus_one: column(D * D + 1),
        }
    }
    #[inline(always)]
    fn write(&self, mut column: impl FnMut(usize, R)) {
        for j in 0..D {
            for i in 0..D {
                column(j * D + i, self.h[(i, j)]);
            }
        }
        column(D * D, self.plastic_jacobian_minus_one);
        column(D * D + 1, self.hardening_jacobian_minus_one);
    }
    #[inline(always)]
    fn from_displacement_gradient(h: Matrix<R, D>) -> Self {
        let zero = h[(0, 0)].zero();
        Self {
            h,
            plastic_jacobian_minus_one: zero,
            hardening_jacobian_minus_one: zero,
        }
    }
    #[inline(always)]
    fn with_plastic_jacobian_minus_one(self, plastic: R) -> Self {
        Self {
            plastic_jacobian_minus_one: plastic,
            hardening_jacobian_minus_one: plastic,
            ..self
        }
    }
    #[inline(always)]
    fn displacement_gradient(&self) -> Matrix<R, D> {
        self.h
    }
    #[inline(always)]
    fn jacobian_minus_one(&self) -> R {
        self.h.determinant_of_identity_plus_minus_one()
    }
    #[inline(always)]
    fn plastic_jacobian_minus_one(&self) -> R {
        self.plastic_jacobian_minus_one
    }
}
