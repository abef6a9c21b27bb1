//! Makes the figures, one after the other.

use std::ops::ControlFlow;

use lovelock_project::error::ProjectError;
use lovelock_session::machine::machine;
use lovelock_session::prepare::open_renderer;
use lovelock_session::progress::{Progress, report_progress};

use super::figures::Figure;
use super::folder::Folder;
use super::report::{FigureReport, PapersReport};
use super::studio::{PapersRequest, Studio};
use super::{bertails, mertens, sintorn, xu};

/// Every figure, in the order of the page.
fn all() -> impl Iterator<Item = &'static Figure> {
    [bertails::FIGURES, mertens::FIGURES, sintorn::FIGURES, xu::FIGURES].into_iter().flatten()
}

/// The names of all figures, in order.
pub fn figure_ids() -> Vec<&'static str> {
    all().map(|figure| figure.id).collect()
}

/// Makes the figures of the request and writes the gallery. Figures of an earlier run of this version that are not asked for stay on the
/// page. The page is written after each figure.
///
/// `progress` is called for each part of the work and may cancel it: finished figures are kept, and the returned report is marked as
/// incomplete.
///
/// # Errors
/// [`ProjectError::exit_code`] 2 for an unknown figure or a size out of range, 1 if the work fails (no adapter, a full disk). A figure
/// that needs too much memory is not an error: the report says why it is missing.
pub fn papers(
    request: &PapersRequest,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<PapersReport, ProjectError> {
    let (width, height) = request.size;
    lovelock_render::check_size(width, height)?;
    let chosen = chosen(&request.figures)?;
    let mut renderer = open_renderer(request.backend, None)?;
    let folder = Folder::new(&request.out)?;
    let version = env!("CARGO_PKG_VERSION");
    let earlier = folder.earlier(version);
    let mut report = PapersReport {
        papers_version: version.to_owned(),
        machine: machine(),
        adapter: renderer.adapter().to_owned(),
        complete: false,
        figures: earlier.figures.clone(),
    };
    report.figures.retain(|kept| all().any(|figure| figure.id == kept.id));
    folder.report(&report)?;
    for (done, figure) in chosen.iter().enumerate() {
        let what = Progress::Comparing {
            what: figure.id.to_owned(),
            done: done as u64,
            total: chosen.len() as u64,
            left_secs: None,
        };
        let made = report_progress(progress, what).and_then(|()| {
            let mut studio = Studio::new(request, &folder, &mut renderer, figure.id, progress);
            (figure.make)(&mut studio).and_then(|()| studio.finish())
        });
        let made = match made {
            Ok(made) => made,
            Err(ProjectError::Cancelled) => return Ok(report),
            // What does not fit into memory is only noted; a full disk ends the run.
            Err(ProjectError::Work { file: None, message }) => {
                FigureReport { refused: Some(message), ..FigureReport::default() }
            }
            Err(error) => return Err(error),
        };
        put(&mut report, described(figure, made));
        report.complete = done + 1 == chosen.len();
        folder.report(&report)?;
    }
    folder.tidy(&earlier, &report);
    Ok(report)
}

/// The figures whose names begin as asked.
fn chosen(asked: &[String]) -> Result<Vec<&'static Figure>, ProjectError> {
    for name in asked {
        if !all().any(|figure| is_named(figure, name)) {
            return Err(ProjectError::option(format!(
                "found the figure `{name}`; must be one of {}, or the beginning of some",
                figure_ids().join(", ")
            )));
        }
    }
    Ok(all().filter(|figure| asked.is_empty() || asked.iter().any(|name| is_named(figure, name))).collect())
}

/// Whether a figure has a name, or a name that continues after a dash.
fn is_named(figure: &Figure, name: &str) -> bool {
    let rest = figure.id.strip_prefix(name);
    rest.is_some_and(|rest| !name.is_empty() && (rest.is_empty() || rest.starts_with('-')))
}

/// A made figure with what is said about it.
fn described(figure: &Figure, made: FigureReport) -> FigureReport {
    FigureReport {
        id: figure.id.to_owned(),
        paper: figure.paper.name().to_owned(),
        title: figure.title.to_owned(),
        shows: figure.shows.to_owned(),
        differs: figure.differs.to_owned(),
        ..made
    }
}

/// Puts a figure at its place in the order of the page.
fn put(report: &mut PapersReport, made: FigureReport) {
    report.figures.retain(|kept| kept.id != made.id);
    report.figures.push(made);
    let place = |id: &str| all().position(|figure| figure.id == id);
    report.figures.sort_by_key(|figure| place(&figure.id));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_chosen_by_names_and_their_beginnings() {
        let ids = |asked: &[&str]| {
            let asked: Vec<String> = asked.iter().map(|name| (*name).to_owned()).collect();
            chosen(&asked).map(|figures| figures.iter().map(|figure| figure.id).collect::<Vec<_>>())
        };
        assert_eq!(ids(&[]).expect("all"), figure_ids());
        let of_one = ids(&["mertens"]).expect("a paper");
        assert!(of_one.len() > 1 && of_one.iter().all(|id| id.starts_with("mertens-")), "{of_one:?}");
        assert_eq!(ids(&["bertails-8", "bertails-8"]).expect("once"), ["bertails-8"]);
        for wrong in ["bertails-", "bert", "", "wig"] {
            let error = ids(&[wrong]).expect_err(wrong);
            assert!(error.exit_code() == 2 && error.to_string().contains("sintorn-2"), "{error}");
        }
    }

    #[test]
    fn names_are_unique_and_sentences_complete() {
        let mut ids = figure_ids();
        ids.sort_unstable();
        ids.dedup();
        assert_eq!(ids.len(), all().count());
        for figure in all() {
            for text in [figure.title, figure.shows] {
                assert!(text.ends_with('.') && text.len() > 8, "{}: {text}", figure.id);
            }
            assert!(figure.differs.is_empty() || figure.differs.ends_with('.'), "{}", figure.id);
        }
    }

    #[test]
    fn a_figure_replaces_its_earlier_self_at_its_place() {
        let ids = figure_ids();
        let of = |id: &str| FigureReport { id: id.to_owned(), ..FigureReport::default() };
        let mut report = PapersReport::default();
        for id in [ids[2], ids[0], ids[1], ids[2]] {
            put(&mut report, of(id));
        }
        let found: Vec<_> = report.figures.iter().map(|figure| figure.id.as_str()).collect();
        assert_eq!(found, ids[..3]);
    }
}
