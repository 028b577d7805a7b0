//! The window without a window: keys, clicks and drags in, orders out; and the solver behind it.
//! Nothing here needs a display. What needs a graphics adapter is left out where there is none.

mod support;

use std::sync::Arc;
use std::time::{Duration, Instant};

use eframe::egui::{self, Key, Modifiers, PointerButton, Vec2, pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use lahar::{Command, Field, PointerAction};
use lahar_app::app_state::{AppState, Effect, Grip};
use lahar_app::colour::ColourBy;
use lahar_app::scenes::{SceneSource, SettingValue, Shelf};
use lahar_app::solver::{Condition, Order, Shown, Solver};
use lahar_app::{DEFAULT_SCENE, view};

/// What the solver would show of a scene at its start.
fn shown(name: &str, opened: u64) -> Shown {
    let mut solver = Solver::start(Arc::new(support::Blocks)).unwrap();
    solver.order(Order::Pause(true));
    solver.order(Order::Open(name.into(), vec![]));
    let mut shown = wait(&mut solver, |shown| shown.opened > 0);
    shown.opened = opened;
    shown
}

/// The newest state that satisfies `until`.
fn wait(solver: &mut Solver, until: impl Fn(&Shown) -> bool) -> Shown {
    let start = Instant::now();
    loop {
        if let Some(shown) = solver.newest().filter(&until) {
            return shown;
        }
        assert!(
            start.elapsed() < Duration::from_secs(60),
            "the solver does not answer"
        );
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn harness(scene: &str) -> Harness<'static, AppState> {
    let mut state = AppState::new(support::Blocks.list(), DEFAULT_SCENE, Some(scene));
    state.receive(shown(scene, 1));
    state.take_effects();
    let mut harness = Harness::builder()
        .with_size(Vec2::new(1100.0, 720.0))
        .build_ui_state(|ui, state: &mut AppState| view::window(state, ui), state);
    harness.run();
    harness
}

fn orders(harness: &mut Harness<'_, AppState>) -> Vec<Order> {
    let effects = harness.state_mut().take_effects();
    let order = |effect| match effect {
        Effect::Order(order) => Some(order),
        Effect::Screenshot | Effect::Thumbnails | Effect::Close => None,
    };
    effects.into_iter().filter_map(order).collect()
}

fn gravity(harness: &mut Harness<'_, AppState>, key: Key) -> [f64; 3] {
    harness.key_press(key);
    harness.run();
    match orders(harness)[..] {
        [Order::Tell(Command::Gravity(gravity))] => gravity,
        ref other => panic!("{other:?}"),
    }
}

#[test]
fn the_default_scene_opens_first_and_shift_r_comes_back_to_it() {
    let mut state = AppState::new(support::Blocks.list(), DEFAULT_SCENE, None);
    assert_eq!(
        state.take_effects(),
        [Effect::Order(Order::Open("dam-break".into(), vec![]))]
    );
    let mut harness = harness("double-dam");
    harness.key_press_modifiers(Modifiers::SHIFT, Key::R);
    harness.run();
    assert_eq!(
        orders(&mut harness),
        [Order::Open("dam-break".into(), vec![])]
    );
    harness.key_press(Key::R);
    harness.run();
    assert_eq!(orders(&mut harness), [Order::Restart]);
}

#[test]
fn number_keys_choose_scenes_and_numbers_without_one_do_nothing() {
    let mut harness = harness("dam-break");
    harness.key_press(Key::Num2);
    harness.run();
    assert_eq!(
        orders(&mut harness),
        [Order::Open("double-dam".into(), vec![])]
    );
    harness.key_press(Key::Num9);
    harness.run();
    assert_eq!(orders(&mut harness), []);
}

#[test]
fn keys_turn_gravity_at_the_scenes_magnitude() {
    let mut harness = harness("dam-break");
    for (key, expected) in [
        (Key::A, [-9.81, 0.0, 0.0]),
        (Key::ArrowLeft, [-9.81, 0.0, 0.0]),
        (Key::D, [9.81, 0.0, 0.0]),
        (Key::ArrowRight, [9.81, 0.0, 0.0]),
        (Key::W, [0.0, 9.81, 0.0]),
        (Key::ArrowUp, [0.0, 9.81, 0.0]),
        (Key::S, [0.0, -9.81, 0.0]),
        (Key::ArrowDown, [0.0, -9.81, 0.0]),
    ] {
        let gravity = gravity(&mut harness, key);
        for axis in 0..3 {
            assert!(
                (gravity[axis] - expected[axis]).abs() < 1e-12,
                "{key:?}: {gravity:?}"
            );
        }
        assert_eq!(
            harness.state().gravity,
            gravity,
            "it keeps its last direction"
        );
    }
}

#[test]
fn in_3d_gravity_goes_to_the_windows_left_however_the_camera_stands() {
    let mut harness = harness("dam-break-3d");
    assert_eq!(gravity(&mut harness, Key::D), [9.81, 0.0, 0.0]);
    let camera = harness.state_mut().camera.as_mut().unwrap();
    camera.yaw += std::f64::consts::PI;
    assert_eq!(
        gravity(&mut harness, Key::D).map(|c| c + 0.0),
        [-9.81, 0.0, 0.0]
    );
    assert_eq!(
        gravity(&mut harness, Key::S).map(|c| c + 0.0),
        [0.0, -9.81, 0.0]
    );
}

#[test]
fn space_pauses_period_steps_plus_and_minus_change_speed() {
    let mut harness = harness("dam-break");
    harness.key_press(Key::Space);
    harness.run();
    assert_eq!(orders(&mut harness), [Order::Pause(true)]);
    harness.key_press(Key::Period);
    harness.run();
    assert_eq!(orders(&mut harness), [Order::Substep]);
    harness.key_press(Key::Space);
    harness.run();
    assert_eq!(orders(&mut harness), [Order::Pause(false)]);
    harness.key_press(Key::Period);
    harness.run();
    assert_eq!(orders(&mut harness), [Order::Pause(true), Order::Substep]);
    harness.key_press(Key::Plus);
    harness.run();
    assert_eq!(orders(&mut harness), [Order::Speed(1.5)]);
    harness.key_press(Key::Minus);
    harness.run();
    harness.key_press(Key::Minus);
    harness.run();
    assert_eq!(
        orders(&mut harness),
        [Order::Speed(1.0), Order::Speed(0.75)]
    );
}

#[test]
fn c_goes_through_the_colours_and_asks_for_their_fields() {
    let mut harness = harness("dam-break");
    for by in [
        ColourBy::Speed,
        ColourBy::Pressure,
        ColourBy::Density,
        ColourBy::Jacobian,
        ColourBy::Material,
    ] {
        harness.key_press(Key::C);
        harness.run();
        assert_eq!(harness.state().colour_by, by);
        assert_eq!(orders(&mut harness), [Order::Fields(by.fields())]);
    }
}

#[test]
fn h_p_and_l_show_and_hide_f12_takes_a_picture_and_escape_leaves() {
    let mut harness = harness("dam-break");
    harness.key_press(Key::H);
    harness.key_press(Key::P);
    harness.key_press(Key::L);
    harness.run();
    let state = harness.state_mut();
    assert!(!state.show_hints && !state.show_panel && state.show_scenes);
    assert_eq!(state.take_effects(), [Effect::Thumbnails]);
    harness.key_press(Key::F12);
    harness.run();
    assert_eq!(harness.state_mut().take_effects(), [Effect::Screenshot]);
    harness.key_press(Key::Escape);
    harness.run();
    assert!(!harness.state().show_scenes, "the list closes first");
    assert_eq!(harness.state_mut().take_effects(), []);
    harness.key_press(Key::Escape);
    harness.run();
    assert_eq!(harness.state_mut().take_effects(), [Effect::Close]);
}

#[test]
fn buttons_do_what_their_keys_do() {
    let mut harness = harness("dam-break");
    for (label, order) in [
        ("Restart", Order::Restart),
        ("Pause", Order::Pause(true)),
        ("Substep", Order::Substep),
        ("Go on", Order::Pause(false)),
        ("None", Order::Tell(Command::Gravity([0.0; 3]))),
        ("Scene's", Order::Tell(Command::Gravity([0.0, -9.81, 0.0]))),
    ] {
        harness.get_by_label(label).click();
        harness.run();
        assert_eq!(orders(&mut harness), [order], "{label}");
    }
    harness.get_by_label("List").click();
    harness.run();
    harness.get_by_label("Double dam").click();
    harness.run();
    assert_eq!(
        orders(&mut harness),
        [Order::Open("double-dam".into(), vec![])]
    );
    assert!(!harness.state().show_scenes);
}

#[test]
fn settings_are_applied_with_a_restart_and_forgotten_with_another_scene() {
    let mut harness = harness("dam-break");
    let state = harness.state_mut();
    state.settings[0].value = SettingValue::Number(0.25);
    state.apply_settings();
    let change = vec![("materials.water.viscosity".to_owned(), "0.25".to_owned())];
    assert_eq!(
        orders(&mut harness),
        [Order::Open("dam-break".into(), change)]
    );
    assert!(harness.state().has_changes());
    harness.key_press(Key::Num1);
    harness.run();
    assert_eq!(
        orders(&mut harness),
        [Order::Open("dam-break".into(), vec![])]
    );
    assert!(!harness.state().has_changes());
}

#[test]
fn a_widget_with_the_keyboard_keeps_it_and_escape_gives_it_back() {
    let mut harness = harness("dam-break");
    harness.get_by_label("Restart").focus();
    harness.run();
    harness.key_press(Key::Space);
    harness.run();
    assert_eq!(
        orders(&mut harness),
        [Order::Restart],
        "the button, not the pause"
    );
    harness.key_press(Key::Escape);
    harness.run();
    assert_eq!(harness.state_mut().take_effects(), [], "the window stays");
    harness.key_press(Key::Space);
    harness.run();
    assert_eq!(orders(&mut harness), [Order::Pause(true)]);
}

fn press(harness: &Harness<'_, AppState>, pos: egui::Pos2, button: PointerButton, pressed: bool) {
    harness.event(egui::Event::PointerButton {
        pos,
        button,
        pressed,
        modifiers: Modifiers::NONE,
    });
}

#[test]
fn the_left_button_attracts_and_the_right_repels_until_released() {
    let mut harness = harness("dam-break");
    for (button, sign) in [
        (PointerButton::Primary, 1.0),
        (PointerButton::Secondary, -1.0),
    ] {
        let at = pos2(700.0, 400.0);
        harness.hover_at(at);
        press(&harness, at, button, true);
        harness.run();
        let orders_now = orders(&mut harness);
        let Some(Order::Tell(Command::Pointer(Some(pointer)))) = orders_now.last() else {
            panic!("{orders_now:?}");
        };
        // The domain is 2 m by 1.2 m, and in view.
        assert!((0.0..2.0).contains(&pointer.position[0]), "{pointer:?}");
        assert!((0.0..1.2).contains(&pointer.position[1]), "{pointer:?}");
        let PointerAction::Attract(pull) = pointer.action else {
            panic!("{pointer:?}");
        };
        assert!(pull * sign > 9.81, "{pointer:?}");
        press(&harness, at, button, false);
        harness.run();
        let orders_now = orders(&mut harness);
        assert_eq!(
            orders_now.last(),
            Some(&Order::Tell(Command::Pointer(None)))
        );
    }
}

#[test]
fn in_3d_a_drag_orbits_and_the_hand_takes_hold_of_the_nearest_water() {
    let mut harness = harness("dam-break-3d");
    let at = pos2(700.0, 400.0);
    let yaw = harness.state().camera.as_ref().unwrap().yaw;
    harness.hover_at(at);
    press(&harness, at, PointerButton::Primary, true);
    harness.run();
    harness.hover_at(at + Vec2::new(60.0, 0.0));
    harness.run();
    press(&harness, at, PointerButton::Primary, false);
    harness.run();
    assert!(harness.state().camera.as_ref().unwrap().yaw < yaw);
    assert_eq!(orders(&mut harness), []);

    let state = harness.state_mut();
    let camera = state.camera.clone().unwrap();
    let middle = [0.5, 0.5, 0.5];
    let at = camera.project(middle, state.aspect).unwrap();
    state.hold(at, Grip::Attract, [0.0; 2]);
    let (position, _) = state.held.unwrap();
    let nearer: f64 = (0..3)
        .map(|i| (position[i] - middle[i]) * camera.axes()[2][i])
        .sum();
    assert!(
        nearer > 0.2,
        "on the front of the block, not inside: {nearer}"
    );
}

#[test]
fn a_scene_left_alone_has_the_same_bits_as_a_headless_run() {
    let mut headless = support::Blocks
        .open("dam-break", &vec![])
        .unwrap()
        .simulation;
    let mut solver = Solver::start(Arc::new(support::Blocks)).unwrap();
    solver.order(Order::Fields(vec![Field::Velocity]));
    solver.order(Order::Speed(8.0));
    solver.order(Order::Open("dam-break".into(), vec![]));
    let mut checked = 0;
    let mut frame = 0;
    while checked < 3 {
        let shown = wait(&mut solver, |shown| {
            let frames = shown.readouts.time * 60.0;
            shown.readouts.time > 0.0 && frames.fract().min(1.0 - frames.fract()) < 1e-9
        });
        let snapshot = shown.snapshot.unwrap();
        while frame < (snapshot.time * 60.0).round() as u64 {
            frame += 1;
            headless.advance_to(frame as f64 / 60.0).unwrap();
        }
        let expected = headless.snapshot(&[Field::Position, Field::Velocity]);
        assert_eq!(shown.readouts.substeps, headless.substeps());
        for field in [Field::Position, Field::Velocity] {
            assert!(
                snapshot.get(field) == expected.get(field),
                "{field:?} differs"
            );
        }
        checked += 1;
    }
}

#[test]
fn pause_stops_the_clock_and_a_substep_is_one_substep() {
    let mut solver = Solver::start(Arc::new(support::Blocks)).unwrap();
    solver.order(Order::Pause(true));
    solver.order(Order::Open("dam-break".into(), vec![]));
    let start = wait(&mut solver, |shown| shown.condition == Condition::Paused);
    assert_eq!(start.readouts.substeps, 0);
    for substeps in 1..=3 {
        solver.order(Order::Substep);
        wait(&mut solver, |shown| shown.readouts.substeps == substeps);
    }
    solver.order(Order::Restart);
    let again = wait(&mut solver, |shown| shown.opened == 2);
    assert_eq!(
        (again.readouts.substeps, again.condition),
        (0, Condition::Paused)
    );
}

#[test]
fn never_faster_than_real_time_times_speed() {
    let mut solver = Solver::start(Arc::new(support::Blocks)).unwrap();
    solver.order(Order::Speed(0.1));
    solver.order(Order::Open("dam-break".into(), vec![]));
    wait(&mut solver, |shown| shown.condition == Condition::Running);
    let start = Instant::now();
    let shown = wait(&mut solver, |shown| shown.readouts.time >= 0.045);
    let elapsed = start.elapsed().as_secs_f64();
    // A frame is computed when it begins to be due.
    assert!(
        shown.readouts.time <= 0.1 * elapsed + 1.5 / 60.0,
        "{} s in {elapsed} s",
        shown.readouts.time
    );
}

#[test]
fn a_scene_that_cannot_be_opened_is_said_and_the_next_one_opens() {
    let mut solver = Solver::start(Arc::new(support::Blocks)).unwrap();
    solver.order(Order::Open("broken".into(), vec![]));
    let shown = wait(&mut solver, |shown| {
        matches!(shown.condition, Condition::Failed(_))
    });
    let mut state = AppState::new(support::Blocks.list(), DEFAULT_SCENE, None);
    state.receive(shown);
    assert_eq!(state.failure(), Some("line 3: gravity: expected numbers"));
    solver.order(Order::Open("dam-break".into(), vec![]));
    wait(&mut solver, |shown| shown.condition == Condition::Running);
}

#[test]
fn scenes_that_ship_open_with_a_colour_for_every_body() {
    let shelf = Shelf::default();
    let list = shelf.list();
    assert_eq!(list[0].name, DEFAULT_SCENE);
    for card in list {
        // Small: what is tested is the window's side of it.
        let stage = shelf
            .open(&card.name, &vec![])
            .unwrap_or_else(|why| panic!("{why}"));
        assert_eq!(stage.simulation.dimension(), card.dimension);
        assert!(!stage.swatches.is_empty());
        let has = |key: &str| stage.settings.iter().any(|setting| setting.key == key);
        assert!(
            has("dx") && has("transfer") && has("kernel"),
            "{:?}",
            stage.settings
        );
        let material = format!("materials.{}.density", stage.simulation.materials()[0]);
        assert!(has(&material), "{:?}", stage.settings);
        // What is offered is accepted, unchanged.
        let all: Vec<_> = (stage.settings.iter())
            .map(|setting| (setting.key.clone(), setting.value.to_toml()))
            .collect();
        shelf
            .open(&card.name, &all)
            .unwrap_or_else(|why| panic!("{why}"));
        assert!(
            stage
                .body_swatches
                .iter()
                .all(|&i| i < stage.swatches.len())
        );
    }
    assert!(shelf.open("no-such-scene", &vec![]).is_err());
}

mod drawn {
    //! Pictures, where there is something to draw with.

    use super::*;
    use eframe::egui_wgpu::{
        RenderState, RendererOptions, WgpuConfiguration, WgpuSetup, WgpuSetupCreateNew,
    };
    use egui_kittest::wgpu::WgpuTestRenderer;

    /// `None` where there is no adapter.
    fn renderer() -> Option<WgpuTestRenderer> {
        let setup = WgpuSetup::CreateNew(WgpuSetupCreateNew::without_display_handle());
        let configuration = WgpuConfiguration {
            wgpu_setup: setup.clone(),
            ..WgpuConfiguration::default()
        };
        let instance = pollster::block_on(setup.new_instance());
        let created = RenderState::create(
            &configuration,
            &instance,
            None,
            RendererOptions::PREDICTABLE,
        );
        let state = pollster::block_on(created).ok()?;
        lahar_app::renderer::install(&state);
        Some(WgpuTestRenderer::from_render_state(state))
    }

    #[test]
    fn water_is_seen_where_it_is() {
        for scene in ["dam-break", "dam-break-3d"] {
            let Some(renderer) = renderer() else { return };
            let mut state = AppState::new(support::Blocks.list(), DEFAULT_SCENE, Some(scene));
            state.show_panel = false;
            state.show_hints = false;
            state.receive(shown(scene, 1));
            let mut harness = Harness::builder()
                .with_size(Vec2::new(600.0, 400.0))
                .renderer(renderer)
                .build_ui_state(|ui, state: &mut AppState| view::window(state, ui), state);
            harness.run();
            let picture = harness.render().unwrap();
            let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
            picture.save(folder.join(format!("{scene}.png"))).unwrap();

            let state = harness.state();
            let camera = state.camera.as_ref().unwrap();
            let colour_at = |point| {
                let [x, y] = camera.project(point, state.aspect).unwrap();
                let at = [(0.5 + 0.5 * x) * 600.0, (0.5 - 0.5 * y) * 400.0];
                let [r, g, b, _] = picture.get_pixel(at[0] as u32, at[1] as u32).0;
                [r, g, b].map(i32::from)
            };
            // Teal in the middle of the block, the background in the far corner.
            let [r, g, b] = colour_at([0.5, 0.6, if scene == "dam-break" { 0.0 } else { 0.5 }]);
            assert!(g > r + 30 && b > r + 30, "{scene}: {r} {g} {b}");
            let [r, g, b] = colour_at([1.9, 1.1, if scene == "dam-break" { 0.0 } else { 0.5 }]);
            assert_eq!([r, g, b], [0x11, 0x2f, 0x41], "{scene}");
        }
    }
}
