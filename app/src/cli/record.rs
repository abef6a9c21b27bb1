//! `lovelock record`.

use lovelock_jobs::record::{
    CurveRecordReport, RecordReport, RecordRequest, TakeRecordReport, is_curves, is_take, record_curves,
    record_take,
};
use lovelock_project::error::ProjectError;
use lovelock_project::grants::Grants;
use lovelock_project::project::CameraSection;
use lovelock_project::unfinished::{Job, Recordings};
use lovelock_record::OutputKind;
use lovelock_render::ShadowMethod;
use lovelock_session::health::{Gauge, HealthLevel};
use lovelock_session::stats::Stage;

use super::args::Record;
use super::output::Output;
use super::replace::{self, Holds};
use super::source::{Source, shipped_body};

/// Simulates and renders the dance of a project.
pub(crate) fn run(task: &Record, output: Output) -> Result<(), ProjectError> {
    let holds = match OutputKind::of(&task.out) {
        _ if is_take(&task.out) => Holds::Work("a take"),
        Ok(OutputKind::Sequence) => Holds::Images,
        // Other names are refused later.
        Ok(OutputKind::Film | OutputKind::Preview) | Err(_) => Holds::RECORDING,
    };
    let replaced = (!task.resume).then(|| replace::check(&task.out, holds, task.force)).transpose()?;
    record(task, output)?;
    if let Some(replaced) = replaced {
        replaced.tell();
    }
    Ok(())
}

fn record(task: &Record, output: Output) -> Result<(), ProjectError> {
    let mut scene = Source::open(&task.source)?;
    scene.project.picture.simulate = task.simulate.unwrap_or(scene.project.picture.simulate);
    let command = std::env::args_os().map(|word| word.to_string_lossy().into_owned()).collect();
    let mut job = Job::new(&task.out, &scene.project, false);
    job.command = Some(command);
    // A recording that is killed is offered by the window.
    let _running = Recordings::of_user().begin(&job);
    let panes = (!task.beside.is_empty()).then(|| scene.beside(&task.beside)).transpose()?;
    let request = RecordRequest {
        out: task.out.clone(),
        frames: task.film.frames.clone(),
        fps: task.film.picture.fps,
        size: task.film.picture.size,
        shadow: task.method.map(ShadowMethod::User).or(task.shadow),
        draw: task.draw,
        transparency: task.transparency,
        quality: task.quality,
        label: task.label,
        seamless: task.seamless,
        format: task.format,
        transparent: task.transparent,
        motion_blur: task.motion_blur,
        shutter_degrees: task.shutter,
        resume: task.resume,
        dance_time: task.dance_time,
        curves: task.curves,
        no_body: task.no_body,
        backend: task.backend,
        // A camera that the project or an option states stays.
        frame_body: task.source.body.as_deref().is_some_and(|body| shipped_body(body).is_none())
            && scene.project.camera == CameraSection::default()
            && !task.source.set.iter().any(|set| set.name.starts_with("camera.")),
        turn_secs: task.turntable,
        panes,
        access: std::mem::take(&mut scene.access),
        ..RecordRequest::default()
    };
    if is_curves(&request.out) {
        let report = scene.watched(|project, progress| record_curves(project, &request, progress))?;
        return output.result(&report, || curve_summary(&report));
    }
    for (given, option) in [(request.curves.is_some(), "--curves"), (request.no_body, "--no-body")] {
        if given {
            let out = request.out.display();
            return Err(ProjectError::option(format!(
                "{option}: found the output {out}; must end in .usdc, .usd, .usda, .glb or .abc"
            )));
        }
    }
    if is_take(&request.out) {
        let report = scene.watched(|project, progress| record_take(project, &request, progress))?;
        let files = scene.project.files();
        Grants::of_user().remember(&request.out, files.into_iter().map(|(_, file)| file), &request.access);
        return output.result(&report, || take_summary(&report));
    }
    let report =
        scene.watched(|project, progress| lovelock_jobs::record::record(project, &request, progress))?;
    output.result(&report, || summary(&report))
}

fn summary(report: &RecordReport) -> String {
    let stages = Stage::ALL
        .iter()
        .map(|&stage| format!("{} {:.2}", stage.label().to_lowercase(), report.stage_ms.get(stage)))
        .collect::<Vec<_>>()
        .join(", ");
    let kept = match report.frames_kept {
        0 => String::new(),
        kept => format!(" ({kept} of them already existed)"),
    };
    format!(
        "{}: {} frames of {}x{} at {} per second{kept}, {} strands, {} segments\n\
         {:.1} ms a frame on {} ({stages})\n\
         largest stretch {:.1e}, deepest in the body {:.2} mm, {} guides put back",
        report.out.display(),
        report.frames,
        report.width,
        report.height,
        report.fps,
        report.strands,
        report.segments,
        report.frame_ms,
        report.adapter,
        report.max_stretch,
        1e3 * report.max_penetration_m,
        report.recovered_guides,
    ) + &advice(&report.health)
}

/// Advice, a line per gauge that is over its limits.
fn advice(health: &[Gauge]) -> String {
    let over = health.iter().filter(|gauge| gauge.level != HealthLevel::Good);
    let line = |gauge: &Gauge| format!("\n{}, {}: {}", gauge.kind.label(), gauge.in_words(), gauge.advice);
    over.map(line).collect::<Vec<_>>().concat()
}

fn take_summary(report: &TakeRecordReport) -> String {
    format!(
        "{}: {} frames at {} per second, {} guides of {} points, {:.2} MB per second\n\
         {:.1} times as fast as real time; largest stretch {:.1e}, deepest in the body {:.2} mm, {} guides put back",
        report.out,
        report.frames,
        report.fps,
        report.guides,
        report.points_per_guide,
        report.bytes as f64 / 1e6 / report.duration_secs.max(1e-9),
        1e3 * report.duration_secs / report.ms.max(1e-9),
        report.max_stretch,
        1e3 * report.max_penetration_m,
        report.recovered_guides,
    ) + &advice(&report.health)
}

fn curve_summary(report: &CurveRecordReport) -> String {
    let body = match report.vertices {
        0 => "no body".to_owned(),
        vertices => format!("a body of {vertices} vertices"),
    };
    format!(
        "{}: {} frames from {} on at {} per second, {} {} of {} points in all, {body}\n{:.1} MB in {:.1} s",
        report.out,
        report.frames,
        report.first_frame,
        report.fps,
        report.strands,
        report.curves,
        report.points,
        report.bytes as f64 / 1e6,
        report.ms / 1e3,
    )
}
