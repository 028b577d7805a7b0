//! Pictures of the window, on machines with a graphics adapter.

use super::*;
use eframe::egui_wgpu::{
    RenderState, RendererOptions, WgpuConfiguration, WgpuSetup, WgpuSetupCreateNew,
};
use egui_kittest::wgpu::WgpuTestRenderer;

/// A renderer for tests; `None` if there is no adapter.
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
fn water_is_drawn_in_its_place() {
    for scene in ["dam-break", "dam-break-3d"] {
        let Some(renderer) = renderer() else { return };
        let mut state = AppState::new(
            support::TestScenes.list(),
            DEFAULT_SCENE,
            Some(alone(scene)),
        );
        state.show_panel = false;
        state.show_hints = false;
        state.receive(opened(scene, 1));
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
        let color_at = |point| {
            let [x, y] = camera.project(point, state.aspect).unwrap();
            let at = [(0.5 + 0.5 * x) * 600.0, (0.5 - 0.5 * y) * 400.0];
            let [r, g, b, _] = picture.get_pixel(at[0] as u32, at[1] as u32).0;
            [r, g, b].map(i32::from)
        };
        // The middle of the block is teal, and the far corner shows the background.
        let [r, g, b] = color_at([0.5, 0.6, if scene == "dam-break" { 0.0 } else { 0.5 }]);
        assert!(g > r + 30 && b > r + 30, "{scene}: {r} {g} {b}");
        let [r, g, b] = color_at([1.9, 1.1, if scene == "dam-break" { 0.0 } else { 0.5 }]);
        assert_eq!([r, g, b], [0x11, 0x2f, 0x41], "{scene}");
    }
}
