//! `lovelock style`.

use lovelock_base::words::counted;
use lovelock_jobs::strokes::StrokeFilm;
use lovelock_project::error::ProjectError;
use lovelock_project::project::save_project;
use lovelock_session::strokes::{PlayStrokes, SeeStrokes, play_strokes, read_strokes};

use super::args::StyleTask;
use super::output::Output;
use super::replace::{self, Holds};
use super::source::Source;

/// The latest start of strokes on the dance, seconds.
const MAX_SECS: f64 = 3600.0;

/// Plays recorded strokes on the hair of a project and writes the project with them.
pub(crate) fn run(task: &StyleTask, output: Output) -> Result<(), ProjectError> {
    let mut strokes = read_strokes(&task.strokes)?;
    strokes.strokes.truncate(task.count.unwrap_or(usize::MAX));
    let replaced = replace::check(&task.out, Holds::Work("a project"), task.force)?;
    let film_replaced =
        task.film.as_ref().map(|film| replace::check(film, Holds::RECORDING, task.force)).transpose()?;
    let source = Source::open(&task.source)?;
    if let Some(secs) = task.on_dance.filter(|secs| !(secs.is_finite() && (0.0..=MAX_SECS).contains(secs))) {
        return Err(ProjectError::option(format!(
            "--on-dance: found {secs}; must be 0 to {MAX_SECS} seconds"
        )));
    }
    let mut film = task.film.as_deref().map(|out| StrokeFilm::create(out, &source.project)).transpose()?;
    let (project, report, problems) = source.watched(|project, progress| {
        let mut see =
            film.as_mut().map(|film| |engine: &mut _, project: &_, brush| film.see(engine, project, brush));
        let see = see.as_mut().map(|see| see as SeeStrokes<'_>);
        let how = PlayStrokes { dance_from_secs: task.on_dance, see };
        play_strokes(project, &source.access, &strokes, how, progress)
    })?;
    film.map(StrokeFilm::finish).transpose()?;
    for problem in &problems {
        eprintln!("lovelock: {problem}");
    }
    save_project(&task.out, &project)?;
    [Some(replaced), film_replaced].iter().flatten().for_each(replace::Replaced::tell);
    output.result(&report, || {
        let missed = if report.missed > 0 {
            format!(", of which {} touched no hair", report.missed)
        } else {
            String::new()
        };
        format!("{}: {}{missed}", task.out.display(), counted(report.strokes, "stroke", "strokes"))
    })
}
