//! Pictures of small scenes, checked by their pixels.

use std::io;

use lahar::{Collider, Data, Field, Snapshot};

use super::drawable::DrawableParticles;
use super::renderer::affordable;
use super::*;

fn snapshot(dimension: usize, positions: &[f64], volume: f32, materials: &[u32]) -> Snapshot {
    Snapshot {
        time: 0.0,
        dimension,
        count: materials.len(),
        columns: vec![
            (Field::Position, Data::F64(positions.to_vec())),
            (Field::Volume0, Data::F32(vec![volume; materials.len()])),
            (Field::Material, Data::U32(materials.to_vec())),
        ],
    }
}

fn scenery(dimension: usize) -> Scenery {
    Scenery {
        dimension,
        bounds: ([0.0; 3], [2.0, 1.0, if dimension == 3 { 1.0 } else { 0.0 }]),
        walls: true,
        up: 1,
        dx: 0.1,
        speed: 0.0,
        background: BACKGROUND,
        colors: model_colors(&["fluid", "corotated"]),
        bodies: Vec::new(),
        colliders: Vec::new(),
    }
}

/// A collider is in the picture where it is at the time, and nowhere else.
#[test]
fn colliders_are_drawn_where_they_are() {
    for (dimension, up) in [(2, 1), (3, 1)] {
        let red = [255, 0, 0];
        let mut collider = Collider::still(
            "ball",
            vec![lahar::Primitive::Ball {
                center: [0.5, 0.5, 0.5 * f64::from(dimension - 2)],
                radius: 0.3,
            }],
            lahar::Contact::Sticky,
        );
        collider.motion = lahar::Motion::Steady {
            velocity: [1.0, 0.0, 0.0],
            spin: [0.0; 3],
        };
        let scenery = Scenery {
            up,
            colliders: vec![(collider, red)],
            ..scenery(dimension as usize)
        };
        let renderer = Renderer::new(scenery, Style::default());
        let middle = |time: f64| {
            let mut moment = snapshot(dimension as usize, &[], 0.01, &[]);
            moment.time = time;
            let picture = renderer.render(&moment);
            let (mut columns, mut count) = (0.0, 0.0);
            for (at, pixel) in picture.rgb.as_chunks::<3>().0.iter().enumerate() {
                if pixel[0] > 60 && pixel[1] < pixel[0] / 2 && pixel[2] < pixel[0] / 2 {
                    columns += (at % picture.width as usize) as f64;
                    count += 1.0;
                }
            }
            assert!(count > 1000.0, "{dimension}D: {count} pixels");
            columns / count / f64::from(picture.width)
        };
        let (early, late) = (middle(0.0), middle(1.0));
        assert!((0.15..0.4).contains(&early), "{dimension}D: {early}");
        assert!((0.6..0.85).contains(&late), "{dimension}D: {late}");
    }
}

#[test]
fn large_pictures_have_fewer_samples() {
    let samples = |width, height| {
        affordable(&Style {
            width,
            height,
            ..Style::default()
        })
    };
    assert_eq!(samples(1920, 1080), 3);
    assert_eq!(samples(8192, 8192), 2);
    assert_eq!(samples(16384, 16384), 1);
}

#[test]
fn bodies_have_their_own_colors() {
    let mut scenery = scenery(2);
    scenery.bodies = vec![None, Some([250, 10, 20])];
    let mut moment = snapshot(2, &[0.5, 0.5, 1.5, 0.5], 0.09, &[0, 0]);
    moment.columns.push((Field::Body, Data::U32(vec![0, 1])));
    for coloring in [Coloring::Material, Coloring::Body] {
        let style = Style {
            coloring,
            ..Style::default()
        };
        let picture = Renderer::new(scenery.clone(), style).render(&moment);
        assert!(
            count(&picture, |p| p == [250, 10, 20]) > 100,
            "{coloring:?}"
        );
    }
}

/// Three bodies, pressed, at rest and torn, in 2D and 3D: the scale's ends and its middle.
#[test]
fn density_and_the_jacobian_have_colors() {
    for dimension in [2, 3] {
        let middle = [0.5; 3];
        let positions: Vec<f64> = [0.4, 1.0, 1.6]
            .iter()
            .flat_map(|&x| [x, middle[1], middle[2]].into_iter().take(dimension))
            .collect();
        let mut moment = snapshot(
            dimension,
            &positions,
            0.1_f32.powi(dimension as i32),
            &[0; 3],
        );
        let mass = 1000.0 * 0.1_f32.powi(dimension as i32);
        moment.columns.push((Field::Mass, Data::F32(vec![mass; 3])));
        let jacobian = Data::F32(vec![0.9, 1.0, 1.1]);
        moment.columns.push((Field::Jacobian, jacobian));
        let drawn =
            |coloring| DrawableParticles::from(&moment, &scenery(dimension), coloring).color;
        let [below, rest, above] = REST_RAMP.map(palette::linear);
        assert_eq!(drawn(Coloring::Jacobian(0.9, 1.1)), [below, rest, above]);
        let density = drawn(Coloring::Density(950.0, 1050.0));
        assert_eq!(density, [above, rest, below]);
    }
}

#[test]
fn a_frame_shows_less() {
    let moment = snapshot(2, &[0.5, 0.5], 0.01, &[0]);
    let renderer = Renderer::new(scenery(2), Style::default());
    let is_drawn = |p: [u8; 3]| p != BACKGROUND;
    let all = renderer.clone().render(&moment);
    let near = renderer.with_frame([0.5, 0.5, 0.0], 0.25).render(&moment);
    assert_eq!((near.width, near.height), (640, 480));
    assert!(count(&near, is_drawn) > 10 * count(&all, is_drawn) / 2);
    let middle = &near.rgb[(240 * 640 + 320) * 3..][..3];
    assert_ne!(middle, BACKGROUND);
}

fn count(picture: &Picture, wanted: impl Fn([u8; 3]) -> bool) -> usize {
    picture
        .rgb
        .chunks_exact(3)
        .filter(|p| wanted([p[0], p[1], p[2]]))
        .count()
}

#[test]
fn a_lone_particle_is_a_disc_of_its_color() {
    let renderer = Renderer::new(scenery(2), Style::default());
    let picture = renderer.render(&snapshot(2, &[1.0, 0.5], 0.01, &[1]));
    let pixels = 640.0 / 2.1;
    // (1 − r²/h²)² is at the threshold.
    let part = (1.0 - f64::from(flat::THRESHOLD).sqrt()).sqrt();
    let radius = part * f64::from(flat::REACH) * 0.1 * pixels;
    // Half red light or more.
    let area = count(&picture, |p| p[0] > 0xB0) as f64;
    let expected = std::f64::consts::PI * f64::powi(radius, 2);
    assert!(
        (0.93..1.07).contains(&(area / expected)),
        "{area} of {expected}"
    );
}

#[test]
fn a_jittered_body_has_no_holes() {
    let (mut positions, mut state) = (vec![], 7_u64);
    let mut jitter = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 40) as f64 / f64::from(1 << 24)
    };
    for i in 0..40 {
        for j in 0..40 {
            positions.extend([
                0.5 + 0.02 * (f64::from(i) + jitter()),
                0.1 + 0.02 * (f64::from(j) + jitter()),
            ]);
        }
    }
    let renderer = Renderer::new(scenery(2), Style::default());
    let picture = renderer.render(&snapshot(2, &positions, 4e-4, &[0; 1600]));
    let pixels = 640.0 / 2.1;
    let fluid = scenery(2).colors[0];
    let filled = count(&picture, |p| p == fluid) as f64;
    assert!(filled > 0.64 * pixels * pixels * 0.97, "{filled}");
}

#[test]
fn walls_clip_and_particles_without_a_position_are_not_drawn() {
    let renderer = Renderer::new(scenery(2), Style::default());
    let empty = renderer.render(&snapshot(2, &[], 0.01, &[]));
    let lost = renderer.render(&snapshot(
        2,
        &[f64::NAN, 0.5, 9.0, 9.0, 1e300, -1e300],
        0.01,
        &[0; 3],
    ));
    assert_eq!(empty, lost);
    let pixels = empty.rgb.len() / 3;
    let background = count(&empty, |p| p == BACKGROUND);
    assert!(
        background < pixels && background > pixels * 9 / 10,
        "{background} of {pixels}"
    );
}

#[test]
fn balls_are_lit_and_hide_things_behind() {
    for up in [1, 2] {
        let renderer = Renderer::new(Scenery { up, ..scenery(3) }, Style::default());
        let picture = renderer.render(&snapshot(3, &[1.0, 0.5, 0.5], 0.008, &[1]));
        // Red above all, in many shades.
        let red = |p: [u8; 3]| f64::from(p[0]) > 1.4 * f64::from(p[1]) && p[0] > 60;
        let area = count(&picture, red);
        assert!((1500..20_000).contains(&area), "{area}");
        let mut shades: Vec<u8> = picture
            .rgb
            .chunks_exact(3)
            .filter(|p| red([p[0], p[1], p[2]]))
            .map(|p| p[0])
            .collect();
        shades.sort_unstable();
        shades.dedup();
        assert!(shades.len() > 30, "{} shades", shades.len());

        let Camera { eye, .. } = Camera::showing(scenery(3).bounds, up, 640.0 / 480.0);
        let towards: Vec<f64> = (0..3)
            .map(|i| [1.0, 0.5, 0.5][i] * 0.9 + 0.1 * f64::from(eye[i]))
            .collect();
        let both: Vec<f64> = [&[1.0, 0.5, 0.5], towards.as_slice()].concat();
        let hidden = renderer.render(&snapshot(3, &both, 0.008, &[1, 0]));
        assert!(count(&hidden, red) < area / 10);
    }
}

#[test]
fn a_png_reads_back() {
    let renderer = Renderer::new(
        scenery(2),
        Style {
            width: 64,
            height: 64,
            ..Style::default()
        },
    );
    let picture = renderer.render(&snapshot(2, &[1.0, 0.5], 0.01, &[0]));
    let mut bytes = Vec::new();
    picture.write_png(&mut bytes).unwrap();
    let mut reader = png::Decoder::new(io::Cursor::new(bytes))
        .read_info()
        .unwrap();
    let mut rgb = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut rgb).unwrap();
    assert_eq!(
        (info.width, info.height, rgb),
        (picture.width, picture.height, picture.rgb)
    );
}
