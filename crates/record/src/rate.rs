//! Frames per second as an exact fraction.

use crate::RecordError;

/// Frames per second as a fraction in lowest terms, so that the times of a film's frames add up without drift.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameRate {
    /// Frames per `den` seconds.
    pub num: u32,
    /// Seconds.
    pub den: u32,
}

impl FrameRate {
    /// The fraction for a decimal number of frames per second.
    ///
    /// Whole numbers and thousandths are exact. The broadcast rates become n·1000/1001, to however many decimals they are
    /// rounded (23.98, 29.97, 59.94).
    ///
    /// # Errors
    /// [`RecordError::Request`] outside 1 to 240 frames per second, and for NaN.
    pub fn from_fps(fps: f64) -> Result<Self, RecordError> {
        if !(1.0..=240.0).contains(&fps) {
            return Err(RecordError::request(format!(
                "{fps} frames per second: must be a number from 1 to 240"
            )));
        }
        for whole in [24_u32, 30, 48, 60, 120] {
            let broadcast = f64::from(whole) * 1000.0 / 1001.0;
            // 0.006 covers rates rounded to two decimals (23.98 for 23.976) and excludes the whole number, 0.024 away.
            if (fps - broadcast).abs() < 0.006 {
                return Ok(Self { num: whole * 1000, den: 1001 });
            }
        }
        let thousandths = (fps * 1000.0).round() as u32;
        let divisor = greatest_common_divisor(thousandths, 1000);
        Ok(Self { num: thousandths / divisor, den: 1000 / divisor })
    }

    /// Frames per second as a decimal number.
    pub fn as_f64(self) -> f64 {
        f64::from(self.num) / f64::from(self.den)
    }

    /// The MP4 clock for this rate: ticks per second, and ticks per frame.
    ///
    /// The clock has at least 10,000 ticks per second, because some players round times to milliseconds and do so more
    /// accurately with a fine clock.
    pub(crate) fn clock(self) -> (u32, u32) {
        let factor = 10_000_u32.div_ceil(self.num).next_multiple_of(2);
        (self.num * factor, self.den * factor)
    }
}

fn greatest_common_divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { greatest_common_divisor(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::FrameRate;

    #[test]
    fn whole_broadcast_and_decimal_rates_are_exact() {
        for (fps, num, den) in [
            (30.0, 30, 1),
            (24.0, 24, 1),
            (23.976, 24_000, 1001),
            (23.98, 24_000, 1001),
            (29.97, 30_000, 1001),
            (59.94, 60_000, 1001),
            (12.5, 25, 2),
            (1.0, 1, 1),
            (240.0, 240, 1),
        ] {
            assert_eq!(FrameRate::from_fps(fps).unwrap(), FrameRate { num, den }, "{fps}");
        }
    }

    #[test]
    fn rates_outside_the_range_are_refused() {
        for fps in [0.0, -30.0, 0.5, 241.0, f64::NAN, f64::INFINITY] {
            assert!(FrameRate::from_fps(fps).unwrap_err().is_request(), "{fps}");
        }
    }

    #[test]
    fn the_clock_is_exact_and_fine() {
        for fps in [1.0, 12.5, 23.976, 30.0, 60.0, 240.0] {
            let rate = FrameRate::from_fps(fps).unwrap();
            let (ticks_per_second, ticks_per_frame) = rate.clock();
            assert_eq!(
                u64::from(ticks_per_second) * u64::from(rate.den),
                u64::from(ticks_per_frame) * u64::from(rate.num)
            );
            assert!(ticks_per_second >= 10_000);
        }
    }
}
