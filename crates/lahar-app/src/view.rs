//! The contents of the window: keys, panel, and the scene with the mouse pointer in it.

use eframe::egui::{self, PointerButton, Rect, Sense, Ui, vec2};

use crate::app_state::AppState;
use crate::camera::sub;
use crate::controls::{Action, actions, held_direction};
use crate::overlay;
use crate::panel::{panel, player};
use crate::pointer::{PointerMode, within};
use crate::scene_list::scene_list;

/// Handles the keys and shows the panel, the scene, and the texts over it.
pub fn window(state: &mut AppState, ui: &mut Ui) {
    keys(state, ui);
    if state.show_panel {
        egui::Panel::left("panel")
            .resizable(false)
            .exact_size(272.0)
            .show(ui, |ui| panel(state, ui));
    }
    if let Some(frames) = state.recorded_frames() {
        egui::Panel::bottom("player").show(ui, |ui| player(state, ui, frames));
    }
    // No fill is needed: the picture covers the area, or the window's own color shows.
    egui::CentralPanel::default()
        .frame(egui::Frame::NONE)
        .show(ui, |ui| {
            let size = ui.available_size();
            let (rect, response) = ui.allocate_exact_size(size, Sense::drag());
            scene(state, ui, rect, &response);
        });
    scene_list(state, ui);
}

fn keys(state: &mut AppState, ui: &Ui) {
    // Escape takes the keyboard away from a widget before it closes the window. egui has done so already when this
    // runs, so the focus in the frame before counts as well.
    let id = egui::Id::unique("keyboard was taken");
    let focused = ui.ctx().memory(|memory| memory.focused().is_some());
    let was_focused = ui.ctx().data_mut(|data| {
        let was: bool = data.get_temp(id).unwrap_or(false);
        data.insert_temp(id, focused);
        was
    });
    let focused = focused || was_focused;
    let (asked, held) = ui.input(|input| {
        let held = held_direction(input, state.gravity_key);
        (actions(input, focused), held.filter(|_| !focused))
    });
    let needs_key = state.gravity_needs_key();
    if needs_key {
        let latest = asked.iter().rev().find_map(|action| match action {
            Action::Gravity(direction) => Some(*direction),
            _ => None,
        });
        state.set_gravity_key(latest.or(held));
    }
    for action in asked {
        if !(needs_key && matches!(action, Action::Gravity(_))) {
            state.act(action);
        }
    }
}

/// Divides `rect` into an area for each side, in rows and columns, such that scenes of this aspect are seen as large as
/// possible.
pub fn cells(rect: Rect, sides: usize, aspect: f64) -> Vec<Rect> {
    let sides = sides.max(1);
    let cell = |columns: usize| {
        let rows = sides.div_ceil(columns);
        vec2(rect.width() / columns as f32, rect.height() / rows as f32)
    };
    let seen = |columns: &usize| {
        let size = cell(*columns);
        (size.x / aspect as f32).min(size.y)
    };
    let columns = (1..=sides)
        .max_by(|a, b| seen(a).total_cmp(&seen(b)))
        .unwrap_or(1);
    let size = cell(columns);
    (0..sides)
        .map(|i| {
            let place = vec2((i % columns) as f32, (i / columns) as f32);
            Rect::from_min_size(rect.min + place * size, size)
        })
        .collect()
}

/// The approximate width over height of the scene as it is seen.
fn scene_aspect(state: &AppState) -> f64 {
    /// Of a box seen from a corner.
    const SOLID: f64 = 1.4;
    let (min, max) = state.scenery.extent;
    let size = sub(max, min);
    if state.info().is_some_and(|info| info.dimension == 3) || size[1] <= 0.0 {
        SOLID
    } else {
        size[0] / size[1]
    }
}

fn scene(state: &mut AppState, ui: &mut Ui, rect: Rect, response: &egui::Response) {
    if rect.width() < 1.0 || rect.height() < 1.0 {
        return;
    }
    let cells = cells(rect, state.sides().len(), scene_aspect(state));
    state.set_aspect(f64::from(cells[0].width() / cells[0].height()));
    pointer(state, ui, &cells, response);

    for (side, cell) in cells.iter().enumerate() {
        let pixels = cell.size() * ui.pixels_per_point();
        if let Some(picture) = state.picture(side, [pixels.x.round(), pixels.y.round()]) {
            ui.painter().add(picture.shape(*cell));
        }
    }
    for (side, cell) in cells.iter().enumerate() {
        if side > 0 {
            overlay::edges(ui, rect, *cell);
        }
        overlay::pointer(state, ui, *cell);
        overlay::status(state, ui, *cell, side);
    }
    overlay::legend(state, ui, cells[0]);
    overlay::scale_bar(state, ui, cells[cells.len() - 1]);
    if state.show_hints {
        overlay::hints(state, ui, rect);
    }
    overlay::messages(state, ui, rect);
}

fn pointer(state: &mut AppState, ui: &Ui, cells: &[Rect], response: &egui::Response) {
    // A drag stays with the side that it began in.
    let begun = ui.input(|input| input.pointer.press_origin());
    let over = begun.or(response.hover_pos());
    let side = over.and_then(|at| cells.iter().position(|cell| cell.contains(at)));
    let side = side.unwrap_or(0);
    let rect = cells[side];
    let solid = state.info().is_some_and(|info| info.dimension == 3);
    let (modifiers, velocity, scroll, pinch) = ui.input(|input| {
        (
            input.modifiers,
            input.pointer.velocity(),
            input.smooth_scroll_delta(),
            input.zoom_delta(),
        )
    });
    let aspect = state.aspect;
    let at = response
        .interact_pointer_pos()
        .or(response.hover_pos())
        .map(|at| within(rect, at));

    if response.contains_pointer()
        && let (Some(at), Some(camera)) = (at, state.camera.as_mut())
    {
        let factor = f64::from((scroll.y * 0.002).exp() * pinch);
        if factor != 1.0 {
            camera.zoom(factor, at, aspect);
            state.view_is_own = true;
        }
    }

    let left = response.dragged_by(PointerButton::Primary);
    let right = response.dragged_by(PointerButton::Secondary);
    let middle = response.dragged_by(PointerButton::Middle);
    let by = response.drag_delta() / rect.height();
    let (x, y) = (f64::from(by.x), f64::from(-by.y));
    let recorded = state.recorded_frames().is_some();
    let [of_left, of_right] = state.pointer_tool.button_modes();
    let mode = if recorded {
        None
    } else if modifiers.ctrl && left {
        Some(PointerMode::Drag)
    } else if solid && !modifiers.shift {
        None
    } else if left {
        Some(of_left)
    } else if right {
        Some(of_right)
    } else {
        None
    };
    match (mode, at) {
        (Some(mode), Some(at)) => {
            let velocity = [
                f64::from(2.0 * velocity.x / rect.width()),
                f64::from(-2.0 * velocity.y / rect.height()),
            ];
            state.press_pointer(side, at, mode, velocity);
        }
        _ => state.release_pointer(),
    }
    if let Some(camera) = state.camera.as_mut() {
        let moves = middle || left && (modifiers.alt || recorded && !solid);
        let orbits = !moves && solid && mode.is_none() && (left || right);
        if moves {
            camera.pan(x, y);
        } else if orbits {
            camera.orbit(x, y);
        }
        state.view_is_own |= moves || orbits;
    }
}
