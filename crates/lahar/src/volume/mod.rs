//! The volume rules of fluids that ask the grid how full it is: (7g)–(7i).
//!
//! ```text
//! P2G of volumes ──sum──▶ NodeField<Volume> ──gather──▶ J of fluids with volume = "gathered"      (7g)
//!                               │
//!                            filling ──▶ NodeField<Filling> ──correction──▶ J − 1 of fluids       (7h), (7i)
//! ```

pub(crate) mod filling;
pub(crate) mod readout;
