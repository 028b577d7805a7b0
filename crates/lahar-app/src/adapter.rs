//! Graphics adapters: whether there is one, and where to look for it.

use eframe::egui_wgpu::wgpu;

/// An instance of these backends, without a display.
pub(crate) fn instance(
    wanted: &wgpu::InstanceDescriptor,
    backends: wgpu::Backends,
) -> wgpu::Instance {
    wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends,
        flags: wanted.flags,
        backend_options: wanted.backend_options.clone(),
        memory_budget_thresholds: wanted.memory_budget_thresholds,
        display: None,
    })
}

/// Looks for an adapter, software included.
///
/// # Errors
/// There is none. The message names the backends that were looked for.
pub(crate) fn check(wanted: &wgpu::InstanceDescriptor) -> Result<(), String> {
    let backends = wanted.backends;
    let found = pollster::block_on(instance(wanted, backends).enumerate_adapters(backends));
    if found.is_empty() {
        return Err(none_found(backends));
    }
    Ok(())
}

/// The message that these backends have no adapter.
pub(crate) fn none_found(backends: wgpu::Backends) -> String {
    format!(
        "looked for {backends:?} (on Linux, a software adapter comes with the package mesa-vulkan-drivers)"
    )
}
