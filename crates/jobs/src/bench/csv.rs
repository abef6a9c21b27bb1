//! The comma-separated report: one line per stage of every scene.

use std::fmt::Write;

use super::report::{BenchReport, SceneReport};
use super::yardstick::Yardstick;

/// The heading. The program knows its own tables by its beginning.
const HEADING: &str = "scene,backend,adapter,shadow,draw,transparency,width,height,points,segments,stage,median_ms,min_ms,max_ms,\
                       published_ms,shadow_bytes,draw_bytes,peak_memory_bytes,multiple,multiple_of,change,copy_gb_per_s,\
                       multiply_adds_g_per_s,scattered_adds_m_per_s,threads,published_parts_ms,published_note,notes";

/// A field of text in quotes.
fn quoted(text: &str) -> String {
    if text.is_empty() { String::new() } else { format!("\"{}\"", text.replace('"', "\"\"")) }
}

impl BenchReport {
    /// One line per stage of the scenes, with a heading. Every line contains the yardstick, the note about the published figures of its
    /// scene, and the notes of the run.
    pub fn csv(&self) -> String {
        let mut out = format!("{HEADING}\n");
        for scene in &self.scenes {
            self.lines(&mut out, scene, &self.yardstick);
        }
        for run in self.scaling.iter().flat_map(|of| &of.runs) {
            self.lines(&mut out, &run.scene, &run.yardstick);
        }
        out
    }

    fn lines(&self, out: &mut String, scene: &SceneReport, yardstick: &Yardstick) {
        let notes = quoted(&self.notes.join("; "));
        let optional = |value: Option<String>| value.unwrap_or_default();
        for stage in &scene.stages {
            let _ = writeln!(
                out,
                "{},{},{},{},{},{},{},{},{},{},{},{:.4},{:.4},{:.4},{},{},{},{},{},{},{},{:.3},{:.3},{:.3},{},{},{},{notes}",
                scene.scene,
                scene.backend,
                quoted(&scene.adapter),
                scene.shadow,
                scene.draw,
                scene.transparency,
                scene.width,
                scene.height,
                scene.points,
                scene.segments,
                stage.name,
                stage.median_ms,
                stage.min_ms,
                stage.max_ms,
                optional(stage.published_ms.map(|ms| ms.to_string())),
                scene.shadow_bytes,
                scene.draw_bytes,
                optional(scene.peak_memory_bytes.map(|bytes| bytes.to_string())),
                optional(stage.multiple.map(|multiple| format!("{multiple:.6}"))),
                optional(stage.multiple_of.clone()),
                optional(stage.change.map(|change| format!("{change:.4}"))),
                yardstick.copy_gb_per_s,
                yardstick.multiply_adds_g_per_s,
                yardstick.scattered_adds_m_per_s,
                scene.threads,
                optional(stage.published_parts_ms.map(|ms| ms.to_string())),
                quoted(scene.published_note.unwrap_or_default()),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::bench::report::tests::report;

    #[test]
    fn csv_quotes_text_carries_the_notes_and_leaves_unknown_fields_empty() {
        let mut report = report();
        report.scenes[0].stages[0].multiple = Some(2.5);
        report.scenes[0].stages[0].multiple_of = Some("bytes copied per point".to_owned());
        report.scenes[0].stages[0].published_parts_ms = Some(36.0);
        report.scenes[0].published_note = Some("published: in \"a paper\", 2005");
        report.notes = vec!["gpu: none".to_owned(), "slow".to_owned()];
        let csv = report.csv();
        let fields = |line: &str| {
            let mut quoted = false;
            let commas = line.chars().filter(|letter| {
                quoted ^= *letter == '"';
                *letter == ',' && !quoted
            });
            1 + commas.count()
        };
        let heading = csv.lines().next().expect("a heading");
        assert!(csv.lines().all(|line| fields(line) == fields(heading)), "{csv}");
        let line = csv.lines().nth(1).expect("a line");
        assert!(
            line.contains("\"a \"\"quoted\"\", name\"")
                && line.ends_with(
                    "11.0000,10.0000,15.0000,37,3145728,5242880,,2.500000,bytes copied per point,,10.000,50.000,200.000,2,36,\
                     \"published: in \"\"a paper\"\", 2005\",\"gpu: none; slow\""
                ),
            "{line}"
        );
        let json = serde_json::to_value(&report).expect("plain data");
        assert_eq!(json["scenes"][0]["published_note"], "published: in \"a paper\", 2005");
        assert_eq!(json["notes"][1], "slow");
    }
}
