//! The text report: a table per scene.

use std::fmt;

use super::occupancy_order::OrderReport;
use super::published::ANIMATION;
use super::report::{BenchReport, SceneReport, StageReport};

/// Rows that are sums of others, in order.
const SUMS: [&str; 4] = [ANIMATION, "passes", "picture", "frame"];

/// One number of a report: label, value and unit.
type Number = (&'static str, fn(&SceneReport) -> f64, &'static str);

const NUMBERS: [Number; 4] = [
    ("shadow memory", |scene| mib(scene.shadow_bytes), " MiB"),
    ("pixel memory", |scene| mib(scene.draw_bytes), " MiB"),
    ("pictures a second", |scene| scene.pictures_per_second, ""),
    ("frames a second", |scene| scene.frames_per_second, ""),
];

fn mib(bytes: u64) -> f64 {
    bytes as f64 / f64::from(1 << 20)
}

/// A number with at most two decimals.
fn short(ms: f64) -> String {
    ((100.0 * ms).round() / 100.0).to_string()
}

/// A multiple with three digits, or all digits before the point.
fn three_digits(multiple: f64) -> String {
    let decimals = if multiple >= 100.0 {
        0
    } else if multiple >= 10.0 {
        1
    } else {
        2
    };
    format!("{multiple:.decimals$}")
}

/// The change by a factor, per cent.
fn percent(change: f64) -> String {
    format!("{:+.0} %", 100.0 * (change - 1.0))
}

impl fmt::Display for BenchReport {
    /// The backends of a scene side by side.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}\n{}", self.machine, self.yardstick)?;
        for same in self.scenes.chunk_by(|a, b| a.scene == b.scene) {
            let Some(first) = same.first() else { continue };
            writeln!(f, "\n{}", first.heading())?;
            // The stages of all backends, in the order of the backend with the most stages.
            let mut by_size: Vec<_> = same.iter().collect();
            by_size.sort_by_key(|scene| std::cmp::Reverse(scene.stages.len()));
            let mut stages: Vec<&StageReport> = Vec::new();
            for stage in by_size.iter().flat_map(|scene| &scene.stages) {
                if !stages.iter().any(|known| known.name == stage.name) {
                    stages.push(stage);
                }
            }
            // The sums after the passes of all backends.
            stages.sort_by_key(|stage| SUMS.iter().position(|sum| stage.name == *sum).map_or(0, |at| at + 1));
            let width = stages.iter().map(|stage| stage.name.len()).fold(20, usize::max);
            // Wide enough for the changes since an earlier run.
            let change_width = if self.comparison.is_some() { 9 } else { 0 };
            write!(f, "  {:<width$}", "")?;
            for scene in same {
                write!(f, "{:>12}{:>24}{:>12}", scene.backend, "(least to most)", "multiple")?;
                write!(f, "{:>change_width$}", if change_width > 0 { "change" } else { "" })?;
            }
            writeln!(f, "{:>12}  multiple of", "published")?;
            for stage in stages {
                write!(f, "  {:<width$}", stage.name)?;
                for scene in same {
                    match scene.stages.iter().find(|other| other.name == stage.name) {
                        Some(found) => {
                            let spread = format!("({:.2} to {:.2})", found.min_ms, found.max_ms);
                            let multiple = found.multiple.map_or_else(String::new, three_digits);
                            let change = found.change.map_or_else(String::new, percent);
                            write!(f, "{:>12.2}{spread:>24}{multiple:>12}", found.median_ms)?;
                            write!(f, "{change:>change_width$}")?;
                        }
                        None => write!(f, "{:>48}{:>change_width$}", "", "")?,
                    }
                }
                let published = match (stage.published_ms, stage.published_parts_ms) {
                    (Some(printed), Some(parts)) => format!("{} ({})", short(printed), short(parts)),
                    (printed, _) => printed.map_or_else(String::new, short),
                };
                let unit = same
                    .iter()
                    .flat_map(|scene| &scene.stages)
                    .filter(|other| other.name == stage.name)
                    .find_map(|other| other.multiple_of.as_deref());
                let line = format!("{published:>12}  {}", unit.unwrap_or_default());
                writeln!(f, "{}", line.trim_end())?;
            }
            for (name, of, unit) in NUMBERS.into_iter().filter(|_| !first.is_simulated_alone()) {
                write!(f, "  {name:<width$}")?;
                for scene in same {
                    let number = format!("{:.1}{unit}", of(scene));
                    write!(f, "{number:>12}{:>36}{:>change_width$}", "", "")?;
                }
                // Papers print the rate of the image.
                let published = first.stages.iter().find(|stage| stage.name == "picture");
                match published.and_then(|stage| stage.published_ms) {
                    Some(ms) if name == "pictures a second" => writeln!(f, "{:>12}", short(1e3 / ms))?,
                    _ => writeln!(f)?,
                }
            }
            // The simulation does not depend on what draws: one column, with advice for gauges over their limits.
            for gauge in &first.health {
                writeln!(f, "  {:<width$}{:>12}", gauge.kind.label().to_lowercase(), gauge.in_words())?;
            }
            for gauge in first.health.iter().filter(|gauge| !gauge.advice.is_empty()) {
                writeln!(f, "  {}", gauge.advice)?;
            }
            if let Some(note) = first.published_note {
                writeln!(f, "  {note}")?;
            }
        }
        for scaling in &self.scaling {
            write!(f, "\n{scaling}")?;
        }
        for locks in &self.locks {
            write!(f, "\n{locks}")?;
        }
        if let Some(voxel_map) = &self.voxel_map {
            write!(f, "\n{voxel_map}")?;
        }
        OrderReport::write_all(&self.occupancy_order, f)?;
        if let Some(comparison) = &self.comparison {
            writeln!(f)?;
            for line in comparison.lines() {
                writeln!(f, "{line}")?;
            }
        }
        for note in &self.notes {
            writeln!(f, "\n{note}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::published::Published;
    use crate::bench::report::tests::report;

    #[test]
    fn backends_are_listed_side_by_side_with_the_published_figure() {
        let text = report().to_string();
        let line = text.lines().find(|line| line.trim().starts_with("draw")).expect("a line");
        let numbers: Vec<_> = line.split_whitespace().collect();
        assert_eq!(
            numbers,
            ["draw", "11.00", "(10.00", "to", "15.00)", "101.00", "(100.00", "to", "105.00)", "37"]
        );
    }

    #[test]
    fn gauges_are_printed_once_with_their_advice() {
        let text = report().to_string();
        let rows: Vec<_> = text.lines().filter(|line| line.contains("deepest in the body")).collect();
        assert!(rows.len() == 1 && rows[0].ends_with("2.0 mm in head and shoulders"), "{text}");
        assert_eq!(text.matches("Hair goes into the body.").count(), 1, "{text}");
        let json = serde_json::to_value(report()).expect("plain data");
        assert_eq!(json["scenes"][1]["health"][0]["within"], "head and shoulders");
    }

    #[test]
    fn a_printed_sum_stands_beside_the_sum_of_its_parts() {
        let mut report = report();
        report.scenes[1].stages[0].published_parts_ms = Some(31.6);
        report.scenes[0].stages[0].published_parts_ms = Some(31.6);
        let text = report.to_string();
        let line = text.lines().find(|line| line.trim().starts_with("draw")).expect("a line");
        assert!(line.ends_with("  37 (31.6)"), "{line}");
    }

    #[test]
    fn sums_follow_the_passes_of_all_backends() {
        let mut report = report();
        let published = Published { ms: 26.81, parts_ms: None };
        for (scene, names) in
            report.scenes.iter_mut().zip([&["draw/tiles", "picture"][..], &["draw/a", "passes", "picture"]])
        {
            scene.stages.extend(names.iter().map(|name| StageReport::new(name, Some(published), &[2.0])));
        }
        let text = report.to_string();
        let rows: Vec<_> = text.lines().filter_map(|line| line.split_whitespace().next()).collect();
        let at = |name: &str| rows.iter().position(|row| *row == name).expect(name);
        assert!(
            at("draw/a") < at("draw/tiles")
                && at("draw/tiles") < at("passes")
                && at("passes") < at("picture")
        );
        let rate = text.lines().find(|line| line.trim().starts_with("pictures a second")).expect("a rate");
        assert!(rate.ends_with("37.3"), "what was published as a rate is printed as one: {rate}");
    }

    #[test]
    fn multiples_stand_beside_their_unit_and_keep_three_digits() {
        assert_eq!(
            [12345.6, 123.4, 12.34, 1.234, 0.012].map(three_digits),
            ["12346", "123", "12.3", "1.23", "0.01"]
        );
        assert_eq!([1.0, 1.104, 0.5].map(percent), ["+0 %", "+10 %", "-50 %"]);
        let mut report = report();
        let stage = &mut report.scenes[1].stages[0];
        (stage.multiple, stage.multiple_of) = (Some(431.2), Some("bytes copied per pixel".to_owned()));
        let text = report.to_string();
        let line = text.lines().find(|line| line.trim().starts_with("draw")).expect("a line");
        assert!(line.contains("105.00)         431          37  bytes copied per pixel"), "{line}");
        assert!(text.lines().nth(1).is_some_and(|line| line.starts_with("yardstick: 10.0 GB/s copied")));
    }
}
