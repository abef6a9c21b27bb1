//! Results of measurements: the keys of `bench --json`.

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
use super::published::{ANIMATION, Published};
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
    /// The scenes with several numbers of threads, if that was asked for; `scenes` is empty then.
    pub scaling: Vec<ScalingReport>,
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

/// A scene with several numbers of threads.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ScalingReport {
    /// Id of the scene.
    pub scene: String,
    /// The runs, in the order of the request. Speed-ups are relative to the first.
    pub runs: Vec<ThreadRun>,
}

/// One scene with one number of threads.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ThreadRun {
    /// How fast that many threads of the machine are.
    pub yardstick: Yardstick,
    /// The scene, with its number of threads.
    pub scene: SceneReport,
    /// The time of each stage of the first run divided by that of this one, in the order of the scene's stages; null where one of them is 0.
    pub speed_up: Vec<Option<f64>>,
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
    /// Number of threads that share the work of the CPU.
    pub threads: u64,
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
    /// The stages, the passes of shadow and drawing where the backend measures them (`shadow/…`, `draw/…`), simulation and
    /// interpolation together (`animation`), all passes of a graphics device together (`passes`), interpolation, shadow and drawing
    /// (`picture`), and the whole frame with its simulation (`frame`). Of a scene that is simulated alone, a step by each method
    /// (`simulate/…`), and of `simulate-402` the interpolation of its strands and both together (`animation/relaxation`).
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
    /// The published time of this stage and scene as printed, milliseconds; null if there is none.
    pub published_ms: Option<f64>,
    /// The sum of the printed parts of that time, milliseconds, where it is another; null otherwise.
    pub published_parts_ms: Option<f64>,
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
    pub(super) fn new(name: &str, published: Option<Published>, times: &[f64]) -> Self {
        let times = times.iter().copied();
        Self {
            name: name.to_owned(),
            median_ms: lovelock_base::statistics::median(times.clone()).unwrap_or(0.0),
            min_ms: times.clone().fold(f64::INFINITY, f64::min),
            max_ms: times.fold(0.0, f64::max),
            published_ms: published.map(|published| published.ms),
            published_parts_ms: published.and_then(|published| published.parts_ms),
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
        let published = |name: &str| if as_published { scene.published(name) } else { None };
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
        stages.push(row(ANIMATION, &|(_, times, _)| times.simulate + times.interpolate));
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
            threads: rayon::current_num_threads() as u64,
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

#[cfg(test)]
pub(super) mod tests {
    use lovelock_session::health::GaugeKind;

    use super::*;

    /// A report of one scene on two backends with one stage.
    pub(in crate::bench) fn report() -> BenchReport {
        let published = Published { ms: 37.0, parts_ms: None };
        let scene = |backend: &str, ms: f64| SceneReport {
            scene: "smooth".to_owned(),
            backend: backend.to_owned(),
            adapter: "a \"quoted\", name".to_owned(),
            threads: 2,
            shadow: "voxel-map".to_owned(),
            draw: "strands".to_owned(),
            transparency: "sorted".to_owned(),
            width: 1280,
            height: 720,
            strands: 2,
            points: 6,
            segments: 4,
            frames: 3,
            stages: vec![StageReport::new("draw", Some(published), &[ms, ms + 1.0, ms + 5.0])],
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
            scaling: Vec::new(),
            locks: Vec::new(),
            voxel_map: None,
            occupancy_order: Vec::new(),
            comparison: None,
            notes: vec![],
        }
    }
}
