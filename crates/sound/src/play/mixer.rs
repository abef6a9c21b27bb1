//! Computes the samples that a device requests.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::sound::{RATE, Sound};

/// The amplitude changes from silence to full within this time, seconds, so that jumps and pauses do not click.
const FADE_SECS: f32 = 0.004;

/// Parts of the output whose place in the sound is remembered. A device requests some hundred frames at a time, so this is several seconds.
const MAX_SPANS: usize = 1024;

/// Computes the samples that a device requests.
pub(super) struct Mixer {
    state: Mutex<State>,
    /// Frames per second of the device.
    out_rate: AtomicU32,
}

struct State {
    sound: Arc<Sound>,
    /// Place in the sound of the next frame of the output, in frames of the sound.
    place: f64,
    /// Frames of the sound per second of the output, in frames at [`RATE`]: 1 is the usual speed.
    rate: f64,
    playing: bool,
    gain: f32,
    /// The amplitude that the last frame had.
    level: f32,
    /// The place to which the sound jumps as soon as it has faded out.
    jump: Option<f64>,
    /// Frames of the output so far.
    written: u64,
    spans: VecDeque<Span>,
}

/// A part of the output that is a contiguous part of the sound.
#[derive(Clone, Copy, Debug)]
struct Span {
    frame: u64,
    place: f64,
    /// Frames of the sound per frame of the output.
    step: f64,
}

impl Mixer {
    pub(super) fn new(sound: Arc<Sound>) -> Self {
        let state = State {
            sound,
            place: 0.0,
            rate: 1.0,
            playing: false,
            gain: 1.0,
            level: 0.0,
            jump: None,
            written: 0,
            spans: VecDeque::new(),
        };
        Self { state: Mutex::new(state), out_rate: AtomicU32::new(RATE) }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Sets the rate of the device, frames per second.
    #[cfg_attr(target_os = "linux", expect(dead_code, reason = "servers of sound on Linux take any rate"))]
    pub(super) fn set_out_rate(&self, rate: u32) {
        self.out_rate.store(rate.max(1), Ordering::Relaxed);
    }

    /// Frames per second of the device.
    pub(super) fn out_rate(&self) -> f64 {
        f64::from(self.out_rate.load(Ordering::Relaxed))
    }

    /// Plays another sound, from silence.
    pub(super) fn set_sound(&self, sound: Arc<Sound>) {
        let mut state = self.state();
        (state.sound, state.playing, state.level) = (sound, false, 0.0);
    }

    /// Fades out and stops.
    pub(super) fn pause(&self) {
        self.state().playing = false;
    }

    /// Plays at a speed with a gain.
    pub(super) fn play(&self, rate: f64, gain: f32) {
        let mut state = self.state();
        (state.playing, state.gain) = (true, gain);
        state.rate = if rate.is_finite() { rate.clamp(-4.0, 4.0) } else { 0.0 };
    }

    /// Continues at another place: that of the next frame that is computed, in seconds of the sound.
    pub(super) fn jump(&self, secs: f64) {
        let mut state = self.state();
        state.jump = Some(if secs.is_finite() { secs * f64::from(RATE) } else { 0.0 });
    }

    /// Frames of the output so far.
    pub(super) fn written(&self) -> u64 {
        self.state().written
    }

    /// Second of the sound at a frame of the output; `None` for frames that were never computed or too long ago.
    pub(super) fn secs_at(&self, frame: f64) -> Option<f64> {
        let state = self.state();
        let span = state.spans.iter().rev().find(|span| span.frame as f64 <= frame)?;
        Some((span.place + (frame - span.frame as f64) * span.step) / f64::from(RATE))
    }

    /// Computes the next frames, left and right beside each other.
    pub(super) fn fill(&self, out: &mut [f32]) {
        let mut guard = self.state();
        let state = &mut *guard;
        let out_rate = self.out_rate();
        let step = state.rate * f64::from(RATE) / out_rate;
        let fade = 1.0 / (FADE_SECS * out_rate as f32).max(1.0);
        state.remember(step);
        for frame in out.chunks_exact_mut(2) {
            let wanted = if state.playing && state.jump.is_none() { state.gain } else { 0.0 };
            state.level += (wanted - state.level).clamp(-fade, fade);
            if let Some(place) = state.jump {
                // The place counts for the frame at which the jump was requested; time has passed since.
                if state.level <= 0.0 {
                    (state.place, state.jump) = (place, None);
                    state.remember(step);
                } else {
                    state.jump = Some(place + step);
                }
            }
            let [left, right] =
                if state.level > 0.0 { state.sound.stereo_between(state.place) } else { [0.0; 2] };
            frame.copy_from_slice(&[left * state.level, right * state.level]);
            if state.playing || state.level > 0.0 {
                state.place += step;
            }
            state.written += 1;
        }
    }
}

impl State {
    /// Remembers where the sound is at the next frame.
    fn remember(&mut self, step: f64) {
        let step = if self.playing { step } else { 0.0 };
        if self.spans.len() >= MAX_SPANS {
            self.spans.pop_front();
        }
        self.spans.push_back(Span { frame: self.written, place: self.place, step });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sound whose samples are a ramp over two seconds.
    fn ramp() -> Arc<Sound> {
        Arc::new(Sound::new((0..96_000).map(|i| (i / 3) as i16).collect(), 1))
    }

    fn fill(mixer: &Mixer, frames: usize) -> Vec<f32> {
        let mut out = vec![0.0; 2 * frames];
        mixer.fill(&mut out);
        out.iter().step_by(2).map(|value| value * 32_768.0).collect()
    }

    #[test]
    fn it_plays_at_any_speed_and_knows_the_place_of_every_frame() {
        for rate in [1.0, 0.5, 2.0, -1.0] {
            let mixer = Mixer::new(ramp());
            mixer.jump(0.5);
            mixer.play(rate, 1.0);
            let heard = fill(&mixer, 4800);
            let last = heard[4799];
            let place = 24_000.0 + 4799.0 * rate;
            assert!((f64::from(last) - place / 3.0).abs() < 1.1, "{rate}: {last}");
            let secs = mixer.secs_at(4799.0).expect("a place");
            assert!((secs - place / 48_000.0).abs() < 1e-9, "{rate}: {secs}");
        }
    }

    #[test]
    fn jumps_and_pauses_fade_and_lose_no_time() {
        let mixer = Mixer::new(ramp());
        mixer.jump(1.0);
        mixer.play(1.0, 1.0);
        let before = fill(&mixer, 4800);
        assert!(before[0].abs() < 120.0, "it fades in: {}", before[0]);
        mixer.jump(0.25);
        let heard = fill(&mixer, 4800);
        let steepest = before.iter().chain(&heard).collect::<Vec<_>>();
        let steepest = steepest.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f32::max);
        assert!(steepest < 120.0, "no click: {steepest} of 32768");
        // The jump was to 0.25 s at the frame of the request.
        let secs = mixer.secs_at(9599.0).expect("a place");
        assert!((secs - 0.25 - 4799.0 / 48_000.0).abs() < 1e-4, "{secs}");
        mixer.pause();
        let quiet = fill(&mixer, 4800);
        assert_eq!(quiet[4799], 0.0);
        assert!(mixer.secs_at(0.0).is_some() && mixer.secs_at(-1.0).is_none());
    }

    #[test]
    fn a_device_of_another_rate_hears_the_same() {
        let mixer = Mixer::new(ramp());
        mixer.out_rate.store(44_100, Ordering::Relaxed);
        mixer.play(1.0, 1.0);
        let heard = fill(&mixer, 44_100);
        assert!((heard[44_099] - 48_000.0 / 3.0).abs() < 2.0, "{}", heard[44_099]);
        for bad in [f64::NAN, f64::INFINITY, -1e300] {
            mixer.jump(bad);
            mixer.play(bad, 1.0);
            assert!(fill(&mixer, 500).iter().all(|value| value.is_finite()));
        }
    }
}
