//! Commands to a running simulation, as plain data.

/// What can be told to a running simulation. Vectors have three components; 2D ignores the third.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// Replaces gravity \[m/s²\].
    Gravity([f64; 3]),
    /// Sets or lifts the hand that stirs.
    Pointer(Option<Pointer>),
    /// Makes a fluid stiffer or softer: its speed of sound at rest is `speed` \[m/s\] from now on, and its
    /// J changes so that pressures stay. Materials without a bulk modulus are left as they are.
    SoundSpeed {
        /// Index of the material.
        material: usize,
        /// Speed of sound at rest \[m/s\], positive.
        speed: f64,
    },
}

/// A hand in the scene: acts on what is near it, until it is lifted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pointer {
    /// Where it is \[m\].
    pub position: [f64; 3],
    /// How far it reaches \[m\].
    pub radius: f64,
    /// Attraction goes to zero within this length \[m\], where its direction means nothing.
    pub softening: f64,
    /// What it does.
    pub action: PointerAction,
}

/// What a hand does to what is at the offset d from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PointerAction {
    /// Accelerates nodes towards the hand by this much times d/(|d| + softening) \[m/s²\]; negative:
    /// away from it.
    Attract(f64),
    /// Drags along: node velocities near the hand are drawn to this velocity \[m/s\].
    Drag([f64; 3]),
    /// Accelerates each particle nearer than the radius away from the hand, by acceleration ×
    /// (|d|/radius)^power; by the same everywhere if the radius is infinite. It acts where the
    /// substep has moved the particle to, and moves it in the next.
    Push {
        /// At the radius \[m/s²\]; negative: towards the hand.
        acceleration: f64,
        /// How much weaker it is near the hand; 0: as strong anywhere within the radius.
        power: f64,
    },
}
