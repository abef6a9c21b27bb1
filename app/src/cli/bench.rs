//! `lovelock bench`.

use std::ops::ControlFlow;

use lovelock_jobs::bench::{BenchRequest, bench};
use lovelock_project::error::ProjectError;
use lovelock_project::files::write_whole;

use super::args::Bench;
use super::output::Output;

/// Measures the scenes and prints the numbers.
pub(crate) fn run(task: &Bench, output: Output) -> Result<(), ProjectError> {
    let mut request = BenchRequest {
        frames: task.frames,
        size: task.size,
        shadow: task.shadow,
        transparency: task.transparency,
        ..BenchRequest::default()
    };
    if !task.scenes.is_empty() {
        request.scenes.clone_from(&task.scenes);
    }
    if let Some(backend) = task.backend {
        request.backends = vec![backend];
    }
    // Checked now, before minutes of measuring.
    if let Some(out) = &task.out {
        let folder = out.parent().filter(|folder| !folder.as_os_str().is_empty());
        if out.is_dir() || folder.is_some_and(|folder| !folder.is_dir()) {
            let message = format!("{}: must be a file in an existing folder", out.display());
            return Err(ProjectError::input(out, message));
        }
    }
    let report = bench(&request, &mut |what| {
        eprintln!("measuring {what}");
        ControlFlow::Continue(())
    })?;
    if let Some(out) = &task.out {
        write_whole(out, report.csv().as_bytes())?;
    }
    output.result(&report, || report.to_string())
}
