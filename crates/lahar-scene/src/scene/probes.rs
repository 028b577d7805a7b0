//! Reads the probes of a scene.

use super::choices::ENDS;
use super::key::words;
use super::read::Reader;
use crate::error::SceneError;
use lahar::{Gauge, Plate, Probe};

/// The kinds of probes.
#[derive(Clone, Copy)]
enum Kind {
    Pressure,
    Velocity,
    Height,
    Front,
    Force,
}

/// The key of each kind; a probe has one of them.
const KINDS: [(&str, Kind); 5] = [
    ("pressure", Kind::Pressure),
    ("velocity", Kind::Velocity),
    ("height", Kind::Height),
    ("front", Kind::Front),
    ("force", Kind::Force),
];

/// Radius of a gauge of pressure or velocity, if the scene does not say \[cells\]: enough layers of particles to find
/// the slope of the pressure on a wall, and to average over their noise. In a resting tank of jittered particles, a
/// point reads within 2.5, 1 and 0.2 % with 1.5, 2 and 3 cells.
const RADIUS_CELLS: f64 = 2.0;

/// Reads the probes of a scene. They are read every frame if they give no rate.
pub(crate) fn read_probes<const D: usize>(
    scene: &Reader<'_>,
    dx: f64,
    frame_rate: f64,
) -> Result<Vec<Probe<D>>, SceneError> {
    let mut probes: Vec<Probe<D>> = Vec::new();
    for (_, table) in scene.tables("probes") {
        let name = table.text("name")?;
        let fits = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        if name.is_empty() || !name.chars().all(fits) {
            let error = table.error_at(
                "name",
                format!(
                    "\"{}\" cannot be a probe's name",
                    crate::text::shorten(name)
                ),
            );
            return Err(error.hint("it names a file: use letters, digits, - and _ only"));
        }
        // Some file systems do not distinguish capitals.
        if probes
            .iter()
            .any(|probe| probe.name.eq_ignore_ascii_case(name))
        {
            return Err(table.error_at("name", format!("two probes are called \"{name}\"")));
        }
        probes.push(Probe {
            name: name.to_owned(),
            rate: table.opt_number("rate").unwrap_or(frame_rate),
            gauge: read_gauge(&table, scene.has("domain"), dx)?,
        });
    }
    Ok(probes)
}

fn read_gauge<const D: usize>(
    probe: &Reader<'_>,
    domain: bool,
    dx: f64,
) -> Result<Gauge<D>, SceneError> {
    let given: Vec<_> = (KINDS.into_iter())
        .filter(|(key, _)| probe.has(key))
        .collect();
    let (key, kind) = match given[..] {
        [given] => given,
        [] => {
            return Err(probe
                .error("this probe measures nothing")
                .hint(format!("give one of: {}", words(&KINDS).join(", "))));
        }
        [(first, _), (second, _), ..] => {
            return Err(probe
                .error_at_key(second, format!("this probe measures \"{first}\" already"))
                .hint("make a second [[probes]] of it"));
        }
    };
    let Some(table) = probe.opt_table(key) else {
        return Err(probe.error_at(key, format!("\"{key}\" must be a table")));
    };
    Ok(match kind {
        Kind::Pressure => Gauge::Pressure {
            at: table.vector("at")?,
            radius: table.opt_number("radius").unwrap_or(RADIUS_CELLS * dx),
            plate: read_plate(&table)?,
        },
        Kind::Velocity => Gauge::Velocity {
            at: table.vector("at")?,
            radius: table.opt_number("radius").unwrap_or(RADIUS_CELLS * dx),
        },
        Kind::Height => {
            let column = table.opt_vector("at");
            if column.is_none() && !domain {
                let error = table.error("without a domain there is no mean height");
                return Err(
                    error.hint("give the probe a place, as in height = { at = [0.5, 0.0] }")
                );
            }
            Gauge::Height {
                up: read_axis::<D>(&table, "up")?,
                column,
            }
        }
        Kind::Force => Gauge::Force {
            on: table.text("on")?.to_owned(),
        },
        Kind::Front => {
            if D == 3 && !domain {
                return Err(
                    table.error("in 3D a front needs a domain: its depth is a mean across it")
                );
            }
            let (along, up) = (
                read_axis::<D>(&table, "along")?,
                read_axis::<D>(&table, "up")?,
            );
            if along == up {
                return Err(
                    table.error_at("along", "a front cannot run along the axis that points up")
                );
            }
            Gauge::Front {
                along,
                up,
                rising: table.choice("towards", &ENDS)?,
                depth: table.number("depth")?,
            }
        }
    })
}

fn read_plate<const D: usize>(table: &Reader<'_>) -> Result<Option<Plate<D>>, SceneError> {
    match (table.opt_vector::<D>("normal"), table.opt_number("width")) {
        (None, None) => Ok(None),
        (Some(normal), Some(width)) => {
            if normal.iter().all(|n| *n == 0.0) {
                return Err(table.error_at("normal", "the normal has no direction"));
            }
            Ok(Some(Plate { normal, width }))
        }
        (Some(_), None) => {
            Err(table.error_at_key("normal", "\"normal\" needs \"width\" beside it"))
        }
        (None, Some(_)) => Err(table.error_at_key("width", "\"width\" needs \"normal\" beside it")),
    }
}

fn read_axis<const D: usize>(table: &Reader<'_>, key: &str) -> Result<usize, SceneError> {
    let word = table.text(key)?;
    let axes = &["x", "y", "z"][..D];
    axes.iter()
        .position(|axis| *axis == word)
        .ok_or_else(|| table.error_at(key, format!("there is no axis {word} in 2D")))
}
