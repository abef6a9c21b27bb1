//! Wall-clock time: the only module that reads the machine's clock.

use std::time::{Duration, Instant};

/// Measures how long work takes. No result of the program depends on it.
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch(Instant);

impl Stopwatch {
    /// Starts to measure.
    #[expect(clippy::disallowed_methods, reason = "this is the clock module")]
    pub fn start() -> Self {
        Self(Instant::now())
    }

    /// Time since the start.
    pub fn elapsed(&self) -> Duration {
        self.0.elapsed()
    }

    /// Seconds since the start.
    pub fn secs(&self) -> f64 {
        self.elapsed().as_secs_f64()
    }

    /// Milliseconds since the start.
    pub fn ms(&self) -> f64 {
        self.secs() * 1e3
    }

    /// Milliseconds since the start. Starts again.
    pub fn lap_ms(&mut self) -> f64 {
        let ms = self.ms();
        *self = Self::start();
        ms
    }
}

#[cfg(test)]
mod tests {
    use super::Stopwatch;

    #[test]
    fn a_lap_starts_the_stopwatch_again() {
        let mut watch = Stopwatch::start();
        std::thread::sleep(std::time::Duration::from_millis(5));
        let whole = watch;
        assert!(watch.lap_ms() >= 5.0);
        assert!(watch.secs() < whole.secs());
    }
}
