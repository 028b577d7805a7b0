//! What a scene asks of keys and mouse in the window.

use super::read::Reader;
use crate::error::SceneError;

/// What keys and mouse do in the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controls {
    /// Simulated seconds a second at first, at most.
    pub speed: f64,
    /// Size of gravity towards a key's side \[m/s²\]; `None`: that of the scene's.
    pub gravity: Option<f64>,
    /// Whether gravity acts only while a key is held.
    pub hold: bool,
    /// Acceleration towards the pointer or away from it \[m/s²\]; `None`: from the size of gravity.
    pub pull: Option<f64>,
    /// How far the pointer reaches \[m\], infinite for everywhere; `None`: from the scene's size.
    pub reach: Option<f64>,
    /// The length within which its acceleration goes to zero \[m\]; `None`: a cell.
    pub softening: Option<f64>,
    /// Particles are pushed instead of nodes attracted, by (distance/reach) to this power.
    pub push: Option<f64>,
}

impl Default for Controls {
    /// Real time, gravity that stays as it was turned, a hand made to the scene's measure.
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
        // The one word that it takes is "everywhere".
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

/// A table that the defaults have seen to.
fn table<'a>(reader: &Reader<'a>, key: &str) -> Result<Reader<'a>, SceneError> {
    let table = reader.opt_table(key);
    table.ok_or_else(|| reader.error(format!("there is no {key}")))
}
