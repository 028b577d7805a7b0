//! The substep.

mod particle_forces;
