//! Reads the colliders of a scene.

use super::contact::contact_with_friction;
use super::document::{Sources, Span, Value, from_json};
use super::files::{EmbeddedFiles, Files};
use super::limits::Limits;
use super::read::Reader;
use super::shapes::read_shape;
use super::space::vector_in_3d;
use crate::error::SceneError;
use lahar::geometry::{Primitive, Shape};
use lahar::{Collider, Contact, Keyframe, Motion};

/// Names of the sides of the domain, which colliders must not have.
const SIDES: [&str; 6] = ["left", "right", "bottom", "top", "back", "front"];

/// A collider of a scene, as windows and pictures show it.
#[derive(Clone, Debug, PartialEq)]
pub struct ColliderInfo {
    /// The name in the scene.
    pub name: String,
    /// The color, if the scene gives one.
    pub color: Option<[u8; 3]>,
    /// The collider in three dimensions. In 2D it has no end along z.
    pub collider: Collider<3>,
}

impl ColliderInfo {
    /// Describes the collider in a few words.
    pub fn words(&self) -> String {
        let Collider {
            primitives,
            contact,
            motion,
            ..
        } = &self.collider;
        let kind = |primitive: &Primitive<3>| match primitive {
            Primitive::Box { .. } => "box",
            Primitive::Ball { .. } => "ball",
            Primitive::HalfSpace { .. } => "half-space",
            Primitive::Polygon { .. } => "polygon",
            Primitive::Rod { round: true, .. } => "capsule",
            Primitive::Rod { round: false, .. } => "cylinder",
        };
        let shape = match &primitives[..] {
            [one] => kind(one).to_owned(),
            all => format!("{} parts", all.len()),
        };
        let (contact, friction) = match contact {
            Contact::Sticky => ("sticky", 0.0),
            Contact::Slip { friction } => ("slip", *friction),
            Contact::Separate { friction } => ("separate", *friction),
            Contact::Open => ("open", 0.0),
        };
        let friction = if friction > 0.0 {
            format!(" with friction {friction}")
        } else {
            String::new()
        };
        let motion = match motion {
            Motion::Still => "standing",
            Motion::Steady { .. } => "moving",
            Motion::Keyframes(_) => "moving by keyframes",
        };
        format!("{shape}, {contact}{friction}, {motion}")
    }
}

pub(super) fn read_colliders<const D: usize>(
    scene: &Reader<'_>,
    dx: f64,
    files: &Files<'_>,
    warnings: &mut Vec<String>,
) -> Result<Vec<Collider<D>>, SceneError> {
    let mut colliders: Vec<Collider<D>> = Vec::new();
    for (index, (_, table)) in scene.tables("colliders").into_iter().enumerate() {
        let collider = read_collider(index, &table, files)?;
        let name = &collider.name;
        if SIDES.contains(&name.as_str()) {
            let message = format!("\"{name}\" is a side of the domain");
            return Err(table
                .error_at("name", message)
                .hint("call the collider something else"));
        }
        if colliders.iter().any(|other| other.name == *name) {
            return Err(table.error_at("name", format!("two colliders are called \"{name}\"")));
        }
        let thin = collider
            .primitives
            .iter()
            .filter_map(Primitive::thickness)
            .fold(f64::INFINITY, f64::min);
        if thin < 2.0 * dx {
            warnings.push(format!("collider \"{name}\" is {thin:.4} m thin, less than two cells: what is on its two sides feels each other through it"));
        }
        colliders.push(collider);
    }
    Ok(colliders)
}

fn read_collider<const D: usize>(
    index: usize,
    table: &Reader<'_>,
    files: &Files<'_>,
) -> Result<Collider<D>, SceneError> {
    let name = table
        .opt_text("name")
        .map_or_else(|| format!("collider-{index}"), str::to_owned);
    let Some(shape) = table.opt_table("shape") else {
        return Err(table.error(format!("collider \"{name}\" has no shape")));
    };
    let shape: Shape<D> = read_shape(&shape, files, 0)?;
    let primitives = shape.primitives().map_err(|part| {
        table
            .error_at("shape", format!("a collider cannot be a {part} yet"))
            .hint("boxes, balls, half-spaces, polygons, cylinders, capsules and unions of them are possible, and scale by one number, rotate, translate, copies")
    })?;
    let contact = contact_with_friction(table)?;
    let center = match table.opt_vector("center") {
        Some(center) => center,
        None => middle(&shape, &primitives),
    };
    Ok(Collider {
        name,
        primitives,
        contact,
        center,
        motion: read_motion(table, center)?,
    })
}

/// Returns the middle of the shape's bounds, or a point on its surface if the shape has no end.
fn middle<const D: usize>(shape: &Shape<D>, primitives: &[Primitive<D>]) -> [f64; D] {
    let bounds = shape.bounds();
    let has_end = (0..D).all(|i| bounds.min[i].is_finite() && bounds.max[i].is_finite());
    match primitives.first() {
        Some(first) if !has_end => first.center(),
        _ => bounds.middle(),
    }
}

fn read_motion<const D: usize>(
    table: &Reader<'_>,
    center: [f64; D],
) -> Result<Motion<D>, SceneError> {
    let tables = table.tables("keyframes");
    if tables.is_empty() {
        let velocity = table.opt_vector("velocity").unwrap_or([0.0; D]);
        let spin = turn(table, "spin");
        return Ok(if velocity == [0.0; D] && spin == [0.0; 3] {
            Motion::Still
        } else {
            Motion::Steady { velocity, spin }
        });
    }
    if let Some(key) = ["velocity", "spin"].into_iter().find(|key| table.has(key)) {
        return Err(table
            .error_at_key(
                key,
                format!("\"{key}\" and \"keyframes\" both say how it moves"),
            )
            .hint("give one of them"));
    }
    let mut frames: Vec<Keyframe<D>> = Vec::new();
    for (_, frame) in tables {
        let time = frame.number("time")?;
        if let Some(before) = frames.last()
            && time <= before.time
        {
            let message = format!(
                "time {time} is not after the keyframe before, {}",
                before.time
            );
            return Err(frame
                .error_at("time", message)
                .hint("keyframes are in the order of time"));
        }
        frames.push(Keyframe {
            time,
            position: frame.opt_vector("position").unwrap_or(center),
            turn: turn(&frame, "rotate").map(f64::to_radians),
        });
    }
    Ok(Motion::Keyframes(frames))
}

/// Reads a rotation: one number in 2D, three in 3D.
fn turn(table: &Reader<'_>, key: &str) -> [f64; 3] {
    table
        .opt_vector::<3>(key)
        .unwrap_or_else(|| [0.0, 0.0, table.opt_number(key).unwrap_or(0.0)])
}

/// Returns the colliders of a scene from its record, which [`super::Scene::resolved`] has made. Returns none if
/// the record cannot be understood.
pub fn colliders_of(resolved: &serde_json::Value) -> Vec<ColliderInfo> {
    let sources = Sources::default();
    let Some(Value::Table(root)) = from_json(resolved).map(|node| node.value) else {
        return Vec::new();
    };
    let scene = Reader::new(&sources, &root, Span::default());
    let limits = Limits::default();
    let files = &Files::new(&EmbeddedFiles(&[]), &limits);
    let read = if scene.opt_integer("dimension") == Some(3) {
        read_colliders::<3>(&scene, 0.0, files, &mut Vec::new()).map(|all| infos(&scene, &all))
    } else {
        read_colliders::<2>(&scene, 0.0, files, &mut Vec::new()).map(|all| infos(&scene, &all))
    };
    read.unwrap_or_default()
}

/// Describes the colliders of a scene for windows and pictures.
pub(super) fn infos<const D: usize>(
    scene: &Reader<'_>,
    colliders: &[Collider<D>],
) -> Vec<ColliderInfo> {
    colliders
        .iter()
        .zip(scene.tables("colliders"))
        .map(|(collider, (_, table))| ColliderInfo {
            name: collider.name.clone(),
            color: table.opt_color("color"),
            collider: in_space(collider),
        })
        .collect()
}

/// Returns the collider in three dimensions. In 2D it has no end along z.
fn in_space<const D: usize>(collider: &Collider<D>) -> Collider<3> {
    let space = |primitive: &Primitive<D>| match primitive {
        Primitive::Box { center, half, axes } => Primitive::Box {
            center: vector_in_3d(*center),
            half: core::array::from_fn(|i| if i < D { half[i] } else { f64::INFINITY }),
            axes: core::array::from_fn(|i| {
                if i < D {
                    vector_in_3d(axes[i])
                } else {
                    core::array::from_fn(|j| f64::from(i == j))
                }
            }),
        },
        Primitive::Ball { center, radius } => Primitive::Ball {
            center: vector_in_3d(*center),
            radius: *radius,
        },
        Primitive::HalfSpace { point, normal } => Primitive::HalfSpace {
            point: vector_in_3d(*point),
            normal: vector_in_3d(*normal),
        },
        Primitive::Rod {
            from,
            to,
            radius,
            round,
        } => Primitive::Rod {
            from: vector_in_3d(*from),
            to: vector_in_3d(*to),
            radius: *radius,
            round: *round,
        },
        Primitive::Polygon { points } => Primitive::Polygon {
            points: points.iter().copied().map(vector_in_3d).collect(),
        },
    };
    Collider {
        name: collider.name.clone(),
        primitives: collider.primitives.iter().map(space).collect(),
        contact: collider.contact,
        center: vector_in_3d(collider.center),
        motion: match &collider.motion {
            Motion::Still => Motion::Still,
            Motion::Steady { velocity, spin } => Motion::Steady {
                velocity: vector_in_3d(*velocity),
                spin: *spin,
            },
            Motion::Keyframes(frames) => Motion::Keyframes(
                frames
                    .iter()
                    .map(|frame| Keyframe {
                        time: frame.time,
                        position: vector_in_3d(frame.position),
                        turn: frame.turn,
                    })
                    .collect(),
            ),
        },
    }
}
