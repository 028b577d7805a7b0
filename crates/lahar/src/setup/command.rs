//! Commands to a running simulation, as plain data.

/// A command to a running simulation, given by [`Simulate::command`](crate::Simulate::command). It takes effect at
/// the next substep. Vectors have three components; 2D ignores the third.
///
/// ```
/// use lahar::{Command, Pointer, PointerAction, Setup, Simulate, Simulation, ParticleBatch};
///
/// let jelly = lahar::material::preset("jelly", 0.0).ok_or("unknown")?;
/// let drop = ParticleBatch { position: vec![[0.5, 0.5]], volume: vec![1e-4], ..Default::default() };
/// let mut simulation = Simulation::<f32, 2>::new(Setup::new(0.02, vec![jelly]), &[drop])?;
///
/// // Turn gravity on, to the left.
/// simulation.command(Command::Gravity([-9.81, 0.0, 0.0]));
/// assert_eq!(simulation.gravity(), [-9.81, 0.0, 0.0]);
///
/// // Drag what is near the pointer upward, for a hundredth of a second.
/// let pointer = Pointer {
///     position: [0.5, 0.5, 0.0],
///     radius: 0.1,
///     softening: 0.0,
///     action: PointerAction::Drag([0.0, 1.0, 0.0]),
/// };
/// simulation.command(Command::Pointer(Some(pointer)));
/// simulation.advance_to(0.01)?;
/// simulation.command(Command::Pointer(None));
/// let momentum = simulation.diagnostics().momentum;
/// assert!(momentum[0] < 0.0 && momentum[1] > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// Replaces gravity \[m/s²\].
    Gravity([f64; 3]),
    /// Puts the pointer down, moves it, or lifts it.
    Pointer(Option<Pointer>),
    /// Makes a fluid stiffer or softer: from now on, its speed of sound at rest is `speed`. The J of its particles
    /// changes so that pressures stay. Materials without a bulk modulus are left as they are.
    ///
    /// ```
    /// use lahar::{Command, ParticleBatch, Setup, Simulate, Simulation};
    ///
    /// let water = lahar::material::preset("water", 30.0).ok_or("unknown")?;
    /// let drop = ParticleBatch { position: vec![[0.5, 0.5]], volume: vec![1e-4], ..Default::default() };
    /// let mut simulation = Simulation::<f32, 2>::new(Setup::new(0.02, vec![water]), &[drop])?;
    /// let (dt, _) = simulation.next_dt();
    /// simulation.command(Command::SoundSpeed { material: 0, speed: 60.0 });
    /// let (shorter, _) = simulation.next_dt();
    /// assert!((shorter / dt - 0.5).abs() < 1e-3, "sound crosses a cell in half the time");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    SoundSpeed {
        /// Index of the material.
        material: usize,
        /// Speed of sound at rest \[m/s\], positive.
        speed: f64,
    },
}

/// A hand in the scene that acts on the material near it until it is lifted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pointer {
    /// Its position \[m\].
    pub position: [f64; 3],
    /// Distance within which it acts \[m\].
    pub radius: f64,
    /// Length \[m\] within which attraction goes to zero, so that it has no jump of direction at the pointer.
    pub softening: f64,
    /// Its effect on the material.
    pub action: PointerAction,
}

/// The effect of a [`Pointer`] on the material at the offset d from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PointerAction {
    /// Accelerates nodes toward the pointer by this number times d/(|d| + softening) \[m/s²\]; away from it if the
    /// number is negative.
    Attract(f64),
    /// Draws the velocities of nodes near the pointer to this velocity \[m/s\].
    Drag([f64; 3]),
    /// Accelerates each particle within the radius away from the pointer, by acceleration × (|d|/radius)^power. If
    /// the radius is infinite, the acceleration is the same everywhere. It acts at the particle's position at the
    /// end of the substep, and moves the particle in the next.
    Push {
        /// Acceleration at the radius \[m/s²\]; toward the pointer if it is negative.
        acceleration: f64,
        /// How fast the acceleration falls off toward the pointer; with 0 it is the same within the radius.
        power: f64,
    },
}
