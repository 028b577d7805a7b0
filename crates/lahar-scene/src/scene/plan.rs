//! From a checked document to a plan in numbers of one dimension: domain, materials, bodies.

use super::colliders::read_colliders;
use super::forces::{lattice, read_forces};
use super::formula::{Formulas, Of};
use super::keys::MODULI;
use super::read::Reader;
use super::shapes::read_shape_source;
use super::stiffness::{Falls, Stiffness};
use super::{Files, Limits};
use crate::error::{SceneError, nearest};
use crate::particle_list::ParticleList;
use lahar::geometry::sampling::{Sampling, expected_count};
use lahar::geometry::{Bounds, Region};
use lahar::material::{
    Corotated, Dust, Eos, Fluid, HardeningFrom, HerschelBulkley, JacobianUpdate, NeoHookean,
    Rheology, Snow, ViscousStress, VolumeCorrection, VolumeRule, lame, rheology::CREEP_RATE,
};
use lahar::{
    Collider, Contact, Cushion, Domain, Force, ForceForm, Kernel, Material, Model, Probe,
    Sides, TimeStep, Transfer, WallStyle,
};

/// Everything that depends on the dimension.
#[derive(Clone, Debug)]
pub(crate) struct Plan<const D: usize> {
    pub(crate) dx: f64,
    /// The part of gravity that is the same always.
    pub(crate) gravity: [f64; D],
    pub(crate) forces: Vec<Force<D>>,
    /// Simulated time of a run \[s\].
    pub(crate) duration: f64,
    pub(crate) domain: Option<Domain<D>>,
    pub(crate) clamp: Option<Bounds<D>>,
    pub(crate) cushion: Option<Cushion<D>>,
    pub(crate) colliders: Vec<Collider<D>>,
    pub(crate) kernel: Kernel,
    pub(crate) transfer: Transfer,
    pub(crate) force: ForceForm,
    pub(crate) time_step: TimeStep,
    pub(crate) materials: Vec<Material>,
    /// Fluids whose speed of sound the scene leaves open.
    pub(crate) automatic: Vec<usize>,
    pub(crate) bodies: Vec<Body<D>>,
    /// What is measured on the way.
    pub(crate) probes: Vec<Probe<D>>,
    pub(crate) warnings: Vec<String>,
}

/// One body.
#[derive(Clone, Debug)]
pub(crate) struct Body<const D: usize> {
    pub(crate) name: String,
    pub(crate) material: usize,
    pub(crate) source: Source<D>,
    pub(crate) velocity: Formulas<D>,
    /// How far each particle's velocity may be from that \[m/s\].
    pub(crate) velocity_spread: [f64; D],
    /// ∂v_i/∂x_j of spin and velocity gradient together \[1/s\].
    pub(crate) gradient: [[f64; D]; D],
    pub(crate) volume: Volume,
    pub(crate) pressure: StartPressure,
}

/// Where the particles come from.
#[derive(Clone, Debug)]
pub(crate) enum Source<const D: usize> {
    Shape {
        region: Region<D>,
        spacing: f64,
        count: Option<usize>,
        sampling: Sampling,
    },
    List(ParticleList<D>),
}

/// Who says what the particles' volume is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Volume {
    /// The shape, or the list.
    Source,
    /// The scene, for the body \[m³\].
    Body(f64),
    /// The scene, for a particle \[m³\].
    Particle(f64),
    /// The shape's, shared so that the grid is evenly filled; on a lattice it is.
    Even,
    /// The grid, at the start.
    Measured,
}

/// The pressure that a fluid body starts with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StartPressure {
    None,
    /// That of a body at rest under gravity.
    Hydrostatic,
    /// That, if the body is at rest.
    Automatic,
}

impl<const D: usize> Body<D> {
    /// Whether nothing of it moves at the start.
    fn is_still(&self) -> bool {
        let listed = match &self.source {
            Source::Shape { .. } => false,
            Source::List(list) => !list.velocity.is_empty() || !list.affine.is_empty(),
        };
        !listed
            && self.velocity.is_constant()
            && self.velocity.constants() == [0.0; D]
            && self.velocity_spread == [0.0; D]
            && self.gradient == [[0.0; D]; D]
    }

    /// A box around its particles \[m\].
    pub(crate) fn bounds(&self) -> Bounds<D> {
        match &self.source {
            Source::Shape { region, .. } => *region.bounds(),
            Source::List(list) => Bounds::around_points(&list.position),
        }
    }

    /// Particles; of shapes that are sampled on lattices about so many.
    pub(crate) fn expected_particles(&self) -> f64 {
        match &self.source {
            Source::Shape {
                count: Some(count), ..
            } => *count as f64,
            Source::Shape {
                region,
                spacing,
                sampling,
                ..
            } => expected_count(region, *spacing, *sampling),
            Source::List(list) => list.position.len() as f64,
        }
    }

    /// The largest speed at the start \[m/s\], or a bound on it.
    pub(super) fn speed(&self) -> f64 {
        let length = |v: &[f64; D]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
        let bounds = self.bounds();
        let half: [f64; D] = core::array::from_fn(|i| 0.5 * bounds.side(i));
        let turning: [f64; D] =
            core::array::from_fn(|i| (0..D).map(|j| self.gradient[i][j].abs() * half[j]).sum());
        // Places along an axis at which a formula is looked at.
        const PLACES: usize = 9;
        let own = if self.velocity.is_constant() {
            vec![self.velocity.constants()]
        } else {
            self.velocity.at(&lattice(&bounds, PLACES))
        };
        let own = own.iter().map(length).fold(0.0, f64::max);
        let listed = match &self.source {
            Source::List(list) => list.velocity.iter().map(length).fold(0.0, f64::max),
            Source::Shape { .. } => 0.0,
        };
        own + listed + length(&turning)
    }
}

impl<const D: usize> Plan<D> {
    pub(crate) fn read(
        scene: &Reader<'_>,
        limits: &Limits,
        files: &Files<'_>,
    ) -> Result<Self, SceneError> {
        let dx = scene.number("dx")?;
        let mut warnings = Vec::new();
        let (gravity, forces) = read_forces(scene, dx)?;
        let domain = scene
            .opt_table("domain")
            .map(|table| read_domain(scene, &table, dx))
            .transpose()?;
        let (clamp, cushion) = match scene.opt_table("domain") {
            Some(table) => read_keep(&table)?,
            None => (None, None),
        };
        let colliders = read_colliders(scene, dx, (files, limits), &mut warnings)?;
        let kernel = match scene.text("kernel")? {
            "linear" => Kernel::Linear,
            "cubic" => Kernel::Cubic,
            _ => Kernel::Quadratic,
        };
        let force = if scene.text("force")? == "classic" {
            ForceForm::Classic
        } else {
            ForceForm::Mls
        };
        if kernel == Kernel::Linear && force == ForceForm::Mls {
            let error = scene.error_at(
                "kernel",
                "the linear kernel has no MLS force: its inertia is singular at nodes",
            );
            return Err(error.hint("add force = \"classic\", or choose kernel = \"quadratic\""));
        }
        let transfer = read_transfer(scene)?;
        let time_step = read_time_step(scene)?;

        let mut materials = Vec::new();
        let mut stiffness = Vec::new();
        for (name, table) in scene.tables("materials") {
            let (material, given) = read_material::<D>(name, &table)?;
            materials.push(material);
            stiffness.push((given, table));
        }
        let mut bodies = Vec::new();
        for (index, (_, table)) in scene.tables("bodies").into_iter().enumerate() {
            let body = read_body(
                index,
                &table,
                &materials,
                domain.as_ref(),
                dx,
                (files, limits),
                &mut warnings,
            )?;
            if bodies.iter().any(|other: &Body<D>| other.name == body.name) {
                return Err(
                    table.error_at("name", format!("two bodies are called \"{}\"", body.name))
                );
            }
            bodies.push(body);
            check_count(&bodies, scene, &table, limits)?;
        }
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

    /// Whether a body of fluid starts with the pressure of its own weight.
    pub(crate) fn starts_hydrostatic(&self, body: &Body<D>, fluid: &Fluid) -> bool {
        match body.pressure {
            StartPressure::None => false,
            StartPressure::Hydrostatic => true,
            StartPressure::Automatic => {
                let corrected = matches!(fluid.volume, VolumeRule::Corrected(_));
                corrected && body.is_still() && self.stands_on_floor(body)
            }
        }
    }

    /// Whether a body touches the wall that it is drawn to most.
    fn stands_on_floor(&self, body: &Body<D>) -> bool {
        let Some(domain) = &self.domain else {
            return false;
        };
        let g = self.gravity;
        let axis = (0..D).fold(0, |most, axis| {
            if g[axis].abs() > g[most].abs() {
                axis
            } else {
                most
            }
        });
        let Sides::Walls { low, high } = domain.sides[axis] else {
            return false;
        };
        let bounds = body.bounds();
        // Half a cell: particles of a list are not on the wall themselves.
        let near = |gap: f64| gap.abs() <= 0.5 * self.dx;
        (g[axis] < 0.0 && low != Contact::Open && near(bounds.min[axis] - domain.min[axis]))
            || (g[axis] > 0.0 && high != Contact::Open && near(bounds.max[axis] - domain.max[axis]))
    }

    fn warn(&mut self) {
        let mut warnings = core::mem::take(&mut self.warnings);
        let speed = Falls::of(self).speed(self.gravity);
        for (index, material) in self.materials.iter().enumerate() {
            if !self.bodies.iter().any(|body| body.material == index) {
                warnings.push(format!(
                    "material \"{}\" is not used by any body",
                    material.name
                ));
                continue;
            }
            let c = material.sound_speed();
            if matches!(material.model, Model::Fluid(_)) && speed > 0.2 * c * (1.0 + 1e-9) {
                warnings.push(format!("speeds up to {speed:.3} m/s are expected, more than a fifth of the speed of sound {c:.3} m/s of \"{}\": it will be visibly compressed", material.name));
            }
            if let TimeStep::Fixed(dt) = self.time_step
                && dt * c > self.dx
            {
                warnings.push(format!("dt = {dt} s is longer than sound in \"{}\" takes to cross a cell ({:.3e} s): expect it to blow up", material.name, self.dx / c));
            }
        }
        for body in &self.bodies {
            let Source::Shape {
                region,
                spacing,
                count,
                ..
            } = &body.source
            else {
                continue;
            };
            let per_cell = match count {
                Some(count) => *count as f64 / region.volume() * self.dx.powi(D as i32),
                None => (self.dx / spacing).powi(D as i32),
            };
            let few = if D == 2 { 2.0 } else { 4.0 };
            if per_cell < few {
                warnings.push(format!("body \"{}\" has {per_cell:.2} particles a cell: below {few} it may fall apart into grains", body.name));
            }
            let thin = (0..D)
                .map(|i| region.bounds().side(i))
                .fold(f64::INFINITY, f64::min);
            if thin < 2.0 * self.dx {
                warnings.push(format!(
                    "body \"{}\" is {thin:.4} m thin, less than two cells: the grid hardly sees it",
                    body.name
                ));
            }
            if region.is_cut() {
                warnings.push(format!(
                    "body \"{}\" reaches out of the domain and is cut off there",
                    body.name
                ));
            }
        }
        self.warnings = warnings;
    }
}

/// Places that sampling may try for each particle that there is memory for.
const PLACES_A_PARTICLE: f64 = 8.0;

/// The bodies so far against the memory that may be used.
fn check_count<const D: usize>(
    bodies: &[Body<D>],
    scene: &Reader<'_>,
    table: &Reader<'_>,
    limits: &Limits,
) -> Result<(), SceneError> {
    let total: f64 = bodies.iter().map(Body::expected_particles).sum();
    // Cells that sampling has to look at: a thin slanted shape fills little of its bounds.
    let candidates: f64 = bodies
        .iter()
        .map(|body| match &body.source {
            Source::Shape {
                region, spacing, ..
            } => region.bounds().volume() / spacing.powi(D as i32),
            Source::List(_) => 0.0,
        })
        .sum();
    let most = (limits.memory as f64 / Limits::BYTES_PER_PARTICLE).min(f64::from(u32::MAX));
    if total <= most && candidates <= PLACES_A_PARTICLE * most {
        return Ok(());
    }
    let message = if total > most {
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
    // Whatever made them so many: the body's own word, or dx.
    let error = match ["count", "spacing", "particles_per_cell", "particles"]
        .into_iter()
        .find(|key| table.has(key))
    {
        Some(key) => table.error_at(key, message),
        None => scene.error_at("dx", message),
    };
    Err(error.hint("use a larger dx, fewer particles_per_cell or smaller bodies"))
}

/// A count as people read it.
fn count_words(count: f64) -> String {
    if count >= 1e7 {
        format!("{count:.1e}")
    } else {
        format!("{count:.0}")
    }
}

fn read_transfer(scene: &Reader<'_>) -> Result<Transfer, SceneError> {
    let transfer = scene.text("transfer")?;
    if transfer != "flip" && scene.has("flip_blend") {
        return Err(scene
            .error_at_key(
                "flip_blend",
                "\"flip_blend\" is for transfer = \"flip\" only",
            )
            .hint(format!("this scene has transfer = \"{transfer}\"")));
    }
    Ok(match transfer {
        "pic" => Transfer::Pic,
        "flip" => Transfer::Flip {
            blend: scene.opt_number("flip_blend").unwrap_or(0.99),
        },
        _ => Transfer::Apic,
    })
}

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

/// Nodes along an axis stay below this: block coordinates are 32-bit numbers.
const MOST_CELLS: f64 = 1e9;

fn read_domain<const D: usize>(
    scene: &Reader<'_>,
    table: &Reader<'_>,
    dx: f64,
) -> Result<Domain<D>, SceneError> {
    let (min, max): ([f64; D], [f64; D]) = (table.vector("min")?, table.vector("max")?);
    for i in 0..D {
        if !(max[i] > min[i]) {
            return Err(table.error_at(
                "max",
                format!(
                    "the domain has no extent along {}: max {} is not above min {}",
                    AXES[i], max[i], min[i]
                ),
            ));
        }
        let cells = (max[i] - min[i]) / dx;
        if cells > MOST_CELLS {
            return Err(scene
                .error_at(
                    "dx",
                    format!(
                        "the domain would have {} cells along {}",
                        count_words(cells),
                        AXES[i]
                    ),
                )
                .hint("use a larger dx or a smaller domain"));
        }
    }
    let sides: [f64; D] = core::array::from_fn(|i| max[i] - min[i]);
    if let Some(i) = (0..D).find(|&i| !is_whole(sides[i] / dx)) {
        let cells = sides[i] / dx;
        let error = scene.error_at("dx", format!("the domain is {} m along {}, which is {cells:.4} cells of dx = {dx}; it must be a whole number", tidy(sides[i]), AXES[i]));
        return Err(match fitting_dx(&sides, dx, |_| true) {
            Some(fit) => {
                let round = fitting_dx(&sides, dx, |fit| tidy(fit * 1e4).fract() == 0.0)
                    .filter(|round| *round != fit)
                    .map(|round| format!("; a round one is {round}"));
                error.hint(format!(
                    "the nearest dx that fits is {fit}{}",
                    round.unwrap_or_default()
                ))
            }
            None => {
                let whole = tidy(min[i] + (cells.round().max(1.0)) * dx);
                error.hint(format!(
                    "change dx, or the domain: max = {whole} along {} would fit",
                    AXES[i]
                ))
            }
        });
    }
    let (walls, style) = read_walls(table)?;
    Ok(Domain {
        min,
        max,
        sides: walls,
        style,
    })
}

/// What keeps particles in, besides walls.
type Keep<const D: usize> = (Option<Bounds<D>>, Option<Cushion<D>>);

fn read_keep<const D: usize>(domain: &Reader<'_>) -> Result<Keep<D>, SceneError> {
    let corners = |table: &Reader<'_>| -> Result<Bounds<D>, SceneError> {
        let (min, max): ([f64; D], [f64; D]) = (table.vector("min")?, table.vector("max")?);
        match (0..D).find(|&i| !(max[i] > min[i])) {
            None => Ok(Bounds { min, max }),
            Some(i) => {
                let message = format!(
                    "this box has no extent along {}: max {} is not above min {}",
                    AXES[i], max[i], min[i]
                );
                Err(table.error_at("max", message))
            }
        }
    };
    let clamp = domain.opt_table("clamp");
    let cushion = domain.opt_table("cushion").map(|table| {
        Ok(Cushion {
            inside: corners(&table)?,
            time: table.number("time")?,
        })
    });
    Ok((
        clamp.map(|table| corners(&table)).transpose()?,
        cushion.transpose()?,
    ))
}

pub(super) const AXES: [&str; 3] = ["x", "y", "z"];
const SIDES: [[&str; 2]; 3] = [["left", "right"], ["bottom", "top"], ["back", "front"]];

/// Whether a side is a whole number of cells, but for the rounding of decimal fractions.
fn is_whole(cells: f64) -> bool {
    cells > 0.5 && (cells - cells.round()).abs() <= 1e-6 * cells.max(1.0)
}

/// A length without the noise of subtraction.
fn tidy(length: f64) -> f64 {
    format!("{length:.12}").parse().unwrap_or(length)
}

/// The dx nearest to `dx` of which every side is a whole number, among those that are `wanted`.
fn fitting_dx(sides: &[f64], dx: f64, wanted: impl Fn(f64) -> bool) -> Option<f64> {
    let cells = (sides[0] / dx).round().max(1.0);
    let fits = |n: f64| {
        let fit = tidy(sides[0]) / n;
        (n >= 1.0 && wanted(fit) && sides.iter().all(|side| is_whole(side / fit))).then_some(fit)
    };
    let nearer = |a: f64, b: f64| {
        if (a - dx).abs() <= (b - dx).abs() {
            a
        } else {
            b
        }
    };
    let reach = (cells as u32).clamp(8, 10_000);
    let below = (0..reach).find_map(|k| fits(cells + f64::from(k)));
    let above = (1..reach).find_map(|k| fits(cells - f64::from(k)));
    match (below, above) {
        (Some(a), Some(b)) => Some(nearer(a, b)),
        (a, b) => a.or(b),
    }
}

fn read_walls<const D: usize>(domain: &Reader<'_>) -> Result<([Sides; D], WallStyle), SceneError> {
    if let Some(word) = domain.opt_text("walls") {
        let sides = if word == "periodic" {
            Sides::Periodic
        } else {
            let contact = contact_word(word);
            Sides::Walls {
                low: contact,
                high: contact,
            }
        };
        return Ok(([sides; D], WallStyle::Plane));
    }
    let Some(walls) = domain.opt_table("walls") else {
        return Err(domain.error("there are no walls"));
    };
    let other = read_contact(&walls, "contact")?.unwrap_or(Contact::Separate { friction: 0.0 });
    let mut sides = [Sides::Periodic; D];
    for i in 0..D {
        let [low, high] = SIDES[i];
        if walls.has(AXES[i]) {
            if let Some(side) = [low, high].into_iter().find(|side| walls.has(side)) {
                return Err(walls.error_at_key(
                    side,
                    format!("there is no wall at the {side}: {} is periodic", AXES[i]),
                ));
            }
            continue;
        }
        sides[i] = Sides::Walls {
            low: read_contact(&walls, low)?.unwrap_or(other),
            high: read_contact(&walls, high)?.unwrap_or(other),
        };
    }
    let style = if walls.text("style")? == "nodes" {
        WallStyle::Nodes {
            padding: walls.opt_integer("padding").unwrap_or(3) as u32,
        }
    } else if walls.has("padding") {
        return Err(walls.error_at_key("padding", "\"padding\" is for style = \"nodes\" only"));
    } else {
        WallStyle::Plane
    };
    Ok((sides, style))
}

fn contact_word(word: &str) -> Contact {
    match word {
        "sticky" => Contact::Sticky,
        "slip" => Contact::Slip { friction: 0.0 },
        "open" => Contact::Open,
        _ => Contact::Separate { friction: 0.0 },
    }
}

fn read_contact(walls: &Reader<'_>, side: &str) -> Result<Option<Contact>, SceneError> {
    if let Some(word) = walls.opt_text(side) {
        return Ok(Some(contact_word(word)));
    }
    let table = walls.opt_table(side);
    table.map(|table| contact_with_friction(&table)).transpose()
}

/// `contact` and `friction` of a wall or a collider.
pub(super) fn contact_with_friction(table: &Reader<'_>) -> Result<Contact, SceneError> {
    let mut contact = contact_word(table.text("contact")?);
    if let Some(given) = table.opt_number("friction") {
        match &mut contact {
            Contact::Slip { friction } | Contact::Separate { friction } => *friction = given,
            Contact::Sticky | Contact::Open => {
                return Err(table
                    .error_at_key("friction", "friction is for \"slip\" and \"separate\" only"));
            }
        }
    }
    Ok(contact)
}

fn read_material<const D: usize>(
    name: &str,
    table: &Reader<'_>,
) -> Result<(Material, Stiffness), SceneError> {
    let mut stiffness = Stiffness::Auto;
    let model = match table.text("model")? {
        "none" => Model::Dust(Dust),
        "fluid" => {
            let (fluid, given) = read_fluid(table)?;
            stiffness = given;
            Model::Fluid(fluid)
        }
        "corotated" => {
            let (lambda, mu) = read_moduli::<D>(table)?;
            Model::Corotated(Corotated { lambda, mu })
        }
        "neo_hookean" => {
            let (lambda, mu) = read_moduli::<D>(table)?;
            let logarithm_ends = table.number("logarithm_ends")?;
            if logarithm_ends == 0.0 {
                return Err(table.error_at("logarithm_ends", "\"logarithm_ends\" must be above 0"));
            }
            Model::NeoHookean(NeoHookean {
                lambda,
                mu,
                logarithm_ends,
            })
        }
        _ => Model::Snow(read_snow::<D>(table)?),
    };
    Ok((
        Material {
            name: name.to_owned(),
            density: table.number("density")?,
            model,
        },
        stiffness,
    ))
}

fn read_fluid(table: &Reader<'_>) -> Result<(Fluid, Stiffness), SceneError> {
    let eos = match table.text("eos")? {
        "linear_j" if table.has("gamma") => {
            return Err(table.error_at_key("gamma", "\"gamma\" is for eos = \"tait\" only"));
        }
        "linear_j" => Eos::LinearJ,
        _ => Eos::Tait {
            gamma: table.opt_number("gamma").unwrap_or(7.0),
        },
    };
    let stiffness = match (
        table.opt_number("sound_speed"),
        table.opt_number("bulk_modulus"),
    ) {
        _ if table.has("sound_speed") && table.has("bulk_modulus") => {
            return Err(table.error_at_key(
                "bulk_modulus",
                "\"sound_speed\" and \"bulk_modulus\" say the same; give one",
            ));
        }
        (Some(c), _) => Stiffness::SoundSpeed(c),
        (_, Some(bulk)) => Stiffness::Bulk(bulk),
        _ => Stiffness::Auto,
    };
    let fluid = Fluid {
        eos,
        bulk_modulus: 0.0,
        viscosity: table.number("viscosity")?,
        rheology: read_rheology(table)?,
        bulk_viscosity: table.number("bulk_viscosity")?,
        tension: table.opt_number("tension").unwrap_or(f64::INFINITY),
        jacobian_update: if table.text("jacobian_update")? == "det" {
            JacobianUpdate::Determinant
        } else {
            JacobianUpdate::Trace
        },
        volume: read_volume_rule(table)?,
        viscous_stress: if table.text("viscous_stress")? == "engineering" {
            ViscousStress::Engineering
        } else {
            ViscousStress::Newtonian
        },
    };
    Ok((fluid, stiffness))
}

fn read_rheology(table: &Reader<'_>) -> Result<Rheology, SceneError> {
    let [yield_stress, consistency, flow_index, creep_rate] =
        ["yield_stress", "consistency", "flow_index", "creep_rate"];
    if table.text("rheology")? == "newtonian" {
        let given = [yield_stress, consistency, flow_index, creep_rate]
            .into_iter()
            .find(|key| table.has(key));
        return match given {
            Some(key) => Err(table
                .error_at_key(
                    key,
                    format!("\"{key}\" is for rheology = \"herschel-bulkley\" only"),
                )
                .hint("add rheology = \"herschel-bulkley\" to the material")),
            None => Ok(Rheology::Newtonian),
        };
    }
    let law = HerschelBulkley {
        yield_stress: table.opt_number(yield_stress).unwrap_or(0.0),
        consistency: table.opt_number(consistency).unwrap_or(0.0),
        flow_index: table.opt_number(flow_index).unwrap_or(1.0),
        creep_rate: table.opt_number(creep_rate).unwrap_or(CREEP_RATE),
    };
    if law.yield_stress == 0.0 && law.consistency == 0.0 {
        let error = table.error_at_key(
            "rheology",
            "a Herschel-Bulkley fluid needs \"yield_stress\" or \"consistency\" or both",
        );
        return Err(error.hint("for mud, for instance, yield_stress = 25.0 and consistency = 0.07"));
    }
    Ok(Rheology::HerschelBulkley(law))
}

fn read_volume_rule(table: &Reader<'_>) -> Result<VolumeRule, SceneError> {
    let rates = ["volume_smoothing", "volume_correction"];
    let rule = match table.text("volume")? {
        "corrected" => {
            let usual = VolumeCorrection::default();
            return Ok(VolumeRule::Corrected(VolumeCorrection {
                smoothing: table.opt_number(rates[0]).unwrap_or(usual.smoothing),
                correction: table.opt_number(rates[1]).unwrap_or(usual.correction),
            }));
        }
        "gathered" => VolumeRule::Gathered,
        _ => VolumeRule::Jacobian,
    };
    match rates.into_iter().find(|key| table.has(key)) {
        Some(key) => {
            Err(table.error_at_key(key, format!("\"{key}\" is for volume = \"corrected\" only")))
        }
        None => Ok(rule),
    }
}

fn read_snow<const D: usize>(table: &Reader<'_>) -> Result<Snow, SceneError> {
    let (lambda, mu) = read_moduli::<D>(table)?;
    Ok(Snow {
        lambda,
        mu,
        critical_compression: table.number("critical_compression")?,
        critical_stretch: table.number("critical_stretch")?,
        hardening: table.number("hardening")?,
        hardening_range: table.vector("hardening_range")?,
        plastic_jacobian_range: table.vector("plastic_jacobian_range")?,
        hardening_from: if table.text("hardening_from")? == "previous" {
            HardeningFrom::Previous
        } else {
            HardeningFrom::Updated
        },
    })
}

/// (λ, μ) from whichever pair is given.
fn read_moduli<const D: usize>(table: &Reader<'_>) -> Result<(f64, f64), SceneError> {
    let given: Vec<&str> = MODULI
        .as_flattened()
        .iter()
        .copied()
        .filter(|key| table.has(key))
        .collect();
    let pairs = || MODULI.map(|[a, b]| format!("{a} and {b}")).join("; or ");
    let Some(pair) = MODULI
        .iter()
        .find(|pair| given.first().is_some_and(|key| pair.contains(key)))
    else {
        return Err(table
            .error("this material has no moduli")
            .hint(format!("give {}", pairs())));
    };
    if let Some(other) = given.iter().find(|key| !pair.contains(key)) {
        return Err(table
            .error_at_key(
                other,
                format!("\"{other}\" does not go with \"{}\"", given[0]),
            )
            .hint(format!("give {}", pairs())));
    }
    if let Some(missing) = pair.iter().find(|key| !table.has(key)) {
        return Err(table.error_at_key(
            given[0],
            format!("\"{}\" needs \"{missing}\" beside it", given[0]),
        ));
    }
    let (a, b) = (table.number(pair[0])?, table.number(pair[1])?);
    let d = D as f64;
    let (lambda, mu) = match pair[0] {
        "youngs_modulus" => lame(a, b),
        "bulk_modulus" => (a - 2.0 * b / d, b),
        _ => (a, b),
    };
    if lambda + 2.0 * mu / d <= 0.0 {
        return Err(table.error_at(
            pair[0],
            format!(
                "these moduli have a bulk modulus of {:.4e} Pa; it must be above 0",
                lambda + 2.0 * mu / d
            ),
        ));
    }
    Ok((lambda, mu))
}

fn read_body<const D: usize>(
    index: usize,
    table: &Reader<'_>,
    materials: &[Material],
    domain: Option<&Domain<D>>,
    dx: f64,
    (files, limits): (&Files<'_>, &Limits),
    warnings: &mut Vec<String>,
) -> Result<Body<D>, SceneError> {
    let name = table
        .opt_text("name")
        .map_or_else(|| format!("body-{index}"), str::to_owned);
    let wanted = table.text("material")?;
    let Some(material) = materials
        .iter()
        .position(|material| material.name == wanted)
    else {
        let names: Vec<&str> = materials
            .iter()
            .map(|material| material.name.as_str())
            .collect();
        let error = table.error_at(
            "material",
            format!("there is no material \"{}\"", super::shorten(wanted)),
        );
        return Err(match nearest(wanted, names.iter().copied()) {
            Some(near) => error.hint(format!("did you mean \"{near}\"?")),
            None => error.hint(format!("there are: {}", names.join(", "))),
        });
    };
    let is_fluid = matches!(materials[material].model, Model::Fluid(_));
    let volume = match (
        table.opt_number("volume"),
        table.opt_number("particle_volume"),
    ) {
        _ if table.has("volume") && table.has("particle_volume") => {
            return Err(table.error_at_key(
                "particle_volume",
                "\"volume\" and \"particle_volume\" say the same; give one",
            ));
        }
        (Some(volume), _) => Volume::Body(volume),
        (_, Some(volume)) => Volume::Particle(volume),
        _ => match table.opt_text("volume") {
            Some("measured") => Volume::Measured,
            Some("even") => Volume::Even,
            Some(_) => Volume::Source,
            None if is_fluid => Volume::Even,
            None => Volume::Source,
        },
    };
    let clip = domain.map_or(Bounds::EVERYTHING, |domain| Bounds {
        min: domain.min,
        max: domain.max,
    });
    let source = match (table.opt_table("shape"), table.opt_text("particles")) {
        (Some(_), Some(_)) => return Err(table.error_at_key("particles", "a body has a \"shape\" or \"particles\", not both")),
        (None, None) => return Err(table.error(format!("body \"{name}\" has no shape")).hint("add, for instance, shape = { box = { min = [0.0, 0.0], max = [1.0, 1.0] } }, or particles = \"start.csv\"")),
        (Some(shape), None) => read_shape_source(&name, table, &shape, (clip, dx), (files, limits))?,
        (None, Some(path)) => Source::List(read_list(table, path, volume, &clip, (files, limits), warnings)?),
    };
    Ok(Body {
        name,
        material,
        source,
        velocity: table.formulas("velocity", Of::Place)?,
        velocity_spread: table.opt_vector("velocity_spread").unwrap_or([0.0; D]),
        gradient: read_gradient(table)?,
        volume,
        pressure: match table.text("pressure")? {
            "none" => StartPressure::None,
            "hydrostatic" => StartPressure::Hydrostatic,
            _ => StartPressure::Automatic,
        },
    })
}

fn read_gradient<const D: usize>(table: &Reader<'_>) -> Result<[[f64; D]; D], SceneError> {
    let mut gradient = [[0.0; D]; D];
    if let Some(rows) = table.opt_rows::<D>("velocity_gradient") {
        for (row, given) in gradient.iter_mut().zip(rows) {
            *row = given;
        }
    }
    // ω × r as a matrix.
    let [x, y, z] = match table.opt_vector::<3>("spin") {
        Some(spin) => spin,
        None => [0.0, 0.0, table.number("spin")?],
    };
    let cross = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
    for i in 0..D {
        for j in 0..D {
            gradient[i][j] += cross[i][j];
        }
    }
    Ok(gradient)
}

pub(super) fn point(p: &[f64]) -> String {
    let parts: Vec<String> = p.iter().map(|x| tidy(*x).to_string()).collect();
    format!("({})", parts.join(", "))
}

/// Reads a particle list from one of NumPy's archives.
#[cfg(feature = "npz")]
fn read_archive<const D: usize>(
    file: &std::path::Path,
    limits: &Limits,
) -> Result<ParticleList<D>, SceneError> {
    crate::particle_list::read_npz(file, limits.memory)
}

/// Refuses NumPy's archives: this build has no reader of them.
#[cfg(not(feature = "npz"))]
fn read_archive<const D: usize>(
    file: &std::path::Path,
    _: &Limits,
) -> Result<ParticleList<D>, SceneError> {
    let name = file.display().to_string();
    Err(SceneError::of_file(
        name,
        "this build of lahar does not read .npz files; give a .csv or .ply file",
    ))
}

fn read_list<const D: usize>(
    table: &Reader<'_>,
    path: &str,
    volume: Volume,
    clip: &Bounds<D>,
    (files, limits): (&Files<'_>, &Limits),
    warnings: &mut Vec<String>,
) -> Result<ParticleList<D>, SceneError> {
    // What the command line names lies where the command is given.
    let here = table.is_override("particles");
    for key in ["particles_per_cell", "spacing", "count"] {
        if table.has(key) {
            return Err(table.error_at_key(
                key,
                format!("\"{key}\" is for shapes; a particle list has the particles it has"),
            ));
        }
    }
    let cannot = |reason: String| {
        let error = table.error_at(
            "particles",
            format!("cannot read \"{}\": {reason}", super::shorten(path)),
        );
        error.hint(if here {
            "with --set, particle lists are found from the current folder"
        } else {
            "particle lists are found from the scene's folder"
        })
    };
    let lower = path.to_ascii_lowercase();
    let mut list = if lower.ends_with(".csv") {
        let bytes = files.bytes(path, here, limits.memory).map_err(cannot)?;
        match core::str::from_utf8(&bytes) {
            Ok(text) => {
                let text = text.strip_prefix('\u{feff}').unwrap_or(text);
                crate::particle_list::parse_csv(text, path)?
            }
            Err(error) => return Err(super::not_text(path, &bytes, error.valid_up_to())),
        }
    } else if lower.ends_with(".ply") {
        let bytes = files.bytes(path, here, limits.memory).map_err(cannot)?;
        crate::ply::parse_ply(&bytes, path)?
    } else if lower.ends_with(".npz") {
        let file = files.path(path, here).map_err(cannot)?;
        read_archive(&file, limits)?
    } else {
        return Err(table.error_at("particles", "a particle list is a .csv, .npz or .ply file"));
    };
    if list.position.is_empty() {
        return Err(SceneError::of_file(
            path,
            "the particle list has no particles",
        ));
    }
    if let Some((row, p)) = list
        .position
        .iter()
        .enumerate()
        .find(|(_, p)| !clip.contains(p))
    {
        let outside = list.position.iter().filter(|p| !clip.contains(p)).count();
        let error = table.error_at("particles", format!("particle {row} (from 0) of \"{path}\" at {} lies outside the domain, {outside} of {} do", point(p), list.position.len()));
        return Err(error.hint(format!(
            "the domain reaches from {} to {}",
            point(&clip.min),
            point(&clip.max)
        )));
    }
    if matches!(volume, Volume::Source | Volume::Even | Volume::Measured)
        && list.volume.is_empty()
        && list.mass.is_empty()
    {
        return Err(table
            .error_at(
                "particles",
                format!("\"{path}\" has neither volume nor mass"),
            )
            .hint("add a column, or particle_volume = .. to the body"));
    }
    warnings.append(&mut list.warnings);
    Ok(list)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_dx_that_fits() {
        assert_eq!(fitting_dx(&[4.0, 2.0], 0.03, |_| true), Some(4.0 / 134.0));
        assert_eq!(fitting_dx(&[1.0, 0.75], 0.26, |_| true), Some(0.25));
        assert_eq!(
            fitting_dx(&[1.0, core::f64::consts::SQRT_2], 0.01, |_| true),
            None
        );
        assert!(
            is_whole(4.0 / 0.02) && is_whole(0.3 / 0.1) && !is_whole(4.0 / 0.03) && !is_whole(0.01)
        );
    }
}
