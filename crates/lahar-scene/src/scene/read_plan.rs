//! Reads a checked document into a [`Plan`].

use super::bodies::{BodyContext, read_body};
use super::choices::{FORCE_FORMS, KERNELS, TRANSFERS};
use super::colliders::read_colliders;
use super::domain::{read_clamp, read_cushion, read_domain};
use super::files::Files;
use super::forces::read_forces;
use super::limits::Limits;
use super::material::read_material;
use super::plan::{Body, Plan, Source};
use super::read::Reader;
use crate::error::SceneError;
use crate::text::count_words;
use lahar::geometry::Bounds;
use lahar::{Domain, ForceForm, Kernel, TimeStep, Transfer};

impl<const D: usize> Plan<D> {
    /// Reads a scene of which every key and value has been checked on its own.
    ///
    /// # Errors
    /// The first thing that does not go together.
    pub(crate) fn read(scene: &Reader<'_>, files: &Files<'_>) -> Result<Self, SceneError> {
        let dx = scene.number("dx")?;
        let mut warnings = Vec::new();
        let (gravity, forces) = read_forces(scene, dx)?;
        let domain_table = scene.opt_table("domain");
        let domain = match &domain_table {
            Some(table) => Some(read_domain(scene, table, dx)?),
            None => None,
        };
        let (clamp, cushion) = match &domain_table {
            Some(table) => (read_clamp(table)?, read_cushion(table)?),
            None => (None, None),
        };
        let colliders = read_colliders(scene, dx, files, &mut warnings)?;
        let (kernel, force) = read_kernel(scene)?;
        let transfer = read_transfer(scene)?;
        let time_step = read_time_step(scene)?;
        let mut materials = Vec::new();
        let mut stiffness = Vec::new();
        for (name, table) in scene.tables("materials") {
            let (material, given) = read_material(name, &table, D)?;
            materials.push(material);
            stiffness.push((given, table));
        }
        let context = BodyContext {
            materials: &materials,
            clip: domain
                .as_ref()
                .map_or(Bounds::EVERYTHING, |domain: &Domain<D>| Bounds {
                    min: domain.min,
                    max: domain.max,
                }),
            dx,
            files,
        };
        let bodies = read_bodies(scene, &context, &mut warnings)?;
        let mut plan = Self {
            dx,
            gravity,
            forces,
            duration: scene.number("duration")?,
            domain,
            clamp,
            cushion,
            colliders,
            kernel,
            transfer,
            force,
            time_step,
            materials,
            automatic: Vec::new(),
            bodies,
            probes: Vec::new(),
            warnings,
        };
        plan.settle_stiffness(&stiffness)?;
        plan.warn();
        Ok(plan)
    }
}

/// Reads all bodies. Their names must differ, and their particles must fit into the memory.
fn read_bodies<const D: usize>(
    scene: &Reader<'_>,
    context: &BodyContext<'_, D>,
    warnings: &mut Vec<String>,
) -> Result<Vec<Body<D>>, SceneError> {
    let mut bodies: Vec<Body<D>> = Vec::new();
    for (index, (_, table)) in scene.tables("bodies").into_iter().enumerate() {
        let body = read_body(index, &table, context, warnings)?;
        if bodies.iter().any(|other| other.name == body.name) {
            let message = format!("two bodies are called \"{}\"", body.name);
            return Err(table.error_at("name", message));
        }
        bodies.push(body);
        check_count(&bodies, scene, &table, context.files.limits())?;
    }
    Ok(bodies)
}

/// Reads `kernel` and `force`, which must go together.
fn read_kernel(scene: &Reader<'_>) -> Result<(Kernel, ForceForm), SceneError> {
    let kernel = scene.choice("kernel", &KERNELS)?;
    let force = scene.choice("force", &FORCE_FORMS)?;
    if kernel == Kernel::Linear && force == ForceForm::Mls {
        let error = scene.error_at(
            "kernel",
            "the linear kernel has no MLS force: its inertia is singular at nodes",
        );
        return Err(error.hint("add force = \"classic\", or choose kernel = \"quadratic\""));
    }
    Ok((kernel, force))
}

/// Places that sampling may try per particle that there is memory for.
const PLACES_PER_PARTICLE: f64 = 8.0;

/// Checks the particles of the bodies read so far against the memory that may be used; `table` is the last
/// body.
fn check_count<const D: usize>(
    bodies: &[Body<D>],
    scene: &Reader<'_>,
    table: &Reader<'_>,
    limits: &Limits,
) -> Result<(), SceneError> {
    let total: f64 = bodies.iter().map(Body::expected_particles).sum();
    // Lattice cells that sampling tries: a thin slanted shape fills little of its bounds.
    let candidates: f64 = bodies
        .iter()
        .map(|body| match &body.source {
            Source::Shape {
                region, spacing, ..
            } => region.bounds().volume() / spacing.powi(D as i32),
            Source::List(_) => 0.0,
        })
        .sum();
    let largest = (limits.memory as f64 / Limits::BYTES_PER_PARTICLE).min(f64::from(u32::MAX));
    if total <= largest && candidates <= PLACES_PER_PARTICLE * largest {
        return Ok(());
    }
    let message = if total > largest {
        format!(
            "this scene comes to {} particles, about {} GB; the limit is {} GB",
            count_words(total),
            count_words((total * Limits::BYTES_PER_PARTICLE / 1e9).ceil()),
            limits.memory as f64 / 1e9
        )
    } else {
        format!(
            "the bodies fill so little of the boxes around them that {} places would have to be tried for particles",
            count_words(candidates)
        )
    };
    // Point at the key that made them so many: the body's own, or dx.
    let error = match ["count", "spacing", "particles_per_cell", "particles"]
        .into_iter()
        .find(|key| table.has(key))
    {
        Some(key) => table.error_at(key, message),
        None => scene.error_at("dx", message),
    };
    Err(error.hint("use a larger dx, fewer particles_per_cell or smaller bodies"))
}

/// Reads `transfer` and `flip_blend`.
fn read_transfer(scene: &Reader<'_>) -> Result<Transfer, SceneError> {
    let mut transfer = scene.choice("transfer", &TRANSFERS)?;
    match (&mut transfer, scene.opt_number("flip_blend")) {
        (_, None) => Ok(transfer),
        (Transfer::Flip { blend }, Some(given)) => {
            *blend = given;
            Ok(transfer)
        }
        (Transfer::Apic | Transfer::Pic, Some(_)) => Err(scene
            .error_at_key(
                "flip_blend",
                "\"flip_blend\" is for transfer = \"flip\" only",
            )
            .hint(format!(
                "this scene has transfer = \"{}\"",
                scene.text("transfer")?
            ))),
    }
}

/// Reads `dt`, `dt_max` and `cfl`.
fn read_time_step(scene: &Reader<'_>) -> Result<TimeStep, SceneError> {
    if let Some(dt) = scene.opt_number("dt") {
        if scene.has("dt_max") {
            return Err(scene
                .error_at_key("dt_max", "\"dt_max\" is for automatic time steps")
                .hint("remove it, or dt"));
        }
        return Ok(TimeStep::Fixed(dt));
    }
    let cfl = scene.number("cfl")?;
    if cfl <= 0.0 {
        return Err(scene.error_at("cfl", "\"cfl\" must be above 0"));
    }
    Ok(TimeStep::Automatic {
        cfl,
        longest: scene.opt_number("dt_max").unwrap_or(f64::INFINITY),
    })
}

/// Frames per simulated second, if the scene does not say \[1/s\].
const USUAL_FRAME_RATE: f64 = 60.0;

/// Reads `frame_rate` and `substeps_per_frame`: frames per second, and substeps per frame where they are fixed.
pub(super) fn read_frames(
    scene: &Reader<'_>,
    time_step: TimeStep,
) -> Result<(f64, Option<u64>), SceneError> {
    let rate = scene.opt_number("frame_rate");
    let Some(substeps) = scene.opt_integer("substeps_per_frame") else {
        return Ok((rate.unwrap_or(USUAL_FRAME_RATE), None));
    };
    let TimeStep::Fixed(dt) = time_step else {
        return Err(scene
            .error_at_key(
                "substeps_per_frame",
                "\"substeps_per_frame\" needs a fixed dt",
            )
            .hint("add dt = .., in seconds"));
    };
    let comes_to = 1.0 / (dt * substeps as f64);
    match rate {
        Some(rate) if (rate / comes_to - 1.0).abs() > 1e-9 => {
            let error = scene.error_at(
                "frame_rate",
                format!(
                    "{substeps} substeps of {dt} s come to {comes_to} frames per second, not {rate}"
                ),
            );
            Err(error.hint("remove frame_rate or substeps_per_frame"))
        }
        _ => Ok((comes_to, Some(substeps))),
    }
}
