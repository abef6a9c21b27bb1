//! Playback, the steps of a recording, and estimates of remaining time.

use std::time::Duration;

use lovelock_base::clock::Stopwatch;

/// Length of one step of the simulation, seconds.
pub const STEP_SECS: f64 = 1.0 / 60.0;

/// Maximum number of steps per tick. A machine that is slower than that plays in slow motion instead of falling further and
/// further behind.
pub const MAX_STEPS_PER_TICK: u32 = 4;

/// Estimates the remaining time of work from the parts of it that are done.
#[derive(Clone, Debug, Default)]
pub struct Pace {
    /// Name of the work, number of parts done at the start, and the start time.
    of: Option<(String, u64, Stopwatch)>,
}

impl Pace {
    /// Estimated seconds until all `total` parts are done; `None` while there is no estimate. Work with another name is
    /// estimated from its own start, because earlier work and parts that existed before say nothing about it.
    pub fn left_secs(&mut self, what: &str, done: u64, total: u64) -> Option<f64> {
        if self.of.as_ref().is_none_or(|(of, first, _)| of != what || done < *first) {
            // The first report arrives when a part is already done, so the duration of that part is unknown.
            self.of = Some((what.to_owned(), done, Stopwatch::start()));
        }
        let (_, first, since) = self.of.as_ref()?;
        Self::left(done - first, total.saturating_sub(done), since.secs())
    }

    /// Parts per second so far; `None` while there is no estimate.
    pub fn per_sec(&self, done: u64) -> Option<f64> {
        let (_, first, since) = self.of.as_ref()?;
        let done = done.checked_sub(*first).filter(|&done| done > 0)?;
        Some(done as f64 / since.secs().max(1e-9))
    }

    fn left(done: u64, rest: u64, secs: f64) -> Option<f64> {
        (done > 0).then(|| secs / done as f64 * rest as f64)
    }

    /// Formats seconds for people.
    pub fn in_words(secs: f64) -> String {
        let secs = secs.clamp(0.0, 1e9).round() as u64;
        match secs {
            0..=99 => format!("{secs} s"),
            100..=5999 => format!("{} min", secs.div_ceil(60)),
            _ => format!("{} h {} min", secs / 3600, secs % 3600 / 60),
        }
    }
}

/// Assumed refresh rate of a display that reports none, Hz; slower displays are treated the same.
const DEFAULT_HZ: f64 = 1.0 / STEP_SECS;

/// Highest refresh rate that is served, Hz.
const MAX_HZ: f64 = 240.0;

/// Playback in the window: converts elapsed time to whole simulation steps, and to images between steps.
///
/// If a refresh of the display takes a whole number of steps (1/60 s is one step), each image shows a step. In slow motion and on
/// faster displays, images are an even fraction of a step apart and are interpolated between the last two steps.
///
/// It has no clock of its own: the caller passes the elapsed time to [`Playback::advance`].
#[derive(Clone, Debug, PartialEq)]
pub struct Playback {
    playing: bool,
    rate: f64,
    /// Time per refresh of the display, seconds.
    picture_secs: f64,
    /// Elapsed scene time that is not yet a whole step, seconds, less than one step.
    rest_secs: f64,
    /// If images lie between steps: elapsed time that is not yet a whole refresh, seconds.
    picture_rest_secs: f64,
}

/// What [`Playback::advance`] asks for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Due {
    /// Number of steps to simulate.
    pub steps: u32,
    /// Then an image at this fraction from the step before the last one (0) to the last one (1). `None` if images show whole
    /// steps, or if no image is due.
    pub between: Option<f64>,
}

impl Default for Playback {
    fn default() -> Self {
        Self {
            playing: true,
            rate: 1.0,
            picture_secs: 1.0 / DEFAULT_HZ,
            rest_secs: 0.0,
            picture_rest_secs: 0.0,
        }
    }
}

impl Playback {
    /// Whether playback runs.
    pub fn is_playing(&self) -> bool {
        self.playing
    }

    /// Plays or pauses.
    pub fn set_playing(&mut self, playing: bool) {
        self.playing = playing;
        (self.rest_secs, self.picture_rest_secs) = (0.0, 0.0);
        self.begin();
    }

    /// Scene seconds per second: below 1 is slow motion, including the hair.
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// Sets the rate, 0.05 to 2.
    pub fn set_rate(&mut self, rate: f64) {
        let rate = if rate.is_finite() { rate.clamp(0.05, 2.0) } else { 1.0 };
        if rate.to_bits() != self.rate.to_bits() {
            self.rate = rate;
            self.begin();
        }
    }

    /// Sets the refresh rate of the display, clamped to 60 to 240 Hz; invalid values give 60.
    pub fn set_display_hz(&mut self, hz: f64) {
        // Displays of 59.94 and of 60.02 Hz count as 60 Hz.
        let quicker = hz.is_finite() && hz > 1.02 * DEFAULT_HZ;
        let picture_secs = 1.0 / if quicker { hz.min(MAX_HZ) } else { DEFAULT_HZ };
        if picture_secs.to_bits() != self.picture_secs.to_bits() {
            self.picture_secs = picture_secs;
            self.begin();
        }
    }

    /// Time per refresh of the display, seconds.
    pub fn picture_secs(&self) -> f64 {
        self.picture_secs
    }

    /// Whether images are interpolated between steps.
    pub fn shows_between(&self) -> bool {
        let steps = self.rate * self.picture_secs / STEP_SECS;
        (steps - steps.round()).abs() > 1e-6
    }

    /// Records that the last step is shown, so that the next image continues from it.
    pub fn begin(&mut self) {
        // Images between steps are one step behind the simulation, so the next step is due at once.
        if self.shows_between() {
            self.rest_secs = STEP_SECS;
        }
    }

    /// Returns what is due after `elapsed_secs`.
    pub fn advance(&mut self, elapsed_secs: f64) -> Due {
        if !self.playing || !elapsed_secs.is_finite() {
            return Due::default();
        }
        let between = self.shows_between();
        if between {
            // Count whole refreshes only, so that image times do not depend on when the thread woke up.
            self.picture_rest_secs += elapsed_secs.max(0.0);
            let pictures = (self.picture_rest_secs / self.picture_secs + 1e-6).floor();
            if pictures < 1.0 {
                return Due::default();
            }
            self.picture_rest_secs = (self.picture_rest_secs - pictures * self.picture_secs).max(0.0);
            self.rest_secs += pictures * self.picture_secs * self.rate;
        } else {
            self.rest_secs += elapsed_secs.max(0.0) * self.rate;
        }
        // With a tolerance for rounding: sixty frames of 1/60 s are sixty steps.
        let due = (self.rest_secs / STEP_SECS + 1e-6).floor();
        if due > f64::from(MAX_STEPS_PER_TICK) {
            self.rest_secs = 0.0;
            return Due { steps: MAX_STEPS_PER_TICK, between: between.then_some(0.0) };
        }
        self.rest_secs = (self.rest_secs - due * STEP_SECS).max(0.0);
        Due { steps: due as u32, between: between.then_some((self.rest_secs / STEP_SECS).min(1.0)) }
    }

    /// How long to sleep until the next step or image is due; `None` while paused.
    pub fn until_next(&self) -> Option<Duration> {
        let secs = if self.shows_between() {
            self.picture_secs - self.picture_rest_secs
        } else {
            (STEP_SECS - self.rest_secs) / self.rate
        };
        self.playing.then(|| Duration::from_secs_f64(secs.clamp(0.0, 0.5)))
    }
}

/// The steps of a recording: a whole number of steps of equal length per frame, at any frame rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameClock {
    /// Length of one step, seconds: 1/60 at 30 and 60 frames per second, and never longer.
    pub step_secs: f64,
    /// Steps per frame.
    pub steps_per_frame: u32,
}

impl FrameClock {
    /// The clock for a frame rate, which is clamped to 1 to 240.
    pub fn new(fps: f64) -> Self {
        let fps = if fps.is_finite() { fps.clamp(1.0, 240.0) } else { 30.0 };
        let steps_per_frame = (1.0 / (fps * STEP_SECS) - 1e-6).ceil().max(1.0);
        Self { step_secs: 1.0 / (fps * steps_per_frame), steps_per_frame: steps_per_frame as u32 }
    }

    /// Frames per second.
    pub fn fps(&self) -> f64 {
        1.0 / (self.step_secs * f64::from(self.steps_per_frame))
    }

    /// The step that frame `frame` shows, counted from time zero.
    pub fn step_of_frame(&self, frame: u64) -> u64 {
        frame * u64::from(self.steps_per_frame)
    }

    /// The time of frame `frame`, seconds.
    pub fn time_of_frame(&self, frame: u64) -> f64 {
        self.time_of_step(self.step_of_frame(frame))
    }

    /// The time of step `step`, seconds.
    pub fn time_of_step(&self, step: u64) -> f64 {
        step as f64 * self.step_secs
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_remaining_time_is_estimated_from_the_same_work_only() {
        assert_eq!(Pace::left(4, 12, 2.0), Some(6.0));
        assert_eq!(Pace::left(0, 12, 2.0), None);
        let mut pace = Pace::default();
        assert_eq!(pace.left_secs("kept", 30, 48), None);
        assert!(pace.left_secs("kept", 31, 48).is_some());
        assert_eq!(pace.left_secs("frame", 32, 48), None, "other work");
        assert_eq!(pace.left_secs("frame", 48, 48), Some(0.0));
        assert_eq!(Pace::in_words(30.4), "30 s");
        assert_eq!(Pace::in_words(340.0), "6 min");
        assert_eq!(Pace::in_words(f64::INFINITY), "277777 h 46 min");
    }

    /// Number of steps during some refreshes of 1/60 s.
    fn steps(playback: &mut Playback, pictures: usize) -> u32 {
        (0..pictures).map(|_| playback.advance(1.0 / 60.0).steps).sum()
    }

    #[test]
    fn sixty_frames_of_a_sixtieth_are_sixty_steps() {
        let mut playback = Playback::default();
        assert!(!playback.shows_between());
        assert_eq!(playback.advance(STEP_SECS), Due { steps: 1, between: None });
        assert_eq!(steps(&mut playback, 60), 60);
        playback.set_rate(2.0);
        assert!(!playback.shows_between(), "each image shows the second step");
        assert_eq!(steps(&mut playback, 60), 120);
    }

    #[test]
    fn uneven_frames_add_up() {
        for rate in [1.0, 0.3] {
            let mut playback = Playback::default();
            playback.set_rate(rate);
            let frames = [0.003, 0.011, 0.02, 0.007, 0.016, 0.0001, 0.0429].iter().cycle().take(700);
            let steps: u32 = frames.clone().map(|&secs| playback.advance(secs).steps).sum();
            let total: f64 = rate * frames.sum::<f64>();
            // Images between steps are one step behind.
            assert!((f64::from(steps) - total / STEP_SECS).abs() <= 1.01, "{steps} steps in {total} s");
        }
    }

    #[test]
    fn images_in_slow_motion_are_evenly_spaced_whenever_the_thread_wakes() {
        for (rate, hz) in [(0.1, 60.0), (0.25, 60.0), (0.5, 75.0), (1.0, 144.0), (1.5, 60.0)] {
            let mut playback = Playback::default();
            playback.set_rate(rate);
            playback.set_display_hz(hz);
            assert!(playback.shows_between(), "{rate} at {hz}");
            let (mut taken, mut seen) = (0, Vec::new());
            // Alternately half a refresh early and late.
            for wake in 0..400 {
                let early = if wake % 2 == 0 { 0.5 } else { 1.5 };
                let due = playback.advance(early / hz);
                taken += due.steps;
                if let Some(t) = due.between {
                    assert!((0.0..1.0).contains(&t) && taken > 0, "{t} after {taken} steps");
                    seen.push(f64::from(taken) - 1.0 + t);
                }
            }
            let apart = rate / hz / STEP_SECS;
            assert!(seen.len() >= 200, "{} pictures", seen.len());
            for pair in seen.windows(2) {
                let pictures = (pair[1] - pair[0]) / apart;
                assert!(
                    (pictures - pictures.round()).abs() < 1e-4 && (0.9..2.1).contains(&pictures),
                    "{pictures}"
                );
            }
        }
    }

    #[test]
    fn slow_motion_takes_fewer_steps_and_a_pause_takes_none() {
        let mut playback = Playback::default();
        playback.set_rate(0.25);
        // One more, which the first images interpolate towards.
        assert_eq!(steps(&mut playback, 80), 21);
        playback.set_playing(false);
        assert_eq!(playback.advance(1.0), Due::default());
        assert_eq!(playback.until_next(), None);
        playback.set_playing(true);
        assert_eq!(playback.advance(0.001), Due::default(), "the pause does not count");
        let due = playback.advance(0.016);
        assert!(due.steps == 1 && due.between.is_some_and(|t| (t - 0.25).abs() < 1e-9), "{due:?}");
    }

    #[test]
    fn a_hang_is_not_caught_up() {
        for rate in [1.0, 0.9] {
            let mut playback = Playback::default();
            playback.set_rate(rate);
            assert_eq!(playback.advance(10.0).steps, MAX_STEPS_PER_TICK);
            assert_eq!(playback.advance(0.001).steps, 0);
            assert_eq!(playback.advance(f64::NAN), Due::default());
            assert_eq!(playback.advance(-1.0), Due::default());
        }
    }

    #[test]
    fn display_rates_are_used_within_limits() {
        let mut playback = Playback::default();
        for (hz, secs) in [
            (144.0, 1.0 / 144.0),
            (59.94, STEP_SECS),
            (60.5, STEP_SECS),
            (30.0, STEP_SECS),
            (f64::NAN, STEP_SECS),
            (1e9, 1.0 / 240.0),
        ] {
            playback.set_display_hz(hz);
            assert!((playback.picture_secs() - secs).abs() < 1e-12, "{hz}");
        }
        let until = playback.until_next().expect("it plays").as_secs_f64();
        assert!((until - 1.0 / 240.0).abs() < 1e-6, "{until}");
    }

    #[test]
    fn every_frame_rate_has_whole_equal_steps_no_longer_than_a_sixtieth() {
        for (fps, steps) in
            [(60.0, 1), (30.0, 2), (24.0, 3), (25.0, 3), (20.0, 3), (10.0, 6), (120.0, 1), (1.0, 60)]
        {
            let clock = FrameClock::new(fps);
            assert_eq!(clock.steps_per_frame, steps, "{fps}");
            assert!(clock.step_secs <= STEP_SECS * (1.0 + 1e-9));
            assert!((clock.time_of_frame(240) - 240.0 / fps).abs() < 1e-9);
        }
        assert_eq!(FrameClock::new(30.0).step_secs, STEP_SECS);
        assert_eq!(FrameClock::new(f64::NAN), FrameClock::new(30.0));
    }
}
