//! Results of measurements: the keys of `bench --json`, and CSV.

use std::fmt::Write;

use lovelock_groom::StrandSet;
use lovelock_project::Project;
use lovelock_render::{Backend, FrameStats, PassTime, Renderer};
use lovelock_session::health::Gauge;
use lovelock_session::stats::{Stage, StageTimes};
use serde::Serialize;

use super::comparison::Comparison;
use super::locks::LockReport;
use super::memory::peak_memory_bytes;
use super::occupancy_order::OrderReport;
use super::scenes::BenchScene;
use super::voxel_map::VoxelMapReport;
use super::yardstick::{Bound, Yardstick};

/// The results on this machine.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BenchReport {
    /// CPU and number of threads.
    pub machine: String,
    /// How fast this machine is.
    pub yardstick: Yardstick,
    /// A report for each scene and backend.
    pub scenes: Vec<SceneReport>,
    /// A report for each hairstyle whose locks were measured.
    pub locks: Vec<LockReport>,
    /// The voxel map beside the published loop, if it was measured.
    pub voxel_map: Option<VoxelMapReport>,
    /// Occupancy order beside exact order, for each scene and backend where it was measured.
    pub occupancy_order: Vec<OrderReport>,
    /// The comparison with an earlier run, if there is one.
    pub comparison: Option<Comparison>,
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
    /// What hair was drawn as: `strands`, `clusters` or `auto`; empty without rendering.
    pub draw: String,
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
    /// The figure of the yardstick that bounds it; null where the stage does not run on the CPU.
    pub bound: Option<Bound>,
    /// The median in units of that figure, per item that the stage handles.
    pub multiple: Option<f64>,
    /// The unit and the item, such as *multiply-adds per vertex*.
    pub multiple_of: Option<String>,
    /// The multiple divided by that of the earlier run; null without one.
    pub change: Option<f64>,
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
            bound: None,
            multiple: None,
            multiple_of: None,
            change: None,
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
            && own.picture.draw == project.picture.draw
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
            draw: project.picture.draw.to_string(),
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
    /// One line per stage of the scenes, with a heading. Every line contains the yardstick.
    pub fn csv(&self) -> String {
        let mut out =
            "scene,backend,adapter,shadow,draw,transparency,width,height,points,segments,stage,median_ms,min_ms,max_ms,published_ms,shadow_bytes,draw_bytes,peak_memory_bytes,multiple,multiple_of,change,copy_gb_per_s,multiply_adds_g_per_s,scattered_adds_m_per_s\n"
                .to_owned();
        for scene in &self.scenes {
            for stage in &scene.stages {
                let optional = |value: Option<String>| value.unwrap_or_default();
                let _ = writeln!(
                    out,
                    "{},{},\"{}\",{},{},{},{},{},{},{},{},{:.4},{:.4},{:.4},{},{},{},{},{},{},{},{:.3},{:.3},{:.3}",
                    scene.scene,
                    scene.backend,
                    scene.adapter.replace('"', "\"\""),
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
                    self.yardstick.copy_gb_per_s,
                    self.yardstick.multiply_adds_g_per_s,
                    self.yardstick.scattered_adds_m_per_s,
                );
            }
        }
        out
    }
}

#[cfg(test)]
pub(super) mod tests {
    use lovelock_session::health::GaugeKind;

    use super::*;

    /// A report of one scene on two backends with one stage.
    pub(in crate::bench) fn report() -> BenchReport {
        let scene = |backend: &str, ms: f64| SceneReport {
            scene: "smooth".to_owned(),
            backend: backend.to_owned(),
            adapter: "a \"quoted\", name".to_owned(),
            shadow: "voxel-map".to_owned(),
            draw: "strands".to_owned(),
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
            yardstick: Yardstick {
                copy_gb_per_s: 10.0,
                multiply_adds_g_per_s: 50.0,
                scattered_adds_m_per_s: 200.0,
            },
            scenes: vec![scene("cpu", 10.0), scene("gpu", 100.0)],
            locks: Vec::new(),
            voxel_map: None,
            occupancy_order: Vec::new(),
            comparison: None,
            notes: vec![],
        }
    }

    #[test]
    fn csv_quotes_text_and_leaves_unknown_fields_empty() {
        let mut report = report();
        report.scenes[0].stages[0].multiple = Some(2.5);
        report.scenes[0].stages[0].multiple_of = Some("bytes copied per pixel".to_owned());
        let csv = report.csv();
        let fields = |line: &str| line.replace("\"a \"\"quoted\"\", name\"", "name").split(',').count();
        assert!(
            csv.lines().all(|line| fields(line) == fields(csv.lines().next().expect("a heading"))),
            "{csv}"
        );
        let line = csv.lines().nth(1).expect("a line");
        assert!(
            line.contains("\"a \"\"quoted\"\", name\"")
                && line.ends_with(
                    "11.0000,10.0000,15.0000,37,3145728,5242880,,2.500000,bytes copied per pixel,,10.000,50.000,200.000"
                ),
            "{line}"
        );
    }
}
