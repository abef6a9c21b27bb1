//! Keeps what is heard in step with a clock.

use std::collections::VecDeque;

use super::Target;
use super::mixer::Mixer;

/// A larger difference between what is heard and the clock is closed by a jump, seconds. Smaller ones are not noticed.
const MAX_DRIFT_SECS: f64 = 0.04;
/// A difference of this size at once is a jump of the clock itself, seconds.
const CLOCK_JUMP_SECS: f64 = 0.15;
/// Time over which the difference is averaged, seconds, because the clock advances in steps of images.
const MEAN_SECS: f64 = 0.12;
/// Time over which the speed of the clock is measured, seconds.
const MEASURED_SECS: f64 = 0.5;
/// A clock that differs less from its stated speed counts as exact. A slower one is that of a machine which plays in slow motion.
const EXACT: f64 = 0.03;
/// The largest change of speed that closes a difference; it is too small to be heard.
const MAX_CORRECTION: f64 = 0.01;

/// Keeps what is heard in step with a clock.
#[derive(Debug, Default)]
pub(super) struct Follower {
    /// Times of the clock: when they were told, and what they were.
    told: VecDeque<[f64; 2]>,
    /// The mean difference, and when it was updated.
    drift: Option<[f64; 2]>,
    /// No difference is measured before this time: what is heard until then was computed before the last jump.
    blind_until: f64,
    jumps: u64,
    playing: bool,
}

impl Follower {
    pub(super) fn drift_secs(&self) -> Option<f64> {
        self.drift.map(|[drift, _]| drift)
    }

    pub(super) fn jumps(&self) -> u64 {
        self.jumps
    }

    /// Adapts the mixer to a target at the time `now`, seconds. `heard` is the frame of the output that is heard now.
    pub(super) fn follow(&mut self, mixer: &Mixer, heard: Option<f64>, now: f64, target: Target) {
        if !target.playing || !target.secs.is_finite() {
            mixer.pause();
            *self = Self { jumps: self.jumps, ..Self::default() };
            return;
        }
        let moved = self.told.back().map(|&[then, secs]| target.secs - secs - (now - then) * target.rate);
        let clock_jumped = moved.is_some_and(|moved| moved.abs() > CLOCK_JUMP_SECS);
        if clock_jumped {
            self.told.clear();
        }
        self.told.push_back([now, target.secs]);
        while self.told.len() > 2 && now - self.told[1][0] >= MEASURED_SECS {
            self.told.pop_front();
        }
        let speed = self.speed(target.rate);
        let Some(heard) = heard else {
            // Nothing is heard yet.
            self.drift = None;
            self.playing = false;
            return;
        };
        let begins = !std::mem::replace(&mut self.playing, true);
        if begins || clock_jumped {
            self.jump(mixer, heard, now, target, speed);
            return;
        }
        if now < self.blind_until {
            mixer.play(speed, target.gain);
            return;
        }
        let Some(secs) = mixer.secs_at(heard) else { return };
        let drift = secs - target.secs;
        let mean = match self.drift {
            Some([mean, then]) => mean + (drift - mean) * (1.0 - (-(now - then) / MEAN_SECS).exp()),
            None => drift,
        };
        self.drift = Some([mean, now]);
        if mean.abs() > MAX_DRIFT_SECS {
            self.jump(mixer, heard, now, target, speed);
            return;
        }
        let correction = (-mean).clamp(-MAX_CORRECTION, MAX_CORRECTION);
        mixer.play(speed + correction * speed.abs().max(0.1), target.gain);
    }

    /// Seconds of the sound per second: as stated, or as measured if the clock runs at another speed.
    fn speed(&self, stated: f64) -> f64 {
        let (Some([from, a]), Some([to, b])) = (self.told.front(), self.told.back()) else { return stated };
        if to - from < 0.6 * MEASURED_SECS {
            return stated;
        }
        let measured = (b - a) / (to - from);
        if (measured - stated).abs() <= EXACT * stated.abs() { stated } else { measured }
    }

    /// Continues where the clock is, ahead by the time until the next frame is heard.
    fn jump(&mut self, mixer: &Mixer, heard: f64, now: f64, target: Target, speed: f64) {
        let ahead = ((mixer.written() as f64 - heard) / mixer.out_rate()).clamp(0.0, 2.0);
        mixer.play(speed, target.gain);
        mixer.jump(target.secs + ahead * speed);
        self.drift = None;
        // The fade delays the jump a little.
        self.blind_until = now + ahead + 0.03;
        self.jumps += 1;
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::sound::Sound;

    /// A device that hears every frame some time after it was computed, with a clock of its own.
    struct Device {
        mixer: Mixer,
        follower: Follower,
        /// Frames per second of real time.
        rate: f64,
        latency_frames: f64,
        now: f64,
    }

    impl Device {
        fn new(rate: f64, latency_secs: f64) -> Self {
            let mixer = Mixer::new(Arc::new(Sound::new(vec![1; 48_000 * 60], 1)));
            Self {
                mixer,
                follower: Follower::default(),
                rate,
                latency_frames: latency_secs * 48_000.0,
                now: 0.0,
            }
        }

        fn heard(&self) -> f64 {
            self.now * self.rate - self.latency_frames
        }

        /// Second of the sound that is heard now.
        fn heard_secs(&self) -> Option<f64> {
            self.mixer.secs_at(self.heard())
        }

        /// Passes a sixtieth of a second, in which the device asks for frames and the clock is told.
        fn pass(&mut self, target: Target) {
            self.now += 1.0 / 60.0;
            while (self.mixer.written() as f64) < self.now * self.rate {
                self.mixer.fill(&mut [0.0; 2 * 240]);
            }
            self.follower.follow(&self.mixer, Some(self.heard()), self.now, target);
        }
    }

    fn target(secs: f64, rate: f64) -> Target {
        Target { secs, playing: true, rate, gain: 1.0 }
    }

    #[test]
    fn devices_with_clocks_of_their_own_stay_in_step_without_jumps() {
        for (device_rate, latency) in [(48_000.0, 0.02), (48_200.0, 0.1), (47_850.0, 0.25), (48_000.0, 0.5)] {
            for rate in [1.0, 0.5, 2.0] {
                let mut device = Device::new(device_rate, latency);
                let mut worst: f64 = 0.0;
                for i in 0..60 * 20 {
                    // Every frame is shown up to one sixtieth late.
                    let secs = (f64::from(i) / 60.0 * 60.0).floor() / 60.0 * rate;
                    device.pass(target(secs, rate));
                    if i > 90 {
                        worst = worst.max((device.heard_secs().expect("a place") - secs).abs());
                    }
                }
                assert!(worst < MAX_DRIFT_SECS, "{device_rate} Hz, {latency} s, rate {rate}: {worst}");
                assert_eq!(
                    device.follower.jumps(),
                    1,
                    "only that of the start: {device_rate}, {latency}, {rate}"
                );
            }
        }
    }

    #[test]
    fn seeking_and_repetitions_are_followed_within_the_latency() {
        let mut device = Device::new(48_000.0, 0.08);
        for i in 0..60 * 12 {
            // A dance of 3 s that repeats, and a jump by 1 s after 7.5 s.
            let time = f64::from(i) / 60.0 + if i >= 450 { 1.0 } else { 0.0 };
            device.pass(target(time % 3.0, 1.0));
            let since =
                [180, 360, 450, 480, 660].iter().filter_map(|jump| (i - jump >= 0).then_some(i - jump)).min();
            if since.is_none_or(|since| since > 12) && i > 30 {
                let off = device.heard_secs().expect("a place") - time % 3.0;
                assert!(off.abs() < MAX_DRIFT_SECS, "pass {i}: {off}");
            }
        }
        assert_eq!(device.follower.jumps(), 6);
    }

    #[test]
    fn a_machine_in_slow_motion_slows_the_sound_down() {
        let mut device = Device::new(48_000.0, 0.1);
        let mut worst: f64 = 0.0;
        for i in 0..60 * 20 {
            // It reaches 70 % of the speed, in uneven steps.
            let secs = (f64::from(i / 4) * 4.0 / 60.0) * 0.7;
            device.pass(target(secs, 1.0));
            if i > 120 {
                worst = worst.max((device.heard_secs().expect("a place") - secs).abs());
            }
        }
        // An image lasts 47 ms of the dance, so the sound runs ahead of it by as much.
        assert!(worst < MAX_DRIFT_SECS + 0.047, "{worst}");
        assert!(device.follower.jumps() <= 4, "{}", device.follower.jumps());
    }

    #[test]
    fn a_pause_is_silent_and_a_lost_device_is_no_fault() {
        let mut device = Device::new(48_000.0, 0.05);
        for i in 0..60 {
            device.pass(target(f64::from(i) / 60.0, 1.0));
        }
        device.pass(Target { playing: false, ..target(1.0, 1.0) });
        let mut out = [0.0; 2 * 480];
        device.mixer.fill(&mut out);
        device.mixer.fill(&mut out);
        assert!(out.iter().all(|value| *value == 0.0) && device.follower.drift_secs().is_none());
        for secs in [2.0, f64::NAN] {
            device.follower.follow(&device.mixer, None, 5.0, target(secs, 1.0));
        }
        assert!(device.follower.drift_secs().is_none());
    }
}
