//! Where the frames of a recording come from: a simulation that runs, or a take that was recorded.

use std::ops::{ControlFlow, Range};
use std::sync::Arc;

use super::Progress;
use super::prepare::{load, simulate_to, tell};
use super::seam::{Seam, SeamOfTake};
use crate::{
    Access, Engine, FrameClock, FrameSnapshot, Place, Problem, ProblemKind, Project, Scene, StudioError,
    TakePlayer, Totals,
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

    /// Refuses frames that there are not. A simulation goes on for ever.
    ///
    /// # Errors
    /// A range that reaches beyond the take.
    pub(crate) fn check(&self, frames: &Range<u64>) -> Result<(), StudioError> {
        match self {
            Self::Taken { player, fps, .. } if frames.end > self.frames() => {
                Err(StudioError::option(format!(
                    "frames {}..{}: {} holds {:.2} s, which at {fps} frames a second are frames 0..{}",
                    frames.start,
                    frames.end,
                    player.path().display(),
                    player.frames() as f64 * player.frame_secs(),
                    self.frames()
                )))
            }
            _ => Ok(()),
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

    /// Lives through the frames before `frame`, so that it is the same whatever is recorded.
    ///
    /// # Errors
    /// [`StudioError::Cancelled`].
    pub(crate) fn begin(
        &mut self,
        frame: u64,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<(), StudioError> {
        if let Self::Simulated { scene, project, clock, engine, seam } = self {
            let mut made =
                Box::new(Engine::with_step(Arc::clone(scene), project.simulation, clock.step_secs));
            made.follow(project);
            simulate_to(&mut made, clock.step_of_frame(frame), progress)?;
            if let Some(seam) = seam {
                seam.live_round(&mut made, clock, progress)?;
            }
            made.clear_totals();
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
            Self::Simulated { scene, project, clock, engine, seam } => {
                let engine = engine.get_or_insert_with(|| {
                    let mut made = Engine::with_step(Arc::clone(scene), project.simulation, clock.step_secs);
                    made.follow(project);
                    Box::new(made)
                });
                let rounds = seam.as_ref().map_or(0, Seam::frames);
                engine.advance_to_step(clock.step_of_frame(frame + rounds));
                let snapshot = engine.snapshot();
                Ok(seam.as_ref().map_or(Arc::clone(&snapshot), |seam| seam.faded(frame, &snapshot)))
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
