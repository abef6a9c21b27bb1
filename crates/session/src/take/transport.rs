//! Position in a take during playback: forwards, backwards and looped.

use std::path::Path;
use std::sync::Arc;

use lovelock_project::error::ProjectError;

use super::player::TakePlayer;
use crate::snapshot::FrameSnapshot;

/// A take and the current position in it.
pub(crate) struct TakeTransport {
    player: TakePlayer,
    secs: f64,
    looping: bool,
}

impl TakeTransport {
    /// The memory of decoded frames, bytes.
    pub(crate) fn cached_bytes(&self) -> u64 {
        self.player.cached_bytes()
    }

    /// Starts at the first frame.
    pub(crate) fn new(player: TakePlayer) -> Self {
        let looping = player.project().motion.looping;
        Self { player, secs: 0.0, looping }
    }

    /// The position in `file`, seconds; `None` if another one plays.
    pub(crate) fn position_in(&self, file: &Path) -> Option<f64> {
        (self.player.path() == file).then_some(self.secs)
    }

    pub(crate) fn set_looping(&mut self, looping: bool) {
        self.looping = looping;
    }

    /// Advances by `secs`, which may be negative. Returns whether playback has stopped at an end.
    pub(crate) fn advance(&mut self, secs: f64) -> bool {
        let duration = self.player.duration_secs();
        let to = self.secs + secs;
        if self.looping && duration > 0.0 {
            // The last frame also lasts for one frame.
            self.secs = to.rem_euclid(duration + self.player.frame_secs());
            return false;
        }
        self.secs = to.clamp(0.0, duration);
        to > duration || to < 0.0
    }

    /// Seeks to a time from the take's start.
    pub(crate) fn seek(&mut self, secs: f64) {
        self.secs = if secs.is_finite() { secs.clamp(0.0, self.player.duration_secs()) } else { 0.0 };
    }

    /// Steps by whole frames.
    pub(crate) fn step(&mut self, frames: i64) {
        let at = (self.secs / self.player.frame_secs()).round() as i64;
        let last = self.player.frames() as i64 - 1;
        let to = at.saturating_add(frames);
        let to = if self.looping { to.rem_euclid(last + 1) } else { to.clamp(0, last) };
        self.secs = to as f64 * self.player.frame_secs();
    }

    /// Whether the position is at the end in the direction of playback.
    pub(crate) fn is_at_end(&self, backwards: bool) -> bool {
        !self.looping
            && if backwards {
                self.secs <= 0.0
            } else {
                self.secs >= self.player.duration_secs() - 0.5 * self.player.frame_secs()
            }
    }

    /// Moves to the end where playback in this direction starts.
    pub(crate) fn restart(&mut self, backwards: bool) {
        self.secs = if backwards { self.player.duration_secs() } else { 0.0 };
    }

    /// As [`TakePlayer::notices`].
    pub(crate) fn notices(&mut self) -> Vec<String> {
        self.player.notices()
    }

    /// The snapshot at the current position.
    ///
    /// # Errors
    /// As [`TakePlayer::snapshot`].
    pub(crate) fn snapshot(&mut self) -> Result<Arc<FrameSnapshot>, ProjectError> {
        self.player.snapshot(self.secs)
    }
}
