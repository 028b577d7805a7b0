//! Shapes of bodies, as scenes write them.

use super::Limits;
use super::files::Files;
use super::plan::{AXES, Source, point};
use super::read::Reader;
use crate::error::SceneError;
use lahar::geometry::sampling::Sampling;
use lahar::geometry::{Bounds, Motion, Region, Shape, area, crossing};
use std::sync::Arc;

/// Primitive shapes in one body at the most: each is asked about every particle.
const MOST_PARTS: usize = 10_000;

/// Shapes inside each other at the most.
const DEEPEST: usize = 32;

/// What a shape is.
const KINDS: [&str; 10] = [
    "box",
    "ball",
    "half_space",
    "polygon",
    "cylinder",
    "capsule",
    "mesh",
    "union",
    "difference",
    "intersection",
];

pub(super) fn read_shape_source<const D: usize>(
    name: &str,
    body: &Reader<'_>,
    table: &Reader<'_>,
    (clip, dx): (Bounds<D>, f64),
    (files, limits): (&Files<'_>, &Limits),
) -> Result<Source<D>, SceneError> {
    let sampling = match body.text("sampling")? {
        "lattice" => Sampling::Lattice,
        "random" => Sampling::Random,
        "poisson" => Sampling::Poisson,
        _ => Sampling::Jittered,
    };
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
    let shape = read_shape(table, (files, limits), 0)?;
    if shape.parts() > MOST_PARTS {
        let message = format!("this shape has {} parts", shape.parts());
        return Err(body
            .error_at("shape", message)
            .hint(format!("at most {MOST_PARTS} are possible")));
    }
    let reach = shape.bounds().intersection(&clip);
    if !(0..D).all(|i| reach.min[i].is_finite() && reach.max[i].is_finite()) {
        return Err(body
            .error_at("shape", format!("body \"{name}\" has no end"))
            .hint(
                "a half-space needs a [domain] to end at, or an intersection with another shape",
            ));
    }
    let region = Region::new(shape, clip);
    if !(region.volume() > 0.0) {
        let bounds = region.shape().bounds();
        let apart = (0..D).any(|i| bounds.max[i] < clip.min[i] || bounds.min[i] > clip.max[i]);
        if !apart && !matches!(region.shape(), Shape::HalfSpace { .. }) {
            return Err(body
                .error_at("shape", format!("body \"{name}\" has no volume"))
                .hint("nothing is left of its shape, or it is flat"));
        }
        let error = body.error_at("shape", format!("body \"{name}\" lies outside the domain"));
        return Err(match region.shape() {
            Shape::HalfSpace { .. } => {
                error.hint("move the point, or turn the normal round: it points out of the body")
            }
            _ => error.hint(format!(
                "it reaches from {} to {}, the domain from {} to {}",
                point(&bounds.min),
                point(&bounds.max),
                point(&clip.min),
                point(&clip.max)
            )),
        });
    }
    let cells = region.volume() / dx.powi(D as i32);
    let count = body.opt_integer("count").map(|count| count as usize);
    if count.is_some() && !matches!(sampling, Sampling::Random | Sampling::Poisson) {
        return Err(body.error_at_key(
            "count",
            format!(
                "\"count\" is for sampling = \"random\" or \"poisson\", this body has \"{}\"",
                sampling.name()
            ),
        ));
    }
    let per_cell = match (count, body.opt_number("particles_per_cell")) {
        (Some(count), _) => count as f64 / cells,
        (None, Some(per_cell)) => per_cell,
        (None, None) => f64::from(1 << D),
    };
    let spacing = body
        .opt_number("spacing")
        .unwrap_or(dx / per_cell.powf(1.0 / D as f64));
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

/// A shape, `depth` shapes inside others.
pub(super) fn read_shape<const D: usize>(
    table: &Reader<'_>,
    files: (&Files<'_>, &Limits),
    depth: usize,
) -> Result<Shape<D>, SceneError> {
    if depth > DEEPEST {
        return Err(table.error(format!("shapes are nested more than {DEEPEST} deep")));
    }
    let kinds: Vec<&str> = KINDS.into_iter().filter(|kind| table.has(kind)).collect();
    let kind = match kinds[..] {
        [kind] => kind,
        [] => {
            return Err(table
                .error("this shape is empty")
                .hint(format!("give one of: {}", KINDS.join(", "))));
        }
        [first, second, ..] => {
            return Err(table
                .error_at_key(second, format!("this shape is a \"{first}\" already"))
                .hint("make a second body of it, or a union: union = [{ .. }, { .. }]"));
        }
    };
    let shape = match kind {
        "union" | "difference" | "intersection" => {
            let shapes = table
                .tables(kind)
                .into_iter()
                .map(|(_, part)| read_shape(&part, files, depth + 1))
                .collect::<Result<Vec<_>, _>>()?;
            match kind {
                "union" => Shape::Union(shapes),
                "difference" => Shape::Difference(shapes),
                _ => Shape::Intersection(shapes),
            }
        }
        "mesh" => read_mesh(table, files)?,
        _ => match table.opt_table(kind) {
            Some(inner) => read_primitive(table, kind, &inner)?,
            None => return Err(table.error_at(kind, format!("\"{kind}\" must be a table"))),
        },
    };
    let shape = read_motion(table, shape)?;
    read_copies(table, shape)
}

/// A shape that is not made of others.
fn read_primitive<const D: usize>(
    table: &Reader<'_>,
    kind: &str,
    inner: &Reader<'_>,
) -> Result<Shape<D>, SceneError> {
    match kind {
        "box" => {
            let (min, max): ([f64; D], [f64; D]) = (inner.vector("min")?, inner.vector("max")?);
            if let Some(i) = (0..D).find(|&i| !(max[i] > min[i])) {
                return Err(inner.error_at(
                    "max",
                    format!(
                        "the box has no extent along {}: max {} is not above min {}",
                        AXES[i], max[i], min[i]
                    ),
                ));
            }
            Ok(Shape::Box { min, max })
        }
        "ball" => Ok(Shape::Ball {
            center: inner.vector("center")?,
            radius: inner.number("radius")?,
        }),
        "half_space" => {
            let normal: [f64; D] = inner.vector("normal")?;
            let length = normal.iter().map(|n| n * n).sum::<f64>().sqrt();
            if !(length > 0.0 && length.is_finite()) {
                return Err(inner.error_at("normal", "the normal has no direction"));
            }
            Ok(Shape::HalfSpace {
                point: inner.vector("point")?,
                normal: normal.map(|n| n / length),
            })
        }
        "polygon" => {
            if D == 3 {
                return Err(table
                    .error_at_key("polygon", "polygons are for 2D only")
                    .hint("this scene has dimension = 3"));
            }
            let points = inner.opt_rows::<D>("points").unwrap_or_default();
            /// Corners up to which sides are tested against each other.
            const TESTED: usize = 4000;
            if points.len() <= TESTED
                && let Some((i, j)) = crossing(&points)
            {
                return Err(inner.error_at("points", format!("the polygon crosses itself: the sides from point {i} and from point {j} (from 0)")));
            }
            let bounds = Shape::Polygon {
                points: points.clone(),
            }
            .bounds();
            if points.len() < 3 || !(area(&points).abs() > 1e-12 * bounds.volume()) {
                return Err(inner.error_at(
                    "points",
                    format!("a polygon of {} points in a line has no area", points.len()),
                ));
            }
            Ok(Shape::Polygon { points })
        }
        "cylinder" | "capsule" => {
            let round = kind == "capsule";
            if D == 2 && !round {
                return Err(table
                    .error_at_key("cylinder", "cylinders are for 3D only")
                    .hint("this scene has dimension = 2; a capsule is a strip with round ends, a box can be turned by rotate"));
            }
            let (from, to): ([f64; D], [f64; D]) = (inner.vector("from")?, inner.vector("to")?);
            if from == to && !round {
                return Err(inner.error_at("to", "the cylinder has no length"));
            }
            Ok(Shape::Rod {
                from,
                to,
                radius: inner.number("radius")?,
                round,
            })
        }
        other => Err(table.error_at(other, format!("\"{other}\" is no shape"))),
    }
}

/// The inside of a mesh file.
fn read_mesh<const D: usize>(
    table: &Reader<'_>,
    (files, limits): (&Files<'_>, &Limits),
) -> Result<Shape<D>, SceneError> {
    if D == 2 {
        return Err(table
            .error_at_key("mesh", "meshes are for 3D only")
            .hint("this scene has dimension = 2; a polygon can have any outline"));
    }
    let keys = table.opt_table("mesh");
    let path = match &keys {
        Some(keys) => keys.text("file")?,
        None => table.text("mesh")?,
    };
    let bytes = files
        .bytes(path, false, limits.memory / 8)
        .map_err(|reason| {
            let message = format!("cannot read \"{}\": {reason}", super::shorten(path));
            let error = match &keys {
                Some(keys) => keys.error_at("file", message),
                None => table.error_at("mesh", message),
            };
            error.hint("meshes are found from the scene's folder")
        })?;
    let mesh = Shape::Mesh(Arc::new(crate::mesh_file::parse_mesh(&bytes, path)?));
    let Some(keys) = keys else {
        return Ok(mesh);
    };
    // z up is turned to y up, then the mesh is brought to its size and place.
    let turn = if keys.text("up")? == "z" {
        [-90.0, 0.0, 0.0]
    } else {
        [0.0; 3]
    };
    let turned = mesh.moved(Motion::new(
        [1.0; D],
        turn.map(f64::to_radians),
        [0.0; D],
        [0.0; D],
    ));
    let bounds = turned.bounds();
    let longest = (0..D).map(|i| bounds.side(i)).fold(0.0, f64::max);
    let factor = keys.opt_number("size").map_or(1.0, |size| size / longest);
    let middle = bounds.middle();
    let by = keys.opt_vector::<D>("center").map_or([0.0; D], |center| {
        core::array::from_fn(|i| center[i] - middle[i])
    });
    let about = if keys.has("center") { middle } else { [0.0; D] };
    Ok(turned.moved(Motion::new([factor; D], [0.0; 3], about, by)))
}

/// `scale`, `rotate` and `translate`, in this order.
fn read_motion<const D: usize>(
    table: &Reader<'_>,
    shape: Shape<D>,
) -> Result<Shape<D>, SceneError> {
    if !["scale", "rotate", "translate"]
        .iter()
        .any(|key| table.has(key))
    {
        if table.has("about") {
            return Err(table
                .error_at_key(
                    "about",
                    "there is nothing to turn or scale \"about\" a point",
                )
                .hint("add rotate or scale"));
        }
        return Ok(shape);
    }
    let scale = match (table.opt_number("scale"), table.opt_vector::<D>("scale")) {
        (Some(factor), _) => [factor; D],
        (None, Some(factors)) => factors,
        (None, None) => [1.0; D],
    };
    if scale.iter().any(|factor| !(*factor > 0.0)) {
        return Err(table.error_at("scale", "factors must be above 0"));
    }
    let turn = match table.opt_vector::<3>("rotate") {
        Some(turn) => turn,
        None => [0.0, 0.0, table.opt_number("rotate").unwrap_or(0.0)],
    };
    let about = table
        .opt_vector("about")
        .unwrap_or_else(|| shape.bounds().middle());
    let by = table.opt_vector("translate").unwrap_or([0.0; D]);
    let turn = turn.map(f64::to_radians);
    Ok(shape.moved(Motion::new(scale, turn, about, by)))
}

/// `copies` in rows along the axes.
fn read_copies<const D: usize>(
    table: &Reader<'_>,
    shape: Shape<D>,
) -> Result<Shape<D>, SceneError> {
    let Some(copies) = table.opt_table("copies") else {
        return Ok(shape);
    };
    let count: [f64; D] = copies.vector("count")?;
    let step: [f64; D] = copies.vector("step")?;
    if count.iter().any(|n| n.fract() != 0.0 || *n < 1.0) {
        return Err(copies.error_at("count", "copies are counted by whole numbers above 0"));
    }
    let total: f64 = count.iter().product();
    if total * shape.parts() as f64 > MOST_PARTS as f64 {
        return Err(copies
            .error_at("count", format!("these are {total} copies"))
            .hint(format!(
                "at most {MOST_PARTS} parts are possible in a shape"
            )));
    }
    if let Some(i) = (0..D).find(|&i| count[i] > 1.0 && step[i] == 0.0) {
        return Err(copies.error_at(
            "step",
            format!("copies along {} need a step there", AXES[i]),
        ));
    }
    let mut all = Vec::new();
    for number in 0..total as usize {
        let mut rest = number;
        let by = core::array::from_fn(|i| {
            let place = rest % count[i] as usize;
            rest /= count[i] as usize;
            place as f64 * step[i]
        });
        all.push(shape.clone().moved(Motion::shift(by)));
    }
    Ok(Shape::Union(all))
}
