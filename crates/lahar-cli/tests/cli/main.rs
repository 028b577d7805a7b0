//! Tests of the program as its users start it, in one binary, so that it is linked once.

mod commands;
mod measure;
mod pictures;
mod resume;
mod run_folder;
mod support;
mod view;
