//! Reads bodies: their shape or particle list, their material and their motion at the start.

use super::choices::{SAMPLINGS, START_PRESSURES, VOLUMES};
use super::files::Files;
use super::formula::Variables;
use super::plan::{Body, Source, Volume};
use super::read::Reader;
use super::shapes::{LARGEST_PART_COUNT, read_shape};
use crate::error::{SceneError, nearest};
use crate::particle_list::{self, ParticleList, known_variables};
use crate::text::{not_text, point, shorten};
use lahar::geometry::sampling::Sampling;
use lahar::geometry::{Bounds, Primitive, Region, Shape};
use lahar::{Material, Model};

/// The surroundings that all bodies of a scene share.
pub(super) struct BodyContext<'a, const D: usize> {
    pub(super) materials: &'a [Material],
    /// The domain, or all of space: bodies are cut off there.
    pub(super) clip: Bounds<D>,
    pub(super) dx: f64,
    pub(super) files: &'a Files<'a>,
}

/// Reads body number `index`.
pub(super) fn read_body<const D: usize>(
    index: usize,
    table: &Reader<'_>,
    context: &BodyContext<'_, D>,
    warnings: &mut Vec<String>,
) -> Result<Body<D>, SceneError> {
    let name = table
        .opt_text("name")
        .map_or_else(|| format!("body-{index}"), str::to_owned);
    let material = find_material(table, context.materials)?;
    let is_fluid = matches!(context.materials[material].model, Model::Fluid(_));
    let volume = read_volume(table, is_fluid)?;
    let source = match (table.opt_table("shape"), table.opt_text("particles")) {
        (Some(shape), None) => read_shape_source(&name, table, &shape, context)?,
        (None, Some(path)) => {
            let mut list = read_list(table, path, volume, context, warnings)?;
            keep_variables(&mut list, path, &context.materials[material], warnings);
            Source::List(list)
        }
        (Some(_), Some(_)) => {
            return Err(table.error_at_key(
                "particles",
                "a body has a \"shape\" or \"particles\", not both",
            ));
        }
        (None, None) => {
            return Err(table.error(format!("body \"{name}\" has no shape")).hint("add, for instance, shape = { box = { min = [0.0, 0.0], max = [1.0, 1.0] } }, or particles = \"start.csv\""));
        }
    };
    Ok(Body {
        name,
        material,
        source,
        velocity: table.formulas("velocity", Variables::Place)?,
        velocity_spread: table.opt_vector("velocity_spread").unwrap_or([0.0; D]),
        gradient: read_velocity_gradient(table)?,
        volume,
        pressure: table.choice("pressure", &START_PRESSURES)?,
    })
}

/// Returns the index of the material that a body names.
fn find_material(table: &Reader<'_>, materials: &[Material]) -> Result<usize, SceneError> {
    let wanted = table.text("material")?;
    let names: Vec<&str> = materials.iter().map(|material| &*material.name).collect();
    if let Some(index) = names.iter().position(|name| *name == wanted) {
        return Ok(index);
    }
    let message = format!("there is no material \"{}\"", shorten(wanted));
    let error = table.error_at("material", message);
    Err(match nearest(wanted, names.iter().copied()) {
        Some(near) => error.hint(format!("did you mean \"{near}\"?")),
        None => error.hint(format!("there are: {}", names.join(", "))),
    })
}

/// Reads the keys `volume` and `particle_volume`.
fn read_volume(table: &Reader<'_>, is_fluid: bool) -> Result<Volume, SceneError> {
    if table.has("volume") && table.has("particle_volume") {
        return Err(table.error_at_key(
            "particle_volume",
            "\"volume\" and \"particle_volume\" say the same; give one",
        ));
    }
    if let Some(volume) = table.opt_number("volume") {
        return Ok(Volume::Body(volume));
    }
    if let Some(volume) = table.opt_number("particle_volume") {
        return Ok(Volume::Particle(volume));
    }
    if table.has("volume") {
        return table.choice("volume", &VOLUMES);
    }
    Ok(if is_fluid {
        Volume::Even
    } else {
        Volume::Source
    })
}

/// Reads `spin` and `velocity_gradient`: ∂v_i/∂x_j of both together \[1/s\].
fn read_velocity_gradient<const D: usize>(table: &Reader<'_>) -> Result<[[f64; D]; D], SceneError> {
    let mut gradient = [[0.0; D]; D];
    if let Some(rows) = table.opt_rows::<D>("velocity_gradient") {
        for (row, given) in gradient.iter_mut().zip(rows) {
            *row = given;
        }
    }
    let [x, y, z] = match table.opt_vector::<3>("spin") {
        Some(spin) => spin,
        None => [0.0, 0.0, table.number("spin")?],
    };
    // ω × r as a matrix.
    let cross = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
    for i in 0..D {
        for j in 0..D {
            gradient[i][j] += cross[i][j];
        }
    }
    Ok(gradient)
}

/// Reads the shape of a body, and how it is filled with particles.
fn read_shape_source<const D: usize>(
    name: &str,
    body: &Reader<'_>,
    table: &Reader<'_>,
    context: &BodyContext<'_, D>,
) -> Result<Source<D>, SceneError> {
    let sampling = body.choice("sampling", &SAMPLINGS)?;
    let amounts: Vec<&str> = ["particles_per_cell", "spacing", "count"]
        .into_iter()
        .filter(|key| body.has(key))
        .collect();
    if let [first, second, ..] = amounts[..] {
        return Err(body.error_at_key(
            second,
            format!("\"{first}\" and \"{second}\" say the same; give one"),
        ));
    }
    let shape = read_shape(table, context.files, 0)?;
    let region = region_of(name, body, shape, &context.clip)?;
    let count = body.opt_integer("count").map(|count| count as usize);
    if count.is_some() && !matches!(sampling, Sampling::Random | Sampling::Poisson) {
        return Err(body.error_at_key(
            "count",
            format!(
                "\"count\" is for sampling = \"random\" or \"poisson\", this body has \"{}\"",
                body.text("sampling")?
            ),
        ));
    }
    let cells = region.volume() / context.dx.powi(D as i32);
    let per_cell = match (count, body.opt_number("particles_per_cell")) {
        (Some(count), _) => count as f64 / cells,
        (None, Some(per_cell)) => per_cell,
        (None, None) => f64::from(1 << D),
    };
    let spacing = body
        .opt_number("spacing")
        .unwrap_or(context.dx / per_cell.powf(1.0 / D as f64));
    if region.volume() / spacing.powi(D as i32) < 0.5 {
        let key = amounts.first().copied().unwrap_or("shape");
        let error = body.error_at(
            key,
            format!(
                "body \"{name}\" comes to no particle: its volume is {:.3e}, a particle's {:.3e}",
                region.volume(),
                spacing.powi(D as i32)
            ),
        );
        return Err(error.hint("make the body larger, or dx or spacing smaller"));
    }
    Ok(Source::Shape {
        region,
        spacing,
        count,
        sampling,
    })
}

/// Cuts the shape of a body off at the domain, and checks that a finite part is left.
fn region_of<const D: usize>(
    name: &str,
    body: &Reader<'_>,
    shape: Shape<D>,
    clip: &Bounds<D>,
) -> Result<Region<D>, SceneError> {
    if shape.part_count() > LARGEST_PART_COUNT {
        let message = format!("this shape has {} parts", shape.part_count());
        return Err(body
            .error_at("shape", message)
            .hint(format!("at most {LARGEST_PART_COUNT} are possible")));
    }
    if !shape.bounds().intersection(clip).is_finite() {
        return Err(body
            .error_at("shape", format!("body \"{name}\" has no end"))
            .hint(
                "a half-space needs a [domain] to end at, or an intersection with another shape",
            ));
    }
    let region = Region::new(shape, *clip);
    if region.volume() > 0.0 {
        return Ok(region);
    }
    let bounds = region.shape().bounds();
    let apart = (0..D).any(|i| bounds.max[i] < clip.min[i] || bounds.min[i] > clip.max[i]);
    let is_half_space = matches!(
        region.shape(),
        Shape::Primitive(Primitive::HalfSpace { .. })
    );
    if !apart && !is_half_space {
        return Err(body
            .error_at("shape", format!("body \"{name}\" has no volume"))
            .hint("nothing is left of its shape, or it is flat"));
    }
    let error = body.error_at("shape", format!("body \"{name}\" lies outside the domain"));
    Err(if is_half_space {
        error.hint("move the point, or turn the normal round: it points out of the body")
    } else {
        error.hint(format!(
            "it reaches from {} to {}, the domain from {} to {}",
            point(&bounds.min),
            point(&bounds.max),
            point(&clip.min),
            point(&clip.max)
        ))
    })
}

/// Reads the particle list that a body names, and checks it against the scene.
fn read_list<const D: usize>(
    table: &Reader<'_>,
    path: &str,
    volume: Volume,
    context: &BodyContext<'_, D>,
    warnings: &mut Vec<String>,
) -> Result<ParticleList<D>, SceneError> {
    for key in ["particles_per_cell", "spacing", "count"] {
        if table.has(key) {
            return Err(table.error_at_key(
                key,
                format!("\"{key}\" is for shapes; a particle list has the particles it has"),
            ));
        }
    }
    let mut list: ParticleList<D> = read_list_file(table, path, context.files)?;
    if list.position.is_empty() {
        return Err(SceneError::of_file(
            path,
            "the particle list has no particles",
        ));
    }
    let clip = &context.clip;
    let mut outside = list.position.iter().enumerate();
    let mut outside = outside.by_ref().filter(|(_, p)| !clip.contains(p));
    if let Some((row, p)) = outside.next() {
        let count = 1 + outside.count();
        let error = table.error_at("particles", format!("particle {row} (from 0) of \"{path}\" at {} lies outside the domain, {count} of {} do", point(p), list.position.len()));
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

/// Keeps the variables that the model of `material` has, and warns of others that are not at rest.
fn keep_variables<const D: usize>(
    list: &mut ParticleList<D>,
    path: &str,
    material: &Material,
    warnings: &mut Vec<String>,
) {
    list.variables.retain(|given| {
        let of_model = (material.model.variables().iter()).any(|known| known.name == given.name);
        let at_rest = known_variables()
            .find(|known| known.name == given.name)
            .is_some_and(|known| known.is_at_rest(&given.values, D));
        if !of_model && !at_rest {
            warnings.push(format!(
                "{} of \"{path}\" is left out: the model \"{}\" of \"{}\" has no such variable",
                given.name,
                material.model.name(),
                material.name
            ));
        }
        of_model
    });
}

/// Reads a particle list by the ending of its name.
fn read_list_file<const D: usize>(
    table: &Reader<'_>,
    path: &str,
    files: &Files<'_>,
) -> Result<ParticleList<D>, SceneError> {
    // A name from the command line is relative to the working folder.
    let here = table.is_override("particles");
    let cannot = |reason: String| {
        let message = format!("cannot read \"{}\": {reason}", shorten(path));
        table.error_at("particles", message).hint(if here {
            "with --set, particle lists are found from the current folder"
        } else {
            "particle lists are found from the scene's folder"
        })
    };
    let limit = files.limits().memory;
    let lower = path.to_ascii_lowercase();
    if lower.ends_with(".csv") {
        let bytes = files.bytes(path, here, limit).map_err(cannot)?;
        let text = core::str::from_utf8(&bytes)
            .map_err(|error| not_text(path, &bytes, error.valid_up_to()))?;
        particle_list::parse_csv(text.strip_prefix('\u{feff}').unwrap_or(text), path)
    } else if lower.ends_with(".ply") {
        let bytes = files.bytes(path, here, limit).map_err(cannot)?;
        crate::ply::parse_ply(&bytes, path)
    } else if lower.ends_with(".npz") {
        #[cfg(feature = "npz")]
        {
            let file = files.open(path, here).map_err(cannot)?;
            particle_list::read_npz(&file.name, file.content, limit)
        }
        #[cfg(not(feature = "npz"))]
        Err(SceneError::of_file(
            path,
            "this build of lahar does not read .npz files; give a .csv or .ply file",
        ))
    } else {
        Err(table.error_at("particles", "a particle list is a .csv, .npz or .ply file"))
    }
}
