//! A take, or curves over time, opened for playing.

use std::path::Path;
use std::sync::Arc;

use lovelock_project::Project;
use lovelock_project::error::{Problem, ProjectError};
use lovelock_project::files::Access;
use lovelock_record::{TakeCondition, TakeHeader};

use super::cache::{CachePlayer, holds_curves};
use super::playing::RecordedPlayer;
use crate::scene::{Scene, Surroundings};
use crate::snapshot::FrameSnapshot;

/// A recorded simulation opened for playing, with its scene: a take, or curves over time of another program.
pub struct TakePlayer(Kind);

enum Kind {
    Recorded(Box<RecordedPlayer>),
    Cache(Box<CachePlayer>),
}

/// Calls a method of either player.
macro_rules! either {
    ($self:expr, $player:ident => $call:expr) => {
        match $self {
            Kind::Recorded($player) => $call,
            Kind::Cache($player) => $call,
        }
    };
}

impl TakePlayer {
    /// Opens a file and loads its scene. Problems say what has changed, is missing or is damaged. A take brings its own body and
    /// motion; curves are shown with those of `project`.
    ///
    /// # Errors
    /// If the file is neither a take nor curves over time, is of a newer version, has no frames, or its guides no longer fit the
    /// hair.
    pub fn open_for(
        path: &Path,
        access: &Access,
        project: &Project,
    ) -> Result<(Self, Vec<Problem>), ProjectError> {
        if holds_curves(path) {
            let (player, problems) = CachePlayer::open(path, access, project)?;
            return Ok((Self(Kind::Cache(Box::new(player))), problems));
        }
        let (player, problems) = RecordedPlayer::open(path, access)?;
        Ok((Self(Kind::Recorded(Box::new(player))), problems))
    }

    /// As [`TakePlayer::open_for`], with the default project.
    ///
    /// # Errors
    /// As [`TakePlayer::open_for`].
    pub fn open(path: &Path, access: &Access) -> Result<(Self, Vec<Problem>), ProjectError> {
        Self::open_for(path, access, &Project::default())
    }

    /// The memory of decoded frames, bytes; curves keep none.
    pub fn cached_bytes(&self) -> u64 {
        match &self.0 {
            Kind::Recorded(player) => player.cached_bytes(),
            Kind::Cache(_) => 0,
        }
    }

    /// The file.
    pub fn path(&self) -> &Path {
        either!(&self.0, player => player.path())
    }

    /// The header of the take. Curves have one with their times, the scene and no project.
    pub fn header(&self) -> &TakeHeader {
        either!(&self.0, player => player.header())
    }

    /// Known damage of the take.
    pub fn condition(&self) -> TakeCondition {
        match &self.0 {
            Kind::Recorded(player) => player.condition(),
            Kind::Cache(_) => TakeCondition::Whole,
        }
    }

    /// The project at the first frame.
    pub fn project(&self) -> &Project {
        either!(&self.0, player => player.project())
    }

    /// Whether it plays curves, whose strands do not follow guides.
    pub fn is_cache(&self) -> bool {
        matches!(self.0, Kind::Cache(_))
    }

    /// The scene of the last snapshot.
    pub fn scene(&self) -> &Arc<Scene> {
        either!(&self.0, player => player.scene())
    }

    /// Sets the pictures around the figure, and notes about them. A take records none. Returns whether they are others than before.
    pub fn set_surroundings(&mut self, pictures: Surroundings, notes: Vec<Problem>) -> bool {
        either!(&mut self.0, player => player.set_surroundings(pictures, notes))
    }

    /// Number of frames.
    pub fn frames(&self) -> u64 {
        either!(&self.0, player => player.frames())
    }

    /// Length of a frame, seconds.
    pub fn frame_secs(&self) -> f64 {
        1.0 / self.header().frames_per_second.as_f64()
    }

    /// Time from the first frame to the last one, seconds.
    pub fn duration_secs(&self) -> f64 {
        self.header().secs_of(self.frames() - 1)
    }

    /// Counts time, and the timeline, from the start of the original motion instead of the start of the take.
    pub fn count_on_dance(&mut self) {
        either!(&mut self.0, player => player.count_on_dance());
    }

    /// Time of the first frame, seconds: 0, or its time in the original motion after [`TakePlayer::count_on_dance`].
    pub fn origin_secs(&self) -> f64 {
        either!(&self.0, player => player.origin_secs())
    }

    /// The snapshot `secs` after the start, clamped to the take and interpolated between frames.
    ///
    /// # Errors
    /// If the frames around it are damaged or cannot be read.
    pub fn snapshot(&mut self, secs: f64) -> Result<Arc<FrameSnapshot>, ProjectError> {
        either!(&mut self.0, player => player.snapshot(secs))
    }

    /// Notices about lost frames since the last call.
    pub fn notices(&mut self) -> Vec<String> {
        match &mut self.0 {
            Kind::Recorded(player) => player.notices(),
            Kind::Cache(_) => Vec::new(),
        }
    }
}
