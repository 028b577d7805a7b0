//! The side panel: buttons and sliders for everything that the keys do, and more.

use eframe::egui::{self, DragValue, RichText, Slider, Ui};

use crate::app_state::{AppState, SPEEDS};
use crate::color;
use crate::controls::{Action, Direction};
use crate::solver::Condition;
use lahar_scene::scene::{ColorBy, Comparison, Setting, SettingValue};

/// Shows the whole panel.
pub fn panel(state: &mut AppState, ui: &mut Ui) {
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        ui.heading("lahar");
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if ui
                .small_button("«")
                .on_hover_text("Hide the panel (P)")
                .clicked()
            {
                state.act(Action::Panel);
            }
        });
    });
    let recorded = state.recorded_frames().is_some();
    egui::ScrollArea::vertical().show(ui, |ui| {
        scene(state, ui);
        ui.separator();
        clock(state, ui);
        ui.separator();
        if !recorded {
            gravity(state, ui);
            ui.separator();
        }
        looks(state, ui);
        ui.separator();
        if !recorded {
            pointer(state, ui);
            ui.separator();
        }
        readouts(state, ui);
        if !recorded {
            ui.separator();
            egui::CollapsingHeader::new("Settings of the scene").show(ui, |ui| settings(state, ui));
            egui::CollapsingHeader::new("Compare")
                .default_open(state.comparison().is_some())
                .show(ui, |ui| compare(state, ui));
        }
        ui.add_space(8.0);
    });
}

/// Shows the player below a recording: play and pause, and a slider over its frames.
pub fn player(state: &mut AppState, ui: &mut Ui, frames: usize) {
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        let stands = state.paused || state.solver().condition == Condition::Ended;
        let (label, hint) = if stands {
            ("Play", "Space")
        } else {
            ("Pause", "Space")
        };
        let size = egui::vec2(54.0, ui.spacing().interact_size.y);
        if ui
            .add_sized(size, egui::Button::new(label))
            .on_hover_text(hint)
            .clicked()
        {
            state.act(Action::Pause);
        }
        let now = state.readouts();
        let last = frames.saturating_sub(1);
        let mut frame = now.frame;
        let text = format!("frame {} of {}  ·  {:.3} s", now.frame, last, now.time);
        ui.spacing_mut().slider_width = (ui.available_width() - 200.0).max(40.0);
        let slider = Slider::new(&mut frame, 0..=last).show_value(false);
        let slider = ui.add(slider);
        let label = ui.label(text);
        if slider.labelled_by(label.id).changed() {
            state.seek(frame);
        }
    });
    ui.add_space(4.0);
}

/// A widget for a value.
fn value(
    ui: &mut Ui,
    salt: impl std::hash::Hash + std::fmt::Debug,
    value: &mut SettingValue,
) -> egui::Response {
    match value {
        SettingValue::Number(number) => {
            let speed = (number.abs() * 0.01).max(1e-6);
            ui.add(DragValue::new(number).speed(speed).max_decimals(8))
        }
        SettingValue::Word(word, words) => {
            egui::ComboBox::from_id_salt(salt)
                .width(84.0)
                .selected_text(word.as_str())
                .show_ui(ui, |ui| {
                    for choice in *words {
                        ui.selectable_value(word, (*choice).to_owned(), *choice);
                    }
                })
                .response
        }
    }
}

/// Shows the comparison of several values of a setting.
fn compare(state: &mut AppState, ui: &mut Ui) {
    let full_name = |setting: &Setting| match setting.group.as_str() {
        "scene" => setting.name.clone(),
        group => format!("{group}: {}", setting.name),
    };
    let chosen = state.settings.iter().position(|s| s.key == state.draft.key);
    let mut choice = chosen;
    ui.horizontal(|ui| {
        let label = ui.label("setting").id;
        egui::ComboBox::from_id_salt("compared setting")
            .width(160.0)
            .selected_text(chosen.map_or_else(String::new, |i| full_name(&state.settings[i])))
            .show_ui(ui, |ui| {
                for (i, setting) in state.settings.iter().enumerate() {
                    ui.selectable_value(&mut choice, Some(i), full_name(setting));
                }
            })
            .response
            .labelled_by(label);
    });
    if choice != chosen
        && let Some(i) = choice
    {
        state.draft.choose(&state.settings[i]);
    }
    let mut removed = None;
    let several = state.draft.values.len() > 2;
    for (i, draft) in state.draft.values.iter_mut().enumerate() {
        ui.horizontal(|ui| {
            let label = ui.label(format!("value {}", i + 1)).id;
            value(ui, ("compared value", i), draft).labelled_by(label);
            if several
                && ui
                    .small_button("×")
                    .on_hover_text("Remove this value")
                    .clicked()
            {
                removed = Some(i);
            }
        });
    }
    if let Some(i) = removed {
        state.draft.values.remove(i);
    }
    ui.horizontal(|ui| {
        let ready = state.draft.comparison();
        let run = egui::Button::new("Side by side");
        if ui
            .add_enabled(ready.is_some(), run)
            .on_hover_text("Restarts the scene with each of the values (V)")
            .clicked()
        {
            state.compare(ready);
        }
        let running = state.comparison().is_some();
        if ui
            .add_enabled(running, egui::Button::new("Alone"))
            .on_hover_text("The scene as it was (V)")
            .clicked()
        {
            state.compare(None);
        }
        let room = (2..Comparison::MOST).contains(&state.draft.values.len());
        if ui
            .add_enabled(room, egui::Button::new("One more"))
            .clicked()
        {
            state.draft.add();
        }
    });
}

/// Shows resolution, schemes and material parameters. They take effect with a restart.
fn settings(state: &mut AppState, ui: &mut Ui) {
    let mut group = String::new();
    egui::Grid::new("settings").num_columns(2).show(ui, |ui| {
        for setting in &mut state.settings {
            if setting.group != group {
                group.clone_from(&setting.group);
                ui.label(RichText::new(&group).strong());
                ui.end_row();
            }
            let label = ui.label(&setting.name).id;
            value(ui, &setting.key, &mut setting.value).labelled_by(label);
            ui.end_row();
        }
    });
    ui.horizontal(|ui| {
        if ui
            .button("Apply")
            .on_hover_text("Restarts the scene with these")
            .clicked()
        {
            state.apply_settings();
        }
        let own = ui.add_enabled(state.has_changes(), egui::Button::new("As in the file"));
        if own.clicked() {
            state.forget_settings();
        }
    });
}

fn scene(state: &mut AppState, ui: &mut Ui) {
    let mut chosen = None;
    let title = state
        .info()
        .map_or_else(|| state.scene.clone(), |info| info.card.title.clone());
    ui.horizontal(|ui| {
        let label = ui.label("scene").id;
        egui::ComboBox::from_id_salt("scene")
            .selected_text(title)
            .width(140.0)
            .show_ui(ui, |ui| {
                for (i, card) in state.scenes.iter().enumerate() {
                    let title = &card.title;
                    let text = if i < 9 {
                        format!("{}  {title}", i + 1)
                    } else {
                        title.clone()
                    };
                    if ui
                        .selectable_label(card.name == state.scene, text)
                        .clicked()
                    {
                        chosen = Some(card.name.clone());
                    }
                }
            })
            .response
            .labelled_by(label);
        if ui
            .button("List")
            .on_hover_text("All scenes, with pictures (L)")
            .clicked()
        {
            state.act(Action::SceneList);
        }
    });
    if let Some(name) = chosen {
        state.open(name);
    }
}

fn clock(state: &mut AppState, ui: &mut Ui) {
    let recorded = state.recorded_frames().is_some();
    ui.horizontal(|ui| {
        if ui.button("Restart").on_hover_text("R").clicked() {
            state.act(Action::Restart);
        }
        if !recorded {
            let pause = if state.paused { "Go on" } else { "Pause" };
            if ui.button(pause).on_hover_text("Space").clicked() {
                state.act(Action::Pause);
            }
        }
        let (step, key) = if recorded {
            ("Next frame", ".")
        } else {
            ("Substep", ".")
        };
        if ui.button(step).on_hover_text(key).clicked() {
            state.act(Action::Substep);
        }
    });
    let mut speed = state.speed;
    let slider = Slider::new(&mut speed, SPEEDS[0]..=SPEEDS[SPEEDS.len() - 1])
        .logarithmic(true)
        .suffix("×")
        .text("speed");
    if ui
        .add(slider)
        .on_hover_text("Largest speed, in simulated seconds per second (+ and −)")
        .changed()
    {
        state.set_speed(speed);
    }
}

fn gravity(state: &mut AppState, ui: &mut Ui) {
    let mut gravity = state.gravity;
    let dimension = state.info().map_or(2, |info| info.dimension);
    let most = 2.0 * state.scene_gravity();
    let mut changed = false;
    for (component, name) in gravity.iter_mut().zip(["x", "y", "z"]).take(dimension) {
        let slider = Slider::new(component, -most..=most)
            .suffix(" m/s²")
            .text(format!("gravity {name}"))
            .fixed_decimals(2);
        changed |= ui.add(slider).changed();
    }
    if changed {
        state.set_gravity(gravity);
    }
    ui.horizontal(|ui| {
        for (label, name, direction) in [
            ("←", "left (A)", Direction::Left),
            ("→", "right (D)", Direction::Right),
            ("↑", "up (W)", Direction::Up),
            ("↓", "down (S)", Direction::Down),
        ] {
            let text = format!("Gravity to the window's {name}");
            let arrow = RichText::new(label).monospace(); // the font that has arrows
            if ui.button(arrow).on_hover_text(text).clicked() {
                state.act(Action::Gravity(direction));
            }
        }
        if ui.button("None").clicked() {
            state.set_gravity([0.0; 3]);
        }
        let own = state.info().map(|info| info.gravity);
        if ui.button("Scene's").clicked()
            && let Some(own) = own
        {
            state.set_gravity(own);
        }
    });
}

fn looks(state: &mut AppState, ui: &mut Ui) {
    let mut by = state.color_by;
    egui::ComboBox::from_label("colors")
        .selected_text(color::name(by))
        .show_ui(ui, |ui| {
            for choice in color::ORDER {
                ui.selectable_value(&mut by, choice, color::name(choice));
            }
        });
    if by != state.color_by {
        state.set_color_by(by);
    }
    ui.add(
        Slider::new(&mut state.radius, 0.1..=2.0)
            .text("radius")
            .fixed_decimals(2),
    )
    .on_hover_text(
        "Radius of a particle, in parts of the distance to its neighbors or of the scene's own radius",
    );
    ui.horizontal(|ui| {
        let label = ui.label("background").id;
        ui.color_edit_button_srgba(&mut state.background)
            .labelled_by(label);
    });
    if state.color_by == ColorBy::Material {
        let names: Vec<String> = state
            .info()
            .map(|info| info.swatches.iter().map(|s| s.name.clone()).collect())
            .unwrap_or_default();
        let mut changed = false;
        for (color, name) in state.palette.iter_mut().zip(&names) {
            ui.horizontal(|ui| {
                let label = ui.label(name).id;
                changed |= ui
                    .color_edit_button_srgba(color)
                    .labelled_by(label)
                    .changed();
            });
        }
        if changed {
            state.palette_changed();
        }
    }
}

fn pointer(state: &mut AppState, ui: &mut Ui) {
    let gravity = state.scene_gravity();
    ui.add(
        Slider::new(&mut state.pointer_tool.pull, 0.1 * gravity..=20.0 * gravity)
            .logarithmic(true)
            .max_decimals(1)
            .suffix(" m/s²")
            .text("mouse"),
    )
    .on_hover_text("How strongly the mouse attracts and repels, pushes and pulls");
    let dimension = state.info().map_or(2, |info| info.dimension);
    let smallest = state.scenery.smallest_side(dimension);
    ui.horizontal(|ui| {
        let mut everywhere = state.pointer_tool.reach.is_infinite();
        let most = 2.0 * smallest;
        let mut reach = state.pointer_tool.reach.min(most);
        let slider = Slider::new(&mut reach, 0.01 * most..=most)
            .logarithmic(true)
            .max_decimals(3)
            .suffix(" m");
        let slider = ui
            .add_enabled(!everywhere, slider)
            .on_hover_text("How far the mouse reaches");
        let toggled = ui.checkbox(&mut everywhere, "all").changed();
        ui.label("reach");
        if slider.changed() || toggled {
            state.pointer_tool.reach = if everywhere { f64::INFINITY } else { reach };
        }
    });
}

fn readouts(state: &AppState, ui: &mut Ui) {
    let now = state.readouts();
    let recorded = state.recorded_frames();
    if let Some(first) = state.sides().first().filter(|side| !side.title.is_empty()) {
        ui.label(RichText::new(&first.title).strong());
    }
    egui::Grid::new("readouts").num_columns(2).show(ui, |ui| {
        let mut row = |name: &str, value: String| {
            ui.label(name);
            ui.label(RichText::new(value).monospace());
            ui.end_row();
        };
        row("simulated", format!("{:.3} s", now.time));
        row("real time", real_time(state));
        if let Some(frames) = recorded {
            row("frame", format!("{} of {}", now.frame, frames - 1));
        } else {
            row("substeps per frame", now.substeps_per_frame.to_string());
            row("dt", format!("{:.3e} s", now.dt));
            row("limited by", now.limit.name().to_owned());
            let rate = millions(now.particle_steps_per_second);
            row("particle-steps/s", rate);
            if now.retries > 0 {
                row("retries", now.retries.to_string());
            }
        }
        row("particles", grouped(now.particles as u64));
        if let Some(info) = state.info() {
            row("numbers", info.numbers.clone());
        }
    });
}

/// The speed relative to real time, as in "0.98×", or the reason why there is none.
pub fn real_time(state: &AppState) -> String {
    match state.solver().condition {
        Condition::Running => format!("{:.2}×", state.readouts().real_time),
        Condition::Paused => "paused".to_owned(),
        Condition::Ended => "at the end".to_owned(),
        Condition::Opening => "opening".to_owned(),
        Condition::Failed(_) => "stopped".to_owned(),
    }
}

/// A rate in millions, as in "12.30 M".
pub fn millions(rate: f64) -> String {
    format!("{:.2} M", rate / 1e6)
}

/// A number with a thin space between groups of digits, as in "12 345".
pub fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push('\u{202f}');
        }
        out.push(digit);
    }
    out
}
