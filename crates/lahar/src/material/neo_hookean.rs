//! Neo-Hookean elasticity.

/// τ = μ(FFᵀ−I) + λ ln J I.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeoHookean {
    /// Lamé's first parameter λ \[Pa\].
    pub lambda: f64,
    /// Shear modulus μ \[Pa\].
    pub mu: f64,
}
