//! Playing a take: forwards, backwards, round and round.

use std::sync::Arc;

use crate::{FrameSnapshot, StudioError};

use super::TakePlayer;

/// A take and where it stands.
pub(crate) struct TakeTransport {
    player: TakePlayer,
    secs: f64,
    looping: bool,
}

impl TakeTransport {
    /// At the first frame.
    pub(crate) fn new(player: TakePlayer) -> Self {
        let looping = player.project().motion.looping;
        Self { player, secs: 0.0, looping }
    }

    pub(crate) fn set_looping(&mut self, looping: bool) {
        self.looping = looping;
    }

    /// Goes on by `secs`, or back; returns whether an end was reached at which it stays.
    pub(crate) fn advance(&mut self, secs: f64) -> bool {
        let duration = self.player.duration_secs();
        let to = self.secs + secs;
        if self.looping && duration > 0.0 {
            // The last frame is shown for its length too.
            self.secs = to.rem_euclid(duration + self.player.frame_secs());
            return false;
        }
        self.secs = to.clamp(0.0, duration);
        to > duration || to < 0.0
    }

    /// To a time from the take's start.
    pub(crate) fn seek(&mut self, secs: f64) {
        self.secs = if secs.is_finite() { secs.clamp(0.0, self.player.duration_secs()) } else { 0.0 };
    }

    /// By whole frames.
    pub(crate) fn step(&mut self, frames: i64) {
        let at = (self.secs / self.player.frame_secs()).round() as i64;
        let last = self.player.frames() as i64 - 1;
        let to = at.saturating_add(frames);
        let to = if self.looping { to.rem_euclid(last + 1) } else { to.clamp(0, last) };
        self.secs = to as f64 * self.player.frame_secs();
    }

    /// Whether it stands at the end that it plays to.
    pub(crate) fn is_at_end(&self, backwards: bool) -> bool {
        !self.looping
            && if backwards {
                self.secs <= 0.0
            } else {
                self.secs >= self.player.duration_secs() - 0.5 * self.player.frame_secs()
            }
    }

    /// To the end that it plays from.
    pub(crate) fn restart(&mut self, backwards: bool) {
        self.secs = if backwards { self.player.duration_secs() } else { 0.0 };
    }

    /// As [`TakePlayer::notices`].
    pub(crate) fn notices(&mut self) -> Vec<String> {
        self.player.notices()
    }

    /// The instant where it stands.
    ///
    /// # Errors
    /// As [`TakePlayer::snapshot`].
    pub(crate) fn snapshot(&mut self) -> Result<Arc<FrameSnapshot>, StudioError> {
        self.player.snapshot(self.secs)
    }
}
