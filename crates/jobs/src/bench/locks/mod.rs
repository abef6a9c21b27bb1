//! Measures whether the locks of a hairstyle hold together in motion, hang by their weight, and come to rest.

mod figures;
mod scenes;

use std::fmt;
use std::sync::Arc;

use glam::Vec3;
use lovelock_groom::{GuideFrame, Hairstyle};
use lovelock_motion::Clip;
use lovelock_project::Project;
use lovelock_session::clock::STEP_SECS;
use lovelock_session::engine::Engine;
use lovelock_session::scene::Scene;
use serde::Serialize;

use figures::{Figures, Instant};
pub use figures::{LockFigures, Spread};
pub use scenes::LockScene;

/// A measured instant for every this many steps of the simulation.
const STEPS_PER_INSTANT: u32 = 2;

/// When the body stops in the second part of the measurement, seconds into the shipped dance: in the middle of a turn.
const STOP_SECS: f64 = 8.2;

/// For how long it then stands still, seconds.
const STILL_SECS: f64 = 5.0;

/// The results of one hairstyle.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LockReport {
    /// Id of the scene.
    pub scene: String,
    /// Number of locks: wisps with three guides.
    pub locks: usize,
    /// What was measured over the dance and after a stop.
    pub figures: LockFigures,
    /// Median time of a step of the simulation, milliseconds.
    pub step_ms: f64,
    /// The largest relative change of a link's length.
    pub max_stretch: f32,
    /// The deepest point inside the body, millimetres.
    pub max_penetration_mm: f32,
    /// Guides that had to be reset.
    pub recovered_guides: u64,
}

/// Plays the dance of `project` once, and again up to [`STOP_SECS`], where the body stops.
pub(super) fn measure(scene: LockScene, project: &Project, loaded: &Arc<Scene>) -> LockReport {
    let mut figures = Figures::new(&loaded.style);
    let mut engine = start(loaded, project);
    let mut times = Vec::new();
    for frame in 0..loaded.frames(1.0 / (f64::from(STEPS_PER_INSTANT) * STEP_SECS)) {
        if frame > 0 {
            for _ in 0..STEPS_PER_INSTANT {
                engine.step();
                times.push(engine.take_simulate_ms().0);
            }
        }
        let snapshot = engine.snapshot();
        figures.add(&instant(&loaded.style, &snapshot.guides), frame);
    }
    let totals = engine.totals();

    let mut engine = start(&Arc::new(stopping(loaded, STOP_SECS)), project);
    engine.advance_to_step((STOP_SECS / STEP_SECS).round() as u64);
    for _ in 0..(STILL_SECS / STEP_SECS / f64::from(STEPS_PER_INSTANT)) as u32 {
        let snapshot = engine.snapshot();
        figures.add_still(&instant(&loaded.style, &snapshot.guides));
        (0..STEPS_PER_INSTANT).for_each(|_| engine.step());
    }
    LockReport {
        scene: scene.id(),
        locks: figures.locks(),
        figures: figures.finish(f64::from(STEPS_PER_INSTANT) * STEP_SECS),
        step_ms: lovelock_base::statistics::median(times).unwrap_or(0.0),
        max_stretch: totals.max_stretch,
        max_penetration_mm: 1e3 * totals.max_penetration_m,
        recovered_guides: totals.recovered_guides,
    }
}

impl fmt::Display for LockReport {
    /// One figure per line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { scene, locks, figures: of, .. } = self;
        let percent = |share: f32| format!("{:.1} %", 100.0 * share);
        let face = [of.first_face_share, of.face_share.p50, of.face_share.p95].map(percent);
        writeln!(f, "{scene}: {locks} locks, through the shipped dance")?;
        let rows = [
            (
                "radius, outer half, p50 / p95 / p99 (at rest)",
                format!("{} mm ({})", of.radius_mm, of.rest_radius_mm),
            ),
            ("points wider than 25 mm", percent(of.wide_share)),
            (
                "before the face, first / p50 / p95 (at rest)",
                format!("{} ({})", face.join(" / "), percent(of.rest_face_share)),
            ),
            (
                "outer half off plumb, p50 / p95 / p99 (first)",
                format!("{}° ({:.1}°)", of.plumb_deg, of.first_plumb_deg),
            ),
            ("crossing of neighbours, p50 / p95 / p99", format!("{}°", of.crossing_deg)),
            (
                "at rest after a stop, median / 95 %",
                format!("{:.2} / {:.2} s", of.settle_secs, of.settle_most_secs),
            ),
            ("radius then, p50 / p95 / p99", format!("{} mm", of.still_radius_mm)),
            ("median step", format!("{:.2} ms", self.step_ms)),
            (
                "stretch, depth in the body, reset guides",
                format!(
                    "{:.1e}, {:.2} mm, {}",
                    self.max_stretch, self.max_penetration_mm, self.recovered_guides
                ),
            ),
        ];
        rows.iter().try_for_each(|(name, value)| writeln!(f, "  {name:<46}{value}"))
    }
}

/// The settled hair at the first frame.
fn start(scene: &Arc<Scene>, project: &Project) -> Engine {
    let mut engine = Engine::at_rest(Arc::clone(scene), project.simulation, STEP_SECS);
    engine.follow(project);
    engine.settle();
    engine
}

/// The scene with a body that stops moving at `secs`.
fn stopping(scene: &Scene, secs: f64) -> Scene {
    let clip = scene.clip.as_deref().map(|clip| {
        let duration_secs = (secs * scene.speed).min(clip.duration_secs);
        Arc::new(Clip { duration_secs, loops: false, loop_blend_secs: 0.0, ..clip.clone() })
    });
    Scene { clip, looping: false, ..scene.clone() }
}

/// The guides of every lock in world space and in head space.
fn instant(style: &Hairstyle, frame: &GuideFrame) -> Instant {
    let head_from_world = frame.world_from_head.inverse();
    let guides = figures::guides_of_locks(style);
    let points = style.guides.points_per_guide;
    let world: Vec<Vec3> = guides
        .flat_map(|g| (0..points).map(move |i| (g, i)))
        .map(|(g, i)| frame.guides.point(g, i))
        .collect();
    let head = world.iter().map(|p| head_from_world.transform_point3(*p)).collect();
    Instant { world, head }
}
