//! Scenes from their text to what they do. One program, so that the crate is linked once.

mod broken_scenes;
mod builtin;
mod formulas;
mod golden;
mod lineage;
mod scenes;
mod shapes;
mod tutorial;
mod water;
