//! The scene itself, the hands in it, and what is written over it.

use eframe::egui::{
    self, Align2, Color32, CornerRadius, FontId, PointerButton, Pos2, Rect, RichText, Sense, Shape,
    Stroke, Ui, Vec2, pos2, vec2,
};

use crate::app_state::{AppState, Grip, round_step, within};
use crate::colour::{self, ColourBy};
use crate::controls::{Action, Hint, KEY_HINTS, MOUSE_HINTS_2D, MOUSE_HINTS_3D, actions};
use crate::panel::{grouped, millions, panel, real_time};
use crate::solver::Condition;

const INK: Color32 = Color32::from_rgb(0xd7, 0xe3, 0xea);
/// Room for a scene's small picture.
const THUMBNAIL: Vec2 = vec2(112.0, 64.0);
const SHADE: Color32 = Color32::from_black_alpha(140);

/// Everything in the window: keys, panel, scene, and what lies over it.
pub fn window(state: &mut AppState, ui: &mut Ui) {
    keys(state, ui);
    if state.show_panel {
        egui::Panel::left("panel")
            .resizable(false)
            .exact_size(272.0)
            .show(ui, |ui| panel(state, ui));
    }
    egui::CentralPanel::default()
        .frame(egui::Frame::NONE.fill(state.background()))
        .show(ui, |ui| {
            let size = ui.available_size();
            let (rect, response) = ui.allocate_exact_size(size, Sense::drag());
            scene(state, ui, rect, &response);
        });
    scene_list(state, ui);
}

fn keys(state: &mut AppState, ui: &Ui) {
    // Escape takes the keyboard away from a widget before it closes the window. egui has already
    // done so when this runs: what counts is who had it in the last frame.
    let id = egui::Id::unique("keyboard was taken");
    let focused = ui.ctx().memory(|memory| memory.focused().is_some());
    let was_focused = ui.ctx().data_mut(|data| {
        let was: bool = data.get_temp(id).unwrap_or(false);
        data.insert_temp(id, focused);
        was
    });
    let asked = ui.input(|input| actions(input, focused || was_focused));
    for action in asked {
        state.act(action);
    }
}

fn scene(state: &mut AppState, ui: &mut Ui, rect: Rect, response: &egui::Response) {
    if rect.width() < 1.0 || rect.height() < 1.0 {
        return;
    }
    let aspect = f64::from(rect.width() / rect.height());
    if (state.aspect - aspect).abs() > 1e-6 {
        let first = state.shown().number == 0;
        state.aspect = aspect;
        if !first && state.readouts().time == 0.0 {
            state.act(Action::Fit);
        }
    }
    pointer(state, ui, rect, response);

    let pixels = rect.size() * ui.pixels_per_point();
    if let Some(picture) = state.picture([pixels.x.round(), pixels.y.round()]) {
        ui.painter().add(picture.shape(rect));
    }
    hand(state, ui, rect);
    legend(state, ui, rect);
    scale_bar(state, ui, rect);
    status(state, ui, rect);
    if state.show_hints {
        hints(state, ui, rect);
    }
    messages(state, ui, rect);
}

fn pointer(state: &mut AppState, ui: &Ui, rect: Rect, response: &egui::Response) {
    let solid = state.facts().is_some_and(|facts| facts.dimension == 3);
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
        }
    }

    let left = response.dragged_by(PointerButton::Primary);
    let right = response.dragged_by(PointerButton::Secondary);
    let middle = response.dragged_by(PointerButton::Middle);
    let by = response.drag_delta() / rect.height();
    let (x, y) = (f64::from(by.x), f64::from(-by.y));
    let grip = if modifiers.ctrl && left {
        Some(Grip::Drag)
    } else if solid && !modifiers.shift {
        None
    } else if left {
        Some(Grip::Attract)
    } else if right {
        Some(Grip::Repel)
    } else {
        None
    };
    match (grip, at) {
        (Some(grip), Some(at)) => {
            let velocity = [
                f64::from(2.0 * velocity.x / rect.width()),
                f64::from(-2.0 * velocity.y / rect.height()),
            ];
            state.hold(at, grip, velocity);
        }
        _ => state.release(),
    }
    if let Some(camera) = state.camera.as_mut() {
        if middle || (left && modifiers.alt) {
            camera.pan(x, y);
        } else if solid && grip.is_none() && (left || right) {
            camera.orbit(x, y);
        }
    }
}

/// The circle that the hand reaches.
fn hand(state: &AppState, ui: &Ui, rect: Rect) {
    let (Some((position, grip)), Some(camera)) = (state.held, &state.camera) else {
        return;
    };
    let Some([x, y]) = camera.project(position, state.aspect) else {
        return;
    };
    let centre = rect.center() + 0.5 * vec2(x as f32 * rect.width(), -y as f32 * rect.height());
    let radius = state.hand_radius() / camera.half_height_at(position) * 0.5;
    let colour = match grip {
        Grip::Attract => Color32::from_rgb(0x7f, 0xd0, 0x9c),
        Grip::Repel => colour::JELLY,
        Grip::Drag => Color32::WHITE,
    };
    let painter = ui.painter_at(rect);
    painter.circle_stroke(
        centre,
        radius as f32 * rect.height(),
        Stroke::new(1.5, colour),
    );
    painter.circle_filled(centre, 3.0, colour);
}

/// What the colours mean, under the title.
fn legend(state: &AppState, ui: &Ui, rect: Rect) {
    let painter = ui.painter_at(rect);
    let font = FontId::proportional(13.0);
    let Some(facts) = state.facts() else { return };
    let corner = rect.left_top() + vec2(14.0, if state.show_panel { 40.0 } else { 60.0 });
    if state.colour_by == ColourBy::Material {
        if facts.swatches.len() < 2 {
            return; // one needs no telling apart
        }
        for (i, (swatch, colour)) in facts.swatches.iter().zip(&state.palette).enumerate() {
            let at = corner + vec2(6.0, 8.0 + 20.0 * i as f32);
            painter.circle_filled(at, 5.0, *colour);
            let at = at + vec2(12.0, 0.0);
            painter.text(at, Align2::LEFT_CENTER, &swatch.name, font.clone(), INK);
        }
        return;
    }
    let shade = Rect::from_min_size(corner - vec2(4.0, 0.0), vec2(128.0, 188.0));
    painter.rect_filled(shade, CornerRadius::same(4), SHADE);
    let unit = state.colour_by.unit(facts.dimension);
    let mut title = state.colour_by.name().to_owned();
    if !unit.is_empty() {
        title = format!("{title} [{unit}]");
    }
    let at = shade.left_top() + vec2(8.0, 6.0);
    painter.text(at, Align2::LEFT_TOP, title, font.clone(), INK);
    let bar = Rect::from_min_size(shade.left_top() + vec2(10.0, 30.0), vec2(14.0, 146.0));
    let steps = 64;
    for i in 0..steps {
        let at = |k: i32| bar.bottom() - bar.height() * k as f32 / steps as f32;
        let strip = Rect::from_x_y_ranges(bar.x_range(), at(i + 1)..=at(i));
        let colour = colour::along(state.colour_by.ramp(), (i as f32 + 0.5) / steps as f32);
        painter.rect_filled(strip, CornerRadius::ZERO, colour);
    }
    let (low, high) = state.range.ends();
    for (part, value) in [(0.0, low), (0.5, 0.5 * (low + high)), (1.0, high)] {
        let at = pos2(bar.right() + 7.0, bar.bottom() - bar.height() * part);
        painter.text(at, Align2::LEFT_CENTER, short(value), font.clone(), INK);
    }
}

/// A number in a few characters.
fn short(value: f32) -> String {
    let size = value.abs();
    if size != 0.0 && !(1e-3..1e5).contains(&size) {
        format!("{value:.2e}")
    } else if size < 10.0 {
        format!("{value:.3}")
    } else {
        format!("{value:.1}")
    }
}

/// How long a metre is, in 2D.
fn scale_bar(state: &AppState, ui: &Ui, rect: Rect) {
    let Some(camera) = state.camera.as_ref().filter(|camera| camera.dimension == 2) else {
        return;
    };
    let metre = f64::from(rect.height()) / (2.0 * camera.half_height);
    let step = round_step(60.0 / metre);
    let width = (step * metre) as f32;
    let painter = ui.painter_at(rect);
    let end = rect.right_bottom() + vec2(-16.0, -14.0);
    let start = end - vec2(width, 0.0);
    let stroke = Stroke::new(1.0, INK);
    painter.line_segment([start, end], stroke);
    for at in [start, end] {
        painter.line_segment([at - vec2(0.0, 4.0), at], stroke);
    }
    let text = if step >= 1.0 {
        format!("{step} m")
    } else if step >= 0.01 {
        format!("{} cm", (step * 100.0).round())
    } else {
        format!("{:.1e} m", step)
    };
    let middle = start + vec2(0.5 * width, -6.0);
    painter.text(
        middle,
        Align2::CENTER_BOTTOM,
        text,
        FontId::proportional(12.0),
        INK,
    );
}

/// The scene's name, and the numbers that the panel would show if it were open.
fn status(state: &AppState, ui: &Ui, rect: Rect) {
    let Some(facts) = state.facts() else { return };
    let painter = ui.painter_at(rect);
    let now = state.readouts();
    let mut text = facts.card.title.clone();
    if state.speed != 1.0 {
        text += &format!("  ·  speed {}×", state.speed);
    }
    if state.paused {
        text += "  ·  paused";
    }
    let at = rect.left_top() + vec2(14.0, 12.0);
    let title = painter.text(at, Align2::LEFT_TOP, text, FontId::proportional(15.0), INK);
    if !state.show_panel {
        let text = format!(
            "{:.2} s  ·  {}  ·  {} substeps a frame  ·  dt {:.2e} s ({})  ·  {} particles  ·  {} particle-steps/s",
            now.time,
            real_time(state),
            now.substeps_per_frame,
            now.dt,
            now.limit.name(),
            grouped(now.particles as u64),
            millions(now.particle_steps_per_second),
        );
        let at = title.left_bottom() + vec2(0.0, 4.0);
        painter.text(at, Align2::LEFT_TOP, text, FontId::proportional(12.0), INK);
    }
}

/// The keys at the upper right, where scenes have their air; the scenes along the bottom.
fn hints(state: &AppState, ui: &Ui, rect: Rect) {
    let solid = state.facts().is_some_and(|facts| facts.dimension == 3);
    let mouse = if solid {
        MOUSE_HINTS_3D
    } else {
        MOUSE_HINTS_2D
    };
    let font = FontId::proportional(12.0);
    let painter = ui.painter_at(rect);
    let height = 16.0;

    let scenes: Vec<String> = (state.scenes.iter().take(9).enumerate())
        .map(|(i, card)| format!("{} {}", i + 1, card.name))
        .collect();
    let lines = wrap(&painter, &font, &scenes, rect.width() - 190.0);
    for (i, line) in lines.iter().rev().enumerate() {
        let at = rect.left_bottom() + vec2(14.0, -8.0 - height * i as f32);
        painter.text(at, Align2::LEFT_BOTTOM, line, font.clone(), INK);
    }

    let rows: Vec<&Hint> = KEY_HINTS.iter().chain(mouse).collect();
    let size = vec2(400.0, height * rows.len() as f32 + 12.0);
    let table = Rect::from_min_size(rect.right_top() + vec2(-size.x - 10.0, 10.0), size);
    if !rect.contains_rect(table) {
        return; // the panel's tooltips name the keys too
    }
    painter.rect_filled(table, CornerRadius::same(4), Color32::from_black_alpha(80));
    for (i, hint) in rows.iter().enumerate() {
        let at = table.left_top() + vec2(10.0, 6.0 + height * i as f32);
        painter.text(
            at,
            Align2::LEFT_TOP,
            hint.keys,
            font.clone(),
            Color32::WHITE,
        );
        let at = at + vec2(118.0, 0.0);
        painter.text(at, Align2::LEFT_TOP, hint.does, font.clone(), INK);
    }
}

/// Words in lines no wider than `width`.
fn wrap(painter: &egui::Painter, font: &FontId, words: &[String], width: f32) -> Vec<String> {
    let measure = |text: &str| {
        painter
            .layout_no_wrap(text.to_owned(), font.clone(), INK)
            .size()
            .x
    };
    let mut lines: Vec<String> = vec![];
    for word in words {
        match lines.last_mut() {
            Some(line) if measure(&format!("{line}    {word}")) <= width => {
                *line += "    ";
                *line += word;
            }
            _ => lines.push(word.clone()),
        }
    }
    lines
}

/// What went wrong, what is awaited, what was done.
fn messages(state: &mut AppState, ui: &Ui, rect: Rect) {
    let painter = ui.painter_at(rect);
    let now = ui.input(|input| input.time);
    if let Some(why) = state.failure() {
        let text = format!("{why}\n\nR restarts the scene, 1 to 9 choose another.");
        card(&painter, rect, rect.center(), &text, colour::JELLY);
    } else if state.shown().condition == Condition::Opening {
        let text = format!("Opening {} …", state.scene);
        card(
            &painter,
            rect,
            rect.center_top() + vec2(0.0, 60.0),
            &text,
            INK,
        );
    }
    if let Some((text, until)) = &state.notice {
        if now < *until {
            card(
                &painter,
                rect,
                rect.center_top() + vec2(0.0, 60.0),
                text,
                INK,
            );
        } else {
            state.notice = None;
        }
    } else if let Some(facts) = state.facts()
        && state.shown().opened > 0
        && state.readouts().time < 3.0
        && !facts.warnings.is_empty()
    {
        let text = facts.warnings.join("\n");
        card(
            &painter,
            rect,
            rect.center_top() + vec2(0.0, 60.0),
            &text,
            INK,
        );
    }
}

/// Text on a dark card.
fn card(painter: &egui::Painter, rect: Rect, centre: Pos2, text: &str, edge: Color32) {
    let width = (rect.width() - 60.0).clamp(60.0, 760.0);
    let text = painter.layout(
        text.to_owned(),
        FontId::proportional(15.0),
        Color32::WHITE,
        width,
    );
    let size = text.size() + Vec2::splat(28.0);
    let mut frame = Rect::from_center_size(centre, size);
    frame = frame.translate(vec2(0.0, (rect.top() + 6.0 - frame.top()).max(0.0)));
    painter.rect_filled(frame, CornerRadius::same(6), Color32::from_black_alpha(215));
    let outline = egui::epaint::RectShape::stroke(
        frame,
        CornerRadius::same(6),
        Stroke::new(1.0, edge),
        egui::StrokeKind::Inside,
    );
    painter.add(Shape::Rect(outline));
    painter.galley(frame.min + Vec2::splat(14.0), text, Color32::WHITE);
}

/// The scenes with a sentence each.
fn scene_list(state: &mut AppState, ui: &Ui) {
    if !state.show_scenes {
        return;
    }
    let mut chosen = None;
    let mut open = true;
    egui::Window::new("Scenes")
        .open(&mut open)
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_CENTER, Vec2::ZERO)
        .default_size([600.0, 680.0])
        .show(ui.ctx(), |ui| {
            let height = ui.ctx().content_rect().height() - 120.0;
            egui::ScrollArea::vertical()
                .max_height(height)
                .show(ui, |ui| {
                    for (i, scene) in state.scenes.iter().enumerate() {
                        let key = if i < 9 {
                            format!("{}", i + 1)
                        } else {
                            String::new()
                        };
                        ui.horizontal(|ui| {
                            ui.add_sized(
                                [14.0, 18.0],
                                egui::Label::new(RichText::new(key).strong()),
                            );
                            match state.thumbnails.get(&scene.name) {
                                Some(picture) => {
                                    let picture = egui::Image::new(picture);
                                    let picture =
                                        picture.max_size(THUMBNAIL).alt_text(&scene.title);
                                    ui.add_sized(THUMBNAIL, picture);
                                }
                                None => {
                                    ui.allocate_space(THUMBNAIL);
                                }
                            }
                            ui.vertical(|ui| {
                                let mut title = scene.title.clone();
                                if scene.dimension == 3 && !title.contains("3D") {
                                    title += "  (3D)";
                                }
                                let current = scene.name == state.scene;
                                if ui
                                    .selectable_label(current, RichText::new(title).strong())
                                    .clicked()
                                {
                                    chosen = Some(scene.name.clone());
                                }
                                if !scene.sentence.is_empty() {
                                    ui.label(&scene.sentence);
                                }
                            });
                        });
                        ui.add_space(4.0);
                    }
                });
        });
    if !open {
        state.show_scenes = false;
    }
    if let Some(name) = chosen {
        state.open(name);
    }
}
