//! Reads the controls of keys and mouse in the window.

use super::read::Reader;
use crate::error::SceneError;

/// The controls of keys and mouse in the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controls {
    /// Largest speed of the simulation at first \[simulated seconds per second\].
    pub speed: f64,
    /// Size of gravity towards the side of a key \[m/s²\]; `None` for the size of the scene's gravity.
    pub gravity: Option<f64>,
    /// True if gravity acts only while its key is pressed.
    pub hold: bool,
    /// Acceleration towards the pointer or away from it \[m/s²\]; `None` for one that follows the size of gravity.
    pub pull: Option<f64>,
    /// Reach of the pointer \[m\], infinite for everywhere; `None` for one that follows the size of the scene.
    pub reach: Option<f64>,
    /// Distance below which the pointer's acceleration goes to zero \[m\]; `None` for the size of a cell.
    pub softening: Option<f64>,
    /// If given, the pointer pushes particles instead of attracting nodes, by (distance/reach) to this power.
    pub push: Option<f64>,
}

impl Default for Controls {
    /// Real time, gravity that stays after its key is released, a pointer that follows the size of the scene.
    fn default() -> Self {
        Self {
            speed: 1.0,
            gravity: None,
            hold: false,
            pull: None,
            reach: None,
            softening: None,
            push: None,
        }
    }
}

pub(super) fn read_controls(scene: &Reader<'_>) -> Result<Controls, SceneError> {
    let controls = table(scene, "controls")?;
    let keys = table(&controls, "gravity_keys")?;
    let pointer = table(&controls, "pointer")?;
    Ok(Controls {
        speed: controls.number("speed")?,
        gravity: keys.opt_number("strength"),
        hold: keys.opt_flag("hold").unwrap_or_default(),
        pull: pointer.opt_number("strength"),
        // The only word for the radius is "everywhere".
        reach: match pointer.opt_text("radius") {
            Some(_) => Some(f64::INFINITY),
            None => pointer.opt_number("radius"),
        },
        softening: pointer.opt_number("softening"),
        push: match pointer.text("action")? {
            "push" => Some(pointer.number("power")?),
            _ => None,
        },
    })
}

/// Returns a table that always is there, because it has a default.
fn table<'a>(reader: &Reader<'a>, key: &str) -> Result<Reader<'a>, SceneError> {
    let table = reader.opt_table(key);
    table.ok_or_else(|| reader.error(format!("there is no {key}")))
}
