//! Peak memory of this process.

/// Resets [`peak_memory_bytes`] to the current memory of the process.
pub(super) fn reset_peak_memory() {
    // Linux only (man 5 proc). If it cannot be written, the peak covers the whole life of the process.
    if cfg!(target_os = "linux") {
        let _ = std::fs::write("/proc/self/clear_refs", "5");
    }
}

/// Peak memory of this process since [`reset_peak_memory`], bytes.
pub(super) fn peak_memory_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kib| kib * 1024)
}
