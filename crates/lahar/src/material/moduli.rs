//! Conversions between the moduli of isotropic elasticity.

/// Returns Lamé's parameters (λ, μ) \[Pa\] of Young's modulus \[Pa\] and Poisson's ratio. In 2D they
/// are those of plane strain.
///
/// ```
/// assert_eq!(lahar::material::lame(2.5, 0.25), (1.0, 1.0));
/// ```
pub fn lame(youngs_modulus: f64, poisson_ratio: f64) -> (f64, f64) {
    let (e, nu) = (youngs_modulus, poisson_ratio);
    (
        e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
        e / (2.0 * (1.0 + nu)),
    )
}

/// Returns Lamé's parameters (K − ⅔G, G) \[Pa\] of the bulk modulus K and the shear modulus G.
///
/// ```
/// assert_eq!(lahar::material::lame_from_bulk_and_shear(5.0, 3.0), (3.0, 3.0));
/// ```
pub fn lame_from_bulk_and_shear(bulk_modulus: f64, shear_modulus: f64) -> (f64, f64) {
    (bulk_modulus - shear_modulus * 2.0 / 3.0, shear_modulus)
}
