//! The tables of the page. Each backend has tables of its own, so that no column mixes their times.

use super::names::{Group, Names};
use super::words::{bytes, draws, escaped, fixed, grouped, ms, signed, small};
use crate::report::{CompareReport, MethodReport, TimeSpread};
use std::fmt::Write as _;

/// A column heading and its tooltip.
struct Column(&'static str, &'static str);

/// A table cell with a number, and its sort key.
fn cell(text: &str, value: Option<f64>, class: &str) -> String {
    let value = value
        .filter(|value| value.is_finite())
        .map(|value| format!(" data-v=\"{value}\""))
        .unwrap_or_default();
    let class = if class.is_empty() { String::new() } else { format!(" class=\"{class}\"") };
    format!("<td{class}{value}>{text}</td>")
}

/// A table with two rows of headings: groups of columns, and columns. The first column names methods.
fn table(caption: &str, spans: &[(&str, usize)], columns: &[Column], rows: &str) -> String {
    let mut head = String::new();
    if !spans.is_empty() {
        head += "<tr class=\"spans\"><td></td>";
        for (title, columns) in spans {
            let _ = write!(head, "<th colspan=\"{columns}\" scope=\"colgroup\">{}</th>", escaped(title));
        }
        head += "</tr>";
    }
    head += "<tr><th scope=\"col\">Method</th>";
    let mut starts = vec![0];
    for (_, columns) in spans {
        starts.push(starts[starts.len() - 1] + columns);
    }
    for (index, Column(title, says)) in columns.iter().enumerate() {
        let first = if starts.contains(&index) && index > 0 { " class=\"first\"" } else { "" };
        let _ = write!(head, "<th scope=\"col\"{first} title=\"{}\">{}</th>", escaped(says), escaped(title));
    }
    head += "</tr>";
    format!(
        "<div class=\"scroll\"><table><caption>{}</caption><thead>{head}</thead><tbody>{rows}</tbody></table></div>",
        escaped(caption)
    )
}

/// Tooltip of the column of errors at points.
const AT_POINTS: &str =
    "Root mean square error against the truth at the points themselves, which no map can reach";

/// Tooltip of the columns of swim.
const SWIM: &str = "Deviation of transmittance while the map is shifted by less than a texel, root mean square over points and frames";

/// Tooltip of the columns of flicker.
const FLICKER: &str = "Root mean square of the change from frame to frame that is not the reference's own";

/// Errors, pictures, costs and stability of the methods of one group.
pub(super) fn overview(group: &Group<'_>, names: &Names, report: &CompareReport) -> String {
    const COLUMNS: [Column; 16] = [
        Column(
            "RMSE",
            "Root mean square error of transmittance at strand points, against the method's own texels",
        ),
        Column("Bias", "Mean error: above zero the hair is too bright"),
        Column("p99", "99th percentile of the absolute error"),
        Column(
            "First 10",
            "Root mean square error where fewer than ten fragments of hair lie before the point",
        ),
        Column(
            "One truth",
            "Root mean square error against the same truth for all: the mean of the light over a texel of exact",
        ),
        Column("At points", AT_POINTS),
        Column("FLIP", "Mean perceived difference of the image, 0 to 1"),
        Column("In hair", "Mean perceived difference over the pixels that show hair"),
        Column("p99", "99th percentile of the perceived difference over the pixels"),
        Column("PSNR", "Peak signal to noise ratio of the image, decibels; ∞ for an equal image"),
        Column("SSIM", "Structural similarity of the image; 1 for an equal image"),
        Column("Build", "Time to build the shadow maps of all lights: milliseconds, median"),
        Column("Query", "Time to query them at every strand point and body vertex: milliseconds, median"),
        Column("Memory", "Shadow maps of all lights"),
        Column("Swim", SWIM),
        Column("Flicker", FLICKER),
    ];
    let cost = format!("Cost on the {} (times: ms)", group.backend);
    let spans =
        [("Error of transmittance", 6), ("Image difference", 5), (cost.as_str(), 3), ("Stability", 2)];
    let mut rows = String::new();
    for (_, method) in &group.methods {
        let _ = write!(rows, "<tr>{}", names.cell(method));
        if method.transmittance.is_none() && method.ms.is_none() && method.flip.is_none() {
            let why = method.refused.as_deref().unwrap_or("not measured");
            let _ = write!(
                rows,
                "<td class=\"refused\" colspan=\"{}\">{}</td></tr>",
                COLUMNS.len(),
                escaped(why)
            );
            continue;
        }
        let error = method.transmittance;
        let flip = method.flip;
        let stages = method.ms;
        let four = |value: Option<f64>| (fixed(value, 4), value);
        let three = |value: Option<f64>| (fixed(value, 3), value);
        let time = |value: Option<f64>| (ms(value), value);
        let bias = error.map(|e| e.bias);
        let equal = flip.is_some_and(|flip| flip.mean == 0.0) && method.psnr_db.is_none();
        let psnr =
            if equal { ("∞".into(), Some(f64::MAX)) } else { (fixed(method.psnr_db, 1), method.psnr_db) };
        let memory = method.memory_bytes;
        let (quick, little) = (method.front_of_time, method.front_of_memory);
        let cells = [
            (four(error.map(|e| e.rmse)), ""),
            ((signed(bias, 4), bias), ""),
            (three(error.map(|e| e.p99)), ""),
            (four(error.and_then(|e| e.first10_rmse)), ""),
            (four(method.transmittance_common.map(|error| error.rmse)), "strong"),
            (four(method.transmittance_at_points.map(|error| error.rmse)), ""),
            (four(flip.map(|f| f.mean)), "first"),
            (four(flip.and_then(|f| f.hair_mean)), ""),
            (three(flip.map(|f| f.p99)), ""),
            (psnr, ""),
            (four(method.ssim), ""),
            (time(stages.and_then(|s| s.build)), if quick { "first front" } else { "first" }),
            (time(stages.and_then(|s| s.query)), if quick { "front" } else { "" }),
            ((bytes(memory), memory.map(|b| b as f64)), if little { "front" } else { "" }),
            (four(method.stability.and_then(|stability| stability.swim)), "first"),
            (four(method.stability.and_then(|stability| stability.flicker)), ""),
        ];
        rows += &cells.map(|((text, value), class)| cell(&text, value, class)).concat();
        rows += "</tr>";
    }
    let title = format!("{}. Times are medians of up to {}.", group.title, draws(report.scene.draws));
    let table = table(&title, &spans, &COLUMNS, &rows);
    match report.reference.doubt_at_points() {
        Some(change) => {
            let doubt =
                format!("{AT_POINTS}. Below {} it may be the truth's own", fixed(Some(change.into()), 4));
            table.replacen(&escaped(AT_POINTS), &escaped(&doubt), 1)
        }
        None => table,
    }
}

/// Temporal stability of the methods of one group.
pub(super) fn stability(group: &Group<'_>, names: &Names) -> String {
    const COLUMNS: [Column; 11] = [
        Column("Swim", SWIM),
        Column("p99", "99th percentile over the points of the deviation of each over the frames"),
        Column(
            "Pop",
            "Largest change of any point from one frame to the next, including the effect of the moving hair",
        ),
        Column("p99", "99th percentile over the points of the largest change of each"),
        Column("Flicker", FLICKER),
        Column("Pop", "Largest change of any point from one step to the next"),
        Column("Of the truth", "Largest change of the reference at any of these points"),
        Column("Excess", "Largest change of any point that is not the reference's own"),
        Column("Jitter", "Root mean square of the change that is not the reference's own"),
        Column("Pop", "Largest change of any point from one step to the next; the truth does not change"),
        Column(
            "Jitter",
            "Root mean square of the change from one step to the next; the truth does not change",
        ),
    ];
    const SPANS: [(&str, usize); 4] =
        [("Map shifted", 2), ("Frame to frame", 3), ("Light turned by 0.1° a step", 4), ("Stray hair", 2)];
    let mut rows = String::new();
    for (_, method) in &group.methods {
        let (found, turned, stray) = (method.stability, method.light_sweep, method.stray);
        if found.is_none() && turned.is_none() {
            continue;
        }
        let numbers = [
            (found.and_then(|f| f.swim), ""),
            (found.and_then(|f| f.swim_p99), ""),
            (found.and_then(|f| f.pop), "first"),
            (found.and_then(|f| f.pop_p99), ""),
            (found.and_then(|f| f.flicker), ""),
            (turned.map(|t| t.pop), "first"),
            (turned.and_then(|t| t.truth_pop), ""),
            (turned.and_then(|t| t.excess), ""),
            (turned.and_then(|t| t.jitter), ""),
            (stray.map(|s| s.pop), "first"),
            (stray.and_then(|s| s.jitter), ""),
        ];
        let cells = numbers.map(|(value, class)| cell(&small(value), value, class)).concat();
        let _ = write!(rows, "<tr>{}{cells}</tr>", names.cell(method));
    }
    if rows.is_empty() {
        return String::new();
    }
    table(&group.title, &SPANS, &COLUMNS, &rows)
}

/// Banding of the methods of one group in uniform density.
pub(super) fn banding(group: &Group<'_>, names: &Names) -> String {
    const COLUMNS: [Column; 6] = [
        Column("RMSE", "Root mean square error of transmittance in the slab"),
        Column(
            "Curvature",
            "Largest error of the second derivative, as a multiple of the exponential's own where light enters",
        ),
        Column("Largest wave", "The largest amplitude of all waves in the error of transmittance"),
        Column("Its period", "As a fraction of the slab's depth"),
        Column(
            "Slice distance",
            "As a fraction of the slab's depth; none where slices differ in depth, or where there are none",
        ),
        Column("Slice wave", "Amplitude of the wave with the period of the slices"),
    ];
    let mut rows = String::new();
    for (_, method) in &group.methods {
        let Some(found) = &method.banding else { continue };
        let _ = write!(rows, "<tr>{}", names.cell(method));
        let numbers = [
            (small(Some(found.rmse)), Some(found.rmse)),
            (fixed(Some(found.residual), 1), Some(found.residual)),
            (small(Some(found.amplitude)), Some(found.amplitude)),
            (fixed(Some(found.period), 3), Some(found.period)),
            (fixed(found.slice, 4), found.slice),
            (small(found.slice_amplitude), found.slice_amplitude),
        ];
        rows += &numbers.map(|(text, value)| cell(&text, value, "")).concat();
        rows += "</tr>";
    }
    if rows.is_empty() {
        return String::new();
    }
    table(&group.title, &[], &COLUMNS, &rows)
}

/// All times of the methods of one group with percentiles.
pub(super) fn times(group: &Group<'_>, names: &Names) -> String {
    let mut passes: Vec<&str> = Vec::new();
    for time in group.methods.iter().flat_map(|(_, method)| &method.times) {
        if !passes.contains(&time.name.as_str()) {
            passes.push(&time.name);
        }
    }
    let measured: Vec<&MethodReport> =
        group.methods.iter().map(|(_, method)| *method).filter(|method| !method.times.is_empty()).collect();
    if measured.is_empty() {
        return String::new();
    }
    // One row per pass and one column per method, because there are more passes than methods.
    let mut head = String::from("<tr><th scope=\"col\">Stage or pass</th>");
    for method in &measured {
        let _ = write!(head, "<th scope=\"col\">{}</th>", escaped(&names.within_group(method)));
    }
    let mut rows = String::new();
    for pass in passes.iter().take(80) {
        let stage = if pass.contains('/') { "" } else { " class=\"stage\"" };
        let name = match *pass {
            "draw" => "draw (the rest)",
            "whole" => "whole picture",
            pass => pass,
        };
        let _ = write!(rows, "<tr{stage}><th scope=\"row\">{}</th>", escaped(name));
        for method in &measured {
            let time = method.times.iter().find(|time| time.name == **pass);
            let (median, text) = time.map_or((None, String::new()), |time| (Some(time.median), spread(time)));
            rows += &cell(&text, median, "");
        }
        rows += "</tr>";
    }
    format!(
        "<div class=\"scroll\"><table class=\"times\"><caption>{} Milliseconds: the median, and below it the 10th and 90th \
         percentiles.</caption><thead>{head}</tr></thead><tbody>{rows}</tbody></table></div>",
        escaped(&format!("{}.", group.title))
    )
}

fn spread(time: &TimeSpread) -> String {
    format!(
        "{}<small title=\"{}\">{}–{}</small>",
        ms(Some(time.median)),
        draws(time.count),
        ms(Some(time.low)),
        ms(Some(time.high))
    )
}

/// A number without meaningless digits; other text is unchanged.
fn shortened(value: &str) -> String {
    match value.parse::<f32>() {
        // The shortest text that reads as the same single-precision number.
        Ok(number) if value.contains('.') && value.len() > 8 => format!("{number}"),
        _ => value.to_owned(),
    }
}

/// The actual size of the map if it differs from the settings: texels are never narrower than strands, and cells only cover hair.
fn effective(method: &MethodReport) -> Option<String> {
    let cells = method.cells_total?;
    let edge = (cells as f64).sqrt().round() as u64;
    let asked = method.settings.iter().find(|(name, _)| name == "resolution")?.1.parse::<u64>().ok()?;
    let map = if asked.checked_pow(3) == Some(cells) {
        return None;
    } else if edge * edge != cells {
        format!("{} cells", grouped(cells))
    } else if edge == asked {
        return None;
    } else {
        format!("{edge} × {edge} texels")
    };
    Some(format!("drawn with <b>{map}</b>"))
}

/// Settings of every method.
pub(super) fn settings(group: &Group<'_>, names: &Names) -> String {
    let mut rows = String::new();
    let refused = group.methods.iter().any(|(_, method)| method.refused.is_some());
    for (_, method) in &group.methods {
        let settings: Vec<String> = (method.settings.iter())
            .map(|(name, value)| {
                let (name, value) = match (name.strip_suffix("_bytes"), value.parse::<u64>()) {
                    (Some(name), Ok(size)) => (name, bytes(Some(size))),
                    _ => (name.as_str(), shortened(value)),
                };
                format!("{} <b>{}</b>", escaped(&name.replace('_', " ")), escaped(&value))
            })
            .collect();
        let settings: Vec<String> = settings.into_iter().chain(effective(method)).collect();
        let texel = method.cell_size_m.map(|size| f64::from(size) * 1000.0);
        let texel = if texel.is_some() { format!("{} mm", fixed(texel, 2)) } else { fixed(None, 0) };
        let why = escaped(method.refused.as_deref().unwrap_or_default());
        let why = if refused { format!("<td class=\"text\">{why}</td>") } else { String::new() };
        let settings = if settings.is_empty() { "none".into() } else { settings.join(" · ") };
        let _ = write!(
            rows,
            "<tr>{}<td>{texel}</td><td class=\"text\">{settings}</td>{why}</tr>",
            names.cell(method)
        );
    }
    let why = if refused { "<th scope=\"col\" class=\"text\">Left out</th>" } else { "" };
    format!(
        "<div class=\"scroll\"><table><caption>{}</caption><thead><tr><th scope=\"col\">Method</th><th scope=\"col\">Texel or \
         cell</th><th scope=\"col\" class=\"text\">Settings</th>{why}</tr></thead><tbody>{rows}</tbody></table></div>",
        escaped(&group.title)
    )
}
