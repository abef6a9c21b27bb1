//! The report as one page for local use: it contains styles and script, images are files beside it, and a content security policy
//! prevents network access.

mod budgets;
mod figures;
mod films;
mod names;
mod pictures;
pub(crate) mod plot;
mod stability;
mod tables;
pub(crate) mod words;

use crate::report::{CompareReport, ImageDifference, ProbeReport};
use figures::Cost;
use names::{Group, Names, groups};
use std::fmt::Write as _;
use words::{address, escaped, fixed, grouped, signed};

/// The whole page. Image names are those of the report, relative to the page.
pub(super) fn page(report: &CompareReport) -> String {
    let names = Names::of(report);
    let groups = groups(report, &names);
    let mut body = String::new();
    body += &header(report);
    let mut contents = Vec::new();
    let sections = [
        ("overview", "Overview", overview(report, &groups, &names)),
        ("cost", "Error against cost", costs(&groups, &names) + &budgets::section(report, &names)),
        ("pictures", "Pictures and maps", pictures::section(report, &names)),
        ("film", "Film", films::section(report, &groups, &names)),
        ("probes", "Probes", probes(report, &names)),
        ("stability", "Stability", stability::section(report, &groups, &names)),
        ("banding", "Banding", banding(report, &groups, &names)),
        ("times", "Times", groups.iter().map(|group| tables::times(group, &names)).collect()),
        ("reference", "Reference", reference(report, &names)),
        ("settings", "Settings", settings(report, &groups, &names)),
        ("reading", "How to read this page", include_str!("reading.html").to_owned()),
    ];
    let mut text = String::new();
    for (id, title, content) in sections {
        if !content.is_empty() {
            contents.push(format!("<a href=\"#{id}\">{title}</a>"));
            let _ = write!(text, "<section id=\"{id}\"><h2>{title}</h2>{content}</section>");
        }
    }
    let _ = write!(body, "<nav aria-label=\"Contents\">{}</nav><main>{text}</main>", contents.join(""));
    document(&title(report), &body, "")
}

/// A whole page for local use: styles and script are part of it, images are files beside it, and a content security policy prevents
/// network access. `style` is added to the common styles; all arguments but the title are inserted as they are.
pub fn document(title: &str, body: &str, style: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta http-equiv=\"Content-Security-Policy\" \
         content=\"default-src 'none'; img-src 'self' data:; media-src 'self'; style-src 'unsafe-inline'; script-src 'unsafe-inline'\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{}</title>\n<style>\n{}{style}</style>\n\
         </head>\n<body>\n{body}\n<script>\n{}</script>\n</body>\n</html>\n",
        escaped(title),
        include_str!("page.css"),
        include_str!("page.js"),
    )
}

fn title(report: &CompareReport) -> String {
    format!("Shadow methods compared: {}", report.scene.name)
}

/// The header: what was compared, and warnings.
fn header(report: &CompareReport) -> String {
    let scene = &report.scene;
    let [first, end] = report.frames;
    let frames = if end > first + 1 {
        format!("frames {first} to {} (pictures, errors and times: frame {first})", end - 1)
    } else {
        format!("frame {first}")
    };
    let facts = [
        frames,
        format!("{} × {} pixels", scene.width, scene.height),
        format!("{} strands, {} points", grouped(scene.strands), grouped(scene.points)),
        format!("{} light{}", scene.lights, if scene.lights == 1 { "" } else { "s" }),
        report.machine.clone(),
        format!("Lovelock {}", report.version),
    ];
    let facts: Vec<String> = facts.iter().filter(|fact| !fact.is_empty()).map(|fact| escaped(fact)).collect();
    let mut out = format!(
        "<header><p class=\"over\">Shadow methods compared</p><h1>{}</h1><p class=\"facts\">{}</p>",
        escaped(&scene.name),
        facts.join(" · ")
    );
    if !report.complete {
        out += "<div class=\"banner\"><b>This comparison is not complete.</b> It was stopped, or is still running: the \
                results here are complete, the rest are missing.</div>";
    }
    out += &doubts(report);
    out + "</header>"
}

/// Reasons why the reference is inaccurate; empty if there are none.
fn doubts(report: &CompareReport) -> String {
    let reference = &report.reference;
    let of_points = coarse_points(report);
    if reference.converged && reference.refused.is_empty() {
        return of_points;
    }
    let mut list = String::new();
    for truth in reference.footprints.iter().filter(|truth| !truth.converged) {
        let _ = write!(
            list,
            "<li>The truth for {} still changed by {} (root mean square) at {} subtexels along the edge of a texel; the limit \
             is {}.</li>",
            if truth.methods.is_empty() { "all".to_owned() } else { escaped(&truth.methods.join(", ")) },
            fixed(Some(f64::from(truth.change)), 5),
            truth.samples,
            fixed(Some(f64::from(reference.limit)), 5)
        );
    }
    for truth in reference.others.iter().filter(|truth| !truth.converged) {
        let _ = write!(
            list,
            "<li>The truth of the {} still changed by {} (root mean square) at {} subtexels.</li>",
            escaped(&truth.name),
            fixed(Some(f64::from(truth.change)), 5),
            truth.samples,
        );
    }
    for why in &reference.refused {
        let _ = write!(list, "<li>{}</li>", escaped(why));
    }
    let head = if reference.converged {
        "A part of the reference is missing."
    } else if reference.footprints.is_empty() {
        "There is no converged reference: errors are missing, or measured against a reference that is not exact."
    } else {
        "The reference did not converge within its limit: errors near its last change mean nothing."
    };
    format!("<div class=\"banner\"><b>{head}</b><ul>{list}</ul></div>{of_points}")
}

/// A warning if the map of the ground truth at points is not fine enough for its limit.
fn coarse_points(report: &CompareReport) -> String {
    let Some(change) = report.reference.doubt_at_points() else { return String::new() };
    format!(
        "<div class=\"banner\"><b>The truth at points is not fine enough.</b> Errors at points below {} may be the truth's \
         own: it changes by that much (root mean square) when its map has half as many texels along each edge.</div>",
        fixed(Some(f64::from(change)), 4)
    )
}

fn overview(report: &CompareReport, groups: &[Group<'_>], names: &Names) -> String {
    let mut out = String::new();
    let reference = &report.reference;
    if reference.converged {
        let _ = write!(
            out,
            "<p>Transmittance of every method is compared with the mean of the light over the method's own texels, computed \
             with {} × {} rays per texel. It converged: the last round changed it by {} (root mean square).</p>",
            reference.samples,
            reference.samples,
            fixed(Some(f64::from(reference.change)), 5)
        );
    }
    for group in groups {
        out += &tables::overview(group, names, report);
    }
    if !out.is_empty() {
        out += "<p class=\"note\">Click a heading to sort by it; hover over one to see what it means. Shaded costs are on \
                the front: no other method in the table is both more accurate (by <i>One truth</i>) and cheaper.</p>";
    }
    out += &between_backends(report);
    if names.draws {
        out += "<p class=\"note\">Only strands have errors of transmittance and swimming. Images of clusters are compared with the \
                reference, which is drawn as strands. <i>Times</i> has the times of whole images.</p>";
    }
    if !report.notes.is_empty() {
        out += "<ul class=\"notes\">";
        for note in &report.notes {
            let _ = write!(out, "<li>{}</li>", escaped(note));
        }
        out += "</ul>";
    }
    out
}

/// The difference between the reference images of the two backends; empty if only one was rendered.
fn between_backends(report: &CompareReport) -> String {
    let Some(difference) = report.reference.gpu_from_cpu else { return String::new() };
    let ImageDifference { flip, psnr_db, ssim } = difference;
    let psnr = if psnr_db.is_none() { "∞".to_owned() } else { fixed(psnr_db, 1) };
    format!(
        "<p class=\"note\"><b>Between the backends:</b> the GPU's reference image differs from the CPU's by FLIP {} ({} in hair), PSNR \
         {psnr} dB, SSIM {}. Images are compared with the reference image of their own backend, so no row includes this difference.</p>",
        fixed(Some(flip.mean), 4),
        fixed(flip.hair_mean, 4),
        fixed(ssim, 4)
    )
}

fn costs(groups: &[Group<'_>], names: &Names) -> String {
    let mut out = String::new();
    for group in groups {
        let plots = [Cost::Time, Cost::Memory].map(|cost| figures::cost(group, names, cost));
        let plots: String = plots.into_iter().flatten().collect();
        if !plots.is_empty() {
            let _ = write!(out, "<h3>{}</h3><div class=\"plots\">{plots}</div>", escaped(&group.title));
        }
    }
    if !out.is_empty() {
        let methods = || groups.iter().flat_map(|group| &group.methods).map(|(_, method)| method);
        let fallen = methods().filter(|method| method.transmittance_common.is_none()).count();
        let error = if fallen == 0 {
            "The error is that of <i>One truth</i>."
        } else if fallen == methods().count() {
            "<i>One truth</i> is missing: the error is that against each method's own texels, and methods with different \
             texels cannot be ranked by it."
        } else {
            "The error is that of <i>One truth</i>; where a method has none, that against its own texels."
        };
        let _ = write!(
            out,
            "<p class=\"note\">{error} Lower is more accurate, further left is cheaper. Filled dots, joined by the grey \
             band, are the front; dashed lines join the settings of a sweep. A method outside a plot is drawn at its \
             edge.</p>"
        );
    }
    out
}

fn probes(report: &CompareReport, names: &Names) -> String {
    let mut out = String::new();
    for (index, probe) in report.probes.iter().enumerate() {
        let [x, y] = probe.pixel;
        let _ = write!(
            out,
            "<h3>Probe {}: pixel {x}, {y}</h3><div class=\"probe\">{}<div class=\"beside\">{}{}</div></div>",
            index + 1,
            figures::probe(report, names, probe),
            place(report, probe),
            values(report, names, probe)
        );
    }
    for truth in report.reference.probes.iter().filter(|truth| !truth.converged) {
        let _ = write!(
            out,
            "<p class=\"note\">The mean over a texel of the {} still changed by {} (root mean square) at {} subtexels.</p>",
            escaped(&truth.name),
            fixed(Some(f64::from(truth.change)), 4),
            truth.samples
        );
    }
    if out.is_empty() {
        return out;
    }
    format!(
        "<p>A probe is a ray of light through a point of hair. Thin black steps: the light along that very ray, strand by \
         strand. Dashed: its mean over a texel around the ray. Each coloured curve: the transmittance that a method returns \
         along the ray. The lanes below show what the method stores there (slices, layers, cells, slabs, clusters, \
         fragments), darker where more hair is counted. Point at a lane to highlight its curve.</p>{out}"
    )
}

/// The part of the reference image around a probe, with its pixel marked.
fn place(report: &CompareReport, probe: &ProbeReport) -> String {
    let Some(file) = &report.reference.picture else { return String::new() };
    let (width, height) = (report.scene.width.max(1), report.scene.height.max(1));
    // The crop is 168 by 126 CSS pixels at twice the scale of the image.
    let (left, top) =
        (84.0 - 2.0 * (f64::from(probe.pixel[0]) + 0.5), 63.0 - 2.0 * (f64::from(probe.pixel[1]) + 0.5));
    format!(
        "<div class=\"crop\"><img src=\"{}\" alt=\"Where the probe is\" style=\"width:{}px;height:{}px;left:{left}px;\
         top:{top}px\"><i></i></div>",
        escaped(&address(file)),
        u64::from(width) * 2,
        u64::from(height) * 2
    )
}

/// The transmittance of every method at the point.
fn values(report: &CompareReport, names: &Names, probe: &ProbeReport) -> String {
    let truth = at(&probe.reference, 0.0);
    let mut rows = String::new();
    if truth.is_some() {
        let _ = write!(
            rows,
            "<tr><th scope=\"row\">Mean over a texel</th><td>{}</td><td></td></tr>",
            fixed(truth, 3)
        );
    }
    for curve in &probe.methods {
        let Some(method) = report.methods.iter().find(|method| method.name == curve.method) else { continue };
        let value = f64::from(curve.value);
        let swatch = names::color(method);
        let _ = write!(
            rows,
            "<tr><th scope=\"row\"><i class=\"swatch\" style=\"background:{swatch}\"></i>{}</th><td>{}</td><td>{}</td></tr>",
            escaped(&names.full(method)),
            fixed(Some(value), 3),
            signed(truth.map(|truth| value - truth), 3)
        );
    }
    format!(
        "<table><thead><tr><th scope=\"col\">At the point</th><th scope=\"col\">Transmittance</th><th scope=\"col\">Error</th></tr></thead>\
         <tbody>{rows}</tbody></table>"
    )
}

/// The interpolated value of a curve at `x`; `None` outside.
fn at(curve: &[(f32, f32)], x: f32) -> Option<f64> {
    let pair = curve.windows(2).find(|pair| pair[0].0 <= x && x <= pair[1].0)?;
    let [(x0, y0), (x1, y1)] = [pair[0], pair[1]].map(|(x, y)| (f64::from(x), f64::from(y)));
    let part = if x1 > x0 { (f64::from(x) - x0) / (x1 - x0) } else { 0.0 };
    Some(y0 + (y1 - y0) * part)
}

fn banding(report: &CompareReport, groups: &[Group<'_>], names: &Names) -> String {
    let tables: String = groups.iter().map(|group| tables::banding(group, names)).collect();
    if tables.is_empty() {
        return tables;
    }
    let mut plots = String::new();
    for method in &report.methods {
        if let Some(plot) = figures::banding(method) {
            let name = escaped(&names.full(method));
            let _ = write!(plots, "<figure><figcaption>{name}</figcaption>{plot}</figure>");
        }
    }
    format!(
        "<p>A slab of uniform density, made for this test, is lit from the front: transmittance should fall exponentially. \
         Slices and layers show as waves in the error. The plots differ in scale.</p>{tables}<div \
         class=\"small\">{plots}</div>"
    )
}

fn reference(report: &CompareReport, names: &Names) -> String {
    let reference = &report.reference;
    let mut rows = String::new();
    for truth in &reference.footprints {
        let held = report.methods.iter().filter(|method| truth.methods.contains(&method.name));
        let held: Vec<String> = held.map(|method| names.full(method)).collect();
        // If `exact` is not among the methods.
        let held = if held.is_empty() { "One truth for all".to_owned() } else { held.join(", ") };
        let swatch = figures::of_truth(report, truth);
        let _ = write!(
            rows,
            "<tr><th scope=\"row\"><i class=\"swatch\" style=\"background:{swatch}\"></i>{}</th><td>{}</td><td>{}</td><td>{}</td>\
             <td class=\"text\">{}</td></tr>",
            escaped(&held),
            grouped(truth.points),
            truth.samples,
            fixed(Some(f64::from(truth.change)), 5),
            if truth.converged { "converged" } else { "<b class=\"bad\">did not converge</b>" }
        );
    }
    let mut out = String::new();
    if let Some(plot) = figures::convergence(report) {
        let _ = write!(out, "<div class=\"plots\">{plot}</div>");
    }
    if !rows.is_empty() {
        let _ = write!(
            out,
            "<div class=\"scroll\"><table><caption>One truth for each size of texel.</caption><thead><tr><th \
             scope=\"col\">Compared with it</th><th scope=\"col\">Points</th><th scope=\"col\">Subtexels</th><th \
             scope=\"col\">Last change</th><th scope=\"col\" \
             class=\"text\"></th></tr></thead><tbody>{rows}</tbody></table></div>"
        );
    }
    if let Some(points) = &reference.points {
        let _ = write!(
            out,
            "<p>The truth at points is the exact method on a map of {} × {} texels ({}). With half as many texels along each edge it \
             changes by {} (root mean square).</p>",
            points.resolution,
            points.resolution,
            words::bytes(Some(points.memory_bytes)),
            fixed(Some(f64::from(points.change)), 5)
        );
    }
    if let Some(file) = &reference.transmittance {
        let _ = write!(
            out,
            "<figure class=\"wide\"><img src=\"{}\" alt=\"Transmittance of the reference\"><figcaption>Transmittance of the \
             reference</figcaption></figure>",
            escaped(&address(file))
        );
    }
    out
}

fn settings(report: &CompareReport, groups: &[Group<'_>], names: &Names) -> String {
    let tables: String = groups.iter().map(|group| tables::settings(group, names)).collect();
    format!(
        "{tables}<p class=\"note\">Factor on the optical depth of strands: {}. The same numbers for other programs are in \
         <a href=\"./report.csv\">report.csv</a> and <a href=\"./report.json\">report.json</a>.</p>",
        report.scene.extinction_scale
    )
}

#[cfg(test)]
mod tests;
