//! No law: particles that carry mass and momentum and exert no stress ("dust").

use super::constitutive::ConstitutiveModel;
use super::presets::Preset;
use super::strain::Dilatation;
use crate::math::{Matrix, Real};

/// The largest |J − 1| of dust. It does not resist, so that the J of a lone particle would grow until
/// no number could represent it.
const LARGEST_DILATATION: f64 = 1e6;

/// τ = 0. The change of volume is tracked all the same, for plots that color dust by it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Dust;

/// There are none: dust has no numbers to look up but its density.
pub(super) const PRESETS: &[Preset<Dust>] = &[];

impl<const D: usize> ConstitutiveModel<D> for Dust {
    type Strain<R: Real> = Dilatation<R>;

    #[inline(always)]
    fn kirchhoff_stress<R: Real>(&self, strain: Dilatation<R>, _: Matrix<R, D>) -> Matrix<R, D> {
        Matrix::scaled_identity(strain.jacobian_minus_one.zero())
    }

    #[inline(always)]
    fn advance<R: Real>(&self, strain: Dilatation<R>, increment: Matrix<R, D>) -> Dilatation<R> {
        let e = strain.jacobian_minus_one;
        let change = increment.determinant_of_identity_plus_minus_one();
        Dilatation {
            jacobian_minus_one: (e + change + e * change) // (7)
                .max(e.lit(-LARGEST_DILATATION))
                .min(e.lit(LARGEST_DILATATION)),
        }
    }

    #[inline(always)]
    fn energy_density<R: Real>(&self, strain: Dilatation<R>) -> R {
        strain.jacobian_minus_one.zero()
    }

    #[inline(always)]
    fn wave_modulus<R: Real>(&self, strain: Dilatation<R>) -> R {
        strain.jacobian_minus_one.zero()
    }
}
