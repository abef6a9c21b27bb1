//! The memory that this process holds.

/// Lets [`peak_memory_bytes`] begin anew at what the process holds now.
pub(super) fn reset_peak_memory() {
    // Of Linux alone (man 5 proc). Where it cannot be written, the peak is that of the process so far.
    if cfg!(target_os = "linux") {
        let _ = std::fs::write("/proc/self/clear_refs", "5");
    }
}

/// The most memory that this process has held since [`reset_peak_memory`], bytes.
pub(super) fn peak_memory_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kib| kib * 1024)
}
