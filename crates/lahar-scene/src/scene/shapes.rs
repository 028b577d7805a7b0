//! Reads shapes of bodies and colliders.

use super::choices::UP_AXES;
use super::files::Files;
use super::read::Reader;
use crate::error::SceneError;
use crate::text::{AXES, shorten};
use lahar::geometry::{Bounds, Primitive, Shape, Transform, crossing_sides, polygon_area};
use std::sync::Arc;

/// Parts of one shape at most: each is tested for every particle.
pub(super) const LARGEST_PART_COUNT: usize = 10_000;

/// Levels of shapes inside shapes at most.
const DEEPEST: usize = 32;

/// Corners of a polygon up to which its sides are tested against each other.
const LARGEST_TESTED_POLYGON: usize = 4000;

/// Reads the shape in the table `shape`, the key `kind` of it being there, `depth` shapes inside others.
type ReadKind<const D: usize> =
    fn(shape: &Reader<'_>, kind: &str, &Files<'_>, depth: usize) -> Result<Shape<D>, SceneError>;

/// The keys that say what kind of shape a table is, in the order of the documentation.
fn kinds<const D: usize>() -> [(&'static str, ReadKind<D>); 10] {
    [
        ("box", |shape, kind, _, _| read_box(&inner(shape, kind)?)),
        ("ball", |shape, kind, _, _| read_ball(&inner(shape, kind)?)),
        ("half_space", |shape, kind, _, _| {
            read_half_space(&inner(shape, kind)?)
        }),
        ("polygon", |shape, kind, _, _| {
            read_polygon(shape, &inner(shape, kind)?)
        }),
        ("cylinder", |shape, kind, _, _| {
            read_cylinder(shape, &inner(shape, kind)?)
        }),
        ("capsule", |shape, kind, _, _| {
            read_rod(&inner(shape, kind)?, true)
        }),
        ("mesh", |shape, _, files, _| read_mesh(shape, files)),
        ("union", |shape, kind, files, depth| {
            Ok(Shape::Union(read_parts(shape, kind, files, depth)?))
        }),
        ("difference", |shape, kind, files, depth| {
            Ok(Shape::Difference(read_parts(shape, kind, files, depth)?))
        }),
        ("intersection", |shape, kind, files, depth| {
            Ok(Shape::Intersection(read_parts(shape, kind, files, depth)?))
        }),
    ]
}

/// Reads a shape, with its transform and copies.
pub(super) fn read_shape<const D: usize>(
    table: &Reader<'_>,
    files: &Files<'_>,
    depth: usize,
) -> Result<Shape<D>, SceneError> {
    if depth > DEEPEST {
        return Err(table.error(format!("shapes are nested more than {DEEPEST} deep")));
    }
    let kinds = kinds::<D>();
    let given: Vec<_> = kinds.iter().filter(|(kind, _)| table.has(kind)).collect();
    let (kind, read) = match given[..] {
        [kind] => kind,
        [] => {
            return Err(table.error("this shape is empty").hint(format!(
                "give one of: {}",
                kinds.map(|(kind, _)| kind).join(", ")
            )));
        }
        [(first, _), (second, _), ..] => {
            return Err(table
                .error_at_key(second, format!("this shape is a \"{first}\" already"))
                .hint("make a second body of it, or a union: union = [{ .. }, { .. }]"));
        }
    };
    let shape = read(table, kind, files, depth)?;
    let shape = read_transform(table, shape)?;
    read_copies(table, shape)
}

/// Returns the table that describes a shape of this kind.
fn inner<'a>(shape: &Reader<'a>, kind: &str) -> Result<Reader<'a>, SceneError> {
    shape
        .opt_table(kind)
        .ok_or_else(|| shape.error_at(kind, format!("\"{kind}\" must be a table")))
}

/// Reads the shapes that a set operation combines.
fn read_parts<const D: usize>(
    shape: &Reader<'_>,
    kind: &str,
    files: &Files<'_>,
    depth: usize,
) -> Result<Vec<Shape<D>>, SceneError> {
    shape
        .tables(kind)
        .into_iter()
        .map(|(_, part)| read_shape(&part, files, depth + 1))
        .collect()
}

fn read_box<const D: usize>(table: &Reader<'_>) -> Result<Shape<D>, SceneError> {
    let (min, max): ([f64; D], [f64; D]) = (table.vector("min")?, table.vector("max")?);
    if let Some(i) = (0..D).find(|&i| !(max[i] > min[i])) {
        return Err(table.error_at(
            "max",
            format!(
                "the box has no extent along {}: max {} is not above min {}",
                AXES[i], max[i], min[i]
            ),
        ));
    }
    Ok(Shape::Box { min, max })
}

fn read_ball<const D: usize>(table: &Reader<'_>) -> Result<Shape<D>, SceneError> {
    Ok(Primitive::Ball {
        center: table.vector("center")?,
        radius: table.number("radius")?,
    }
    .into())
}

fn read_half_space<const D: usize>(table: &Reader<'_>) -> Result<Shape<D>, SceneError> {
    let normal: [f64; D] = table.vector("normal")?;
    let length = normal.iter().map(|n| n * n).sum::<f64>().sqrt();
    if !(length > 0.0 && length.is_finite()) {
        return Err(table.error_at("normal", "the normal has no direction"));
    }
    Ok(Primitive::HalfSpace {
        point: table.vector("point")?,
        normal: normal.map(|n| n / length),
    }
    .into())
}

fn read_polygon<const D: usize>(
    shape: &Reader<'_>,
    table: &Reader<'_>,
) -> Result<Shape<D>, SceneError> {
    if D == 3 {
        return Err(shape
            .error_at_key("polygon", "polygons are for 2D only")
            .hint("this scene has dimension = 3"));
    }
    let points = table.opt_rows::<D>("points").unwrap_or_default();
    if points.len() <= LARGEST_TESTED_POLYGON
        && let Some((i, j)) = crossing_sides(&points)
    {
        return Err(table.error_at(
            "points",
            format!(
                "the polygon crosses itself: the sides from point {i} and from point {j} (from 0)"
            ),
        ));
    }
    let bounds = Bounds::around_points(&points);
    if points.len() < 3 || !(polygon_area(&points).abs() > 1e-12 * bounds.volume()) {
        return Err(table.error_at(
            "points",
            format!("a polygon of {} points in a line has no area", points.len()),
        ));
    }
    Ok(Primitive::Polygon { points }.into())
}

fn read_cylinder<const D: usize>(
    shape: &Reader<'_>,
    table: &Reader<'_>,
) -> Result<Shape<D>, SceneError> {
    if D == 2 {
        return Err(shape
            .error_at_key("cylinder", "cylinders are for 3D only")
            .hint("this scene has dimension = 2; a capsule is a strip with round ends, a box can be turned by rotate"));
    }
    read_rod(table, false)
}

/// Reads a capsule (`round`) or a cylinder.
fn read_rod<const D: usize>(table: &Reader<'_>, round: bool) -> Result<Shape<D>, SceneError> {
    let (from, to): ([f64; D], [f64; D]) = (table.vector("from")?, table.vector("to")?);
    if from == to && !round {
        return Err(table.error_at("to", "the cylinder has no length"));
    }
    Ok(Primitive::Rod {
        from,
        to,
        radius: table.number("radius")?,
        round,
    }
    .into())
}

/// Reads a mesh file, and brings the mesh to its size and place.
fn read_mesh<const D: usize>(
    shape: &Reader<'_>,
    files: &Files<'_>,
) -> Result<Shape<D>, SceneError> {
    if D == 2 {
        return Err(shape
            .error_at_key("mesh", "meshes are for 3D only")
            .hint("this scene has dimension = 2; a polygon can have any outline"));
    }
    let keys = shape.opt_table("mesh");
    let path = match &keys {
        Some(keys) => keys.text("file")?,
        None => shape.text("mesh")?,
    };
    let bytes = files
        .bytes(path, false, files.limits().memory / 8)
        .map_err(|reason| {
            let message = format!("cannot read \"{}\": {reason}", shorten(path));
            let error = match &keys {
                Some(keys) => keys.error_at("file", message),
                None => shape.error_at("mesh", message),
            };
            error.hint("meshes are found from the scene's folder")
        })?;
    let mesh = Shape::Mesh(Arc::new(crate::mesh_file::parse_mesh(&bytes, path)?));
    let Some(keys) = keys else {
        return Ok(mesh);
    };
    let turn = keys.choice("up", &UP_AXES)?;
    let upright = mesh.transformed(Transform::new(
        [1.0; D],
        turn.map(f64::to_radians),
        [0.0; D],
        [0.0; D],
    ));
    let bounds = upright.bounds();
    let longest = (0..D).map(|i| bounds.side(i)).fold(0.0, f64::max);
    let factor = keys.opt_number("size").map_or(1.0, |size| size / longest);
    let middle = bounds.middle();
    let by = keys.opt_vector::<D>("center").map_or([0.0; D], |center| {
        core::array::from_fn(|i| center[i] - middle[i])
    });
    let about = if keys.has("center") { middle } else { [0.0; D] };
    Ok(upright.transformed(Transform::new([factor; D], [0.0; 3], about, by)))
}

/// Applies `scale`, `rotate` and `translate`, in this order.
fn read_transform<const D: usize>(
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
    Ok(shape.transformed(Transform::new(scale, turn, about, by)))
}

/// Repeats the shape in rows along the axes, as `copies` says.
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
    if total * shape.part_count() as f64 > LARGEST_PART_COUNT as f64 {
        return Err(copies
            .error_at("count", format!("these are {total} copies"))
            .hint(format!(
                "at most {LARGEST_PART_COUNT} parts are possible in a shape"
            )));
    }
    if let Some(i) = (0..D).find(|&i| count[i] > 1.0 && step[i] == 0.0) {
        return Err(copies.error_at(
            "step",
            format!("copies along {} need a step there", AXES[i]),
        ));
    }
    let all = (0..total as usize).map(|number| {
        let mut rest = number;
        let by = core::array::from_fn(|i| {
            let place = rest % count[i] as usize;
            rest /= count[i] as usize;
            place as f64 * step[i]
        });
        shape.clone().transformed(Transform::translation(by))
    });
    Ok(Shape::Union(all.collect()))
}
