//! A material of your own: a Kelvin–Voigt solid, that is jelly that damps its own wobble.
//!
//! A law is one `impl` of [`ConstitutiveModel`]. It is generic over [`Real`], so the same lines run
//! on one `f64` and on sixteen `f32` at once; that is all there is to being fast.
//!
//! Run it with `cargo run --release -p lahar --example custom_material`.

use lahar::material::{ConstitutiveModel, Corotated, DisplacementGradient, Dust, lame, law};
use lahar::math::{Matrix, Real};
use lahar::{
    Contact, Domain, Material, Model, ParticleBatch, Setup, Sides, Simulate, Simulation, WallStyle,
};

/// Corotated elasticity plus viscosity.
#[derive(Clone, Copy, Debug)]
struct KelvinVoigt {
    elastic: Corotated,
    /// Shear viscosity [Pa s].
    viscosity: f64,
}

impl<const D: usize> ConstitutiveModel<D> for KelvinVoigt {
    type Strain<R: Real> = DisplacementGradient<R, D>;

    #[inline(always)]
    fn kirchhoff_stress<R: Real>(
        &self,
        strain: Self::Strain<R>,
        gradient: Matrix<R, D>,
    ) -> Matrix<R, D> {
        let rate = gradient + gradient.transpose();
        self.elastic.kirchhoff_stress(strain, gradient) + rate * rate[(0, 0)].lit(self.viscosity)
    }

    #[inline(always)]
    fn advance<R: Real>(
        &self,
        strain: Self::Strain<R>,
        increment: Matrix<R, D>,
    ) -> Self::Strain<R> {
        self.elastic.advance(strain, increment)
    }

    #[inline(always)]
    fn energy_density<R: Real>(&self, strain: Self::Strain<R>) -> R {
        ConstitutiveModel::<D>::energy_density(&self.elastic, strain)
    }

    #[inline(always)]
    fn wave_modulus<R: Real>(&self, strain: Self::Strain<R>) -> R {
        ConstitutiveModel::<D>::wave_modulus(&self.elastic, strain)
    }

    fn viscosity(&self) -> f64 {
        self.viscosity
    }
}

/// Drops a block and returns its kinetic energy after a second [J].
fn drop_a_block(viscosity: f64) -> Result<f64, Box<dyn std::error::Error>> {
    let (lambda, mu) = lame(2e4, 0.3);
    let mut setup = Setup::<2>::new(
        0.025,
        // The model named here is not used: the law given below takes its place.
        vec![Material {
            name: "gel".into(),
            density: 1000.0,
            model: Model::Dust(Dust),
        }],
    );
    let walls = Sides::Walls {
        low: Contact::Sticky,
        high: Contact::Sticky,
    };
    setup.domain = Some(Domain {
        min: [0.0; 2],
        max: [1.0; 2],
        sides: [walls; 2],
        style: WallStyle::Plane,
    });
    setup.gravity = [0.0, -9.81];
    let spacing = 0.0125;
    let position = (0..24 * 24)
        .map(|k| {
            [
                0.35 + spacing * f64::from(k % 24),
                0.01 + spacing * f64::from(k / 24),
            ]
        })
        .collect();
    let block = ParticleBatch {
        position,
        volume: vec![spacing * spacing],
        ..ParticleBatch::default()
    };
    let gel = KelvinVoigt {
        elastic: Corotated { lambda, mu },
        viscosity,
    };
    let mut simulation = Simulation::<f32, 2>::with_laws(setup, vec![law(gel)], &[block])?;
    simulation.advance_to(1.0)?;
    Ok(simulation.diagnostics().kinetic_energy)
}

#[expect(clippy::print_stdout, reason = "an example shows its result")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (free, damped) = (drop_a_block(0.0)?, drop_a_block(20.0)?);
    println!("kinetic energy after 1 s: {free:.3e} J without damping, {damped:.3e} J with");
    assert!(damped < free, "viscosity must damp");
    Ok(())
}
