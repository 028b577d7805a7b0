//! Validation cases against their targets. One program, so that the crate is linked once.

mod validation;
