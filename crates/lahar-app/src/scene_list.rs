//! The list of scenes, each with a picture and a sentence. Typing searches it.

use eframe::egui::{self, Align2, Key, RichText, Ui, Vec2, vec2};

use crate::app_state::AppState;
use crate::scenes::SceneCard;

/// Size of a scene's small picture \[points\].
const THUMBNAIL: Vec2 = vec2(112.0, 64.0);

/// Shows the list of scenes. Typing leaves the scenes that contain all the words, the arrows choose one of them, and
/// Enter opens it.
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
                        let here = place == state.search.chosen;
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

/// Shows the line to type in. Returns the scenes found, and true if another one of them is chosen than before.
fn search(state: &mut AppState, ui: &mut Ui, chosen: &mut Option<String>) -> (Vec<usize>, bool) {
    let before = state.search.clone();
    let search = &mut state.search;
    let hint = "type to find one; arrows, Enter";
    let line = egui::TextEdit::singleline(&mut search.text).hint_text(hint);
    let line = ui.add(line.desired_width(f32::INFINITY));
    if search.text != before.text {
        search.chosen = 0;
    }
    let has_all = |card: &SceneCard| {
        let text = format!("{} {} {}", card.name, card.title, card.sentence).to_lowercase();
        (search.text.to_lowercase().split_whitespace()).all(|word| text.contains(word))
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
        search.chosen = (search.chosen + usize::from(down)).saturating_sub(usize::from(up));
    }
    search.chosen = search.chosen.min(found.len().saturating_sub(1));
    if enter && line.lost_focus() {
        *chosen = found
            .get(search.chosen)
            .map(|&index| state.scenes[index].name.clone());
    }
    let nothing_is_focused = ui.memory(|memory| memory.focused().is_none());
    if nothing_is_focused {
        line.request_focus();
    }
    (found, state.search != before)
}

/// Shows one scene and returns its title. Enter opens it if `here` is true.
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
