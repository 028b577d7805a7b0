//! The list of scenes: a picture and a sentence each, found by typing.

use eframe::egui::{self, Align2, Key, RichText, Ui, Vec2, vec2};

use crate::app_state::AppState;
use crate::scenes::SceneCard;

/// Room for a scene's small picture.
const THUMBNAIL: Vec2 = vec2(112.0, 64.0);

/// The scenes with a sentence each. Typing leaves those that have all the words, the arrows choose,
/// Enter opens.
pub(crate) fn scene_list(state: &mut AppState, ui: &Ui) {
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
            let (found, moved) = search(state, ui, &mut chosen);
            let height = ui.ctx().content_rect().height() - 150.0;
            egui::ScrollArea::vertical()
                .max_height(height)
                .show(ui, |ui| {
                    for (place, &index) in found.iter().enumerate() {
                        let here = place == state.search.1;
                        let row = row(state, ui, index, here);
                        if row.clicked() {
                            chosen = Some(state.scenes[index].name.clone());
                        }
                        if here && moved {
                            row.scroll_to_me(None);
                        }
                        ui.add_space(4.0);
                    }
                });
        });
    if !open || ui.input(|input| input.key_pressed(Key::Escape)) {
        state.show_scenes = false;
    }
    if let Some(name) = chosen {
        state.open(name);
    }
}

/// The line to type in; returns the scenes that it leaves, and whether another one is chosen now.
fn search(state: &mut AppState, ui: &mut Ui, chosen: &mut Option<String>) -> (Vec<usize>, bool) {
    let before = state.search.clone();
    let (typed, at) = &mut state.search;
    let hint = "type to find one; arrows, Enter";
    let line = egui::TextEdit::singleline(typed).hint_text(hint);
    let line = ui.add(line.desired_width(f32::INFINITY));
    if *typed != before.0 {
        *at = 0;
    }
    let has_all = |card: &SceneCard| {
        let text = format!("{} {} {}", card.name, card.title, card.sentence).to_lowercase();
        (typed.to_lowercase().split_whitespace()).all(|word| text.contains(word))
    };
    let found: Vec<usize> = (0..state.scenes.len())
        .filter(|&index| has_all(&state.scenes[index]))
        .collect();
    let (up, down, enter) = ui.input(|input| {
        let pressed = |key| input.key_pressed(key);
        (
            pressed(Key::ArrowUp),
            pressed(Key::ArrowDown),
            pressed(Key::Enter),
        )
    });
    if line.has_focus() {
        *at = (*at + usize::from(down)).saturating_sub(usize::from(up));
    }
    *at = (*at).min(found.len().saturating_sub(1));
    if enter && line.lost_focus() {
        *chosen = found
            .get(*at)
            .map(|&index| state.scenes[index].name.clone());
    }
    let nothing_has_it = ui.memory(|memory| memory.focused().is_none());
    if nothing_has_it {
        line.request_focus();
    }
    (found, state.search != before)
}

/// One scene; returns its title. Enter opens it if `here`.
fn row(state: &AppState, ui: &mut Ui, index: usize, here: bool) -> egui::Response {
    let scene = &state.scenes[index];
    let key = match index {
        0..9 => format!("{}", index + 1),
        _ => String::new(),
    };
    let cells = ui.horizontal(|ui| {
        let key = egui::Label::new(RichText::new(key).strong());
        ui.add_sized([14.0, 18.0], key);
        match state.thumbnails.get(&scene.name) {
            Some(picture) => {
                let picture = egui::Image::new(picture);
                let picture = picture.max_size(THUMBNAIL).alt_text(&scene.title);
                ui.add_sized(THUMBNAIL, picture);
            }
            None => {
                ui.allocate_space(THUMBNAIL);
            }
        }
        let words = ui.vertical(|ui| {
            let mut title = scene.title.clone();
            if scene.dimension == 3 && !title.contains("3D") {
                title += "  (3D)";
            }
            let title = ui.selectable_label(here, RichText::new(title).strong());
            if !scene.sentence.is_empty() {
                ui.label(&scene.sentence);
            }
            title
        });
        words.inner
    });
    cells.inner
}
