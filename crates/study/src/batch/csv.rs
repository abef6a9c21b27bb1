//! The report as a table for other programs.

use crate::report::{CompareReport, MethodReport};

/// One line per method, with a heading. Fields that were not measured are empty. Backend and adapter distinguish rows of the CPU
/// and the GPU.
pub(super) fn csv(report: &CompareReport) -> String {
    let line = |fields: &mut dyn Iterator<Item = &str>| fields.collect::<Vec<_>>().join(",") + "\n";
    // Any row gives the heading.
    let heading = row(report, &MethodReport::default());
    let mut out = line(&mut heading.iter().map(|(name, _)| *name));
    for method in &report.methods {
        out += &line(&mut row(report, method).iter().map(|(_, value)| value.as_str()));
    }
    out
}

/// The fields of a method's line, each under its name.
fn row(report: &CompareReport, method: &MethodReport) -> Vec<(&'static str, String)> {
    let swept: Vec<_> = method.sweep.iter().map(|(name, value)| format!("{name}={value}")).collect();
    let whole = |value: Option<u64>| value.map(|value| value.to_string()).unwrap_or_default();
    let (footprint, points) = (method.transmittance, method.transmittance_at_points);
    let (common, flip) = (method.transmittance_common, method.flip);
    let mut row = vec![
        ("name", quoted(&method.name)),
        ("method", method.id.clone()),
        ("draw", method.draw.clone()),
        ("transparency", method.transparency.clone()),
        ("backend", method.backend.clone()),
        ("adapter", quoted(&method.adapter)),
        ("sweep", quoted(&swept.join(" "))),
        ("frame", report.frames[0].to_string()),
        ("width", report.scene.width.to_string()),
        ("height", report.scene.height.to_string()),
        ("cell_size_m", number(method.cell_size_m.map(f64::from))),
        ("rmse", number(footprint.map(|e| e.rmse))),
        ("bias", number(footprint.map(|e| e.bias))),
        ("p99", number(footprint.map(|e| e.p99))),
        ("max", number(footprint.map(|e| e.max))),
        ("first10_rmse", number(footprint.and_then(|e| e.first10_rmse))),
        ("common_rmse", number(common.map(|e| e.rmse))),
        ("common_bias", number(common.map(|e| e.bias))),
        ("points_rmse", number(points.map(|e| e.rmse))),
        ("points_bias", number(points.map(|e| e.bias))),
        ("points_p99", number(points.map(|e| e.p99))),
        ("points_first10_rmse", number(points.and_then(|e| e.first10_rmse))),
        ("flip_mean", number(flip.map(|flip| flip.mean))),
        ("flip_hair_mean", number(flip.and_then(|flip| flip.hair_mean))),
        ("flip_p99", number(flip.map(|flip| flip.p99))),
        ("psnr_db", number(method.psnr_db)),
        ("ssim", number(method.ssim)),
    ];
    for (stage, names) in [
        ("build", ["build_ms", "build_low_ms", "build_high_ms"]),
        ("query", ["query_ms", "query_low_ms", "query_high_ms"]),
        ("draw", ["draw_ms", "draw_low_ms", "draw_high_ms"]),
        ("whole", ["whole_ms", "whole_low_ms", "whole_high_ms"]),
    ] {
        let time = method.times.iter().find(|time| time.name == stage);
        let values = [time.map(|t| t.median), time.map(|t| t.low), time.map(|t| t.high)];
        row.extend(names.into_iter().zip(values.map(number)));
    }
    let (stability, banding) = (method.stability, method.banding.as_ref());
    let (turned, stray) = (method.light_sweep, method.stray);
    row.extend([
        ("draws", whole(method.times.first().map(|time| u64::from(time.count)))),
        ("memory_bytes", whole(method.memory_bytes)),
        ("fallbacks", whole(Some(method.fallbacks))),
        ("draw_bytes", whole(method.draw_bytes)),
        ("swim", number(stability.and_then(|s| s.swim))),
        ("swim_p99", number(stability.and_then(|s| s.swim_p99))),
        ("swim_frames", whole(stability.and_then(|s| s.swim).map(|_| report.swim_frames.len() as u64))),
        ("pop", number(stability.and_then(|s| s.pop))),
        ("pop_p99", number(stability.and_then(|s| s.pop_p99))),
        ("flicker", number(stability.and_then(|s| s.flicker))),
        ("film_rmse", number(stability.and_then(|s| s.film_rmse))),
        ("light_pop", number(turned.map(|t| t.pop))),
        ("light_truth_pop", number(turned.and_then(|t| t.truth_pop))),
        ("light_truth_rms", number(turned.and_then(|t| t.truth_rms))),
        ("light_excess", number(turned.and_then(|t| t.excess))),
        ("light_jitter", number(turned.and_then(|t| t.jitter))),
        ("stray_pop", number(stray.map(|s| s.pop))),
        ("stray_jitter", number(stray.and_then(|s| s.jitter))),
        ("banding_residual", number(banding.map(|b| b.residual))),
        ("banding_rmse", number(banding.map(|b| b.rmse))),
        ("banding_amplitude", number(banding.map(|b| b.amplitude))),
        ("banding_slice_amplitude", number(banding.and_then(|b| b.slice_amplitude))),
        ("front_of_time", method.front_of_time.to_string()),
        ("front_of_memory", method.front_of_memory.to_string()),
        ("complete", report.complete.to_string()),
        ("refused", quoted(method.refused.as_deref().unwrap_or_default())),
    ]);
    row
}

/// A number with six significant digits; empty if there is none.
fn number(value: Option<f64>) -> String {
    let Some(value) = value.filter(|value| value.is_finite()) else { return String::new() };
    // Round in exponential notation, then print as a plain number.
    format!("{value:.5e}").parse::<f64>().map(|value| value.to_string()).unwrap_or_default()
}

/// A text field, quoted by RFC 4180.
fn quoted(text: &str) -> String {
    if text.is_empty() { String::new() } else { format!("\"{}\"", text.replace('"', "\"\"")) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::changes::ChangeReport;

    #[test]
    fn every_row_has_as_many_fields_as_the_heading() {
        let method = MethodReport {
            name: "a \"b\"".to_owned(),
            refused: Some("too large".to_owned()),
            psnr_db: Some(31.25),
            light_sweep: Some(ChangeReport { pop: 0.125, jitter: Some(0.5), ..ChangeReport::default() }),
            stray: Some(ChangeReport { pop: 0.75, ..ChangeReport::default() }),
            ..MethodReport::default()
        };
        let report = CompareReport { methods: vec![method], ..CompareReport::default() };
        let text = csv(&report);
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(lines.len(), 2);
        let fields = |line: &str| line.split(',').count();
        assert_eq!(fields(lines[0]), fields(lines[1]), "{text}");
        assert!(lines[1].starts_with("\"a \"\"b\"\"\",") && lines[1].contains(",31.25,"), "{text}");
        for (name, value) in [
            ("psnr_db", "31.25"),
            ("light_pop", "0.125"),
            ("light_jitter", "0.5"),
            ("light_excess", ""),
            ("stray_pop", "0.75"),
            ("refused", "\"too large\""),
        ] {
            let at = lines[0].split(',').position(|heading| heading == name).expect("a column");
            assert_eq!(lines[1].split(',').nth(at), Some(value), "{name}");
        }
        let mut names: Vec<&str> = lines[0].split(',').collect();
        names.sort_unstable();
        assert!(names.windows(2).all(|pair| pair[0] != pair[1]), "{names:?}");
    }

    #[test]
    fn small_numbers_keep_six_digits() {
        for (value, text) in [
            (6.525_431_2e-5, "0.0000652543"),
            (0.0, "0"),
            (-1.0, "-1"),
            (1_234_567.8, "1234570"),
            (0.123_456_789, "0.123457"),
        ] {
            assert_eq!(number(Some(value)), text);
        }
        assert_eq!([number(None), number(Some(f64::NAN)), number(Some(f64::INFINITY))], ["", "", ""]);
    }
}
