//! The window on the screen: eframe around [`AppState`] and [`Solver`].

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

use eframe::egui::{self, ColorImage};
use eframe::egui_wgpu::wgpu;
use lahar_io::image::Picture;

use crate::app_state::{AppState, Effect};
use crate::meter::Meter;
use crate::scenes::SceneSource;
use crate::solver::Solver;
use crate::{palette, renderer, screenshot, view};

/// The application that eframe runs.
pub(crate) struct Window {
    state: AppState,
    solver: Solver,
    screenshots: PathBuf,
    pictures: (Sender<Arc<ColorImage>>, Receiver<Arc<ColorImage>>),
    source: Arc<dyn SceneSource>,
    thumbnails: Option<Receiver<(String, Picture)>>,
    meter: Option<Meter>,
}

impl Window {
    pub(crate) fn new(
        context: &eframe::CreationContext<'_>,
        state: AppState,
        solver: Solver,
        source: Arc<dyn SceneSource>,
        screenshots: PathBuf,
        meter: Option<Meter>,
    ) -> Self {
        let mut pause = Duration::ZERO;
        if let Some(render_state) = &context.wgpu_render_state {
            renderer::install(render_state);
            if render_state.adapter.get_info().device_type == wgpu::DeviceType::Cpu {
                pause = SOFTWARE_PAUSE;
            }
        }
        let repaint = context.egui_ctx.clone();
        solver.on_new_state(move || repaint.request_repaint_after(pause));
        style(&context.egui_ctx);
        Self {
            state,
            solver,
            screenshots,
            pictures: channel(),
            source,
            thumbnails: None,
            meter,
        }
    }

    fn carry_out(&mut self, context: &egui::Context) {
        for effect in self.state.take_effects() {
            match effect {
                Effect::Order(order) => self.solver.order(order),
                Effect::Close => context.send_viewport_cmd(egui::ViewportCommand::Close),
                Effect::Thumbnails => self.draw_thumbnails(context),
                Effect::Screenshot => {
                    let pictures = self.pictures.0.clone();
                    let repaint = context.clone();
                    context.request_screenshot(move |picture| {
                        // The receiver is gone only with the window, which nobody misses the picture of.
                        let _ = pictures.send(picture);
                        repaint.request_repaint();
                    });
                }
            }
        }
    }

    /// Draws small pictures of all scenes on a thread of its own, since scenes must be built to be drawn.
    fn draw_thumbnails(&mut self, context: &egui::Context) {
        let repaint = context.clone();
        let (sender, receiver) = channel();
        let source = Arc::clone(&self.source);
        let draw = move || {
            for card in source.list() {
                if let Some(picture) = source.thumbnail(&card.name, THUMBNAIL_PIXELS) {
                    if sender.send((card.name, picture)).is_err() {
                        return;
                    }
                    repaint.request_repaint();
                }
            }
        };
        // Without a thread the list has no pictures; it is still usable.
        let thread = std::thread::Builder::new().name("lahar thumbnails".into());
        self.thumbnails = thread.spawn(draw).ok().map(|_| receiver);
    }

    fn take_thumbnails(&mut self, context: &egui::Context) {
        for (name, picture) in self.thumbnails.iter().flat_map(Receiver::try_iter) {
            let size = [picture.width as usize, picture.height as usize];
            let image = ColorImage::from_rgb(size, &picture.rgb);
            let texture = context.load_texture(&name, image, egui::TextureOptions::LINEAR);
            self.state.thumbnails.insert(name, texture);
        }
    }
}

/// Delay between a new state and its picture where the processor draws, since drawing takes time from the solver.
const SOFTWARE_PAUSE: Duration = Duration::from_millis(50);

/// The window is drawn at least this often.
const IDLE: Duration = Duration::from_millis(100);

/// Size of a scene's small picture, two pixels per point.
const THUMBNAIL_PIXELS: [u32; 2] = [224, 128];

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        let context = ui.ctx().clone();
        if let Some(state) = self.solver.newest() {
            self.state.receive(state);
        }
        while let Ok(picture) = self.pictures.1.try_recv() {
            let saved = screenshot::save(&self.screenshots, &self.state.scene, &picture);
            let text = match saved {
                Ok(path) => format!("Saved {}", path.display()),
                Err(why) => why,
            };
            self.state.notify(text, ui.input(|input| input.time));
        }
        self.take_thumbnails(&context);
        view::window(&mut self.state, ui);
        self.carry_out(&context);
        if let Some(meter) = &mut self.meter {
            meter.drawn(self.state.sides());
        }
        // The solver asks for a picture when it has a new state. Drawing now and then besides lets notices disappear
        // and a resting pointer stop dragging.
        context.request_repaint_after(IDLE);
    }

    fn clear_color(&self, _visuals: &egui::Visuals) -> [f32; 4] {
        palette::BACKGROUND.to_normalized_gamma_f32()
    }
}

/// Sets a dark theme that suits the scene's colors.
pub(crate) fn style(context: &egui::Context) {
    context.set_theme(egui::Theme::Dark);
    context.style_mut_of(egui::Theme::Dark, |style| {
        style.visuals.panel_fill = egui::Color32::from_rgb(0x16, 0x22, 0x2b);
        style.visuals.window_fill = egui::Color32::from_rgb(0x16, 0x22, 0x2b);
        style.visuals.selection.bg_fill = egui::Color32::from_rgb(0x06, 0x66, 0x70);
        style.visuals.override_text_color = Some(egui::Color32::from_rgb(0xd7, 0xe3, 0xea));
        style.spacing.slider_width = 90.0;
    });
}
