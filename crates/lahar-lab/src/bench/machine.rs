//! The machine that measures: its name, clock and memory.

use std::fs;
use std::sync::LazyLock;
use std::time::Instant;

use serde::{Deserialize, Serialize};

/// A machine, which each measured speed belongs to.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    /// Name of the processor, or its architecture if the name is not known.
    pub cpu: String,
    /// Number of threads that can run at the same time.
    pub threads: usize,
    /// Name of the operating system.
    pub system: String,
}

impl Machine {
    /// Returns the machine that this program runs on.
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

/// Returns the seconds since the first call.
pub fn seconds() -> f64 {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    START.elapsed().as_secs_f64()
}

/// Returns the seconds in which threads of this process were ready to compute but had no processor, summed over all
/// threads. `None` if the system does not tell.
pub(super) fn waited() -> Option<f64> {
    let mut nanoseconds = 0.0;
    for task in fs::read_dir("/proc/self/task").ok()? {
        let text = fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
        nanoseconds += text.split_whitespace().nth(1)?.parse::<f64>().ok()?;
    }
    Some(1e-9 * nanoseconds)
}

/// Resets the peak of memory that [`peak`] returns, if the system can.
pub(super) fn forget_peak() {
    // On Linux, 5 sets the peak to the memory in use.
    drop(fs::write("/proc/self/clear_refs", "5"));
}

/// Returns the largest memory of the process so far \[bytes\].
pub(super) fn peak() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024 * kilobytes)
}
