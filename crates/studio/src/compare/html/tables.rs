//! The tables of the page. Each backend has tables of its own, so that no column mixes their times.

use super::names::{Group, Names};
use super::words::{bytes, escaped, fixed, grouped, ms, signed};
use crate::{CompareReport, MethodReport, TimeSpread};
use std::fmt::Write as _;

/// A heading of a column: what it says, and what the pointer shows.
struct Column(&'static str, &'static str);

/// A number in a cell, with what it is sorted by.
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

/// What the column of errors at points says.
const AT_POINTS: &str =
    "Root mean square error against the truth at the points themselves, which no map can reach";

/// Errors, pictures, costs and stillness of the methods of one group.
pub(super) fn overview(group: &Group<'_>, names: &Names, report: &CompareReport) -> String {
    const COLUMNS: [Column; 15] = [
        Column(
            "RMSE",
            "Root mean square error of transmittance at strand points, against the method's own texels",
        ),
        Column("Bias", "Mean error: above zero the hair is too bright"),
        Column("p99", "99th percentile of the error without its sign"),
        Column(
            "First 10",
            "Root mean square error where fewer than ten fragments of hair lie before the point",
        ),
        Column(
            "One truth",
            "Root mean square error against the same truth for all: the mean of the light over a texel of exact",
        ),
        Column("At points", AT_POINTS),
        Column("FLIP", "Mean perceived difference of the picture, 0 to 1"),
        Column("In hair", "Mean perceived difference over the pixels that show hair"),
        Column("p99", "99th percentile of the perceived difference over the pixels"),
        Column("PSNR", "Peak signal to noise ratio of the picture, decibels; ∞ for an equal picture"),
        Column("SSIM", "Structural similarity of the picture; 1 for an equal picture"),
        Column("Build", "To make the shadow maps of all lights, milliseconds, median"),
        Column("Ask", "To ask them at every strand point and body vertex, milliseconds, median"),
        Column("Memory", "Shadow maps of all lights"),
        Column(
            "Swim",
            "Root mean square deviation of transmittance under shifts of the map by less than a texel",
        ),
    ];
    let cost = format!("Cost on the {}, ms", group.backend);
    let spans = [
        ("Error of transmittance", 6),
        ("Difference of the picture", 5),
        (cost.as_str(), 3),
        ("Stillness", 1),
    ];
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
        let at_points = method.transmittance_at_points.map(|error| error.rmse);
        let flip = method.flip;
        let stages = method.ms;
        let swim = method.stability.map(|stability| stability.swim);
        let mut put = |text: String, value: Option<f64>, class: &str| rows += &cell(&text, value, class);
        let four = |value: Option<f64>| fixed(value, 4);
        put(four(error.map(|e| e.rmse)), error.map(|e| e.rmse), "");
        put(signed(error.map(|e| e.bias), 4), error.map(|e| e.bias), "");
        put(fixed(error.map(|e| e.p99), 3), error.map(|e| e.p99), "");
        put(four(error.and_then(|e| e.first10_rmse)), error.and_then(|e| e.first10_rmse), "");
        let common = method.transmittance_common.map(|error| error.rmse);
        put(four(common), common, "strong");
        put(four(at_points), at_points, "");
        put(four(flip.map(|f| f.mean)), flip.map(|f| f.mean), "first");
        put(four(flip.and_then(|f| f.hair_mean)), flip.and_then(|f| f.hair_mean), "");
        put(fixed(flip.map(|f| f.p99), 3), flip.map(|f| f.p99), "");
        let equal = flip.is_some_and(|flip| flip.mean == 0.0) && method.psnr_db.is_none();
        let psnr = if equal { "∞".into() } else { fixed(method.psnr_db, 1) };
        put(psnr, if equal { Some(f64::MAX) } else { method.psnr_db }, "");
        put(four(method.ssim), method.ssim, "");
        let time_front = if method.front_of_time { "first front" } else { "first" };
        put(ms(stages.and_then(|s| s.build)), stages.and_then(|s| s.build), time_front);
        let time_front = if method.front_of_time { "front" } else { "" };
        put(ms(stages.and_then(|s| s.query)), stages.and_then(|s| s.query), time_front);
        let memory = method.memory_bytes;
        put(bytes(memory), memory.map(|b| b as f64), if method.front_of_memory { "front" } else { "" });
        put(four(swim), swim, "first");
        rows += "</tr>";
    }
    let title = format!("{}. Times are medians of {} draws.", group.title, report.scene.draws);
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

/// How still the methods of one group stand.
pub(super) fn stability(group: &Group<'_>, names: &Names) -> String {
    const COLUMNS: [Column; 5] = [
        Column(
            "Swim",
            "Deviation under shifts of the map by less than a texel, root mean square over the points",
        ),
        Column("Swim p99", "99th percentile of the deviation over the points"),
        Column("Pop", "Largest change of any point from one frame to the next"),
        Column("Pop p99", "99th percentile of that over the points"),
        Column(
            "Flicker",
            "Root mean square of the change from frame to frame that is not the reference's own",
        ),
    ];
    let mut rows = String::new();
    for (_, method) in group.methods.iter().filter(|(_, method)| method.stability.is_some()) {
        let Some(found) = method.stability else { continue };
        let numbers = [Some(found.swim), Some(found.swim_p99), found.pop, found.pop_p99, found.flicker];
        let cells: String = numbers.map(|value| cell(&fixed(value, 4), value, "")).concat();
        let _ = write!(rows, "<tr>{}{cells}</tr>", names.cell(method));
    }
    if rows.is_empty() {
        return String::new();
    }
    table(&group.title, &[], &COLUMNS, &rows)
}

/// What the slices of the methods of one group show in even density.
pub(super) fn banding(group: &Group<'_>, names: &Names) -> String {
    const COLUMNS: [Column; 6] = [
        Column("RMSE", "Root mean square error of transmittance in the slab"),
        Column(
            "Curvature",
            "Largest deviation of the second derivative, as a multiple of the exponential's own at the entry",
        ),
        Column("Largest wave", "The largest amplitude of all waves in the error"),
        Column("Its period", "Part of the slab's depth"),
        Column("Slice distance", "Part of the slab's depth; none where slices have no one depth"),
        Column("Slice wave", "Amplitude of the wave with the period of the slices"),
    ];
    let mut rows = String::new();
    for (_, method) in &group.methods {
        let Some(found) = &method.banding else { continue };
        let _ = write!(rows, "<tr>{}", names.cell(method));
        let numbers = [
            (Some(found.rmse), 4),
            (Some(found.residual), 1),
            (Some(found.amplitude), 4),
            (Some(found.period), 3),
            (found.slice, 4),
            (found.slice_amplitude, 5),
        ];
        rows += &numbers.map(|(value, places)| cell(&fixed(value, places), value, "")).concat();
        rows += "</tr>";
    }
    if rows.is_empty() {
        return String::new();
    }
    table(&group.title, &[], &COLUMNS, &rows)
}

/// Every time of the methods of one group with its spread.
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
    // A pass in a row and a method in a column: there are more passes than methods.
    let mut head = String::from("<tr><th scope=\"col\">Stage or pass</th>");
    for method in &measured {
        let _ = write!(head, "<th scope=\"col\">{}</th>", escaped(&names.within_group(method)));
    }
    let mut rows = String::new();
    for pass in passes.iter().take(80) {
        let stage = if pass.contains('/') { "" } else { " class=\"stage\"" };
        let _ = write!(rows, "<tr{stage}><th scope=\"row\">{}</th>", escaped(pass));
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
        "{}<small title=\"{} draws\">{}–{}</small>",
        ms(Some(time.median)),
        grouped(u64::from(time.count)),
        ms(Some(time.low)),
        ms(Some(time.high))
    )
}

/// A number with no more digits than it means; anything else as it is.
fn shortened(value: &str) -> String {
    match value.parse::<f32>() {
        // The shortest number of single precision that reads the same.
        Ok(number) if value.contains('.') && value.len() > 8 => format!("{number}"),
        _ => value.to_owned(),
    }
}

/// The map that was made, where it is not the one that the settings say: texels are never narrower than strands, and cells
/// lie only where hair is.
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
                format!("{} <b>{}</b>", escaped(&name.replace('_', " ")), escaped(&shortened(value)))
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
