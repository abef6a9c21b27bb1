//! `lovelock style`.

use lovelock_brush::StrokeFile;
use lovelock_project::error::ProjectError;
use lovelock_project::project::save_project;
use lovelock_session::strokes::play_strokes;

use super::args::StyleTask;
use super::output::Output;
use super::source::Source;

/// Plays recorded strokes on the hair of a project and writes the project with them.
pub(crate) fn run(task: &StyleTask, output: Output) -> Result<(), ProjectError> {
    let name = task.strokes.display();
    let text = std::fs::read_to_string(&task.strokes)
        .map_err(|error| ProjectError::input(&task.strokes, format!("{name}: {error}")))?;
    let mut strokes = StrokeFile::from_text(&text)
        .map_err(|error| ProjectError::input(&task.strokes, format!("{name}: {error}")))?;
    strokes.strokes.truncate(task.count.unwrap_or(usize::MAX));
    let source = Source::open(&task.source)?;
    let (project, report, problems) =
        source.watched(|project, progress| play_strokes(project, &source.access, &strokes, progress))?;
    for problem in &problems {
        eprintln!("lovelock: {problem}");
    }
    save_project(&task.out, &project)?;
    output.result(&report, || {
        let missed = if report.missed > 0 {
            format!(", of which {} touched no hair", report.missed)
        } else {
            String::new()
        };
        format!("{}: {} strokes{missed}", task.out.display(), report.strokes)
    })
}
