//! The simulation and the state of a frame: synchronous, and without a clock.

use std::sync::Arc;

use glam::Affine3A;
use lovelock_groom::GuideFrame;
use lovelock_motion::{PlacedCollider, Pose, Skin, place_colliders, pose_at, skin};
use lovelock_record::TakeFrame;
use lovelock_wisp::{Simulation, SimulationSettings, StepInput, StepReport};

use super::snapshot::SnapshotPool;
use super::{FrameSnapshot, Scene};
use crate::{Animation, Project, STEP_SECS, StageTimes, Stopwatch};

/// How long hair falls into place before the first frame, seconds.
pub const SETTLE_SECS: f64 = 1.0;

/// How much of the dance before the first frame hair lives through, where the clip loops, seconds.
const LEAD_SECS: f64 = 1.0;

/// What the simulator is told that has passed where the motion jumps, seconds: it then moves hair along with the
/// head instead of simulating it ([`StepInput::time_secs`]).
const JUMP_SECS: f64 = 16.0;

/// The worst of all steps since the hair was last settled.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Totals {
    /// Steps taken.
    pub steps: u64,
    /// Largest relative change of a link's length.
    pub max_stretch: f32,
    /// Deepest point inside a collider, metres.
    pub max_penetration_m: f32,
    /// Guides put back to their last good pose, counted at each step.
    pub recovered_guides: u64,
    /// Steps at which the motion jumped.
    pub jumps: u64,
}

impl Totals {
    fn add(&mut self, report: &StepReport) {
        self.steps += 1;
        self.max_stretch = self.max_stretch.max(report.max_stretch);
        self.max_penetration_m = self.max_penetration_m.max(report.max_penetration_m);
        self.recovered_guides += u64::from(report.recovered_guides);
        self.jumps += u64::from(report.jumped);
    }
}

/// A scene in motion.
///
/// Time runs in equal steps from the first frame: the state after a number of steps depends on the scene, the
/// settings and that number alone, not on the number of threads nor on the clock.
#[derive(Debug)]
pub struct Engine {
    scene: Arc<Scene>,
    settings: SimulationSettings,
    /// What of the settings follows the timeline.
    animation: Option<Animation>,
    step_secs: f64,
    simulation: Simulation,
    /// Steps from the scene's time zero.
    at_step: i64,
    /// Steps since the engine started.
    taken: u64,
    /// The simulator's clock, which jumps where the motion does.
    simulated_secs: f64,
    pose: Pose,
    colliders: Vec<PlacedCollider>,
    report: StepReport,
    totals: Totals,
    times: StageTimes,
    /// Whether time or the motion jumped since the last step: nothing lies between the instants before and after.
    jumped_since: bool,
    /// The same, as the last step found it.
    cut: bool,
    pool: SnapshotPool,
}

impl Engine {
    /// A scene at its first frame, its hair settled, in steps of 1/60 s.
    pub fn new(scene: Arc<Scene>, settings: SimulationSettings) -> Self {
        Self::with_step(scene, settings, STEP_SECS)
    }

    /// As [`Engine::new`], in steps of `step_secs`.
    pub fn with_step(scene: Arc<Scene>, settings: SimulationSettings, step_secs: f64) -> Self {
        let simulation = Simulation::new(Arc::clone(&scene.style));
        let mut engine = Self {
            scene,
            settings: settings.clamped(),
            animation: None,
            step_secs,
            simulation,
            at_step: 0,
            taken: 0,
            simulated_secs: 0.0,
            pose: Pose::default(),
            colliders: Vec::new(),
            report: StepReport::default(),
            totals: Totals::default(),
            times: StageTimes::default(),
            jumped_since: false,
            cut: false,
            pool: SnapshotPool::default(),
        };
        engine.restart();
        engine
    }

    /// The scene.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// Length of a step, seconds.
    pub fn step_secs(&self) -> f64 {
        self.step_secs
    }

    /// Time of the scene, seconds; goes on rising where the clip loops.
    pub fn time_secs(&self) -> f64 {
        self.at_step as f64 * self.step_secs
    }

    /// Where the timeline stands, seconds.
    pub fn position_secs(&self) -> f64 {
        self.scene.position_secs(self.time_secs())
    }

    /// Whether a motion that does not loop has come to its end.
    pub fn is_at_end(&self) -> bool {
        !self.scene.looping && self.time_secs() >= self.scene.duration_secs()
    }

    /// Settings for the steps to come.
    pub fn set_settings(&mut self, settings: &SimulationSettings) {
        self.settings = settings.clamped();
    }

    /// Settings for the steps to come, and what of them follows the timeline.
    pub fn follow(&mut self, project: &Project) {
        self.set_settings(&project.simulation);
        self.animation = Animation::of(project);
    }

    /// The worst of all steps since the hair was last settled.
    pub fn totals(&self) -> Totals {
        self.totals
    }

    /// Forgets the worst steps, so that [`Engine::totals`] counts from here.
    pub fn clear_totals(&mut self) {
        self.totals = Totals::default();
    }

    /// A fingerprint of the simulated state.
    pub fn state_hash(&self) -> u64 {
        self.simulation.state_hash()
    }

    /// Takes another scene at the same time. Hair of the same layout goes on moving; other hair starts in its
    /// style and falls into place.
    pub fn set_scene(&mut self, scene: Arc<Scene>) {
        let before = std::mem::replace(&mut self.scene, scene);
        let same_layout = before.style.guides.points_per_guide == self.scene.style.guides.points_per_guide
            && before.style.guides.count() == self.scene.style.guides.count();
        if !Arc::ptr_eq(&before.style, &self.scene.style) {
            if same_layout {
                self.simulation.set_style(Arc::clone(&self.scene.style));
            } else {
                self.simulation = Simulation::new(Arc::clone(&self.scene.style));
            }
        }
        let same_body = Arc::ptr_eq(&before.body, &self.scene.body);
        let same_clip = match (&before.clip, &self.scene.clip) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            (None, None) => true,
            _ => false,
        };
        let old_secs = self.at_step as f64 * self.step_secs;
        // Another tempo goes on from the same pose; another clip from the same place of the timeline.
        let time_secs = if same_clip {
            before.clip_secs(old_secs) / self.scene.speed
        } else {
            before.position_secs(old_secs)
        };
        self.at_step = (self.scene.position_secs(time_secs) / self.step_secs).round() as i64;
        if !same_layout || !same_body {
            // Briefly: a slider that is dragged brings many such scenes, and the rest of the fall may be seen.
            self.fall_into_place(0.2, 0.0);
        } else if !same_clip {
            self.jump();
        }
    }

    /// Back to the first frame, the hair settled.
    pub fn restart(&mut self) {
        self.at_step = 0;
        self.settle();
    }

    /// Puts the hair to its style and lets it fall into place. Where the clip loops, it then lives through the
    /// dance before this time, so that the first frame moves like all others.
    pub fn settle(&mut self) {
        let lead_secs =
            if self.scene.loops_smoothly() && self.scene.clip.is_some() { LEAD_SECS } else { 0.0 };
        self.fall_into_place(SETTLE_SECS, lead_secs);
    }

    /// From the style at rest: `fall_secs` in the pose `lead_secs` before now, then the motion until now.
    fn fall_into_place(&mut self, fall_secs: f64, lead_secs: f64) {
        let steps = |secs: f64| (secs / self.step_secs).round() as i64;
        let (fall, lead) = (steps(fall_secs), steps(lead_secs));
        self.jumped_since = true;
        self.at_step -= lead;
        self.simulated_secs += JUMP_SECS;
        self.place_body();
        self.simulation.reset(&Self::input(self.simulated_secs, self.pose.world_from_head, &self.colliders));
        for _ in 0..fall {
            self.simulate();
        }
        for _ in 0..lead {
            self.at_step += 1;
            self.place_body();
            self.simulate();
        }
        self.totals = Totals::default();
        self.times = StageTimes::default();
    }

    /// One step on.
    pub fn step(&mut self) {
        self.cut = std::mem::take(&mut self.jumped_since);
        let before = self.scene.repetition(self.time_secs());
        self.at_step += 1;
        let mut watch = Stopwatch::start();
        if !self.scene.loops_smoothly() && self.scene.repetition(self.time_secs()) != before {
            self.simulated_secs += JUMP_SECS;
        }
        if let Some(animation) = &self.animation {
            self.settings = animation.simulation_at(self.position_secs());
        }
        self.place_body();
        self.times.motion += watch.lap_ms();
        self.simulate();
        self.times.simulate += watch.ms();
        self.taken += 1;
        self.totals.add(&self.report);
    }

    /// On to the given step, counted from the scene's time zero; does nothing where time is there already.
    pub fn advance_to_step(&mut self, step: u64) {
        while self.at_step < step as i64 {
            self.step();
        }
    }

    /// To a time of the scene: the hair keeps its shape and moves along with the head.
    pub fn seek(&mut self, time_secs: f64) {
        let time_secs = if time_secs.is_finite() { time_secs.max(0.0) } else { 0.0 };
        self.at_step = (time_secs / self.step_secs).round() as i64;
        self.jump();
    }

    /// Back by a number of steps; from the first frame of a loop on to its last one. The hair moves along.
    pub fn step_back(&mut self, steps: u64) {
        let back = self.time_secs() - steps as f64 * self.step_secs;
        let time_secs = if back < 0.0 && self.scene.looping { self.scene.position_secs(back) } else { back };
        self.seek(time_secs);
    }

    /// The instant as a take holds it.
    pub fn take_frame(&self, out: &mut TakeFrame) {
        self.simulation.frame(&mut out.guides);
        out.guides.time_secs = self.time_secs();
        out.clip_secs = self.scene.clip_secs(self.time_secs());
        (out.wall_frame, out.substeps) = (self.taken, self.report.substeps);
        out.jumped = self.report.jumped || self.cut;
    }

    /// The instant as it is, for drawing. Resets the times that it carries.
    pub fn snapshot(&mut self) -> Arc<FrameSnapshot> {
        let watch = Stopwatch::start();
        let (scene, pose, times) = (&self.scene, &self.pose, &mut self.times);
        let (simulation, report, totals) = (&self.simulation, self.report, self.totals);
        let (step, time_secs) = (self.taken, self.at_step as f64 * self.step_secs);
        let new = || FrameSnapshot {
            scene: Arc::clone(scene),
            step,
            time_secs,
            position_secs: 0.0,
            duration_secs: 0.0,
            pose: Pose::default(),
            skin: Skin::default(),
            guides: GuideFrame {
                time_secs,
                world_from_head: Affine3A::IDENTITY,
                guides: scene.style.guides.clone(),
            },
            report,
            totals,
            times: StageTimes::default(),
        };
        self.pool.make(new, |frame| {
            if !Arc::ptr_eq(&frame.scene, scene) {
                frame.scene = Arc::clone(scene);
            }
            (frame.step, frame.time_secs, frame.position_secs) =
                (step, time_secs, scene.position_secs(time_secs));
            frame.duration_secs = scene.duration_secs();
            frame.pose.clone_from(pose);
            skin(&scene.body, pose, &mut frame.skin);
            simulation.frame(&mut frame.guides);
            // The simulator's clock has jumps in it; the frame's is the scene's.
            frame.guides.time_secs = time_secs;
            (frame.report, frame.totals) = (report, totals);
            times.motion += watch.ms();
            frame.times = std::mem::take(times);
        })
    }

    fn input(time_secs: f64, world_from_head: Affine3A, colliders: &[PlacedCollider]) -> StepInput<'_> {
        StepInput::new(time_secs, world_from_head, colliders)
    }

    /// Poses the body at the present step.
    fn place_body(&mut self) {
        let clip_secs = self.scene.clip_secs(self.time_secs());
        pose_at(&self.scene.body, self.scene.clip.as_deref(), clip_secs, &mut self.pose);
        place_colliders(&self.scene.colliders, &self.scene.body, &self.pose, &mut self.colliders);
    }

    /// One step of the hair to where the body is.
    fn simulate(&mut self) {
        self.simulated_secs += self.step_secs;
        let input = Self::input(self.simulated_secs, self.pose.world_from_head, &self.colliders);
        self.report = self.simulation.step(&input, &self.settings, self.step_secs as f32);
    }

    /// The body is elsewhere at once: moves the hair along.
    fn jump(&mut self) {
        self.jumped_since = true;
        self.simulated_secs += JUMP_SECS;
        self.place_body();
        self.simulate();
        self.totals.add(&self.report);
    }
}
