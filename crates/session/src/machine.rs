//! The machine that a measurement ran on.

/// Name of the CPU and its number of threads.
pub fn machine() -> String {
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name =
        info.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':')).map(|(_, name)| name);
    format!("{}, {threads} threads", name.map_or(std::env::consts::ARCH, str::trim))
}
