//! The simulation and the state of a frame: synchronous, and without a clock.

mod combing;
mod preroll;
mod settle;
mod shown;

pub use preroll::{Preroll, PrerollProgress};
pub(crate) use shown::LastSteps;

use std::sync::Arc;

use combing::Combing;
use glam::Affine3A;
use lovelock_groom::{GuideFrame, Guides};
use lovelock_motion::{FieldPose, PlacedCollider, Pose, place_colliders, pose_at};
use lovelock_project::Project;
use lovelock_project::animation::Animation;
use lovelock_project::project::TimelineSection;
use lovelock_record::TakeFrame;
use lovelock_simulation::{InsidePoint, PlacedField, Simulation, SimulationSettings, StepInput, StepReport};

use crate::clock::{STEP_SECS, Stopwatch};
use crate::scene::Scene;
use crate::snapshot::SnapshotPool;
use crate::stats::StageTimes;
use crate::totals::Totals;

/// What the simulator is told that has passed where the motion jumps, seconds: it then moves hair along with the
/// head instead of simulating it ([`StepInput::time_secs`]).
const JUMP_SECS: f64 = 16.0;

/// A scene in motion.
///
/// Time runs in equal steps from the first frame: the state after a number of steps depends on the scene, the
/// settings and that number alone, not on the number of threads nor on the clock.
///
/// Going to another time carries the hair along rigidly, at once; [`Engine::settle`], or [`Engine::preroll`] aside, then gives
/// it the shape that it has there.
#[derive(Debug)]
pub struct Engine {
    scene: Arc<Scene>,
    settings: SimulationSettings,
    /// What of the settings follows the timeline.
    animation: Option<Animation>,
    /// How long hair lives before an instant that is gone to, seconds.
    preroll_secs: f64,
    step_secs: f64,
    simulation: Simulation,
    /// Strands that go over to other ties.
    combing: Option<Combing>,
    /// Steps from the scene's time zero.
    at_step: i64,
    /// Steps since the engine started.
    taken: u64,
    /// The simulator's clock, which jumps where the motion does.
    simulated_secs: f64,
    pose: Pose,
    colliders: Vec<PlacedCollider>,
    sheltering: Vec<PlacedCollider>,
    field: FieldPose,
    /// Where the style at rest lies inside the body.
    rest_inside: Option<InsidePoint>,
    /// Whether the next step may change that.
    rest_is_new: bool,
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
        let mut engine = Self::at_rest(scene, settings, step_secs);
        engine.settle();
        engine
    }

    /// A scene at its first frame, its hair in its style and not yet settled.
    pub fn at_rest(scene: Arc<Scene>, settings: SimulationSettings, step_secs: f64) -> Self {
        let simulation = Simulation::new(Arc::clone(&scene.style));
        let mut engine = Self {
            scene,
            settings: settings.clamped(),
            animation: None,
            preroll_secs: f64::from(TimelineSection::default().preroll_secs),
            step_secs,
            simulation,
            combing: None,
            at_step: 0,
            taken: 0,
            simulated_secs: 0.0,
            pose: Pose::default(),
            colliders: Vec::new(),
            sheltering: Vec::new(),
            field: FieldPose::default(),
            rest_inside: None,
            rest_is_new: false,
            report: StepReport::default(),
            totals: Totals::default(),
            times: StageTimes::default(),
            jumped_since: false,
            cut: false,
            pool: SnapshotPool::default(),
        };
        engine.lay_at_rest(0, f64::NEG_INFINITY);
        engine.rest_inside = engine.simulation.rest_inside();
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
        self.preroll_secs = f64::from(project.timeline.preroll_secs);
    }

    /// The worst of all steps since the hair was last settled.
    pub fn totals(&self) -> Totals {
        self.totals
    }

    /// Forgets the worst steps, so that [`Engine::totals`] counts from here.
    pub fn clear_totals(&mut self) {
        self.totals = Totals::default();
    }

    /// Goes on counting from totals of before.
    pub(super) fn set_totals(&mut self, totals: &Totals) {
        self.totals = *totals;
    }

    /// Where the style at rest lies deepest inside the body; none where it does not.
    pub fn rest_inside(&self) -> Option<InsidePoint> {
        self.rest_inside
    }

    /// What the simulator took for the steps since they were last taken, milliseconds, with the substeps of the last one. Counts anew.
    pub fn take_simulate_ms(&mut self) -> (f64, u32) {
        (std::mem::take(&mut self.times).simulate, self.report.substeps)
    }

    /// A fingerprint of the simulated state.
    pub fn state_hash(&self) -> u64 {
        self.simulation.state_hash()
    }

    /// Takes another scene at the same time. Hair of the same layout goes on moving; other hair starts in its style. Returns
    /// whether the hair is now as it was laid and not as it has lived, so that it wants to be settled.
    pub fn set_scene(&mut self, scene: Arc<Scene>) -> bool {
        let before = std::mem::replace(&mut self.scene, scene);
        let same_layout = before.style.guides.points_per_guide == self.scene.style.guides.points_per_guide
            && before.style.guides.count() == self.scene.style.guides.count();
        if !Arc::ptr_eq(&before.style, &self.scene.style) {
            if same_layout {
                let seen = self.combing.take().map(|combing| combing.style(&before.style));
                let mut now = GuideFrame {
                    time_secs: 0.0,
                    world_from_head: Affine3A::IDENTITY,
                    guides: Guides::default(),
                };
                self.simulation.frame(&mut now);
                let seen = seen.as_ref().unwrap_or(&before.style);
                self.combing = Combing::between(seen, &self.scene.style, &now);
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
        if !Arc::ptr_eq(&before.colliders, &self.scene.colliders) {
            // As many of them may be other ones.
            self.simulation.invalidate_colliders();
        }
        if !same_layout || !same_body {
            self.lay_at_rest(self.at_step, f64::NEG_INFINITY);
        } else if !same_clip {
            self.jump();
        }
        self.rest_is_new = true;
        !(same_layout && same_body && same_clip)
    }

    /// A step of a life that leads to another instant.
    pub(super) fn live_step(&mut self, lead_in_secs: f64) {
        self.at_step += 1;
        self.follow_timeline();
        self.place_body(lead_in_secs);
        self.simulate();
    }

    /// What the last step had to say.
    #[cfg(test)]
    pub(super) fn report(&self) -> StepReport {
        self.report
    }

    /// Steps from the scene's time zero.
    pub(crate) fn at_step(&self) -> i64 {
        self.at_step
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
        self.follow_timeline();
        self.place_body(f64::NEG_INFINITY);
        self.times.motion += watch.lap_ms();
        self.simulate();
        self.times.simulate += watch.ms();
        self.taken += 1;
        self.count();
        let step_secs = self.step_secs;
        self.combing.take_if(|combing| !combing.advance(step_secs));
    }

    /// On to the given step, counted from the scene's time zero; does nothing where time is there already.
    pub fn advance_to_step(&mut self, step: u64) {
        while self.at_step < step as i64 {
            self.step();
        }
    }

    /// To a time of the scene: the hair keeps its shape and moves along with the head, until it is settled there.
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

    /// The settings of the present step.
    fn follow_timeline(&mut self) {
        if let Some(animation) = &self.animation {
            self.settings = animation.simulation_at(self.position_secs());
        }
    }

    /// Poses the body at the present step, or at `lead_in_secs` where that is later.
    fn place_body(&mut self, lead_in_secs: f64) {
        let clip_secs = self.scene.clip_secs(self.time_secs().max(lead_in_secs));
        pose_at(&self.scene.body, self.scene.clip.as_deref(), clip_secs, &mut self.pose);
        place_colliders(&self.scene.colliders, &self.scene.body, &self.pose, &mut self.colliders);
        place_colliders(&self.scene.sheltering, &self.scene.body, &self.pose, &mut self.sheltering);
        if let Some(field) = &self.scene.field {
            field.place(&self.scene.body, &self.pose, self.scene.field_lift_m, &mut self.field);
        }
    }

    /// One step of the hair to where the body is.
    fn simulate(&mut self) {
        // The same wind blows at the same time, however the hair came there.
        self.simulation.set_wind_secs(self.time_secs() - self.step_secs);
        self.simulated_secs += self.step_secs;
        let placed = [&self.colliders[..], &self.sheltering];
        let input = body_at(self.simulated_secs, &self.scene, &self.pose, placed, &self.field);
        self.report = self.simulation.step(&input, &self.settings, self.step_secs as f32);
        if std::mem::take(&mut self.rest_is_new) {
            self.rest_inside = self.simulation.rest_inside();
        }
    }

    /// The body is elsewhere at once: moves the hair along.
    fn jump(&mut self) {
        self.jumped_since = true;
        self.simulated_secs += JUMP_SECS;
        self.place_body(f64::NEG_INFINITY);
        self.simulate();
        self.count();
    }

    /// Adds the last step to the totals.
    fn count(&mut self) {
        let has_timeline = self.scene.duration_secs() > 0.0;
        let (secs, simulation) = (has_timeline.then(|| self.position_secs()), &self.simulation);
        self.totals.add(&self.report, secs, |guide, point| simulation.guide_point(guide, point));
    }
}

/// The body at a time of the simulator's clock: the shapes that hair meets, and those that only the wind does.
fn body_at<'a>(
    time_secs: f64,
    scene: &'a Scene,
    pose: &Pose,
    [colliders, sheltering]: [&'a [PlacedCollider]; 2],
    field: &'a FieldPose,
) -> StepInput<'a> {
    let field = scene.field.as_ref().map(|of| PlacedField { field: of, pose: field });
    StepInput { field, sheltering, ..StepInput::new(time_secs, pose.world_from_head, colliders) }
}
