//! Markdown.

use std::fmt::Write as _;

use lovelock_shadow::{CONVERGED_CHANGE, ShadowMethod};

use crate::grooms::Groom;
use crate::measure::{CONVERGED_POINTS, FIRST, Measured, RUNS, Time};
use crate::{machine, on_gpu};

/// The methods.
pub(crate) fn registry() -> String {
    let mut text = String::from("\n| id | label | what | source |\n|---|---|---|---|\n");
    for method in ShadowMethod::ALL {
        // The text in parentheses repeats the source.
        let what = method.description().split(" (").next().unwrap_or_default().trim_end_matches('.');
        let source = method.source().unwrap_or_default();
        let _ = writeln!(text, "| `{}` | {} | {what} | {source} |", method.id(), method.label());
    }
    text
}

/// The meaning of the columns, and the machine.
pub(crate) fn how_measured() -> String {
    format!(
        "\n\
         Measured on: {machine}. This part is written by\n\n\
         \x20   LOVELOCK_SUITE=long cargo run --release -p lovelock-shadow --example measure_methods -- docs/shadow_methods.md\n\n\
         Every method with its default settings, at every point of the strands. Errors are differences of transmittance:\n\n\
         - *edge*: texels or cells along the edge of the map. Texels are at least as wide as strands, so few strands mean few texels.\n\
         - *exact*: RMSE against `exact` with the same number of texels along the edge.\n\
         - *converged*: RMSE against the converged shadow over texels of the default map of `exact`, at\n\
         \x20 {CONVERGED_POINTS} random points. It changes by less than {CONVERGED_CHANGE} when its samples are doubled.\n\
         - *bias*: mean difference from `exact`, above 0 where a method is too bright.\n\
         - *99 %*: the 99th percentile of the absolute difference from `exact`.\n\
         - *first ten*: RMSE against `exact` over points with fewer than {FIRST} fragments before them.\n\n\
         Times are medians of {RUNS} runs, or of as many as take 10 s, with the quartiles, on a machine that may have been busy. *Map* is the memory of a\n\
         map (address space for the voxel map); *building* is additional memory that builds use and keep.\n\n\
         The second table of a hairstyle compares the CPU with the GPU ({adapter}). *Difference*: the 99th percentile of the\n\
         difference between both, of which rounding to 8 bits contributes 0.002. Times on the GPU are sums over passes, measured with\n\
         timestamps or, on a software adapter, by waiting for each pass. *Held* is *map* plus *building*.\n",
        machine = machine::line(),
        adapter = on_gpu::adapter().unwrap_or_else(|| String::from("there was none")),
    )
}

/// The methods on one hairstyle.
pub(crate) fn hairstyle(groom: &Groom, measured: &[Measured]) -> String {
    let hair = &groom.strands;
    let segments = hair.points() - hair.count();
    let mut text = format!(
        "\n### Measured on {}\n\n{} strands, {} segments, each {:.2} mm wide to the light. ",
        groom.name,
        thousands(hair.count()),
        thousands(segments),
        groom.width * 1e3
    );
    if let Some(exact) = measured.iter().find(|row| row.method == ShadowMethod::Exact) {
        let share = 100.0 * exact.first_points as f64 / hair.points().max(1) as f64;
        let _ = write!(
            text,
            "Texels of {:.2} mm with {} fragments; {share:.0} % of the points are among the first ten.",
            exact.report.cell_size * 1e3,
            thousands(exact.report.samples as usize),
        );
    }
    text.push_str(
        "\n\n| method | edge | exact | converged | bias | 99 % | first ten | build, ms | lookups, ms | map | building |\n\
         |---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for row in measured {
        let errors = &row.errors;
        let edge = if row.method == ShadowMethod::None { String::new() } else { row.edge.to_string() };
        let _ = writeln!(
            text,
            "| `{}` | {edge} | {:.4} | {:.4} | {:+.4} | {:.3} | {:.4} | {} | {} | {} | {} |",
            row.method,
            errors.exact,
            errors.converged,
            errors.bias,
            errors.percentile,
            errors.first,
            milliseconds(&row.build),
            milliseconds(&row.lookup),
            bytes(row.report.memory_bytes),
            bytes(row.report.scratch_bytes),
        );
    }
    text
}

/// The methods on both backends.
pub(crate) fn both_backends(measured: &[Measured]) -> String {
    let mut text = String::from(
        "\n| both backends | exact, CPU | exact, GPU | difference | build, CPU | build, GPU | lookups, CPU | lookups, GPU | held, CPU | held, GPU |\n\
         |---|---|---|---|---|---|---|---|---|---|\n",
    );
    for row in measured {
        let Some(gpu) = &row.on_gpu else { continue };
        let _ = writeln!(
            text,
            "| `{}` | {:.4} | {:.4} | {:.4} | {} | {} | {} | {} | {} | {} |",
            row.method,
            row.errors.exact,
            gpu.exact,
            gpu.difference,
            digits(row.build.median),
            milliseconds(&gpu.build),
            digits(row.lookup.median),
            milliseconds(&gpu.lookup),
            bytes(row.report.memory_bytes + row.report.scratch_bytes),
            bytes(gpu.held),
        );
    }
    text
}

fn digits(ms: f64) -> String {
    if ms < 10.0 { format!("{ms:.2}") } else { format!("{ms:.1}") }
}

/// A time with three significant digits, or fewer if it is short.
fn milliseconds(time: &Time) -> String {
    let digits = if time.median < 10.0 { 2 } else { 1 };
    format!("{:.digits$} ({:.digits$}–{:.digits$})", time.median, time.low, time.high)
}

fn bytes(bytes: u64) -> String {
    match bytes {
        0 => String::from("0"),
        1..0x10_0000 => format!("{:.0} KiB", bytes as f64 / 1024.0),
        _ => format!("{:.1} MiB", bytes as f64 / f64::from(1 << 20)),
    }
}

/// A number with commas.
fn thousands(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}
