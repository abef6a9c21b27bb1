//! The scale of images in the window while something moves, so that they come at a wanted rate.
//!
//! The scale follows the measured time of images. It changes seldom and by a little, so that an eye sees neither steps nor flicker: time
//! is averaged over several images, nothing happens while it is near enough to the wanted one, and only a much too slow image
//! changes the scale at once.

/// The range of the wanted rate, images per second.
pub const RATES: [f32; 2] = [15.0, 120.0];
/// The rate that is wanted unless the user chooses another one.
pub const DEFAULT_RATE: f32 = 30.0;

/// The least scale. Below it single strands cannot be seen, and most of the time of an image does not depend on its size.
const LEAST: f64 = 0.5;
/// Scales are multiples of this, so that textures of the same size are used again.
const STEP: f64 = 1.0 / 48.0;
/// Weight of the newest image in the average.
const NEWEST: f64 = 0.2;
/// Time may be this much longer or shorter than wanted, as natural logarithms: slow images are noticed sooner than quick ones.
const TOO_SLOW: f64 = 0.08;
const TOO_QUICK: f64 = 0.25;
/// Images are so much too slow that waiting for more of them would be seen.
const MUCH_TOO_SLOW: f64 = 0.5;
/// The largest change otherwise.
const MAX_CHANGE: f64 = 1.08;
/// Images between two changes.
const PATIENCE: u32 = 8;

/// Chooses the scale of images that move.
#[derive(Clone, Debug)]
pub struct Resolution {
    scale: f64,
    /// Average of the logarithm of time over wanted time, and the number of images in it.
    slowness: f64,
    images: u32,
}

impl Default for Resolution {
    fn default() -> Self {
        Self { scale: 1.0, slowness: 0.0, images: 0 }
    }
}

impl Resolution {
    /// Pixels of an image per pixel of the screen along each side, 0.5 to 1.
    pub fn scale(&self) -> f32 {
        self.scale as f32
    }

    /// Takes the time of an image that was rendered at the present scale, milliseconds. `rate` is the wanted number of images per second.
    pub fn take(&mut self, ms: f64, rate: f32) {
        let rate = if rate.is_finite() { rate.clamp(RATES[0], RATES[1]) } else { DEFAULT_RATE };
        let wanted = 1e3 / f64::from(rate);
        if !(ms > 0.0 && ms.is_finite()) {
            return;
        }
        let slowness = (ms / wanted).ln();
        self.images += 1;
        // The first images after a change are averaged evenly.
        self.slowness += NEWEST.max(1.0 / f64::from(self.images)) * (slowness - self.slowness);
        let at_once = self.slowness > MUCH_TOO_SLOW && self.images >= 2;
        if !at_once && (self.images < PATIENCE || (-TOO_QUICK..TOO_SLOW).contains(&self.slowness)) {
            return;
        }
        // Time grows with the number of pixels, which is the square of the scale, and less than that: part of it is the same for any size.
        let change = (-0.5 * self.slowness).exp();
        let change = if at_once { change } else { change.clamp(1.0 / MAX_CHANGE, MAX_CHANGE) };
        let scale = ((self.scale * change / STEP).round() * STEP).clamp(LEAST, 1.0);
        if scale.to_bits() != self.scale.to_bits() {
            *self = Self { scale, slowness: 0.0, images: 0 };
        }
    }
}

#[cfg(test)]
mod tests {
    use lovelock_base::random::SplitMix64;

    use super::*;

    /// Scales over many images of a machine that needs `fixed` milliseconds and `full` more for all pixels, with noise.
    fn scales(from: &mut Resolution, [fixed, full]: [f64; 2], noise: f64, images: u32) -> Vec<f64> {
        let mut random = SplitMix64::new(7);
        (0..images)
            .map(|_| {
                let scale = f64::from(from.scale());
                let noise = 1.0 + noise * f64::from(random.signed());
                from.take((fixed + full * scale * scale) * noise, 30.0);
                f64::from(from.scale())
            })
            .collect()
    }

    #[test]
    fn images_come_at_the_wanted_rate() {
        for [fixed, full] in [[10.0, 90.0], [2.0, 400.0], [20.0, 30.0], [0.0, 40.0]] {
            let found = *scales(&mut Resolution::default(), [fixed, full], 0.1, 300).last().expect("images");
            let ms = fixed + full * found * found;
            let wanted = 1e3 / 30.0;
            let at_bound = found <= LEAST + STEP && ms > wanted;
            assert!(
                at_bound || (0.72..1.12).contains(&(ms / wanted)),
                "{fixed} + {full}: {ms} ms at {found}"
            );
        }
    }

    #[test]
    fn a_quick_machine_renders_every_pixel_and_a_hopeless_one_the_fewest() {
        assert_eq!(scales(&mut Resolution::default(), [1.0, 9.0], 0.2, 200).last(), Some(&1.0));
        let slow = *scales(&mut Resolution::default(), [500.0, 500.0], 0.2, 200).last().expect("images");
        assert!((slow - LEAST).abs() < STEP, "{slow}");
    }

    #[test]
    fn the_scale_is_found_soon_and_then_rests() {
        let mut resolution = Resolution::default();
        let all = scales(&mut resolution, [10.0, 40.0], 0.1, 400);
        let last = all[399];
        // Within half a second it is near.
        assert!((all[15] - last).abs() < 0.12, "{} and {last}", all[15]);
        let changes = all[100..].windows(2).filter(|pair| pair[0].to_bits() != pair[1].to_bits()).count();
        assert!(changes <= 4, "{changes} changes in ten seconds");
        let most = all[16..].windows(2).map(|pair| (pair[1] / pair[0]).ln().abs()).fold(0.0, f64::max);
        assert!(most <= MAX_CHANGE.ln() + 2.0 * STEP, "{most}");
        // Control: a much slower view is answered at once, a quicker one by steps.
        let slower = scales(&mut resolution, [10.0, 900.0], 0.0, 6);
        assert!(slower[5] < 0.7 * last, "{slower:?}");
        let quicker = scales(&mut resolution, [5.0, 20.0], 0.0, 400);
        assert!((quicker[399] - 1.0).abs() < 1e-6 && quicker[7] < 0.8, "{}", quicker[7]);
    }

    #[test]
    fn times_of_other_sizes_are_the_callers_to_leave_out() {
        // The window leaves out the times of images that were drawn before the last change. Two images in flight then only make the
        // answer later: the scale that is found is the same.
        let (mut at_once, mut late) = (Resolution::default(), Resolution::default());
        let ms = |scale: f32| 10.0 + 40.0 * f64::from(scale * scale);
        let mut in_flight = std::collections::VecDeque::from([1.0_f32, 1.0]);
        for _ in 0..400 {
            at_once.take(ms(at_once.scale()), 30.0);
            in_flight.push_back(late.scale());
            let finished = in_flight.pop_front().expect("two in flight");
            if finished.to_bits() == late.scale().to_bits() {
                late.take(ms(finished), 30.0);
            }
        }
        assert!((at_once.scale() - late.scale()).abs() < 1e-6, "{} {}", at_once.scale(), late.scale());
    }

    #[test]
    fn times_that_are_none_change_nothing() {
        let mut resolution = Resolution::default();
        for ms in [f64::NAN, f64::INFINITY, 0.0, -5.0] {
            resolution.take(ms, 30.0);
        }
        assert!((resolution.scale() - 1.0).abs() < 1e-6 && resolution.images == 0);
        for rate in [0.0, f32::NAN, 1e9] {
            resolution.take(5.0, rate);
        }
        assert!(resolution.scale().is_finite());
    }
}
