//! `lovelock compare`.

use std::fmt::Write;
use std::ops::Range;

use lovelock_project::error::ProjectError;
use lovelock_render::ShadowMethod;
use lovelock_study::batch::CompareRequest;
use lovelock_study::report::{CompareReport, MethodReport};

use super::args::Compare;
use super::output::Output;
use super::replace::{self, Holds};
use super::source::Source;

/// Compares methods and writes a report.
pub(crate) fn run(task: &Compare, output: Output) -> Result<(), ProjectError> {
    let one = task.frame.map(one_frame).transpose()?;
    let files = ["report.html", "report.csv", "report.json"].map(str::to_owned);
    let replaced = replace::check_in(&task.out, files, Holds::REPORT, task.force)?;
    let mut scene = Source::open(&task.source)?;
    let request = CompareRequest {
        out: task.out.clone(),
        name: scene.name.clone(),
        frames: task.frames.clone().or(one),
        fps: task.picture.fps,
        size: task.picture.size,
        methods: compared(task),
        draws_as: task.draw.clone(),
        transparencies: task.transparency.clone(),
        backends: task.backend.clone().map(|backends| backends.0).unwrap_or_default(),
        sweeps: task.sweep.clone(),
        probes: task.probe.clone(),
        draws: task.draws.unwrap_or(if task.quick {
            CompareRequest::QUICK_DRAWS
        } else {
            CompareRequest::DEFAULT_DRAWS
        }),
        quick: task.quick,
        film: !task.no_film,
        access: std::mem::take(&mut scene.access),
        gpu: None,
    };
    let report =
        scene.watched(|project, progress| lovelock_study::batch::compare(project, &request, progress))?;
    replaced.tell();
    output.result(&report, || summary(&report, &task.out.join("report.html").display().to_string()))
}

/// The methods that are named, and the user's own; none stands for all of the program.
fn compared(task: &Compare) -> Vec<ShadowMethod> {
    let named = &task.methods.0;
    let named = if named.is_empty() && !task.method.is_empty() { ShadowMethod::ALL } else { named };
    named.iter().copied().chain(task.method.iter().copied().map(ShadowMethod::User)).collect()
}

/// The range of one frame.
///
/// # Errors
/// The largest integer: no range can end after it.
fn one_frame(frame: u64) -> Result<Range<u64>, ProjectError> {
    let end = frame.checked_add(1);
    let end =
        end.ok_or_else(|| ProjectError::option(format!("--frame: found {frame}; must be inside the clip")))?;
    Ok(frame..end)
}

/// The path of the page, warnings about its numbers, and a table of the most important numbers per backend.
fn summary(report: &CompareReport, page: &str) -> String {
    let mut text = format!("{page}\n");
    let mut line = |line: std::fmt::Arguments| {
        let _ = text.write_fmt(line);
        text.push('\n');
    };
    let reference = &report.reference;
    if !reference.converged {
        line(format_args!(
            "the reference did not converge: {:.4} in the last round, the limit is {:.4}",
            reference.change, reference.limit
        ));
    }
    if let Some(change) = reference.doubt_at_points() {
        line(format_args!("errors at points below {change:.4} may come from the reference"));
    }
    if let Some(between) = &reference.gpu_from_cpu {
        line(format_args!(
            "the GPU's reference image differs from the CPU's by FLIP {:.4}; no row includes this difference",
            between.flip.mean
        ));
    }
    for sentence in reference.refused.iter().chain(&report.notes) {
        line(format_args!("{sentence}"));
    }
    let names = report.methods.iter().map(|method| method.name.chars().count()).fold(6, usize::max);
    let mut adapters: Vec<(&str, &str)> = Vec::new();
    for method in &report.methods {
        let adapter = (method.backend.as_str(), method.adapter.as_str());
        if !adapters.contains(&adapter) {
            adapters.push(adapter);
        }
    }
    for (backend, adapter) in adapters {
        line(format_args!("\n{backend}: {adapter}; times are medians of up to {} draws", report.scene.draws));
        line(format_args!(
            "{:<names$} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>10}",
            "method", "rmse", "of one", "bias", "FLIP", "build ms", "query ms", "draw ms", "KiB"
        ));
        for method in report.methods.iter().filter(|method| method.backend == backend) {
            line(format_args!("{:<names$} {}", method.name, numbers(method)));
        }
    }
    text
}

/// Errors, times and memory of a method, or the reason why there are none.
fn numbers(method: &MethodReport) -> String {
    if let Some(refused) = &method.refused {
        return refused.clone();
    }
    let number = |value: Option<f64>, places: usize| {
        value.map_or_else(|| "-".to_owned(), |value| format!("{value:.places$}"))
    };
    let bias = method.transmittance.map_or_else(|| "-".to_owned(), |error| format!("{:+.4}", error.bias));
    format!(
        "{:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>10}",
        number(method.transmittance.map(|error| error.rmse), 4),
        number(method.front_error(), 4),
        bias,
        number(method.flip.map(|flip| flip.mean), 4),
        number(method.ms.and_then(|ms| ms.build), 2),
        number(method.ms.and_then(|ms| ms.query), 2),
        number(method.ms.map(|ms| ms.draw), 1),
        number(method.memory_bytes.map(|bytes| bytes as f64 / 1024.0), 0),
    )
}
