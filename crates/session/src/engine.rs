//! The simulation of a scene, step by step. It is synchronous and has no clock.

mod ahead;
mod brushing;
mod combing;
mod preroll;
mod settle;
mod shown;
mod stepper;
mod styled;

pub use brushing::BrushLayers;
pub use preroll::{Preroll, PrerollProgress};
pub(crate) use shown::LastSteps;
#[cfg(test)]
pub(crate) use stepper::kernels_for_tests;

use std::sync::Arc;

use combing::Combing;
use glam::Affine3A;
use lovelock_base::clock::Stopwatch;
use lovelock_base::settings::Settings;
use lovelock_groom::{GuideFrame, Guides};
use lovelock_motion::{FieldPose, PlacedCollider, Pose, place_colliders};
use lovelock_project::Project;
use lovelock_project::animation::Animation;
use lovelock_project::project::TimelineSection;
use lovelock_record::TakeFrame;
use lovelock_simulation::{InsidePoint, PlacedField, Simulation, SimulationSettings, StepInput, StepReport};

use stepper::Stepper;

use crate::clock::STEP_SECS;
use crate::scene::{Scene, Styling};
use crate::snapshot::SnapshotPool;
use crate::stats::StageTimes;
use crate::totals::Totals;

/// Time step that is passed to the simulator when the motion jumps, seconds. The simulator then moves the hair with the head
/// instead of simulating it ([`StepInput::time_secs`]).
const JUMP_SECS: f64 = 16.0;

/// A scene in motion.
///
/// Time advances in equal steps from the first frame. The state after a number of steps depends only on the scene, the settings
/// and that number, not on the number of threads or the clock.
///
/// [`Engine::seek`] moves the hair rigidly with the head. [`Engine::settle`], or [`Engine::preroll`] on another thread, then gives
/// it the shape that it has at that time.
#[derive(Debug)]
pub struct Engine {
    /// The scene with the hairstyle of the current step.
    scene: Arc<Scene>,
    /// The scene as it was loaded.
    loaded: Arc<Scene>,
    /// The tracks of the hairstyle.
    styling: Option<Styling>,
    settings: SimulationSettings,
    /// The tracks of the settings.
    animation: Option<Animation>,
    /// Length of the pre-roll before an instant, seconds.
    preroll_secs: f64,
    step_secs: f64,
    simulation: Simulation,
    stepper: Stepper,
    /// The transition of strands to other ties, while it lasts.
    combing: Option<Combing>,
    /// Current step, counted from the scene's time zero.
    at_step: i64,
    /// Steps since the engine started.
    taken: u64,
    /// The simulator's clock, which jumps when the motion does.
    simulated_secs: f64,
    pose: Pose,
    colliders: Vec<PlacedCollider>,
    sheltering: Vec<PlacedCollider>,
    field: FieldPose,
    /// The deepest point of the style at rest inside the body.
    rest_inside: Option<InsidePoint>,
    /// Whether the next step must compute `rest_inside` again.
    rest_is_new: bool,
    report: StepReport,
    totals: Totals,
    times: StageTimes,
    /// Whether time or the motion jumped since the last step, so that the instants must not be interpolated.
    jumped_since: bool,
    /// The same for the last step.
    cut: bool,
    pool: SnapshotPool,
}

impl Engine {
    /// The memory of its hair, bytes: the hairstyle, that below the layers, and the guides that move.
    pub fn bytes(&self) -> u64 {
        let (style, base) = (&self.scene.style, &self.scene.source.base);
        let below = if Arc::ptr_eq(style, base) { 0 } else { base.bytes() };
        style.bytes() + below + self.simulation.bytes()
    }

    /// A scene at its first frame with settled hair, in steps of 1/60 s.
    pub fn new(scene: Arc<Scene>, settings: SimulationSettings) -> Self {
        Self::with_step(scene, settings, STEP_SECS)
    }

    /// As [`Engine::new`], in steps of `step_secs`.
    pub fn with_step(scene: Arc<Scene>, settings: SimulationSettings, step_secs: f64) -> Self {
        let mut engine = Self::at_rest(scene, settings, step_secs);
        engine.settle();
        engine
    }

    /// A scene at its first frame with its hair in the rest style, not settled.
    pub fn at_rest(scene: Arc<Scene>, settings: SimulationSettings, step_secs: f64) -> Self {
        let simulation = Simulation::new(Arc::clone(&scene.style));
        let mut engine = Self {
            loaded: Arc::clone(&scene),
            styling: None,
            scene,
            settings: settings.clamped(),
            animation: None,
            preroll_secs: f64::from(TimelineSection::default().preroll_secs),
            step_secs,
            simulation,
            stepper: Stepper::default(),
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
        engine.reset_to_rest(0, f64::NEG_INFINITY);
        engine.rest_inside = engine.simulation.rest_inside();
        engine
    }

    /// The scene, with the hairstyle as it was loaded. Snapshots have that of their instant.
    #[expect(
        clippy::misnamed_getters,
        reason = "`scene` is the one of the current step, which is the engine's own"
    )]
    pub fn scene(&self) -> &Arc<Scene> {
        &self.loaded
    }

    /// Length of a step, seconds.
    pub fn step_secs(&self) -> f64 {
        self.step_secs
    }

    /// Time of the scene, seconds; keeps increasing when the clip loops.
    pub fn time_secs(&self) -> f64 {
        self.at_step as f64 * self.step_secs
    }

    /// Position on the timeline, seconds.
    pub fn position_secs(&self) -> f64 {
        self.scene.position_secs(self.time_secs())
    }

    /// Whether a motion without loop has reached its end.
    pub fn is_at_end(&self) -> bool {
        !self.scene.looping && self.time_secs() >= self.scene.duration_secs()
    }

    /// Sets the settings of the next steps.
    pub fn set_settings(&mut self, settings: &SimulationSettings) {
        self.settings = settings.clamped();
    }

    /// Sets the settings of the next steps, including their tracks, and the tracks of the hairstyle.
    pub fn follow(&mut self, project: &Project) {
        self.set_settings(&project.simulation);
        self.animation = Animation::of(project);
        self.preroll_secs = f64::from(project.timeline.preroll_secs);
        self.stepper.choose(project.picture.simulate, &mut self.simulation);
        self.styling = Styling::of(project, self.styling.take());
        self.restyle(f64::NEG_INFINITY);
    }

    /// The worst values of all steps since the hair was last settled.
    pub fn totals(&self) -> Totals {
        self.totals
    }

    /// Resets [`Engine::totals`].
    pub fn clear_totals(&mut self) {
        self.totals = Totals::default();
    }

    /// Continues from earlier totals.
    pub(super) fn set_totals(&mut self, totals: &Totals) {
        self.totals = *totals;
    }

    /// The deepest point of the style at rest inside the body, if any.
    pub fn rest_inside(&self) -> Option<InsidePoint> {
        self.rest_inside
    }

    /// Simulation time since the last call, milliseconds, and the substeps of the last step. Resets the time.
    pub fn take_simulate_ms(&mut self) -> (f64, u32) {
        (std::mem::take(&mut self.times).simulate, self.report.substeps)
    }

    /// Whether a graphics device advanced the guides in the last step, and a sentence that says why it did not if it was to.
    pub fn simulated_on_device(&self) -> (bool, Option<&Arc<str>>) {
        self.stepper.state()
    }

    /// A hash of the simulated state.
    pub fn state_hash(&self) -> u64 {
        self.simulation.state_hash()
    }

    /// Replaces the scene at the same time. Hair of the same layout keeps moving; other hair starts in its rest style. Returns
    /// whether the hair is now in its rest style and should be settled.
    pub fn set_scene(&mut self, scene: Arc<Scene>) -> bool {
        let old_secs = self.at_step as f64 * self.step_secs;
        let before = std::mem::replace(&mut self.loaded, scene);
        let same_clip = match (&before.clip, &self.loaded.clip) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            (None, None) => true,
            _ => false,
        };
        // Another speed continues from the same pose; another clip from the same position on the timeline.
        let time_secs = if same_clip {
            before.clip_secs(old_secs) / self.loaded.speed
        } else {
            before.position_secs(old_secs)
        };
        self.at_step = (self.loaded.position_secs(time_secs) / self.step_secs).round() as i64;
        let styled = self.styled(f64::NEG_INFINITY);
        let before = std::mem::replace(&mut self.scene, styled);
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
        if !Arc::ptr_eq(&before.colliders, &self.scene.colliders) {
            // The same number of colliders may still be different ones.
            self.simulation.invalidate_colliders();
        }
        if !same_layout || !same_body {
            self.reset_to_rest(self.at_step, f64::NEG_INFINITY);
        } else if !same_clip {
            self.jump();
        }
        self.rest_is_new = true;
        !(same_layout && same_body && same_clip)
    }

    /// One step of a pre-roll.
    pub(super) fn step_preroll(&mut self, lead_in_secs: f64) {
        self.at_step += 1;
        self.follow_timeline(lead_in_secs);
        self.place_body(lead_in_secs);
        self.simulate(false);
    }

    /// The report of the last step.
    #[cfg(test)]
    pub(super) fn report(&self) -> StepReport {
        self.report
    }

    /// Carries the space of the head to the world at the current step.
    pub(crate) fn world_from_head(&self) -> Affine3A {
        self.pose.world_from_head
    }

    /// Current step, counted from the scene's time zero.
    pub(crate) fn at_step(&self) -> i64 {
        self.at_step
    }

    /// Advances by one step.
    pub fn step(&mut self) {
        self.finish_step();
        self.advance(false);
    }

    /// Advances by one step, or only begins it if it may go `ahead`.
    fn advance(&mut self, ahead: bool) {
        self.cut = std::mem::take(&mut self.jumped_since);
        let before = self.scene.repetition(self.time_secs());
        self.at_step += 1;
        let mut watch = Stopwatch::start();
        if !self.scene.loops_smoothly() && self.scene.repetition(self.time_secs()) != before {
            self.simulated_secs += JUMP_SECS;
        }
        self.follow_timeline(f64::NEG_INFINITY);
        self.place_body(f64::NEG_INFINITY);
        self.times.motion += watch.lap_ms();
        let done = self.simulate(ahead);
        self.times.simulate += watch.ms();
        if done {
            self.end_step();
        }
    }

    /// Counts a step that is done.
    fn end_step(&mut self) {
        self.taken += 1;
        self.count();
        let step_secs = self.step_secs;
        self.combing.take_if(|combing| !combing.advance(step_secs));
    }

    /// Advances to a step, counted from the scene's time zero. Does nothing if that step is not later.
    pub fn advance_to_step(&mut self, step: u64) {
        while self.at_step < step as i64 {
            self.step();
        }
    }

    /// Moves to a time of the scene. The hair keeps its shape relative to the head until it is settled.
    pub fn seek(&mut self, time_secs: f64) {
        let time_secs = if time_secs.is_finite() { time_secs.max(0.0) } else { 0.0 };
        self.at_step = (time_secs / self.step_secs).round() as i64;
        self.jump();
    }

    /// Moves back by a number of steps; from the first frame of a loop to its last one. The hair moves with the head.
    pub fn step_back(&mut self, steps: u64) {
        let back = self.time_secs() - steps as f64 * self.step_secs;
        let time_secs = if back < 0.0 && self.scene.looping { self.scene.position_secs(back) } else { back };
        self.seek(time_secs);
    }

    /// The instant as a take stores it.
    pub fn take_frame(&self, out: &mut TakeFrame) {
        self.simulation.frame(&mut out.guides);
        out.guides.time_secs = self.time_secs();
        out.clip_secs = self.scene.clip_secs(self.time_secs());
        (out.wall_frame, out.substeps) = (self.taken, self.report.substeps);
        out.jumped = self.report.jumped || self.cut;
    }

    /// Applies the tracks to the settings and the hairstyle of the current step; see [`Engine::restyle`].
    fn follow_timeline(&mut self, lead_in_secs: f64) {
        self.restyle(lead_in_secs);
        if let Some(animation) = &self.animation {
            self.settings = animation.simulation_at(self.position_secs());
        }
    }

    /// Poses the body at the current step, or at `lead_in_secs` if that is later.
    fn place_body(&mut self, lead_in_secs: f64) {
        let clip_secs = self.scene.clip_secs(self.time_secs().max(lead_in_secs));
        self.scene.pose_at(clip_secs, &mut self.pose);
        place_colliders(&self.scene.colliders, &self.scene.body, &self.pose, &mut self.colliders);
        place_colliders(&self.scene.sheltering, &self.scene.body, &self.pose, &mut self.sheltering);
        if let Some(field) = &self.scene.field {
            field.place(&self.scene.body, &self.pose, self.scene.field_lift_m, &mut self.field);
        }
    }

    /// Simulates one step of the hair with the current pose, or only begins it if it may go `ahead`. Returns whether it is done.
    fn simulate(&mut self, ahead: bool) -> bool {
        // The wind depends only on the time, not on how the engine got there.
        self.simulation.set_wind_secs(self.time_secs() - self.step_secs);
        self.simulated_secs += self.step_secs;
        let placed = [&self.colliders[..], &self.sheltering];
        let input = body_at(self.simulated_secs, &self.scene, &self.pose, placed, &self.field);
        let secs = self.step_secs as f32;
        let (stepper, simulation) = (&mut self.stepper, &mut self.simulation);
        let report = if ahead {
            stepper.begin(simulation, &input, &self.settings, secs)
        } else {
            Some(stepper.step(simulation, &input, &self.settings, secs))
        };
        if std::mem::take(&mut self.rest_is_new) {
            self.rest_inside = self.simulation.rest_inside();
        }
        self.report = report.unwrap_or(self.report);
        report.is_some()
    }

    /// Moves the hair with the body after a jump.
    fn jump(&mut self) {
        self.jumped_since = true;
        self.restyle(f64::NEG_INFINITY);
        self.simulated_secs += JUMP_SECS;
        self.place_body(f64::NEG_INFINITY);
        self.simulate(false);
        self.count();
    }

    /// Adds the last step to the totals.
    fn count(&mut self) {
        let has_timeline = self.scene.duration_secs() > 0.0;
        let (secs, simulation) = (has_timeline.then(|| self.position_secs()), &self.simulation);
        self.totals.add(&self.report, secs, |guide, point| simulation.guide_point(guide, point));
    }
}

/// The body at a time of the simulator's clock: the shapes that hair collides with, and those that only block the wind.
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
