//! The machine that measures: what it is, its clock, its memory.

use std::fs;
use std::sync::LazyLock;
use std::time::Instant;

use serde::{Deserialize, Serialize};

/// What a speed belongs to.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    /// The processor's name, as far as the system tells it.
    pub cpu: String,
    /// Threads that run at the same time.
    pub threads: usize,
    /// Operating system.
    pub system: String,
}

impl Machine {
    /// The one that this runs on.
    pub fn here() -> Self {
        let cpu = fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| {
            let line = text.lines().find(|line| line.starts_with("model name"))?;
            Some(line.split_once(':')?.1.trim().to_owned())
        });
        Self {
            cpu: cpu.unwrap_or_else(|| std::env::consts::ARCH.to_owned()),
            threads: std::thread::available_parallelism().map_or(1, usize::from),
            system: std::env::consts::OS.to_owned(),
        }
    }
}

/// Seconds since this was first asked.
pub fn seconds() -> f64 {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    START.elapsed().as_secs_f64()
}

/// Seconds that threads of this process were ready to compute and had no processor, all together, if the
/// system says.
pub(super) fn waited() -> Option<f64> {
    let mut nanoseconds = 0.0;
    for task in fs::read_dir("/proc/self/task").ok()? {
        let text = fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
        nanoseconds += text.split_whitespace().nth(1)?.parse::<f64>().ok()?;
    }
    Some(1e-9 * nanoseconds)
}

/// From here on [`peak`] counts anew, where the system can.
pub(super) fn forget_peak() {
    // Linux: 5 sets the peak to what is used now.
    drop(fs::write("/proc/self/clear_refs", "5"));
}

/// The most memory that the process has had \[bytes\].
pub(super) fn peak() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024 * kilobytes)
}
