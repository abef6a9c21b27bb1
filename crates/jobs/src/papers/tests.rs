use std::ops::ControlFlow;

use lovelock_render::Backend;
use lovelock_session::progress::Progress;

use super::*;

/// A request for figures without images, which are quick.
fn request(out: &std::path::Path, figures: &[&str]) -> PapersRequest {
    PapersRequest {
        out: out.to_owned(),
        figures: figures.iter().map(|id| (*id).to_owned()).collect(),
        size: (48, 48),
        frames: 1,
        backend: Backend::Cpu,
    }
}

#[test]
fn a_stopped_gallery_keeps_what_is_finished_and_goes_on() {
    let dir = tempfile::tempdir().expect("a folder");
    let out = dir.path().join("a gallery");
    let read = || -> PapersReport {
        serde_json::from_slice(&std::fs::read(out.join("papers.json")).expect("a report")).expect("JSON")
    };
    // Stopped before the second figure.
    let mut begun = 0;
    let mut stop = |progress: Progress| {
        begun += u32::from(matches!(progress, Progress::Comparing { .. }));
        if begun > 1 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let report = papers(&request(&out, &["xu-6", "sintorn-5"]), &mut stop).expect("stopped");
    assert_eq!((report.complete, report.figures.len()), (false, 1));
    assert_eq!(read(), report);
    let figure = &report.figures[0];
    assert_eq!((figure.id.as_str(), figure.plots.len(), figure.tables.len()), ("sintorn-5", 2, 1));
    assert!(figure.checks.iter().all(|check| check.holds), "{:?}", figure.checks);
    let page = || std::fs::read_to_string(out.join("papers.html")).expect("a page");
    assert!(page().contains("not complete") && page().contains("</html>"), "{}", page());

    let report = papers(&request(&out, &["xu-6"]), &mut |_| ControlFlow::Continue(())).expect("finished");
    let ids: Vec<_> = report.figures.iter().map(|figure| figure.id.as_str()).collect();
    assert_eq!((report.complete, ids), (true, vec!["sintorn-5", "xu-6"]));
    assert_eq!(read(), report);
    let page = page();
    assert!(!page.contains("not complete") && !page.contains("http:") && !page.contains("https:"));
    assert!(page.contains("default-src 'none'"));
    let locks = report.figures.last().expect("a figure");
    assert_eq!(locks.pictures.len(), 4);
    assert!(locks.checks.len() == 4 && locks.checks.iter().all(|check| check.holds), "{:?}", locks.checks);
    for picture in &locks.pictures {
        let project = picture.project.as_ref().expect("a project");
        assert!(out.join(&picture.file).is_file() && out.join(project).is_file(), "{picture:?}");
        let (opened, problems) =
            lovelock_project::project::load_project(&out.join(project)).expect("a project");
        assert!(
            problems.is_empty() && opened.hair.file.is_some_and(|file| file.path.is_file()),
            "{problems:?}"
        );
    }
}

#[test]
fn wrong_requests_are_refused_before_anything_is_written() {
    let dir = tempfile::tempdir().expect("a folder");
    let out = dir.path().join("out");
    let refuse = |request: &PapersRequest, found: &str| {
        let error = papers(request, &mut |_| ControlFlow::Continue(())).expect_err(found);
        assert!(error.exit_code() == 2 && error.to_string().contains(found), "{error}");
        assert!(!out.exists());
    };
    refuse(&request(&out, &["wig"]), "must be one of bertails-1");
    refuse(&PapersRequest { size: (0, 48), ..request(&out, &["sintorn-5"]) }, "0x48");
    let file = dir.path().join("file");
    std::fs::write(&file, b"x").expect("a file");
    refuse(&request(&file, &["sintorn-5"]), "must be the folder of the gallery");
}

#[test]
fn the_page_escapes_text_and_marks_what_does_not_hold() {
    let figure = FigureReport {
        id: "xu-4".to_owned(),
        paper: "P <1>".to_owned(),
        title: "A & B.".to_owned(),
        pictures: vec![PictureReport {
            file: "pictures/a b.png".to_owned(),
            caption: "<script>".to_owned(),
            project: None,
            command: None,
        }],
        checks: vec![CheckReport { claim: "x < y".to_owned(), found: "2 and 1".to_owned(), holds: false }],
        tables: vec![TableReport {
            caption: "t".to_owned(),
            heads: vec!["a".to_owned()],
            rows: vec![vec!["<b>".to_owned(), "1".to_owned()]],
        }],
        plots: vec![PlotReport {
            caption: "c".to_owned(),
            axes: ["x".to_owned(), "y".to_owned()],
            curves: vec![CurveReport { name: "k".to_owned(), points: vec![(0.0, 1.0), (1.0, 0.5)] }],
        }],
        ..FigureReport::default()
    };
    let report = PapersReport { figures: vec![figure], complete: true, ..PapersReport::default() };
    let page = page::page(&report);
    assert!(page.contains("1 of 1 checks do not hold"), "{page}");
    assert!(
        page.contains("x &lt; y") && page.contains("&lt;script&gt;") && page.contains("./pictures/a%20b.png")
    );
    assert!(page.contains("<th scope=\"row\">&lt;b&gt;</th><td>1</td>") && page.contains("class=\"bad\""));
    assert_eq!(page.matches("<svg").count(), 1);
    assert_eq!(report.failed().len(), 1);
}
