//! The program as its users start it. One program of tests, so that it is linked once.

mod commands;
mod resume;
mod view;
