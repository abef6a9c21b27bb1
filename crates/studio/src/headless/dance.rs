//! Where the frames of a recording come from: a simulation that runs, or a take that was recorded.

use std::ops::{ControlFlow, Range};
use std::sync::Arc;

use lovelock_record::TakeAsset;

use super::Progress;
use super::prepare::{load, settled_at, simulate_to, tell};
use super::seam::{Seam, SeamOfTake};
use crate::session::LastSteps;
use crate::{
    Access, Engine, FrameClock, FrameSnapshot, Gauge, Place, Problem, ProblemKind, Project, Scene,
    StudioError, TakePlayer, Totals, health,
};

/// A dance, frame by frame.
pub(crate) enum Dance {
    /// The window's engine with a fixed clock; made when the first frame is asked for.
    Simulated {
        scene: Arc<Scene>,
        project: Box<Project>,
        clock: FrameClock,
        engine: Option<Box<Engine>>,
        /// Where the film goes round, and the hair with it.
        seam: Option<Seam>,
        /// Where instants between two steps are asked for.
        steps: Box<LastSteps>,
    },
    /// A take: nothing is simulated.
    Taken { player: Box<TakePlayer>, fps: f64, seam: Option<SeamOfTake> },
}

impl Dance {
    /// Loads the project's scene, or opens its take. Also returns what is missing or not as it was.
    ///
    /// # Errors
    /// Hair that cannot be grown, a take that cannot be played, or [`StudioError::Cancelled`].
    pub(crate) fn open(
        project: &Project,
        access: &Access,
        fps: f64,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<(Self, Vec<Problem>), StudioError> {
        let Some(file) = &project.take.file else {
            let (scene, problems) = load(project, access, progress)?;
            let dance = Self::Simulated {
                scene,
                project: Box::new(project.clone()),
                clock: FrameClock::new(fps),
                engine: None,
                seam: None,
                steps: Box::default(),
            };
            return Ok((dance, problems));
        };
        tell(progress, Progress::Loading { what: "opening the take".to_owned() })?;
        let path =
            access.read(Place::Take, file).map_err(|problem| StudioError::input(&file.path, problem))?;
        let (player, problems) = TakePlayer::open(&path, access)?;
        Ok((Self::Taken { player: Box::new(player), fps, seam: None }, problems))
    }

    /// The scene at the frame that was made last.
    pub(crate) fn scene(&self) -> &Arc<Scene> {
        match self {
            Self::Simulated { scene, .. } => scene,
            Self::Taken { player, .. } => player.scene(),
        }
    }

    /// Frames that it lasts, at least one.
    pub(crate) fn frames(&self) -> u64 {
        match self {
            Self::Simulated { scene, clock, .. } => {
                scene.frames(1.0 / (clock.step_secs * f64::from(clock.steps_per_frame)))
            }
            // The last recorded frame is shown for its length.
            Self::Taken { player, fps, .. } => {
                ((player.frames() as f64 * player.frame_secs() * fps) + 1e-6).floor().max(1.0) as u64
            }
        }
    }

    /// The first frame that there is.
    pub(crate) fn first_frame(&self) -> u64 {
        match self {
            Self::Simulated { .. } => 0,
            Self::Taken { player, fps, .. } => (player.origin_secs() * fps - 1e-6).ceil().max(0.0) as u64,
        }
    }

    /// Counts the frames of a take on the dance that it was recorded from; those of a simulation are.
    pub(crate) fn count_on_dance(&mut self) {
        if let Self::Taken { player, .. } = self {
            player.count_on_dance();
        }
    }

    /// When a frame is, seconds.
    pub(crate) fn secs_of(&self, frame: u64) -> f64 {
        match self {
            Self::Simulated { clock, .. } => clock.time_of_frame(frame),
            Self::Taken { fps, .. } => frame as f64 / fps,
        }
    }

    /// Refuses frames that there are not. A simulation goes on for ever.
    ///
    /// # Errors
    /// A range that reaches beyond the take.
    pub(crate) fn check(&self, frames: &Range<u64>) -> Result<(), StudioError> {
        match self {
            Self::Taken { player, fps, .. } => {
                let first = self.first_frame();
                let held = first..first + self.frames();
                if frames.start >= held.start && frames.end <= held.end {
                    return Ok(());
                }
                Err(StudioError::option(format!(
                    "frames {}..{}: {} holds {:.2} s, which at {fps} frames a second are frames {}..{}",
                    frames.start,
                    frames.end,
                    player.path().display(),
                    player.frames() as f64 * player.frame_secs(),
                    held.start,
                    held.end
                )))
            }
            Self::Simulated { .. } => Ok(()),
        }
    }

    /// Lets the hair of the last of `frames` go over into that of the first, so that a film of them goes round without a jump.
    ///
    /// # Errors
    /// Frames after which the body does not stand as it did before them; a take without the time before them that the
    /// hair comes from.
    pub(crate) fn close(&mut self, frames: &Range<u64>) -> Result<(), StudioError> {
        let count = frames.end - frames.start;
        match self {
            Self::Simulated { scene, clock, seam, .. } => {
                let frame_secs = clock.step_secs * f64::from(clock.steps_per_frame);
                *seam = Some(Seam::of(scene, frames, frame_secs)?);
            }
            Self::Taken { player, fps, seam } => {
                *seam = Some(SeamOfTake::of(player, frames.start as f64 / *fps, count as f64 / *fps)?);
            }
        }
        Ok(())
    }

    /// Gives the hair its life before the frame `start`, and lives on to `first_secs` in what is recorded from there: a frame is
    /// the same whatever of a recording is kept.
    ///
    /// # Errors
    /// [`StudioError::Cancelled`].
    pub(crate) fn begin(
        &mut self,
        start: u64,
        first_secs: f64,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<(), StudioError> {
        if let Self::Simulated { scene, project, clock, engine, steps, seam } = self {
            let first = step_before(first_secs, clock).0;
            let mut made =
                Box::new(settled_at(scene, project, clock, [clock.step_of_frame(start), first], progress)?);
            match seam {
                Some(seam) => seam.live_round(&mut made, clock, first_secs, progress)?,
                None => simulate_to(&mut made, first, progress)?,
            }
            made.clear_totals();
            steps.forget();
            *engine = Some(made);
        }
        Ok(())
    }

    /// The instant of a frame; of a simulation, after [`Dance::begin`] and in rising order.
    ///
    /// # Errors
    /// A take whose frames there are damaged.
    pub(crate) fn snapshot(&mut self, frame: u64) -> Result<Arc<FrameSnapshot>, StudioError> {
        match self {
            Self::Simulated { scene, project, clock, engine, seam, .. } => {
                let engine = engine.get_or_insert_with(|| engine_at(scene, project, clock, frame));
                let Some(seam) = seam else {
                    engine.advance_to_step(clock.step_of_frame(frame));
                    return Ok(engine.snapshot());
                };
                engine.advance_to_step(clock.step_of_frame(frame + seam.frames()));
                Ok(seam.faded(seam.secs_of(frame), &engine.snapshot()))
            }
            Self::Taken { player, fps, seam } => {
                let secs = frame as f64 / *fps;
                match seam {
                    Some(seam) => seam.snapshot(player, secs),
                    None => player.snapshot(secs),
                }
            }
        }
    }

    /// The instant at a time, seconds; of a simulation, after [`Dance::begin`] and in rising order. Between two steps of it hair is
    /// interpolated as between two frames of a take.
    ///
    /// # Errors
    /// As [`Dance::snapshot`].
    pub(crate) fn snapshot_at(&mut self, secs: f64) -> Result<Arc<FrameSnapshot>, StudioError> {
        match self {
            Self::Simulated { scene, project, clock, engine, steps, seam } => {
                let first = || engine_at(scene, project, clock, 0);
                let engine = engine.get_or_insert_with(first);
                let round = seam.as_ref().map_or(0.0, Seam::round_secs);
                let (step, t) = step_before(secs + round, clock);
                // One by one at the end, so that the step before the last one is known.
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
                    Some(seam) => seam.faded(secs, &snapshot),
                    None => snapshot,
                })
            }
            Self::Taken { player, seam, .. } => match seam {
                Some(seam) => seam.snapshot(player, secs),
                None => player.snapshot(secs),
            },
        }
    }

    /// The files that a take was made from.
    pub(crate) fn take_assets(&self) -> &[TakeAsset] {
        match self {
            Self::Simulated { .. } => &[],
            Self::Taken { player, .. } => &player.header().assets,
        }
    }

    /// Frames of a take that were lost, and what was drawn in their place.
    pub(crate) fn notices(&mut self) -> Vec<Problem> {
        let Self::Taken { player, .. } = self else { return Vec::new() };
        let told = player.notices().into_iter();
        told.map(|notice| Problem::new(Place::Take, ProblemKind::Note, notice)).collect()
    }

    /// The worst of the steps since [`Dance::begin`]; none of a take.
    pub(crate) fn totals(&self) -> Totals {
        match self {
            Self::Simulated { engine: Some(engine), .. } => engine.totals(),
            _ => Totals::default(),
        }
    }

    /// The gauges of the steps since [`Dance::begin`]; none of a take.
    pub(crate) fn health(&self) -> Vec<Gauge> {
        match self {
            Self::Simulated { scene, project, engine: Some(engine), .. } => {
                health(&engine.totals(), engine.rest_inside(), scene, &project.simulation)
            }
            _ => Vec::new(),
        }
    }

    /// A fingerprint of the simulated state; none of a take.
    pub(crate) fn state_hash(&self) -> Option<u64> {
        match self {
            Self::Simulated { engine: Some(engine), .. } => Some(engine.state_hash()),
            _ => None,
        }
    }

    /// Steps of the simulation a frame; 0 of a take.
    pub(crate) fn steps_per_frame(&self) -> u32 {
        match self {
            Self::Simulated { clock, .. } => clock.steps_per_frame,
            Self::Taken { .. } => 0,
        }
    }
}

/// A simulation whose hair is settled at a frame.
fn engine_at(scene: &Arc<Scene>, project: &Project, clock: &FrameClock, frame: u64) -> Box<Engine> {
    let mut made = Engine::at_rest(Arc::clone(scene), project.simulation, clock.step_secs);
    made.follow(project);
    made.seek(clock.time_of_frame(frame));
    made.settle();
    Box::new(made)
}

/// The step at or before a time, and how far on to the next one it is, 0 to 1.
pub(super) fn step_before(secs: f64, clock: &FrameClock) -> (u64, f64) {
    let steps = (secs / clock.step_secs).max(0.0);
    // A hair's breadth beside a step is the step.
    let (step, t) = ((steps + 1e-6).floor(), steps - (steps + 1e-6).floor());
    (step as u64, if t < 1e-6 { 0.0 } else { t })
}
