//! `lovelock record`.

use std::io::IsTerminal;
use std::ops::ControlFlow;

use indicatif::{ProgressBar, ProgressStyle};
use lovelock_studio::groom::Preset;
use lovelock_studio::{
    Access, Place, Problem, Progress, Project, RecordReport, RecordRequest, Stage, StudioError,
    load_project_with,
};

use super::args::Record;
use super::output::Output;

/// Simulates and draws a project's dance.
pub(crate) fn run(task: &Record, output: Output) -> Result<(), StudioError> {
    let mut access = Access::new();
    let (mut project, problems) = match &task.project {
        Some(path) => {
            access.set_project(Some(path));
            load_project_with(path, &mut access)?
        }
        None => (Project::default(), Vec::new()),
    };
    tell(&problems);
    if let Some(id) = &task.preset {
        project.set_preset(preset(id)?);
    }
    // A file that is named here is wanted: without it there is nothing to record.
    for path in [&task.hair, &task.body, &task.motion].into_iter().flatten() {
        if !path.is_file() {
            return Err(StudioError::input(path, format!("{}: there is no such file", path.display())));
        }
        access.pick(path);
    }
    if let Some(path) = &task.hair {
        project.set_hair_file(path);
    }
    if let Some(path) = &task.body {
        project.set_body_file(path);
    }
    if let Some(path) = &task.motion {
        project.set_motion_file(path);
    }
    let named: Vec<_> = [(Place::Hair, &task.hair), (Place::Body, &task.body), (Place::Motion, &task.motion)]
        .into_iter()
        .filter_map(|(place, path)| Some((place, path.as_ref()?)))
        .collect();
    let request = RecordRequest {
        out: task.out.clone(),
        frames: task.frames.clone(),
        fps: task.fps,
        size: task.size,
        shadow: task.shadow,
        transparency: task.transparency,
        backend: task.backend,
        access,
        gpu: None,
    };
    let mut bar = Bar::new();
    let mut refused = None;
    let result = lovelock_studio::record(&project, &request, &mut |progress| {
        if let Progress::Loaded { problems } = &progress {
            // A file that the project names is replaced, and said so; one that is named here is not.
            for problem in problems.iter().filter(|problem| problem.is_failure()) {
                if let Some((_, path)) = named.iter().find(|(place, _)| *place == problem.place) {
                    refused = Some(StudioError::input(path, problem.cause.clone()));
                    return ControlFlow::Break(());
                }
            }
        }
        bar.show(&progress);
        ControlFlow::Continue(())
    });
    bar.done();
    if let Some(error) = refused {
        return Err(error);
    }
    let report = result?;
    output.result(&report, || summary(&report))
}

fn preset(id: &str) -> Result<Preset, StudioError> {
    Preset::from_id(id).ok_or_else(|| {
        let known: Vec<_> = Preset::ALL.iter().map(|preset| preset.id()).collect();
        StudioError::option(format!(
            "--preset: unknown hairstyle `{id}`: expected one of {}",
            known.join(", ")
        ))
    })
}

/// Tells what the project's text had wrong. Files that are missing are told by the loader, with what takes their place.
fn tell(problems: &[Problem]) {
    for problem in problems.iter().filter(|problem| !problem.is_failure()) {
        eprintln!("lovelock: {}", problem.message);
    }
}

fn summary(report: &RecordReport) -> String {
    let stages = Stage::ALL
        .iter()
        .map(|&stage| format!("{} {:.2}", stage.label().to_lowercase(), report.stage_ms.get(stage)))
        .collect::<Vec<_>>()
        .join(", ");
    format!(
        "{}: {} frames of {}x{} at {} a second, {} strands, {} segments\n\
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
    )
}

/// Progress on standard error: a bar on a terminal, plain lines elsewhere.
struct Bar {
    bar: Option<ProgressBar>,
    said: u64,
}

impl Bar {
    fn new() -> Self {
        let bar = std::io::stderr().is_terminal().then(|| {
            let style = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} {eta} left")
                .unwrap_or_else(|_| ProgressStyle::default_bar());
            ProgressBar::new(1).with_style(style)
        });
        Self { bar, said: 0 }
    }

    fn show(&mut self, progress: &Progress) {
        let (what, done, total) = match progress {
            Progress::Loading { what } => (what.as_str(), 0, 1),
            Progress::Loaded { problems } => {
                for problem in problems {
                    self.line(&format!("lovelock: {}", problem.message));
                }
                return;
            }
            Progress::Simulating { done, total } => ("simulating", *done, *total),
            Progress::Frame { done, total } => ("frame", *done, *total),
            Progress::Finishing => ("finishing", 1, 1),
        };
        if let Some(bar) = &self.bar {
            bar.set_length(total.max(1));
            bar.set_position(done);
            bar.set_message(what.to_owned());
            return;
        }
        // Some twenty lines for a whole recording, however long.
        let tenth = (20 * done).checked_div(total).unwrap_or(0);
        if matches!(progress, Progress::Frame { .. }) && tenth != self.said {
            self.said = tenth;
            eprintln!("{what} {done} of {total}");
        }
    }

    fn line(&self, text: &str) {
        match &self.bar {
            Some(bar) => bar.println(text),
            None => eprintln!("{text}"),
        }
    }

    fn done(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
