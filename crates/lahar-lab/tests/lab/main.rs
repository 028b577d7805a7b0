//! Tests of validation and of the method, in one binary, so that the crate is linked once.

mod method;
mod validation;
