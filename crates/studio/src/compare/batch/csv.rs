//! The report as a table for other programs.

use crate::CompareReport;

/// One line a method, with a heading. What was not measured is empty. Rows of the CPU and of the GPU tell themselves apart by
/// their backend and adapter.
pub(super) fn csv(report: &CompareReport) -> String {
    let mut out = String::from(
        "name,method,transparency,backend,adapter,sweep,frame,width,height,cell_size_m,\
         rmse,bias,p99,max,first10_rmse,common_rmse,common_bias,points_rmse,points_bias,points_p99,points_first10_rmse,\
         flip_mean,flip_hair_mean,flip_p99,psnr_db,ssim,build_ms,build_low_ms,build_high_ms,query_ms,query_low_ms,query_high_ms,\
         draw_ms,draw_low_ms,draw_high_ms,whole_ms,whole_low_ms,whole_high_ms,draws,memory_bytes,draw_bytes,\
         swim,swim_p99,pop,pop_p99,flicker,banding_residual,banding_rmse,banding_amplitude,banding_slice_amplitude,\
         front_of_time,front_of_memory,complete,refused\n",
    );
    for method in &report.methods {
        let swept: Vec<_> = method.sweep.iter().map(|(name, value)| format!("{name}={value}")).collect();
        let mut row = vec![
            quoted(&method.name),
            method.id.clone(),
            method.transparency.clone(),
            method.backend.clone(),
            quoted(&method.adapter),
            quoted(&swept.join(" ")),
            report.frames[0].to_string(),
            report.scene.width.to_string(),
            report.scene.height.to_string(),
            number(method.cell_size_m.map(f64::from)),
        ];
        let (footprint, points) = (method.transmittance, method.transmittance_at_points);
        row.extend([
            number(footprint.map(|e| e.rmse)),
            number(footprint.map(|e| e.bias)),
            number(footprint.map(|e| e.p99)),
            number(footprint.map(|e| e.max)),
            number(footprint.and_then(|e| e.first10_rmse)),
            number(method.transmittance_common.map(|e| e.rmse)),
            number(method.transmittance_common.map(|e| e.bias)),
            number(points.map(|e| e.rmse)),
            number(points.map(|e| e.bias)),
            number(points.map(|e| e.p99)),
            number(points.and_then(|e| e.first10_rmse)),
            number(method.flip.map(|flip| flip.mean)),
            number(method.flip.and_then(|flip| flip.hair_mean)),
            number(method.flip.map(|flip| flip.p99)),
            number(method.psnr_db),
            number(method.ssim),
        ]);
        for stage in ["build", "query", "draw", "whole"] {
            let time = method.times.iter().find(|time| time.name == stage);
            row.extend([time.map(|t| t.median), time.map(|t| t.low), time.map(|t| t.high)].map(number));
        }
        let draws = method.times.first().map(|time| time.count.to_string());
        let whole = |value: Option<u64>| value.map(|value| value.to_string()).unwrap_or_default();
        row.extend([draws.unwrap_or_default(), whole(method.memory_bytes), whole(method.draw_bytes)]);
        let (stability, banding) = (method.stability, method.banding.as_ref());
        row.extend([
            number(stability.map(|s| s.swim)),
            number(stability.map(|s| s.swim_p99)),
            number(stability.and_then(|s| s.pop)),
            number(stability.and_then(|s| s.pop_p99)),
            number(stability.and_then(|s| s.flicker)),
            number(banding.map(|b| b.residual)),
            number(banding.map(|b| b.rmse)),
            number(banding.map(|b| b.amplitude)),
            number(banding.and_then(|b| b.slice_amplitude)),
            method.front_of_time.to_string(),
            method.front_of_memory.to_string(),
            report.complete.to_string(),
            quoted(method.refused.as_deref().unwrap_or_default()),
        ]);
        out += &row.join(",");
        out.push('\n');
    }
    out
}

/// Six digits that mean something, however small the number; nothing for what is no number.
fn number(value: Option<f64>) -> String {
    let Some(value) = value.filter(|value| value.is_finite()) else { return String::new() };
    // Rounded in the notation that counts digits, then written as programs write numbers.
    format!("{value:.5e}").parse::<f64>().map(|value| value.to_string()).unwrap_or_default()
}

/// A text field as RFC 4180 has it.
fn quoted(text: &str) -> String {
    if text.is_empty() { String::new() } else { format!("\"{}\"", text.replace('"', "\"\"")) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MethodReport;

    #[test]
    fn every_row_has_as_many_fields_as_the_heading() {
        let method = MethodReport {
            name: "a \"b\"".to_owned(),
            refused: Some("too large".to_owned()),
            psnr_db: Some(31.25),
            ..MethodReport::default()
        };
        let report = CompareReport { methods: vec![method], ..CompareReport::default() };
        let text = csv(&report);
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(lines.len(), 2);
        let fields = |line: &str| line.split(',').count();
        assert_eq!(fields(lines[0]), fields(lines[1]), "{text}");
        assert!(lines[1].starts_with("\"a \"\"b\"\"\",") && lines[1].contains(",31.25,"), "{text}");
        let at = lines[0].split(',').position(|name| name == "psnr_db").expect("a column");
        assert_eq!(lines[1].split(',').nth(at), Some("31.25"));
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
