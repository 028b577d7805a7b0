//! Snow (Stomakhin 2013): corotated, yielding outside a band of stretch, hardening as it packs.

/// Corotated with moduli h λ, h μ; singular values of F_E clamped to [1−θc, 1+θs];
/// h = exp(ξ(1−J_P)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Snow {
    /// Lamé's first parameter λ at J_P = 1 \[Pa\].
    pub lambda: f64,
    /// Shear modulus μ at J_P = 1 \[Pa\].
    pub mu: f64,
    /// Critical compression θc.
    pub critical_compression: f64,
    /// Critical stretch θs.
    pub critical_stretch: f64,
    /// Hardening ξ.
    pub hardening: f64,
    /// The range h is clamped to.
    pub hardening_range: [f64; 2],
    /// The range J_P is clamped to.
    pub plastic_jacobian_range: [f64; 2],
    /// Which J_P the hardening reads.
    pub hardening_from: HardeningFrom,
}

/// Which J_P the hardening reads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum HardeningFrom {
    /// After this substep's clamping.
    #[default]
    Updated,
    /// Before it, as in mpm99 and mpm128.
    Previous,
}
