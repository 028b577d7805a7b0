//! The texts over the scene: titles, legend, scale, key hints, messages.

use eframe::egui::{
    self, Align2, Color32, CornerRadius, FontId, Pos2, Rect, Shape, Stroke, Ui, Vec2, pos2, vec2,
};

use crate::app_state::{AppState, Notice};
use lahar_scene::scene::ColorBy;

use crate::color;
use crate::controls;
use crate::palette;
use crate::panel::{grouped, millions, real_time};
use crate::pointer::PointerMode;
use crate::scenery::round_step;
use crate::solver::Condition;

/// Color of texts and thin lines.
const INK: Color32 = Color32::from_rgb(0xd7, 0xe3, 0xea);
/// Color behind the legend.
const SHADE: Color32 = Color32::from_black_alpha(140);

/// Draws the edges between a side and the sides to its left and above.
pub(crate) fn edges(ui: &Ui, rect: Rect, cell: Rect) {
    let stroke = Stroke::new(1.0, Color32::from_white_alpha(60));
    let painter = ui.painter_at(rect);
    if cell.left() > rect.left() {
        painter.vline(cell.left(), cell.y_range(), stroke);
    }
    if cell.top() > rect.top() {
        painter.hline(cell.x_range(), cell.top(), stroke);
    }
}

/// Draws the circle that the pointer reaches while a button is pressed.
pub(crate) fn pointer(state: &AppState, ui: &Ui, rect: Rect) {
    let (Some((position, mode)), Some(camera)) = (state.pressed, &state.camera) else {
        return;
    };
    let Some([x, y]) = camera.project(position, state.aspect) else {
        return;
    };
    let center = rect.center() + 0.5 * vec2(x as f32 * rect.width(), -y as f32 * rect.height());
    let radius = state.pointer_tool.reach / camera.half_height_at(position) * 0.5;
    let color = match mode {
        PointerMode::Attract => Color32::from_rgb(0x7f, 0xd0, 0x9c),
        PointerMode::Repel => palette::JELLY,
        PointerMode::Drag => Color32::WHITE,
    };
    let painter = ui.painter_at(rect);
    if radius.is_finite() {
        let radius = radius as f32 * rect.height();
        painter.circle_stroke(center, radius, Stroke::new(1.5, color));
    }
    painter.circle_filled(center, 3.0, color);
}

/// The largest number of bodies in a legend.
const MAX_NAMED: usize = 12;

/// Draws the meaning of the colors, under the title.
pub(crate) fn legend(state: &AppState, ui: &Ui, rect: Rect) {
    let painter = ui.painter_at(rect);
    let font = FontId::proportional(13.0);
    let Some(info) = state.info() else { return };
    let below_title = if shows_numbers(state) { 60.0 } else { 40.0 };
    let corner = rect.left_top() + vec2(14.0, below_title);
    let named: Option<Vec<(&str, Color32)>> = match state.color_by {
        ColorBy::Material => {
            let swatches = info.swatches.iter().zip(&state.palette);
            Some(
                swatches
                    .map(|(swatch, &color)| (swatch.name.as_str(), color))
                    .collect(),
            )
        }
        ColorBy::Body => {
            let bodies = info.bodies.iter().enumerate().take(MAX_NAMED);
            let color = |number| palette::color_of_body(info, number);
            Some(
                bodies
                    .map(|(number, body)| (body.name.as_str(), color(number)))
                    .collect(),
            )
        }
        ColorBy::Speed | ColorBy::Pressure | ColorBy::Density | ColorBy::Jacobian => None,
    };
    if let Some(named) = named {
        if named.len() < 2 {
            return; // one color needs no legend
        }
        for (i, (name, color)) in named.into_iter().enumerate() {
            let at = corner + vec2(6.0, 8.0 + 20.0 * i as f32);
            painter.circle_filled(at, 5.0, color);
            let at = at + vec2(12.0, 0.0);
            painter.text(at, Align2::LEFT_CENTER, name, font.clone(), INK);
        }
        return;
    }
    let shade = Rect::from_min_size(corner - vec2(4.0, 0.0), vec2(128.0, 188.0));
    painter.rect_filled(shade, CornerRadius::same(4), SHADE);
    let unit = color::unit(state.color_by, info.dimension);
    let mut title = color::name(state.color_by).to_owned();
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
        let color = color::along(state.color_by, (i as f32 + 0.5) / steps as f32);
        painter.rect_filled(strip, CornerRadius::ZERO, color);
    }
    let (low, high) = state.range.ends();
    for (part, value) in [(0.0, low), (0.5, 0.5 * (low + high)), (1.0, high)] {
        let at = pos2(bar.right() + 7.0, bar.bottom() - bar.height() * part);
        painter.text(at, Align2::LEFT_CENTER, short(value), font.clone(), INK);
    }
}

/// Writes a number in a few characters.
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

/// Draws the scale, in 2D.
pub(crate) fn scale_bar(state: &AppState, ui: &Ui, rect: Rect) {
    let Some(camera) = state.camera.as_ref().filter(|camera| camera.dimension == 2) else {
        return;
    };
    let meter = f64::from(rect.height()) / (2.0 * camera.half_height);
    let step = round_step(60.0 / meter);
    let width = (step * meter) as f32;
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

/// True if the numbers are shown over the scene: where there is no panel, or several sides.
fn shows_numbers(state: &AppState) -> bool {
    !state.show_panel || state.sides().len() > 1
}

/// Draws the names of the scene and the side, and the numbers that the panel does not show.
pub(crate) fn status(state: &AppState, ui: &Ui, rect: Rect, side: usize) {
    let Some(info) = state.info() else { return };
    let painter = ui.painter_at(rect);
    let mut parts = vec![];
    if side == 0 {
        parts.push(info.card.title.clone());
    }
    if let Some(side) = state
        .sides()
        .get(side)
        .filter(|side| !side.title.is_empty())
    {
        parts.push(side.title.clone());
    }
    if side == 0 && state.speed != 1.0 {
        parts.push(format!("speed {}×", state.speed));
    }
    if side == 0 && state.paused {
        parts.push("paused".to_owned());
    }
    let at = rect.left_top() + vec2(14.0, 12.0);
    let text = parts.join("  ·  ");
    let title = painter.text(at, Align2::LEFT_TOP, text, FontId::proportional(15.0), INK);
    if !shows_numbers(state) {
        return;
    }
    let Some(now) = state.sides().get(side).map(|side| side.readouts) else {
        return;
    };
    let mut parts = vec![format!("{:.2} s", now.time)];
    if side == 0 {
        parts.push(real_time(state));
    }
    if state.recorded_frames().is_none() {
        parts.push(format!("{} substeps per frame", now.substeps_per_frame));
        parts.push(format!("dt {:.2e} s ({})", now.dt, now.limit.name()));
    }
    parts.push(format!("{} particles", grouped(now.particles as u64)));
    if state.recorded_frames().is_none() {
        let rate = millions(now.particle_steps_per_second);
        parts.push(format!("{rate} particle-steps/s"));
    }
    let at = title.left_bottom() + vec2(0.0, 4.0);
    let font = FontId::proportional(12.0);
    // The last parts are left out until the rest fits.
    loop {
        let text = painter.layout_no_wrap(parts.join("  ·  "), font.clone(), INK);
        if at.x + text.size().x <= rect.right() - 8.0 || parts.len() == 1 {
            painter.galley(at, text, INK);
            return;
        }
        parts.pop();
    }
}

/// Draws the key hints at the upper right, where scenes have their air, and the scenes along the bottom.
pub(crate) fn hints(state: &AppState, ui: &Ui, rect: Rect) {
    let dimension = state.info().map_or(2, |info| info.dimension);
    let rows = controls::hints(
        state.recorded_frames().is_some(),
        dimension,
        state.pointer_tool.push.is_some(),
    );
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

    let size = vec2(400.0, height * rows.len() as f32 + 12.0);
    let top = if shows_numbers(state) { 58.0 } else { 10.0 };
    let table = Rect::from_min_size(rect.right_top() + vec2(-size.x - 10.0, top), size);
    if !rect.contains_rect(table) {
        return; // too small; the panel's tooltips name the keys too
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

/// Joins words to lines no wider than `width`.
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

/// Draws failures, progress, notices and warnings.
pub(crate) fn messages(state: &mut AppState, ui: &Ui, rect: Rect) {
    let painter = ui.painter_at(rect);
    let now = ui.input(|input| input.time);
    state.notify_of_retries(now);
    if let Some(why) = state.failure() {
        let text = format!("{why}\n\nR restarts the scene, 1 to 9 choose another.");
        card(&painter, rect, rect.center(), &text, palette::JELLY);
    } else if state.solver().condition == Condition::Opening {
        let text = format!("Opening {} …", state.scene);
        card(
            &painter,
            rect,
            rect.center_top() + vec2(0.0, 60.0),
            &text,
            INK,
        );
    }
    if let Some(Notice { text, until }) = &state.notice {
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
    } else if let Some(info) = state.info()
        && state.solver().opened > 0
        && state.readouts().time < 3.0
        && !info.warnings.is_empty()
    {
        let text = info.warnings.join("\n");
        card(
            &painter,
            rect,
            rect.center_top() + vec2(0.0, 60.0),
            &text,
            INK,
        );
    }
}

/// Draws a text on a dark card.
fn card(painter: &egui::Painter, rect: Rect, center: Pos2, text: &str, edge: Color32) {
    let width = (rect.width() - 60.0).clamp(60.0, 760.0);
    let text = painter.layout(
        text.to_owned(),
        FontId::proportional(15.0),
        Color32::WHITE,
        width,
    );
    let size = text.size() + Vec2::splat(28.0);
    let mut frame = Rect::from_center_size(center, size);
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
