//! The camera and the colors that a scene asks for, for pictures drawn on the processor.

use lahar_io::image::{Camera, Coloring, Renderer, Scenery, Style};
use lahar_scene::scene::{ColorBy, Scene};

/// The largest width of a film \[pixels\], which keeps a film of all frames at a few megabytes.
const FILM_WIDTH: u32 = 640;

/// Returns the size of a film for pictures of this size \[pixels\].
pub(crate) fn film_size([width, height]: [u32; 2]) -> [u32; 2] {
    let film_width = width.min(FILM_WIDTH);
    let film_height = f64::from(height) * f64::from(film_width) / f64::from(width);
    [film_width, film_height.round() as u32]
}

/// Returns the quantity that colors show in pictures of `scene`, with its range.
pub(crate) fn coloring(scene: &Scene, scenery: &Scenery) -> Coloring {
    match scene.camera.color_by {
        ColorBy::Material => Coloring::Material,
        ColorBy::Body => Coloring::Body,
        ColorBy::Speed => Coloring::Speed(scenery.speed.max(1e-3)),
        ColorBy::Pressure => Coloring::Pressure(0.0, pressure_scale(scene, scenery)),
        ColorBy::Density => {
            let squeeze = squeeze(scene, scenery);
            let densities = || scene.materials.iter().map(|m| m.density);
            let least = densities().fold(f64::INFINITY, f64::min);
            let most = densities().fold(0.0, f64::max);
            Coloring::Density(least * (1.0 - squeeze), most * (1.0 + squeeze))
        }
        ColorBy::Jacobian => {
            let squeeze = squeeze(scene, scenery);
            Coloring::Jacobian(1.0 - squeeze, 1.0 + squeeze)
        }
    }
}

/// Returns a renderer for pictures of `scene` in this size \[pixels\].
pub(crate) fn renderer(scene: &Scene, scenery: &Scenery, [width, height]: [u32; 2]) -> Renderer {
    let camera = &scene.camera;
    let style = Style {
        width,
        height,
        coloring: coloring(scene, scenery),
        ..Style::default()
    };
    let mut scenery = scenery.clone();
    scenery.background = camera.background.unwrap_or_default();
    for (color, material) in scenery.colors.iter_mut().zip(&scene.materials) {
        *color = material.color.unwrap_or(*color);
    }
    scenery.bodies = scene.bodies.iter().map(|body| body.color).collect();
    let mut renderer = Renderer::new(scenery.clone(), style);
    let framing = scene.framing();
    if let Some((center, height)) = framing {
        renderer = renderer.with_frame(center, height);
    }
    let aspect = f64::from(width) / f64::from(height);
    let direction = (camera.direction.unwrap_or([0.0, 0.0, 1.0])).map(|x| x as f32);
    if direction.iter().all(|x| *x == 0.0) {
        return renderer;
    }
    let angle = camera.field_of_view.unwrap_or(35.0).to_radians() as f32;
    if let Some((center, height)) = framing {
        return renderer.with_camera(Camera::framing(
            center, height, scenery.up, direction, angle,
        ));
    }
    renderer.with_camera(Camera::showing_from(
        scenery.bounds,
        scenery.up,
        aspect as f32,
        direction,
        angle,
    ))
}

/// The pressure at the foot of a column of half the scene's height \[Pa\].
fn pressure_scale(scene: &Scene, scenery: &Scenery) -> f64 {
    let density = scene
        .materials
        .iter()
        .map(|material| material.density)
        .fold(0.0, f64::max);
    (density * scenery.speed * scenery.speed * 0.5).max(f64::MIN_POSITIVE)
}

/// The relative compression at the foot of such a column, in the softest material.
fn squeeze(scene: &Scene, scenery: &Scenery) -> f64 {
    let softest = (scene.materials.iter())
        .map(|material| material.wave_speed)
        .filter(|speed| *speed > 0.0)
        .fold(f64::INFINITY, f64::min);
    (0.5 * (scenery.speed / softest).powi(2)).clamp(1e-3, 0.5)
}
