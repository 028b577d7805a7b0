//! The list of scenes: a picture and a sentence each.

use eframe::egui::{self, Align2, RichText, Ui, Vec2, vec2};

use crate::app_state::AppState;

/// Room for a scene's small picture.
const THUMBNAIL: Vec2 = vec2(112.0, 64.0);

/// The scenes with a sentence each.
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
