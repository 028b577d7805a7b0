//! The camera and the colors that a scene asks for, for pictures drawn on the processor.

use lahar_io::image::{Camera, Coloring, Renderer, Scenery, Style};
use lahar_scene::scene::Scene;

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
    match scene.camera.color_by.as_str() {
        "body" => Coloring::Body,
        "speed" => Coloring::Speed(scenery.speed.max(1e-3)),
        "pressure" => Coloring::Pressure(0.0, pressure_scale(scene, scenery)),
        "density" => {
            let squeeze = squeeze(scene, scenery);
            let densities = || scene.materials.iter().map(|m| m.density);
            let least = densities().fold(f64::INFINITY, f64::min);
            let most = densities().fold(0.0, f64::max);
            Coloring::Density(least * (1.0 - squeeze), most * (1.0 + squeeze))
        }
        "J" => {
            let squeeze = squeeze(scene, scenery);
            Coloring::Jacobian(1.0 - squeeze, 1.0 + squeeze)
        }
        _ => Coloring::Material,
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
    scenery.background = camera.background;
    for (color, material) in scenery.colors.iter_mut().zip(&scene.materials) {
        *color = material.color.unwrap_or(*color);
    }
    scenery.bodies = scene.bodies.iter().map(|body| body.color).collect();
    let mut renderer = Renderer::new(scenery.clone(), style);
    if camera.framed {
        renderer = renderer.with_frame(camera.center, camera.height);
    }
    let aspect = f64::from(width) / f64::from(height);
    let direction = camera.direction.map(|x| x as f32);
    if direction.iter().all(|x| *x == 0.0) {
        return renderer;
    }
    let angle = camera.field_of_view.to_radians() as f32;
    if camera.framed {
        return renderer.with_camera(Camera::framing(
            camera.center,
            camera.height,
            scenery.up,
            direction,
            angle,
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
