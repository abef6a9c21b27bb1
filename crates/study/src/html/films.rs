//! Several frames: films of panes, and the error of every frame.

use super::figures;
use super::names::{Group, Names};
use super::words::{address, escaped, fixed};
use crate::report::CompareReport;
use std::fmt::Write as _;

/// The films, the curves of errors, and a table of errors beside flicker. Empty for a single frame.
pub(super) fn section(report: &CompareReport, groups: &[Group<'_>], names: &Names) -> String {
    let mut out = String::new();
    for film in &report.films {
        let title = if film.shows == "picture" { "Images" } else { "Errors of transmittance" };
        let file = escaped(&address(&film.file));
        let _ = write!(
            out,
            "<h3>{title}</h3><video controls loop muted preload=\"metadata\" style=\"max-width:100%\" src=\"{file}\"></video>"
        );
    }
    for group in groups {
        let Some(curves) = figures::frames(group, names, report.frames) else { continue };
        let _ =
            write!(out, "<h3>{}</h3>{curves}<div class=\"scroll\"><table><thead><tr>", escaped(&group.title));
        out += "<th scope=\"col\">Method</th><th scope=\"col\">RMSE of the film</th><th scope=\"col\">Flicker</th>\
                <th scope=\"col\">Worst frame</th><th scope=\"col\">Its RMSE</th></tr></thead><tbody>";
        for (_, method) in &group.methods {
            let Some(stability) = method.stability else { continue };
            let of_frames = method.frame_errors.iter().enumerate();
            let Some((worst, error)) = of_frames.max_by(|a, b| a.1.rmse.total_cmp(&b.1.rmse)) else {
                continue;
            };
            let _ = write!(
                out,
                "<tr>{}<td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
                names.cell(method),
                fixed(stability.film_rmse, 4),
                fixed(stability.flicker, 4),
                report.frames[0] + worst as u64,
                fixed(Some(error.rmse), 4)
            );
        }
        out += "</tbody></table></div>";
    }
    let folder = report.methods.iter().find_map(|method| method.files.error_frames.as_deref());
    if let (false, Some(folder)) = (out.is_empty(), folder) {
        let _ = write!(
            out,
            "<p class=\"note\">Errors are those against each method's own texels. The error map of every frame is in a folder per method, \
             such as <code>{}</code>.</p>",
            escaped(folder)
        );
    }
    out
}
