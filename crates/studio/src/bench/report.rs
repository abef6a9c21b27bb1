//! What was measured: the keys of `bench --json`, a table, and CSV.

use std::fmt::{self, Write};

use lovelock_groom::StrandSet;
use lovelock_render::{FrameStats, Renderer};
use serde::Serialize;

use super::{BenchRequest, BenchScene};
use crate::{Project, Stage, StageTimes};

/// What was measured on this machine.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BenchReport {
    /// Processor and number of threads.
    pub machine: String,
    /// A report for each scene and backend.
    pub scenes: Vec<SceneReport>,
    /// What was left out, in sentences.
    pub notes: Vec<String>,
}

/// One scene on one backend.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SceneReport {
    /// Id of the scene.
    pub scene: String,
    /// `cpu` or `gpu`.
    pub backend: String,
    /// Name of what drew.
    pub adapter: String,
    /// Id of the shadow method.
    pub shadow: String,
    /// Id of the transparency mode.
    pub transparency: String,
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// Strands drawn.
    pub strands: u64,
    /// Their points.
    pub points: u64,
    /// Their segments.
    pub segments: u64,
    /// Frames measured.
    pub frames: u64,
    /// The stages, the passes of shadow and drawing where the backend measures them (`shadow/…`, `draw/…`), and the whole
    /// frame.
    pub stages: Vec<StageReport>,
    /// Bytes that the shadow maps held.
    pub shadow_bytes: u64,
    /// Bytes that were held for the pixels, to put strands together in them.
    pub draw_bytes: u64,
    /// The most memory that the process held while this was measured, bytes, with what it kept from before; on
    /// Linux, null elsewhere.
    pub peak_memory_bytes: Option<u64>,
}

/// One stage.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StageReport {
    /// Its name.
    pub name: String,
    /// Median over the frames, milliseconds.
    pub median_ms: f64,
    /// The quickest frame, milliseconds.
    pub min_ms: f64,
    /// The slowest frame, milliseconds.
    pub max_ms: f64,
    /// What was published for this stage of this scene, milliseconds; null where nothing was.
    pub published_ms: Option<f64>,
}

impl StageReport {
    fn new(name: &str, published_ms: Option<f64>, times: impl Iterator<Item = f64> + Clone) -> Self {
        Self {
            name: name.to_owned(),
            median_ms: crate::median(times.clone()),
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
        request: &BenchRequest,
        strands: &StrandSet,
        frames: &[(f64, StageTimes, FrameStats)],
    ) -> Self {
        let drawn = [Stage::Motion, Stage::Simulate, Stage::Interpolate, Stage::Shadow, Stage::Draw];
        let mut stages: Vec<_> = drawn
            .into_iter()
            .map(|stage| {
                let name = stage.label().to_lowercase();
                StageReport::new(&name, scene.published_ms(stage), frames.iter().map(move |f| f.1.get(stage)))
            })
            .collect();
        let named = |name: &str, stats: &FrameStats| {
            stats.passes.iter().find(|pass| pass.name == name).map_or(0.0, |pass| pass.ms)
        };
        let passes = frames.first().map_or(&[][..], |frame| &frame.2.passes);
        stages.extend(passes.iter().map(|pass| {
            StageReport::new(&pass.name, None, frames.iter().map(|frame| named(&pass.name, &frame.2)))
        }));
        let published = drawn.into_iter().filter_map(|stage| scene.published_ms(stage)).sum::<f64>();
        let published = (published > 0.0).then_some(published);
        stages.push(StageReport::new("frame", published, frames.iter().map(|frame| frame.0)));
        Self {
            scene: scene.id().to_owned(),
            backend: renderer.backend().to_string(),
            adapter: renderer.adapter().to_owned(),
            shadow: project.shadow.method.to_string(),
            transparency: project.picture.transparency.to_string(),
            width: request.size.0,
            height: request.size.1,
            strands: strands.count() as u64,
            points: strands.points() as u64,
            segments: strands.segments() as u64,
            frames: frames.len() as u64,
            stages,
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
    /// One line a stage, with a heading.
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

/// One of the amounts of memory of a report, bytes.
type Memory = fn(&SceneReport) -> u64;

const MEMORY: [(&str, Memory); 2] =
    [("shadow memory", |scene| scene.shadow_bytes), ("pixel memory", |scene| scene.draw_bytes)];

impl fmt::Display for BenchReport {
    /// The backends of a scene side by side.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.machine)?;
        for same in self.scenes.chunk_by(|a, b| a.scene == b.scene) {
            let Some(first) = same.first() else { continue };
            writeln!(
                f,
                "\n{}: {} strands, {} segments, {}x{}, {}, {}; medians of {} frames, milliseconds",
                first.scene,
                first.strands,
                first.segments,
                first.width,
                first.height,
                first.shadow,
                first.transparency,
                first.frames
            )?;
            write!(f, "  {:<20}", "")?;
            for scene in same {
                write!(f, "{:>12}{:>20}", scene.backend, "(least to most)")?;
            }
            writeln!(f, "{:>12}", "published")?;
            // Those of all, in the order of the one that has most.
            let mut by_size: Vec<_> = same.iter().collect();
            by_size.sort_by_key(|scene| std::cmp::Reverse(scene.stages.len()));
            let mut stages: Vec<&StageReport> = Vec::new();
            for stage in by_size.iter().flat_map(|scene| &scene.stages) {
                if !stages.iter().any(|known| known.name == stage.name) {
                    stages.push(stage);
                }
            }
            for stage in stages {
                write!(f, "  {:<20}", stage.name)?;
                for scene in same {
                    match scene.stages.iter().find(|other| other.name == stage.name) {
                        Some(found) => {
                            let spread = format!("({:.2} to {:.2})", found.min_ms, found.max_ms);
                            write!(f, "{:>12.2}{spread:>20}", found.median_ms)?;
                        }
                        None => write!(f, "{:>32}", "")?,
                    }
                }
                writeln!(f, "{:>12}", stage.published_ms.map_or_else(String::new, |ms| format!("{ms:.0}")))?;
            }
            for (name, of) in MEMORY {
                write!(f, "  {name:<20}")?;
                for scene in same {
                    write!(f, "{:>8.1} MiB{:>20}", of(scene) as f64 / f64::from(1 << 20), "")?;
                }
                writeln!(f)?;
            }
        }
        for note in &self.notes {
            writeln!(f, "\n{note}")?;
        }
        Ok(())
    }
}

/// The processor's name and the number of threads.
pub(super) fn machine() -> String {
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name =
        info.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':')).map(|(_, name)| name);
    format!("{}, {threads} threads", name.map_or(std::env::consts::ARCH, str::trim))
}

/// Lets [`peak_memory_bytes`] begin anew at what the process holds now.
pub(super) fn reset_peak_memory() {
    // Of Linux alone (man 5 proc). Where it cannot be written, the peak is that of the process so far.
    if cfg!(target_os = "linux") {
        let _ = std::fs::write("/proc/self/clear_refs", "5");
    }
}

/// The most memory that this process has held since [`reset_peak_memory`], bytes.
fn peak_memory_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kib| kib * 1024)
}

#[cfg(test)]
mod tests {
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
            stages: vec![StageReport::new("draw", Some(37.0), [ms, ms + 1.0, ms + 5.0].into_iter())],
            shadow_bytes: 3 << 20,
            draw_bytes: 5 << 20,
            peak_memory_bytes: None,
        };
        BenchReport {
            machine: "m".to_owned(),
            scenes: vec![scene("cpu", 10.0), scene("gpu", 100.0)],
            notes: vec![],
        }
    }

    #[test]
    fn backends_stand_side_by_side_with_the_published_figure() {
        let text = report().to_string();
        let line = text.lines().find(|line| line.trim().starts_with("draw")).expect("a line");
        let numbers: Vec<_> = line.split_whitespace().collect();
        assert_eq!(
            numbers,
            ["draw", "11.00", "(10.00", "to", "15.00)", "101.00", "(100.00", "to", "105.00)", "37"]
        );
    }

    #[test]
    fn csv_quotes_and_leaves_empty_what_is_not_known() {
        let csv = report().csv();
        let line = csv.lines().nth(1).expect("a line");
        assert!(
            line.contains("\"a \"\"quoted\"\", name\"")
                && line.ends_with("11.0000,10.0000,15.0000,37,3145728,5242880,"),
            "{line}"
        );
    }
}
