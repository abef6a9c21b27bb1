//! `lovelock bench`.

use std::ops::ControlFlow;

use lovelock_jobs::bench::{Baseline, BenchRequest, bench};
use lovelock_jobs::reference::{ReferenceRequest, ReferenceScene, write_reference};
use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_project::files::write_whole;
use lovelock_render::{Backend, ShadowMethod};

use super::args::Bench;
use super::output::Output;
use super::replace::{self, Holds, Replaced};
use super::values::BenchTarget;

/// Measures the scenes and prints the numbers.
pub(crate) fn run(task: &Bench, output: Output) -> Result<(), ProjectError> {
    let references = references(task)?;
    if !references.is_empty() {
        return write_references(task, references, output);
    }
    let mut request = BenchRequest {
        frames: task.frames,
        size: task.size,
        shadow: task.method.map(ShadowMethod::User).or(task.shadow),
        draw: task.draw,
        transparency: task.transparency,
        threads: task.threads.iter().map(|threads| *threads as usize).collect(),
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
                // Never beside others.
                BenchTarget::Reference(_) => {}
            }
        }
    }
    request.simulate = task.simulate;
    if let Some(backend) = task.backend {
        request.backends = vec![backend];
    }
    if !task.threads.is_empty() {
        if let Some(backend) = task.backend.filter(|backend| *backend != Backend::Cpu) {
            return Err(ProjectError::option(format!(
                "--threads: found with the backend {backend}; must be used with cpu"
            )));
        }
        if request.scenes.is_empty() {
            return Err(ProjectError::option("--threads: found without a scene; must be used with one"));
        }
        request.backends = vec![Backend::Cpu];
    }
    // Checked now, before minutes of measuring.
    if let Some(out) = &task.out {
        let folder = out.parent().filter(|folder| !folder.as_os_str().is_empty());
        if out.is_dir() || folder.is_some_and(|folder| !folder.is_dir()) {
            let message = format!("{}: must be a file in an existing folder", out.display());
            return Err(ProjectError::input(out, message));
        }
    }
    let replaced = task.out.as_ref().map(|out| replace::check(out, Holds::BENCH, task.force)).transpose()?;
    let baseline = task.baseline.as_deref().map(Baseline::read).transpose()?;
    if let (Some(file), Some(baseline)) = (&task.baseline, &baseline)
        && !request.scenes.iter().any(|scene| baseline.has_scene(scene.id()))
    {
        let found =
            if baseline.scenes().is_empty() { "no scenes".into() } else { baseline.scenes().join(", ") };
        let message = format!("{}: found {found}; must contain one of the measured scenes", file.display());
        return Err(ProjectError::input(file, message));
    }
    let change = |project: &mut Project| project.assign(&task.set);
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
    replaced.iter().for_each(Replaced::tell);
    output.result(&report, || report.to_string())
}

/// Width and height of reference scenes, pixels.
const REFERENCE_SIZE: (u32, u32) = (384, 384);

/// The reference scenes of the request, which must not be combined with anything else.
fn references(task: &Bench) -> Result<Vec<ReferenceScene>, ProjectError> {
    let mut references: Vec<ReferenceScene> = Vec::new();
    let mut others = false;
    for target in &task.scenes {
        match target {
            BenchTarget::Reference(scenes) => {
                for scene in scenes {
                    if !references.contains(scene) {
                        references.push(*scene);
                    }
                }
            }
            _ => others = true,
        }
    }
    let refuse = |message: &str| Err(ProjectError::option(message));
    if references.is_empty() {
        if task.strands.is_some() {
            return refuse("--strands: found without reference scenes; must be used with `reference`");
        }
        return Ok(references);
    }
    if others {
        return refuse("reference scenes are not measured; must be the only scenes of the command");
    }
    if !task.threads.is_empty() {
        return refuse("--threads: found with reference scenes, which are not measured; leave it out");
    }
    if task.baseline.is_some() {
        return refuse("--baseline: found with reference scenes, which are not measured; leave it out");
    }
    Ok(references)
}

/// Writes reference scenes and prints what `scenes.json` says.
fn write_references(task: &Bench, scenes: Vec<ReferenceScene>, output: Output) -> Result<(), ProjectError> {
    let Some(out) = &task.out else {
        return Err(ProjectError::option("--out: missing; must be a folder for reference scenes"));
    };
    if out.is_file() {
        return Err(ProjectError::input(out, format!("{}: found a file; must be a folder", out.display())));
    }
    let replaced = replace::check_in(out, ["scenes.json".to_owned()], Holds::SCENES, task.force)?;
    let request = ReferenceRequest {
        scenes,
        out: out.clone(),
        size: task.size.unwrap_or(REFERENCE_SIZE),
        strands: task.strands.map(|strands| strands as usize),
        backend: task.backend.unwrap_or(Backend::Cpu),
    };
    let change = |project: &mut Project| {
        project.shadow.method =
            task.method.map(ShadowMethod::User).or(task.shadow).unwrap_or(project.shadow.method);
        project.picture.draw = task.draw.unwrap_or(project.picture.draw);
        project.picture.transparency = task.transparency.unwrap_or(project.picture.transparency);
        project.assign(&task.set)
    };
    let report = write_reference(&request, &change, &mut |what| {
        eprintln!("rendering {what}");
        ControlFlow::Continue(())
    })?;
    replaced.tell();
    output.result(&report, || format!("{} scenes in {}", report.scenes.len(), out.display()))
}
