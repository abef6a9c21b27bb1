//! Plays a sound in step with a clock.
//!
//! The clock is that of the dance, which a slow machine plays in slow motion, and the device has a clock of its own. [`Player::follow`] is
//! told where the dance is and compares it with what is heard. Small differences are closed by playing a little faster or slower, larger
//! ones by a jump.

mod follower;
mod mixer;
#[cfg_attr(target_os = "linux", path = "pulse.rs")]
#[cfg_attr(not(target_os = "linux"), path = "system.rs")]
mod output;

use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use lovelock_base::clock::Stopwatch;

use crate::sound::Sound;
use follower::Follower;
use mixer::Mixer;
use output::Output;

/// Where the sound should be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Second of the sound; before 0 and after its end there is silence.
    pub secs: f64,
    /// Whether it plays.
    pub playing: bool,
    /// Seconds of the sound per second; negative values play backwards.
    pub rate: f64,
    /// Factor of the amplitude.
    pub gain: f32,
}

/// The frames of the device that are heard, reported by its thread.
#[derive(Debug, Default)]
struct Heard {
    /// The frame that was heard at a time.
    at: Option<(f64, Stopwatch)>,
    /// Why there is no device, as a sentence.
    failure: Option<String>,
    /// Whether something plays, so that a device is wanted.
    is_wanted: bool,
}

/// [`Heard`], shared with the thread of the device.
#[derive(Clone, Debug, Default)]
struct SharedHeard(Arc<Mutex<Heard>>);

impl SharedHeard {
    /// Reports the frame that is heard now.
    fn report(&self, frame: f64) {
        let mut heard = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        (heard.at, heard.failure) = (Some((frame, Stopwatch::start())), None);
    }

    /// Says whether something plays.
    fn want(&self, is_wanted: bool) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).is_wanted = is_wanted;
    }

    /// Calls `open`, which plays until the device is lost and returns why, again and again: after a loss every `reopened`, and only while
    /// something plays. Ends when `open` returns `None`, or when the sender of `ended` is dropped.
    fn keep_open(&self, ended: &Receiver<()>, reopened: Duration, mut open: impl FnMut() -> Option<String>) {
        while let Some(why) = open() {
            self.fail(why);
            loop {
                if ended.recv_timeout(reopened) != Err(RecvTimeoutError::Timeout) {
                    return;
                }
                if self.0.lock().unwrap_or_else(PoisonError::into_inner).is_wanted {
                    break;
                }
            }
        }
    }

    /// Reports that nothing is heard, and why.
    fn fail(&self, why: impl Into<String>) {
        let mut heard = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        (heard.at, heard.failure) = (None, Some(why.into()));
    }

    /// The frame that is heard now, at `rate` frames per second.
    fn frame(&self, rate: f64) -> Option<f64> {
        let heard = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        heard.at.map(|(frame, since)| frame + since.secs() * rate)
    }

    fn failure(&self) -> Option<String> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).failure.clone()
    }
}

/// Plays a sound in step with a clock. The device is opened by a thread of its own; until then, and without one, it is silent. A device that
/// was lost or is missing is looked for every two seconds while the sound plays.
pub struct Player {
    mixer: Arc<Mixer>,
    heard: SharedHeard,
    follower: Follower,
    since: Stopwatch,
    _output: Output,
}

impl std::fmt::Debug for Player {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Player").field("follower", &self.follower).finish_non_exhaustive()
    }
}

impl Player {
    /// Opens the system's usual device for a sound.
    pub fn open(sound: Arc<Sound>) -> Self {
        let (mixer, heard) = (Arc::new(Mixer::new(sound)), SharedHeard::default());
        let output = Output::open(&mixer, &heard);
        Self { mixer, heard, follower: Follower::default(), since: Stopwatch::start(), _output: output }
    }

    /// Plays another sound.
    pub fn set_sound(&mut self, sound: Arc<Sound>) {
        self.mixer.set_sound(sound);
        self.follower = Follower::default();
    }

    /// Tells where the sound should be now. Call it for every image while the dance plays, and when it pauses.
    pub fn follow(&mut self, target: Target) {
        self.heard.want(target.playing);
        let heard = self.heard.frame(self.mixer.out_rate());
        self.follower.follow(&self.mixer, heard, self.since.secs(), target);
    }

    /// How far the sound that is heard is ahead of the clock, seconds; `None` while nothing is heard.
    pub fn drift_secs(&self) -> Option<f64> {
        self.follower.drift_secs()
    }

    /// How often the sound jumped to catch up with the clock, or because the clock jumped.
    pub fn jumps(&self) -> u64 {
        self.follower.jumps()
    }

    /// Why nothing is heard, as a sentence: this computer has no device for sound, or it was lost.
    pub fn failure(&self) -> Option<String> {
        self.heard.failure()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Plays silence through the sound server of this computer, if there is one, in step with real time: for a machine without other work.
    #[test]
    fn long_suite_a_real_device_stays_in_step() {
        let mut player = Player::open(Arc::new(Sound::new(vec![0; 48_000 * 10], 1)));
        let since = Stopwatch::start();
        let mut drifts = Vec::new();
        while since.secs() < 3.0 {
            player.follow(Target { secs: since.secs(), playing: true, rate: 1.0, gain: 1.0 });
            if let Some(failure) = player.failure() {
                assert!(
                    failure.starts_with("The sound is silent: ") && failure.lines().count() == 1,
                    "{failure}"
                );
                println!("skipped: {failure}");
                return;
            }
            drifts.extend(player.drift_secs().filter(|_| since.secs() > 1.0));
            std::thread::sleep(std::time::Duration::from_millis(16));
        }
        if drifts.len() < 60 {
            // A suspended device answers and plays nothing.
            println!("skipped: the device plays nothing");
            return;
        }
        let worst = drifts.iter().map(|drift| drift.abs()).fold(0.0, f64::max);
        println!("{} times, at most {:.1} ms off, {} jumps", drifts.len(), 1e3 * worst, player.jumps());
        assert!(worst < 0.06 && player.jumps() < 8, "{worst} s, {} jumps", player.jumps());
    }
}
