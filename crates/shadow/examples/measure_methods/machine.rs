//! The machine that times depend on.

use lovelock_base::simd::Width;

/// The CPU, threads and vector width, as one line.
pub(crate) fn line() -> String {
    let threads = rayon::current_num_threads();
    let plural = if threads == 1 { "" } else { "s" };
    format!("{}, {threads} thread{plural}, {}", processor(), width(Width::widest()))
}

/// The name of the CPU; its architecture if the system does not provide the name.
fn processor() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = info.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    let architecture = std::env::consts::ARCH;
    name.map_or_else(|| architecture.to_owned(), |(_, name)| format!("{} ({architecture})", name.trim()))
}

fn width(width: Width) -> &'static str {
    match width {
        Width::Baseline => "vectors of the baseline",
        #[cfg(target_arch = "x86_64")]
        Width::Avx2 => "vectors of 256 bits (AVX2)",
        #[cfg(target_arch = "x86_64")]
        Width::Avx512 => "vectors of 512 bits (AVX-512)",
    }
}
