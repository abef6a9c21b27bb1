//! The source of a recording's frames: a running simulation, or a take.

#[cfg(test)]
mod once_tests;
mod seam;

use std::ops::{ControlFlow, Range};
use std::sync::Arc;

use lovelock_project::Project;
use lovelock_project::error::{Place, Problem, ProblemKind, ProjectError};
use lovelock_project::files::Access;
use lovelock_record::TakeAsset;
use seam::{Seam, SeamOfTake};

use crate::clock::FrameClock;
use crate::engine::{Engine, LastSteps};
use crate::health::{Gauge, health};
use crate::prepare::{load, settled_at, simulate_to};
use crate::progress::{Progress, report_progress};
use crate::scene::{Scene, SurroundingsLoader};
use crate::snapshot::FrameSnapshot;
use crate::take::TakePlayer;
use crate::totals::Totals;

/// The moving hair of a project, frame by frame, simulated or from a take.
pub struct Dance(Source);

/// The source of the frames.
enum Source {
    /// An engine with a fixed clock, created for the first frame.
    Simulated {
        scene: Arc<Scene>,
        project: Box<Project>,
        clock: FrameClock,
        engine: Option<Box<Engine>>,
        /// For seamless loops: how the end blends into the start.
        seam: Option<Seam>,
        /// The last two steps, for snapshots between them.
        steps: Box<LastSteps>,
    },
    /// A take, which needs no simulation.
    Take { player: Box<TakePlayer>, fps: f64, seam: Option<SeamOfTake> },
}

impl Dance {
    /// Loads the project's scene, or opens its take. Also returns problems.
    ///
    /// # Errors
    /// If no hair can be grown, the take cannot be played, or [`ProjectError::Cancelled`].
    pub fn open(
        project: &Project,
        access: &Access,
        fps: f64,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<(Self, Vec<Problem>), ProjectError> {
        let Some(file) = &project.take.file else {
            let (scene, problems) = load(project, access, progress)?;
            let dance = Source::Simulated {
                scene,
                project: Box::new(project.clone()),
                clock: FrameClock::new(fps),
                engine: None,
                seam: None,
                steps: Box::default(),
            };
            return Ok((Self(dance), problems));
        };
        report_progress(progress, Progress::Loading { what: "opening the take".to_owned() })?;
        let path =
            access.read(Place::Take, file).map_err(|problem| ProjectError::input(&file.path, problem))?;
        let (mut player, mut problems) = TakePlayer::open_for(&path, access, project)?;
        let mut light = SurroundingsLoader::default();
        let picture = light.load(project, access, &mut problems);
        problems.extend(light.notes());
        player.set_surroundings(picture, light.notes());
        Ok((Self(Source::Take { player: Box::new(player), fps, seam: None }), problems))
    }

    /// The scene of the last frame.
    pub fn scene(&self) -> &Arc<Scene> {
        match &self.0 {
            Source::Simulated { scene, .. } => scene,
            Source::Take { player, .. } => player.scene(),
        }
    }

    /// Number of frames, at least one.
    pub fn frames(&self) -> u64 {
        match &self.0 {
            Source::Simulated { scene, clock, .. } => scene.frames(clock.fps()),
            // The last recorded frame also lasts for one frame.
            Source::Take { player, fps, .. } => {
                ((player.frames() as f64 * player.frame_secs() * fps) + 1e-6).floor().max(1.0) as u64
            }
        }
    }

    /// Number of frames of one round of a looping motion, at least one; all frames of a take.
    pub fn frames_of_round(&self) -> u64 {
        match &self.0 {
            Source::Simulated { scene, clock, .. } => scene.frames_of_round(clock.fps()),
            Source::Take { .. } => self.frames(),
        }
    }

    /// Plays a looping motion whose last pose is not its first without the blend that its loop needs, if `frames` need no second round.
    /// Replaces the note about that blend. For frames of a seamless loop, use [`Dance::close`] instead.
    pub fn play_once(&mut self, frames: &Range<u64>, problems: &mut [Problem]) {
        let Source::Simulated { scene, project, clock, .. } = &mut self.0 else { return };
        let Some(once) = scene.played_once(frames, clock.fps()) else { return };
        replace_loop_note(scene, problems);
        project.motion.looping = false;
        *scene = Arc::new(once);
    }

    /// Number of the first available frame.
    pub fn first_frame(&self) -> u64 {
        match &self.0 {
            Source::Simulated { .. } => 0,
            Source::Take { player, fps, .. } => (player.origin_secs() * fps - 1e-6).ceil().max(0.0) as u64,
        }
    }

    /// Counts the frames of a take from the start of the original motion, as frames of a simulation are.
    pub fn count_on_dance(&mut self) {
        if let Source::Take { player, .. } = &mut self.0 {
            player.count_on_dance();
        }
    }

    /// Time of a frame, seconds.
    pub fn secs_of(&self, frame: u64) -> f64 {
        match &self.0 {
            Source::Simulated { clock, .. } => clock.time_of_frame(frame),
            Source::Take { fps, .. } => frame as f64 / fps,
        }
    }

    /// The time after which the timeline starts again at 0, seconds, if the dance loops. That of a take does not.
    pub fn period_secs(&self) -> Option<f64> {
        match &self.0 {
            Source::Simulated { scene, .. } if scene.looping => {
                Some(scene.duration_secs()).filter(|secs| *secs > 0.0)
            }
            Source::Simulated { .. } | Source::Take { .. } => None,
        }
    }

    /// Rejects frames outside the take. A simulation has no last frame.
    ///
    /// # Errors
    /// A range that extends beyond the take.
    pub fn check(&self, frames: &Range<u64>) -> Result<(), ProjectError> {
        match &self.0 {
            Source::Take { player, fps, .. } => {
                let first = self.first_frame();
                let held = first..first + self.frames();
                if frames.start >= held.start && frames.end <= held.end {
                    return Ok(());
                }
                Err(ProjectError::option(format!(
                    "frames {}..{}: {} holds {:.2} s, which at {fps} frames per second are frames {}..{}",
                    frames.start,
                    frames.end,
                    player.path().display(),
                    player.frames() as f64 * player.frame_secs(),
                    held.start,
                    held.end
                )))
            }
            Source::Simulated { .. } => Ok(()),
        }
    }

    /// Blends the hair at the end of `frames` into the hair at their start, so that a film of them loops without a jump.
    ///
    /// # Errors
    /// If the body is not in the same pose before and after the frames, or a take has not enough time before them to take the
    /// hair from.
    pub fn close(&mut self, frames: &Range<u64>) -> Result<(), ProjectError> {
        let count = frames.end - frames.start;
        match &mut self.0 {
            Source::Simulated { scene, clock, seam, .. } => {
                let frame_secs = clock.step_secs * f64::from(clock.steps_per_frame);
                *seam = Some(Seam::of(scene, frames, frame_secs)?);
            }
            Source::Take { player, .. } if player.is_cache() => {
                return Err(ProjectError::option(format!(
                    "a seamless loop: {} holds curves, and only a simulation or a take can be blended",
                    player.path().display()
                )));
            }
            Source::Take { player, fps, seam } => {
                let frame_secs = 1.0 / *fps;
                let (start, length) = (frames.start as f64 * frame_secs, count as f64 * frame_secs);
                *seam = Some(SeamOfTake::of(player, start, length, frame_secs)?);
            }
        }
        Ok(())
    }

    /// Simulates the pre-roll of the frame `start` and continues to `first_secs`. A frame is therefore the same no matter which
    /// frames of a recording exist already.
    ///
    /// # Errors
    /// [`ProjectError::Cancelled`].
    pub fn begin(
        &mut self,
        start: u64,
        first_secs: f64,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<(), ProjectError> {
        if let Source::Simulated { scene, project, clock, engine, steps, seam } = &mut self.0 {
            let first = step_before(first_secs, clock).0;
            let mut made =
                Box::new(settled_at(scene, project, clock, [clock.step_of_frame(start), first], progress)?);
            match seam {
                Some(seam) => seam.simulate_period(&mut made, clock, first_secs, progress)?,
                None => simulate_to(&mut made, first, progress)?,
            }
            made.clear_totals();
            steps.forget();
            *engine = Some(made);
        }
        Ok(())
    }

    /// The snapshot of a frame. For a simulation: after [`Dance::begin`] and in ascending order.
    ///
    /// # Errors
    /// If the frames of a take are damaged there.
    pub fn snapshot(&mut self, frame: u64) -> Result<Arc<FrameSnapshot>, ProjectError> {
        match &mut self.0 {
            Source::Simulated { scene, project, clock, engine, seam, .. } => {
                let engine = engine.get_or_insert_with(|| engine_at(scene, project, clock, frame));
                let Some(seam) = seam else {
                    engine.advance_to_step(clock.step_of_frame(frame));
                    return Ok(engine.snapshot());
                };
                engine.advance_to_step(clock.step_of_frame(frame + seam.frames()));
                Ok(seam.blended(seam.secs_of(frame), &engine.snapshot()))
            }
            Source::Take { player, fps, seam } => {
                let secs = frame as f64 / *fps;
                match seam {
                    Some(seam) => seam.snapshot(player, secs),
                    None => player.snapshot(secs),
                }
            }
        }
    }

    /// The snapshot at a time, seconds. For a simulation: after [`Dance::begin`] and in ascending order. Hair between two steps is
    /// interpolated, as between two frames of a take.
    ///
    /// # Errors
    /// As [`Dance::snapshot`].
    pub fn snapshot_at(&mut self, secs: f64) -> Result<Arc<FrameSnapshot>, ProjectError> {
        match &mut self.0 {
            Source::Simulated { scene, project, clock, engine, steps, seam } => {
                let first = || engine_at(scene, project, clock, 0);
                let engine = engine.get_or_insert_with(first);
                let round = seam.as_ref().map_or(0.0, Seam::period_secs);
                let (step, t) = step_before(secs + round, clock);
                // Take the last step separately, so that the state before it is known.
                let to = step + u64::from(t > 0.0);
                engine.advance_to_step(to.saturating_sub(1));
                if engine.at_step() < to as i64 {
                    steps.step(engine);
                }
                let snapshot = if engine.at_step() == step as i64 {
                    engine.snapshot()
                } else {
                    engine.snapshot_between(steps, t)
                };
                Ok(match seam {
                    Some(seam) => seam.blended(secs, &snapshot),
                    None => snapshot,
                })
            }
            Source::Take { player, seam, .. } => match seam {
                Some(seam) => seam.snapshot(player, secs),
                None => player.snapshot(secs),
            },
        }
    }

    /// The files that a take was made from.
    pub fn take_assets(&self) -> &[TakeAsset] {
        match &self.0 {
            Source::Simulated { .. } => &[],
            Source::Take { player, .. } => &player.header().assets,
        }
    }

    /// Notices about lost frames of a take and their replacements.
    pub fn notices(&mut self) -> Vec<Problem> {
        let Source::Take { player, .. } = &mut self.0 else { return Vec::new() };
        let told = player.notices().into_iter();
        told.map(|notice| Problem::new(Place::Take, ProblemKind::Note, notice)).collect()
    }

    /// The worst values of the steps since [`Dance::begin`]; empty for a take.
    pub fn totals(&self) -> Totals {
        match &self.0 {
            Source::Simulated { engine: Some(engine), .. } => engine.totals(),
            _ => Totals::default(),
        }
    }

    /// The gauges of the steps since [`Dance::begin`]; none for a take.
    pub fn health(&self) -> Vec<Gauge> {
        match &self.0 {
            Source::Simulated { scene, project, engine: Some(engine), .. } => {
                health(&engine.totals(), engine.rest_inside(), scene, &project.simulation)
            }
            _ => Vec::new(),
        }
    }

    /// A hash of the simulated state; `None` for a take.
    pub fn state_hash(&self) -> Option<u64> {
        match &self.0 {
            Source::Simulated { engine: Some(engine), .. } => Some(engine.state_hash()),
            _ => None,
        }
    }

    /// Simulation steps per frame; 0 for a take.
    pub fn steps_per_frame(&self) -> u32 {
        match &self.0 {
            Source::Simulated { clock, .. } => clock.steps_per_frame,
            Source::Take { .. } => 0,
        }
    }
}

/// Says of a motion that plays once what was said of it while it loops.
pub fn replace_loop_note(scene: &Scene, problems: &mut [Problem]) {
    for problem in problems.iter_mut().filter(|problem| scene.is_loop_note(problem)) {
        let how =
            "the motion plays once, from its first pose to its last, without the blend by which it loops";
        *problem = Problem::new(Place::Motion, ProblemKind::Note, how);
    }
}

/// An engine with hair that is settled at a frame.
fn engine_at(scene: &Arc<Scene>, project: &Project, clock: &FrameClock, frame: u64) -> Box<Engine> {
    let mut made = Engine::at_rest(Arc::clone(scene), project.simulation, clock.step_secs);
    made.follow(project);
    made.seek(clock.time_of_frame(frame));
    made.settle();
    Box::new(made)
}

/// The step at or before a time, and the fraction from there to the next step, 0 to 1.
pub(super) fn step_before(secs: f64, clock: &FrameClock) -> (u64, f64) {
    let steps = (secs / clock.step_secs).max(0.0);
    // With a tolerance for rounding.
    let (step, t) = ((steps + 1e-6).floor(), steps - (steps + 1e-6).floor());
    (step as u64, if t < 1e-6 { 0.0 } else { t })
}
