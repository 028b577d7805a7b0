//! Fixed corotated elasticity (Stomakhin 2012): "jelly".

/// τ = 2μ(F−R)Fᵀ + λ(J−1)J I.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corotated {
    /// Lamé's first parameter λ \[Pa\].
    pub lambda: f64,
    /// Shear modulus μ \[Pa\].
    pub mu: f64,
}
