//! The gallery as one page for local use.

use std::fmt::Write;

use lovelock_study::page::{Axis, Plot, Stroke, address, document, escaped};

use super::report::{FigureReport, PapersReport, PlotReport, TableReport};

/// Added to the common styles.
const STYLE: &str = "
.gallery { display: flex; flex-wrap: wrap; gap: 16px; margin: 12px 0; }
.gallery figure { margin: 0; width: min(100%, 384px); }
.gallery img { display: block; width: 100%; height: auto; background: var(--bed); }
.gallery figcaption { font-size: 13.5px; padding-top: 5px; }
.gallery details { font-size: 12.5px; color: var(--soft); }
code { font-size: 12.5px; overflow-wrap: anywhere; }
article { padding: 18px 0 8px; border-top: 1px solid var(--rule); }
article h3 { margin-top: 0; }
ul.checks { list-style: none; padding: 0; margin: 10px 0; font-size: 14px; max-width: 100ch; }
ul.checks li { padding: 3px 0 3px 26px; position: relative; }
ul.checks li::before { content: '✓'; position: absolute; left: 4px; color: #1a7f37; font-weight: 700; }
ul.checks li.bad::before { content: '✗'; color: #b3261e; }
ul.checks span { color: var(--soft); }
.keys { font-size: 13px; padding-left: 70px; }
.keys i { margin-left: 14px; }
";

/// Colours of curves; the first is that of the truth.
const COLORS: [&str; 5] = ["#202124", "#d1490f", "#0a58ca", "#1a7f37", "#8250df"];

/// The whole page. File names are those of the report, relative to the page.
pub(super) fn page(report: &PapersReport) -> String {
    let mut body = header(report);
    let (mut contents, mut text) = (String::new(), String::new());
    for figures in report.figures.chunk_by(|a, b| a.paper == b.paper) {
        let Some(first) = figures.first() else { continue };
        let paper = first.id.split('-').next().unwrap_or_default();
        let short = first.paper.split(':').next().unwrap_or_default();
        let _ = write!(contents, "<a href=\"#{}\">{}</a>", escaped(paper), escaped(short));
        let _ = write!(text, "<section id=\"{}\"><h2>{}</h2>", escaped(paper), escaped(&first.paper));
        for of in figures {
            text += &figure(of);
        }
        text += "</section>";
    }
    let _ = write!(body, "<nav aria-label=\"Contents\">{contents}</nav><main>{text}</main>");
    document("Figures of the papers", &body, STYLE)
}

fn header(report: &PapersReport) -> String {
    let facts =
        [report.machine.clone(), report.adapter.clone(), format!("Lovelock {}", report.papers_version)];
    let facts: Vec<String> = facts.iter().filter(|fact| !fact.is_empty()).map(|fact| escaped(fact)).collect();
    let mut out = format!(
        "<header><p class=\"over\">lovelock papers</p><h1>Figures of the papers</h1><p class=\"facts\">{}</p>",
        facts.join(" · ")
    );
    if !report.complete {
        out += "<div class=\"banner\"><b>This gallery is not complete.</b> It was stopped, or is still being made: the figures here \
                are complete, others are missing.</div>";
    }
    let failed = report.failed();
    if !failed.is_empty() {
        let _ = write!(
            out,
            "<div class=\"banner\"><b>{} of {} checks do not hold.</b><ul>",
            failed.len(),
            report.checks()
        );
        for (id, check) in failed {
            let _ = write!(
                out,
                "<li><a href=\"#{0}\">{0}</a>: {1} ({2})</li>",
                escaped(id),
                escaped(&check.claim),
                escaped(&check.found)
            );
        }
        out += "</ul></div>";
    }
    out + "</header>"
}

fn figure(of: &FigureReport) -> String {
    let mut out = format!(
        "<article id=\"{}\"><h3>{}</h3><p><b>The paper:</b> {}</p>",
        escaped(&of.id),
        escaped(&of.title),
        escaped(&of.shows)
    );
    if !of.differs.is_empty() {
        let _ = write!(out, "<p><b>Here:</b> {}</p>", escaped(&of.differs));
    }
    if let Some(why) = &of.refused {
        let _ = write!(out, "<div class=\"banner\"><b>It could not be made.</b> {}</div>", escaped(why));
    }
    if !of.pictures.is_empty() {
        out += "<div class=\"gallery\">";
        for picture in &of.pictures {
            let (file, caption) = (escaped(&address(&picture.file)), escaped(&picture.caption));
            let _ = write!(
                out,
                "<figure><a href=\"{file}\"><img src=\"{file}\" alt=\"{caption}\" loading=\"lazy\"></a><figcaption>{caption}"
            );
            if let (Some(project), Some(command)) = (&picture.project, &picture.command) {
                let _ = write!(
                    out,
                    "<details><summary>Alone</summary><a href=\"{}\">Project</a>, <code>{}</code></details>",
                    escaped(&address(project)),
                    escaped(command)
                );
            }
            out += "</figcaption></figure>";
        }
        out += "</div>";
    }
    for plot in &of.plots {
        out += &curves(plot);
    }
    for of in &of.tables {
        out += &table(of);
    }
    if !of.checks.is_empty() {
        out += "<ul class=\"checks\">";
        for check in &of.checks {
            let class = if check.holds { "" } else { " class=\"bad\"" };
            let _ = write!(
                out,
                "<li{class}>{}<br><span>{}</span></li>",
                escaped(&check.claim),
                escaped(&check.found)
            );
        }
        out += "</ul>";
    }
    let _ = write!(out, "<p class=\"note\"><code>lovelock papers {}</code></p></article>", escaped(&of.id));
    out
}

fn curves(of: &PlotReport) -> String {
    let points = || of.curves.iter().flat_map(|curve| &curve.points);
    let (low, high) = points()
        .fold((f64::MAX, f64::MIN), |(low, high), (x, _)| (low.min(f64::from(*x)), high.max(f64::from(*x))));
    let [x, y] = &of.axes;
    let mut plot = Plot::new(640.0, 260.0, Axis::even(x, low, high), Axis::even(y, 0.0, 1.0));
    let mut keys = String::new();
    for (at, curve) in of.curves.iter().enumerate() {
        let color = COLORS[at % COLORS.len()];
        let points: Vec<(f64, f64)> =
            curve.points.iter().map(|(x, y)| (f64::from(*x), f64::from(*y))).collect();
        let width = if at == 0 { 2.4 } else { 1.5 };
        plot.line(&points, Stroke { color, width, dashed: at == 0 }, Some(at));
        let _ = write!(keys, "<i class=\"swatch\" style=\"background:{color}\"></i>{}", escaped(&curve.name));
    }
    format!(
        "<div class=\"plots\"><figure><figcaption>{}</figcaption>{}<p class=\"keys\">{keys}</p></figure></div>",
        escaped(&of.caption),
        plot.svg(&of.caption, 0.0)
    )
}

fn table(of: &TableReport) -> String {
    let (mut head, mut rows) = (String::new(), String::new());
    for title in &of.heads {
        let _ = write!(head, "<th scope=\"col\">{}</th>", escaped(title));
    }
    for row in &of.rows {
        rows += "<tr>";
        for (at, cell) in row.iter().enumerate() {
            let _ = if at == 0 {
                write!(rows, "<th scope=\"row\">{}</th>", escaped(cell))
            } else {
                write!(rows, "<td>{}</td>", escaped(cell))
            };
        }
        rows += "</tr>";
    }
    format!(
        "<div class=\"scroll\"><table class=\"times\"><caption>{}</caption><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></div>",
        escaped(&of.caption)
    )
}
