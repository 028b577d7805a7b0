//! Tests of the window without a display: keys, clicks and drags go in, and orders come out. Tests of the solver stand
//! beside them. Tests that need a graphics adapter pass without one.

mod compare;
mod drawn;
mod keys;
mod mouse;
mod panel;
mod replay;
mod solver;
mod support;

use std::sync::Arc;
use std::time::{Duration, Instant};

use eframe::egui::Vec2;
use egui_kittest::Harness;
use lahar_app::app_state::{AppState, Effect};
use lahar_app::scenes::SceneSource;
use lahar_app::solver::{Order, Readouts, SceneRequest, Solver, SolverState};
use lahar_app::{DEFAULT_SCENE, view};

/// A request for a scene without changes or comparison.
fn alone(scene: &str) -> SceneRequest {
    SceneRequest {
        scene: scene.into(),
        ..SceneRequest::default()
    }
}

fn open(scene: &str) -> Order {
    Order::Open(alone(scene))
}

/// The numbers of the first side.
fn first(shown: &SolverState) -> Readouts {
    shown
        .sides
        .first()
        .map_or_else(Readouts::default, |side| side.readouts)
}

/// The solver's state after opening a scene.
fn opened(name: &str, opened: u64) -> SolverState {
    let mut solver = Solver::start(Arc::new(support::TestScenes), 1).unwrap();
    solver.order(Order::Pause(true));
    solver.order(open(name));
    let mut shown = wait(&mut solver, |shown| shown.opened > 0);
    shown.opened = opened;
    shown
}

/// Waits for a state that satisfies `until`.
fn wait(solver: &mut Solver, until: impl Fn(&SolverState) -> bool) -> SolverState {
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
    harness_of(opened(scene, 1))
}

fn harness_of(shown: SolverState) -> Harness<'static, AppState> {
    let scene = shown.info.as_ref().unwrap().card.name.clone();
    let mut state = AppState::new(
        support::TestScenes.list(),
        DEFAULT_SCENE,
        Some(alone(&scene)),
    );
    state.receive(shown);
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
