//! Wind: a mean, gusts that travel with it, and eddies, all sums of waves.
//!
//! A sum of waves is smooth in time and space, costs a few multiplications, and is the same in every run.
//! Eddies move the air perpendicular to the direction of their waves, so the flow is solenoidal.

use glam::{DVec3, Vec3};
use lovelock_base::random::SplitMix64;

use crate::lanes::{LANES, Lane3, ZERO3, at, put};
use crate::settings::Wind;

/// Numbers of waves of gusts and of eddies.
const GUSTS: usize = 3;
const EDDIES: usize = 6;

/// The waves at one moment, in working space.
#[derive(Clone, Debug, Default)]
pub(crate) struct WindField {
    mean: Vec3,
    waves: [Wave; GUSTS + EDDIES],
    blows: bool,
}

#[derive(Clone, Copy, Debug, Default)]
struct Wave {
    amplitude: Vec3,
    /// Wave vector in turns per metre.
    turns: Vec3,
    /// Phase at the origin, in turns.
    phase: f32,
}

impl WindField {
    /// The wind at `elapsed_secs`, for points relative to `origin` in world space. `air_travel` is the
    /// distance by which the mean wind has carried the air until then, metres.
    ///
    /// Eddies are placed by the distance that the air has really travelled, not by the current speed times
    /// the elapsed time, so that they do not shift abruptly when the wind changes.
    pub(crate) fn new(wind: &Wind, elapsed_secs: f64, air_travel: DVec3, origin: Vec3) -> Self {
        let mean = mean_of(wind);
        let Some(along) = mean.try_normalize() else { return Self::default() };
        let mut random = SplitMix64::new(u64::from(wind.seed));
        let mut field = Self { mean, waves: [Wave::default(); GUSTS + EDDIES], blows: true };
        for (n, out) in field.waves.iter_mut().enumerate() {
            let start = random.unit();
            // Frequency in turns per second at a fixed place, and direction and length of the wave.
            let (amplitude, wave, hertz, carried);
            if n < GUSTS {
                hertz = [0.19, 0.53, 1.27][n] * (0.8 + 0.4 * random.unit());
                wave = along * (hertz / wind.speed.max(0.5));
                amplitude = mean * (wind.gusts * [0.5, 0.3, 0.2][n]);
                carried = 0.0;
            } else {
                let direction = random_direction(&mut random);
                let length = 0.15 * 1.5_f32.powi((n - GUSTS) as i32);
                wave = direction / length;
                // Carried by the wind, and slowly changing by themselves.
                hertz = 0.3 * (random.unit() - 0.5);
                carried = wave.as_dvec3().dot(air_travel);
                let across = direction
                    .cross(random_direction(&mut random))
                    .normalize_or(direction.any_orthonormal_vector());
                amplitude = across * (wind.speed * wind.turbulence * (2.0 / EDDIES as f32).sqrt());
            }
            let world = origin.as_dvec3().dot(wave.as_dvec3());
            let shift = f64::from(start) + world - carried - elapsed_secs * f64::from(hertz);
            *out = Wave { amplitude, turns: wave, phase: (shift - shift.floor()) as f32 };
        }
        field
    }

    /// Whether there is any wind.
    pub(crate) fn blows(&self) -> bool {
        self.blows
    }

    /// Appends the mean wind, and amplitude, wave vector and phase of each wave.
    pub(crate) fn write(&self, out: &mut Vec<f32>) {
        out.extend(self.mean.to_array());
        for wave in &self.waves {
            out.extend(wave.amplitude.to_array());
            out.extend(wave.turns.to_array());
            out.push(wave.phase);
        }
    }

    /// Velocity of the air at a row of points, metres per second.
    #[inline(always)]
    pub(crate) fn velocity(&self, points: &Lane3) -> Lane3 {
        let mut out = ZERO3;
        for k in 0..LANES {
            put(&mut out, k, self.mean);
        }
        for wave in &self.waves {
            for k in 0..LANES {
                let turns = at(points, k).dot(wave.turns) + wave.phase;
                let v = at(&out, k) + wave.amplitude * sine_of_turns(turns);
                put(&mut out, k, v);
            }
        }
        out
    }
}

/// The mean wind, metres per second; 0 if it has no direction.
pub(crate) fn mean_of(wind: &Wind) -> Vec3 {
    Vec3::from_array(wind.direction).normalize_or_zero() * wind.speed.max(0.0)
}

/// Polynomial approximation of `sin(2 pi t)`: within 2e-4, and the same on every machine.
#[inline(always)]
fn sine_of_turns(t: f32) -> f32 {
    // Adding and subtracting 1.5 * 2^23 rounds to the nearest integer.
    const ROUND: f32 = 12_582_912.0;
    let t = t - ((t + ROUND) - ROUND);
    // Folds to a quarter turn: sin is symmetric about it.
    let folded = if t > 0.25 {
        0.5 - t
    } else if t < -0.25 {
        -0.5 - t
    } else {
        t
    };
    let x = folded * core::f32::consts::TAU;
    let s = x * x;
    x * (1.0 + s * (-1.0 / 6.0 + s * (1.0 / 120.0 - s * (1.0 / 5040.0))))
}

/// A unit vector, uniform over the sphere.
fn random_direction(random: &mut SplitMix64) -> Vec3 {
    let (z, turn) = (2.0 * random.unit() - 1.0, random.unit());
    let r = (1.0 - z * z).max(0.0).sqrt();
    Vec3::new(r * sine_of_turns(turn + 0.25), r * sine_of_turns(turn), z)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(p: Vec3) -> Lane3 {
        crate::lanes::splat3(p)
    }

    /// A wind that has always blown at the given settings.
    fn steady(wind: &Wind, secs: f64, origin: Vec3) -> WindField {
        WindField::new(wind, secs, mean_of(wind).as_dvec3() * secs, origin)
    }

    #[test]
    fn the_sine_approximation_is_within_its_error() {
        for i in -4000..4000 {
            let t = i as f32 * 0.001;
            let want = (f64::from(t) * std::f64::consts::TAU).sin() as f32;
            // The next term of the series at a quarter turn is 1.6e-4.
            assert!((sine_of_turns(t) - want).abs() < 2e-4, "{t}");
        }
    }

    #[test]
    fn wind_keeps_its_mean_and_is_smooth_and_repeatable() {
        let wind = Wind { speed: 4.0, ..Wind::default() };
        let mut sum = Vec3::ZERO;
        let mut last: Option<Vec3> = None;
        for i in 0..6000 {
            let field = steady(&wind, f64::from(i) / 60.0, Vec3::ZERO);
            let v = at(&field.velocity(&row(Vec3::new(0.1, 0.2, 0.0))), 0);
            if let Some(last) = last {
                // The finest eddies pass at 4 m/s / 0.15 m with 0.7 m/s each: 2 pi 27 * 0.7 / 60 = 2 m/s.
                assert!((v - last).length() < 4.0, "the wind jumps");
            }
            last = Some(v);
            sum += v / 6000.0;
        }
        assert!((sum - Vec3::new(4.0, 0.0, 0.0)).length() < 0.2, "{sum}");
        let (a, b) = (steady(&wind, 7.5, Vec3::ONE), steady(&wind, 7.5, Vec3::ONE));
        assert_eq!(a.velocity(&row(Vec3::X)), b.velocity(&row(Vec3::X)));
        let other = steady(&Wind { seed: 2, ..wind }, 7.5, Vec3::ONE);
        assert_ne!(a.velocity(&row(Vec3::X)), other.velocity(&row(Vec3::X)));
    }

    #[test]
    fn wind_does_not_depend_on_the_origin() {
        let wind = Wind { speed: 3.0, turbulence: 1.0, ..Wind::default() };
        let p = Vec3::new(0.3, 1.5, -0.2);
        let a = steady(&wind, 3.0, Vec3::ZERO).velocity(&row(p));
        let b = steady(&wind, 3.0, p).velocity(&row(Vec3::ZERO));
        assert!((at(&a, 0) - at(&b, 0)).length() < 1e-3);
    }

    #[test]
    fn a_change_of_wind_speed_does_not_shift_the_eddies() {
        let (calm, fresh) = (Wind { speed: 4.0, ..Wind::default() }, Wind { speed: 4.02, ..Wind::default() });
        let secs = 600.0;
        let air_travel = mean_of(&calm).as_dvec3() * secs;
        let p = row(Vec3::new(0.1, 0.2, 0.0));
        let before = at(&WindField::new(&calm, secs, air_travel, Vec3::ZERO).velocity(&p), 0);
        let after = at(&WindField::new(&fresh, secs, air_travel, Vec3::ZERO).velocity(&p), 0);
        // Everything grows by half a per cent of a few metres per second; gusts shift by as much over half a
        // metre.
        assert!((after - before).length() < 0.1, "{before} became {after}");
        // Control: computed as if the new wind had always blown.
        let always = at(&steady(&fresh, secs, Vec3::ZERO).velocity(&p), 0);
        assert!((always - before).length() > 0.3, "{before} and {always}");
    }

    #[test]
    fn no_wind_does_not_blow() {
        assert!(!steady(&Wind::default(), 1.0, Vec3::ZERO).blows());
        let nowhere = Wind { speed: 5.0, direction: [0.0; 3], ..Wind::default() };
        assert!(!steady(&nowhere, 1.0, Vec3::ZERO).blows());
    }
}
