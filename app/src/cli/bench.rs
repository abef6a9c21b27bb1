//! `lovelock bench`.

use std::ops::ControlFlow;

use lovelock_jobs::bench::{Baseline, BenchRequest, bench};
use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_project::files::write_whole;

use super::args::{Bench, BenchTarget};
use super::output::Output;
use super::source::apply;

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
        request.scenes.clear();
        for target in &task.scenes {
            match target {
                BenchTarget::Scene(scene) => request.scenes.push(*scene),
                BenchTarget::Locks(locks) => request.locks.extend(locks),
                BenchTarget::VoxelMap => request.voxel_map = true,
                BenchTarget::OccupancyOrder => request.occupancy_order = true,
            }
        }
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
    let baseline = task.baseline.as_deref().map(Baseline::read).transpose()?;
    if let (Some(file), Some(baseline)) = (&task.baseline, &baseline)
        && !request.scenes.iter().any(|scene| baseline.has_scene(scene.id()))
    {
        let found =
            if baseline.scenes().is_empty() { "no scenes".into() } else { baseline.scenes().join(", ") };
        let message = format!("{}: found {found}; must contain one of the measured scenes", file.display());
        return Err(ProjectError::input(file, message));
    }
    let change = |project: &mut Project| apply(&task.set, project);
    let mut report = bench(&request, &change, &mut |what| {
        eprintln!("measuring {what}");
        ControlFlow::Continue(())
    })?;
    if let Some(baseline) = &baseline {
        baseline.compare(&mut report);
    }
    if let Some(out) = &task.out {
        write_whole(out, report.csv().as_bytes())?;
    }
    output.result(&report, || report.to_string())
}
