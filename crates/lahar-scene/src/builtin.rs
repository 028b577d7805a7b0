//! Scenes that ship with the program.
//!
//! ```
//! use lahar_scene::builtin;
//!
//! assert_eq!(builtin::list()[0].name, "dam-break");
//! assert!(builtin::find("mpm88").is_some());
//! ```

/// A built-in scene.
#[derive(Clone, Copy, Debug)]
pub struct Builtin {
    /// The name on the command line.
    pub name: &'static str,
    /// The title, in a few words.
    pub title: &'static str,
    /// One sentence on what happens in the scene.
    pub summary: &'static str,
    /// Number of dimensions, 2 or 3.
    pub dimension: usize,
    /// The text of the scene file.
    pub text: &'static str,
    /// The files that the scene names: name and content.
    pub files: &'static [(&'static str, &'static str)],
}

macro_rules! scenes {
    ($($name:literal $(in $folder:literal)? $dimension:literal $title:literal $summary:literal $(with $file:literal at $path:literal)?;)*) => {
        &[$(Builtin {
            name: $name,
            title: $title,
            summary: $summary,
            dimension: $dimension,
            text: include_str!(concat!("../scenes/", $($folder, "/",)? $name, ".toml")),
            files: &[$(($file, include_str!(concat!("../scenes/", $path))))?],
        }),*]
    };
}

const SCENES: &[Builtin] = scenes! {
    "dam-break" 2 "Dam break" "A column of water collapses, runs along the floor and climbs the far wall.";
    "dam-break-3d" 3 "Dam break in 3D" "A column of water collapses in a tank, shoots up the far wall and falls back.";
    "double-dam" 2 "Double dam" "Two dyed columns of water run towards each other and throw up a jet where they meet.";
    "water-jelly-snow" 2 "Water, jelly and snow" "A block of each falls into a pool: water splashes, jelly floats, snow breaks up.";
    "water-jelly-snow-3d" 3 "Water, jelly and snow in 3D" "Cubes of water and jelly and a ball of snow fall into a pool.";
    "jelly-drop" 2 "Jelly drop" "Three jellies fall: the soft one spreads, the stiff one jumps.";
    "spinning-jelly" 2 "Spinning jelly" "A square of jelly turns in free space; only the transfer scheme slows it down.";
    "snowball" 2 "Snowball" "A thrown snowball bursts on a wall.";
    "obstacle" 2 "Dam break with elastic plates" "A wave bends two elastic plates and shoots over them.";
    "square-obstacle" 2 "Dam break against a block" "A small block throws the tongue of water up and against the far wall.";
    "beach" 2 "Waves on a beach" "A rocking flap makes waves that run up a beach and break.";
    "mixer" 2 "Mixer" "A cross of paddles stirs water in two dyes.";
    "rain" 2 "Rain" "Rows of drops fall into a pool.";
    "jelly-letters" 2 "Letters of jelly" "The word MPM in jelly falls into a pool and floats.";
    "honey" 2 "Honey" "A thread of honey tears off, folds and piles up on a plate.";
    "sloshing" 2 "Sloshing tank" "A tank is shaken at the period of its first wave; colors show speeds.";
    "snow-castle" 2 "Snow castle" "A ball of rubber breaks through a castle of snow.";
    "snowballs" 2 "Snowballs" "Two snowballs meet in the air.";
    "gears" 2 "Jelly gears" "A spinning wheel of jelly drives other wheels, without gravity.";
    "planet" 2 "Planet and moon of water" "A moon of water falls on a planet of water, held together by a pull towards the middle.";
    "galaxy" 2 "Galaxy of dust" "A two-colored disc of dust winds up into spirals.";
    "taylor-green" 2 "Taylor-Green whirls" "Whirls in a periodic square stir two dyes.";
    "box-obstacle-3d" 3 "Dam break against a box in 3D" "The wave splits at a box on the floor and closes behind it.";
    "knot-3d" 3 "Knot of jelly in 3D" "A knot of jelly, made from a mesh, falls and bounces." with "knot-3d.obj" at "knot-3d.obj";
    "drops-3d" 3 "Two drops in 3D" "Two drops of water collide off center, without gravity.";
    "whirlpool-3d" 3 "Whirlpool in 3D" "A stirred basin: the surface sinks in the middle and rises at the walls.";
    "mpm88" in "lineage" 2 "mpm88" "The fluid square of Taichi's mpm88.py, with its constants, walls and time step.";
    "mpm88-corrected" in "lineage" 2 "mpm88, corrected" "mpm88 with walls on their planes, and without holes and strings.";
    "mpm99" in "lineage" 2 "mpm99" "Taichi's mpm99.py: liquid, jelly and snow fall into a box under strong gravity.";
    "mpm99-corrected" in "lineage" 2 "mpm99, corrected" "mpm99 with walls on their planes, and a liquid stiff enough for its fall.";
    "mpm128" in "lineage" 2 "mpm128" "Taichi's mpm128.py: stiffer liquid, jelly and snow, to be stirred with the mouse.";
    "mpm128-corrected" in "lineage" 2 "mpm128, corrected" "mpm128 with walls on their planes, and gravity that stays as it is turned.";
    "mpm3d" in "lineage" 3 "mpm3d, 32 cells per side" "Taichi's mpm3d.py: a cube of mpm88's fluid falls into a box.";
    "mpm3d-corrected" in "lineage" 3 "mpm3d, corrected" "mpm3d with particles of their true volume, and walls on their planes.";
    "mpm3d-64" in "lineage" 3 "mpm3d, 64 cells per side" "mpm3d with 65,536 particles.";
    "mpm3d-128" in "lineage" 3 "mpm3d, 128 cells per side" "mpm3d with 524,288 particles.";
    "mpm3d-ggui-single-dam" in "lineage" 3 "mpm3d_ggui, single dam break" "Taichi's mpm3d_ggui.py, first preset: a block of water collapses in a corner.";
    "mpm3d-ggui-double-dam" in "lineage" 3 "mpm3d_ggui, double dam break" "Taichi's mpm3d_ggui.py, second preset: two blocks of water meet.";
    "mpm3d-ggui-water-snow-jelly" in "lineage" 3 "mpm3d_ggui, water, snow and jelly" "Taichi's mpm3d_ggui.py, third preset: cubes of water, snow and jelly fall and touch.";
    "mls-mpm88" in "lineage" 2 "mls-mpm88" "The 88 lines of C++ that came with the paper on MLS-MPM: three squares of snow fall.";
    "incremental-mpm-1" in "lineage" 2 "incremental_mpm 1: dust" "nialltl's first stage: particles without stress, whose velocities the grid averages.";
    "incremental-mpm-2" in "lineage" 2 "incremental_mpm 2: neo-Hookean" "nialltl's second stage: a square of rubber bounces.";
    "incremental-mpm-3" in "lineage" 2 "incremental_mpm 3: fluid" "nialltl's third stage: a square of fluid, with density gathered from the grid, splashes between soft walls.";
    "incremental-mpm-3-corrected" in "lineage" 2 "incremental_mpm 3, corrected" "Stage 3 with Newtonian viscosity, density that follows the motion, and plain walls.";
};

/// Scenes with published numbers to compare with. They are not listed, but found by name.
const VALIDATION: &[Builtin] = scenes! {
    "k2-affine-dust" in "validation" 2 "Dust in affine motion" "Dust turns, stretches and shears.";
    "k3-discs" in "validation" 2 "Two discs collide, APIC" "The discs of e4-discs with APIC.";
    "k7-mpm88-regression" in "validation" 2 "mpm88, the regression of the Taichi project" "64 x 64 particles of mpm88's fluid at given positions; moments of their positions are known at substep 500." with "k7-mpm88-regression.csv" at "validation/k7-mpm88-regression.csv";
    "k8-free-fall" in "validation" 2 "Free fall" "A ball of jelly falls.";
    "e1-bar" in "validation" 2 "Bar that oscillates lengthwise" "A bar, fixed at one end, oscillates in its first mode.";
    "e2-plate" in "validation" 2 "Plate that oscillates, clamped at one end" "A plate in its first bending mode.";
    "e3-cantilever" in "validation" 2 "Soft cantilever released under its weight" "A thick soft beam bends far down and comes up again.";
    "e3-elastica" in "validation" 2 "Slender cantilever at rest under its weight" "A slender beam bends until it rests.";
    "e4-discs" in "validation" 2 "Two discs collide" "Two elastic discs bounce off each other.";
    "f1-taylor-green" in "validation" 2 "Taylor-Green whirls at Re = 100" "A square of whirls decays.";
    "f2-shear-wave" in "validation" 2 "Shear wave without viscosity" "A shear wave that should stay.";
    "f3-poiseuille" in "validation" 2 "Poiseuille flow starts" "A force starts the flow between two plates.";
    "f3-couette" in "validation" 2 "Couette flow starts" "A moving plate starts the flow between two plates.";
    "f4-tank" in "validation" 2 "Tank of water at rest" "Water that should stay at rest.";
    "f4-tank-3d" in "validation" 3 "Tank of water at rest in 3D" "Water that should stay at rest.";
    "f5-standing-wave" in "validation" 2 "Standing wave" "A standing gravity wave in a tank.";
    "f6-acoustic-mode" in "validation" 2 "Acoustic mode of a closed box" "Sound between two walls.";
    "f7-elliptic-drop" in "validation" 2 "Elliptic drop" "A drop stretches by its own motion.";
    "f8-rotating-square" in "validation" 2 "Square patch of fluid that turns" "A square of fluid begins to turn.";
    "f9-jet" in "validation" 2 "Jet on a wall" "A plane jet meets a wall.";
    "d1-martin-moyce" in "validation" 2 "Dam break of Martin and Moyce" "A column of water collapses.";
    "d2-koshizuka-oka" in "validation" 2 "Dam break of Koshizuka and Oka" "A column of water collapses in a short tank.";
    "d3-wall-impact" in "validation" 2 "Dam break that runs into a wall" "A dam break hits the end wall, where gauges are.";
    "d6-column" in "validation" 3 "Bore that hits a column" "A dam break over a wet bed hits a square column.";
};

/// Scenes to measure speed with. They are not listed, but found by name.
const BENCH: &[Builtin] = scenes! {
    "bench-dam-3d" in "bench" 3 "Benchmark: dam break in 3D" "A million particles of water, 8 per cell, collapse.";
    "bench-dam-2d" in "bench" 2 "Benchmark: dam break in 2D" "A million particles of water, 4 per cell, collapse.";
    "bench-jelly-3d" in "bench" 3 "Benchmark: jelly in 3D" "A million particles of jelly slide into a wall.";
    "bench-snow-3d" in "bench" 3 "Benchmark: snow in 3D" "A million particles of snow break in a corner.";
};

/// Returns a commented scene to start a new one from.
pub fn starter() -> &'static str {
    include_str!("../scenes/starter.toml")
}

/// Returns the listed scenes, the default first.
pub fn list() -> &'static [Builtin] {
    SCENES
}

/// Returns the validation scenes.
pub fn validation() -> &'static [Builtin] {
    VALIDATION
}

/// Returns the scenes to measure speed with.
pub fn bench() -> &'static [Builtin] {
    BENCH
}

/// Returns the built-in scene called `name`.
pub fn find(name: &str) -> Option<&'static Builtin> {
    SCENES
        .iter()
        .chain(VALIDATION)
        .chain(BENCH)
        .find(|scene| scene.name == name)
}
