//! Results of measurements: the keys of `bench --json`, a table, and CSV.

use std::fmt::{self, Write};

use lovelock_groom::StrandSet;
use lovelock_project::Project;
use lovelock_render::{Backend, FrameStats, PassTime, Renderer};
use lovelock_session::health::Gauge;
use lovelock_session::stats::{Stage, StageTimes};
use serde::Serialize;

use super::locks::LockReport;
use super::memory::peak_memory_bytes;
use super::scenes::BenchScene;

/// The results on this machine.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BenchReport {
    /// CPU and number of threads.
    pub machine: String,
    /// A report for each scene and backend.
    pub scenes: Vec<SceneReport>,
    /// A report for each hairstyle whose locks were measured.
    pub locks: Vec<LockReport>,
    /// Notes, such as skipped backends, as sentences.
    pub notes: Vec<String>,
}

/// One scene on one backend.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SceneReport {
    /// Id of the scene.
    pub scene: String,
    /// `cpu` or `gpu`.
    pub backend: String,
    /// Name of the device that rendered.
    pub adapter: String,
    /// Id of the shadow method; empty without rendering.
    pub shadow: String,
    /// Id of the transparency mode; empty without rendering.
    pub transparency: String,
    /// Width, pixels; 0 without rendering.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// Number of rendered strands; of a scene without rendering, its guides.
    pub strands: u64,
    /// Their points.
    pub points: u64,
    /// Their segments, or the guides' links.
    pub segments: u64,
    /// Number of measured frames; steps of 1/60 s for a scene without rendering.
    pub frames: u64,
    /// The stages, the passes of shadow and drawing where the backend measures them (`shadow/…`, `draw/…`), all passes of a
    /// graphics device together (`passes`), interpolation, shadow and drawing (`picture`), and the whole frame with its
    /// simulation (`frame`). Of a scene that is simulated alone, a step by each method (`simulate/…`).
    pub stages: Vec<StageReport>,
    /// Images per second: one divided by the median of `picture`; 0 without rendering.
    pub pictures_per_second: f64,
    /// Frames per second: one divided by the median of `frame`; 0 without rendering.
    pub frames_per_second: f64,
    /// A note about the published figures.
    pub published_note: Option<&'static str>,
    /// The gauges of the simulation, from settling to the last frame.
    pub health: Vec<Gauge>,
    /// Bytes of the shadow maps.
    pub shadow_bytes: u64,
    /// Bytes of the pixel buffers for blending strands.
    pub draw_bytes: u64,
    /// Peak memory of the process during the measurement, bytes, including earlier allocations; null except on Linux.
    pub peak_memory_bytes: Option<u64>,
}

/// One stage.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StageReport {
    /// Its name.
    pub name: String,
    /// Median over the frames, milliseconds.
    pub median_ms: f64,
    /// The fastest frame, milliseconds.
    pub min_ms: f64,
    /// The slowest frame, milliseconds.
    pub max_ms: f64,
    /// The published time of this stage and scene, milliseconds; null if there is none.
    pub published_ms: Option<f64>,
}

impl StageReport {
    pub(super) fn new(name: &str, published_ms: Option<f64>, times: &[f64]) -> Self {
        let times = times.iter().copied();
        Self {
            name: name.to_owned(),
            median_ms: lovelock_base::statistics::median(times.clone()).unwrap_or(0.0),
            min_ms: times.clone().fold(f64::INFINITY, f64::min),
            max_ms: times.fold(0.0, f64::max),
            published_ms,
        }
    }
}

impl SceneReport {
    pub(super) fn new(
        scene: BenchScene,
        project: &Project,
        renderer: &Renderer,
        [width, height]: [u32; 2],
        strands: &StrandSet,
        health: Vec<Gauge>,
        frames: &[(f64, StageTimes, FrameStats)],
    ) -> Self {
        let own = scene.project();
        // Published figures apply to the scene's own method only.
        let as_published = own.shadow.method == project.shadow.method
            && own.picture.transparency == project.picture.transparency;
        let published = |name: &str| if as_published { scene.published_ms(name) } else { None };
        let row = |name: &str, of: &dyn Fn(&(f64, StageTimes, FrameStats)) -> f64| {
            StageReport::new(name, published(name), &frames.iter().map(of).collect::<Vec<f64>>())
        };
        let mut stages: Vec<_> =
            [Stage::Motion, Stage::Simulate, Stage::Interpolate, Stage::Shadow, Stage::Draw]
                .map(|stage| row(&stage.label().to_lowercase(), &|(_, times, _)| times.get(stage)))
                .into();
        let passes = frames.first().map_or(&[][..], |frame| &frame.2.passes);
        for PassTime { name, .. } in passes {
            // Interpolation is both a stage and a pass.
            if stages.iter().all(|stage| stage.name != *name) {
                let of =
                    |stats: &FrameStats| stats.passes.iter().find(|pass| pass.name == *name).map(|p| p.ms);
                stages.push(row(name, &|(.., stats)| of(stats).unwrap_or(0.0)));
            }
        }
        if renderer.backend() == Backend::Gpu && !passes.is_empty() {
            stages.push(row("passes", &|(.., stats)| stats.passes.iter().map(|pass| pass.ms).sum()));
        }
        let picture = row("picture", &|(_, times, _)| times.interpolate + times.shadow + times.draw);
        let frame = row("frame", &|(whole_ms, ..)| *whole_ms);
        let [pictures_per_second, frames_per_second] = [&picture, &frame].map(|row| 1e3 / row.median_ms);
        stages.extend([picture, frame]);
        Self {
            scene: scene.id().to_owned(),
            backend: renderer.backend().to_string(),
            adapter: renderer.adapter().to_owned(),
            shadow: project.shadow.method.to_string(),
            transparency: project.picture.transparency.to_string(),
            width,
            height,
            strands: strands.count() as u64,
            points: strands.points() as u64,
            segments: strands.segments() as u64,
            frames: frames.len() as u64,
            stages,
            pictures_per_second,
            frames_per_second,
            published_note: scene.published_note().filter(|_| as_published),
            health,
            shadow_bytes: frames.iter().map(|frame| frame.2.shadow_bytes).max().unwrap_or(0),
            draw_bytes: frames.iter().map(|frame| frame.2.draw_bytes).max().unwrap_or(0),
            peak_memory_bytes: peak_memory_bytes(),
        }
    }

    /// The median of a stage, milliseconds.
    pub fn median_ms(&self, name: &str) -> Option<f64> {
        self.stages.iter().find(|stage| stage.name == name).map(|stage| stage.median_ms)
    }
}

impl BenchReport {
    /// One line per stage, with a heading.
    pub fn csv(&self) -> String {
        let mut out =
            "scene,backend,adapter,shadow,transparency,width,height,points,segments,stage,median_ms,min_ms,max_ms,published_ms,shadow_bytes,draw_bytes,peak_memory_bytes\n"
                .to_owned();
        for scene in &self.scenes {
            for stage in &scene.stages {
                let optional = |value: Option<String>| value.unwrap_or_default();
                let _ = writeln!(
                    out,
                    "{},{},\"{}\",{},{},{},{},{},{},{},{:.4},{:.4},{:.4},{},{},{},{}",
                    scene.scene,
                    scene.backend,
                    scene.adapter.replace('"', "\"\""),
                    scene.shadow,
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
                );
            }
        }
        out
    }
}

/// Rows that are sums of others, in order.
const SUMS: [&str; 3] = ["passes", "picture", "frame"];

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

impl fmt::Display for BenchReport {
    /// The backends of a scene side by side.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.machine)?;
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
            write!(f, "  {:<width$}", "")?;
            for scene in same {
                write!(f, "{:>12}{:>24}", scene.backend, "(least to most)")?;
            }
            writeln!(f, "{:>12}", "published")?;
            for stage in stages {
                write!(f, "  {:<width$}", stage.name)?;
                for scene in same {
                    match scene.stages.iter().find(|other| other.name == stage.name) {
                        Some(found) => {
                            let spread = format!("({:.2} to {:.2})", found.min_ms, found.max_ms);
                            write!(f, "{:>12.2}{spread:>24}", found.median_ms)?;
                        }
                        None => write!(f, "{:>36}", "")?,
                    }
                }
                writeln!(f, "{:>12}", stage.published_ms.map_or_else(String::new, short))?;
            }
            for (name, of, unit) in NUMBERS.into_iter().filter(|_| !first.is_simulated_alone()) {
                write!(f, "  {name:<width$}")?;
                for scene in same {
                    let number = format!("{:.1}{unit}", of(scene));
                    write!(f, "{number:>12}{:>24}", "")?;
                }
                // Papers print the rate of the image.
                let published = first.stages.iter().find(|stage| stage.name == "picture");
                match published.and_then(|stage| stage.published_ms) {
                    Some(ms) if name == "pictures a second" => writeln!(f, "{:>12}", short(1e3 / ms))?,
                    _ => writeln!(f)?,
                }
            }
            // The simulation does not depend on the backend: one column, with advice for gauges over their limits.
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
        for locks in &self.locks {
            write!(f, "\n{locks}")?;
        }
        for note in &self.notes {
            writeln!(f, "\n{note}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use lovelock_session::health::GaugeKind;

    use super::*;

    fn report() -> BenchReport {
        let scene = |backend: &str, ms: f64| SceneReport {
            scene: "smooth".to_owned(),
            backend: backend.to_owned(),
            adapter: "a \"quoted\", name".to_owned(),
            shadow: "voxel-map".to_owned(),
            transparency: "sorted".to_owned(),
            width: 1280,
            height: 720,
            strands: 2,
            points: 6,
            segments: 4,
            frames: 3,
            stages: vec![StageReport::new("draw", Some(37.0), &[ms, ms + 1.0, ms + 5.0])],
            pictures_per_second: 90.9,
            frames_per_second: 80.0,
            published_note: None,
            health: vec![Gauge {
                kind: GaugeKind::Penetration,
                value: 2e-3,
                level: lovelock_session::health::HealthLevel::Watch,
                at: Some((1, 2)),
                found: None,
                within: Some("head and shoulders".to_owned()),
                advice: "Hair goes into the body.".to_owned(),
            }],
            shadow_bytes: 3 << 20,
            draw_bytes: 5 << 20,
            peak_memory_bytes: None,
        };
        BenchReport {
            machine: "m".to_owned(),
            scenes: vec![scene("cpu", 10.0), scene("gpu", 100.0)],
            locks: Vec::new(),
            notes: vec![],
        }
    }

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
    fn sums_follow_the_passes_of_all_backends() {
        let mut report = report();
        for (scene, names) in
            report.scenes.iter_mut().zip([&["draw/tiles", "picture"][..], &["draw/a", "passes", "picture"]])
        {
            scene.stages.extend(names.iter().map(|name| StageReport::new(name, Some(26.81), &[2.0])));
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
    fn csv_quotes_text_and_leaves_unknown_fields_empty() {
        let csv = report().csv();
        let line = csv.lines().nth(1).expect("a line");
        assert!(
            line.contains("\"a \"\"quoted\"\", name\"")
                && line.ends_with("11.0000,10.0000,15.0000,37,3145728,5242880,"),
            "{line}"
        );
    }
}
