//! Some seconds of each dance, ten minutes in the long suite, at several rates and at an uneven one: lengths hold and no guide is
//! lost.

use lovelock_groom::{GroomSettings, Preset};
use lovelock_simulation::{Integrator, SimulationSettings, StepReport};
use lovelock_testkit::{data_dir, suite};

use crate::common::{Stage, stretch, worse};

/// The duration of a dance in each suite, seconds. A round of the shipped dance takes ten.
const SHORT: f64 = 5.0;
const A_ROUND_AND_MORE: f64 = 11.0;
const LONG: f64 = 600.0;

/// At most sixteen guides, so that ten minutes of motion cost seconds.
fn stage() -> Stage {
    Stage::grown(&GroomSettings { wisps: 5, ..GroomSettings::preset(Preset::Long) })
}

/// Simulates `secs` seconds; `step` returns the length of each step by its index.
fn dance(
    stage: &mut Stage,
    settings: &SimulationSettings,
    secs: f64,
    mut step: impl FnMut(u32) -> f32,
) -> StepReport {
    let mut simulation = stage.simulation(Some(0.0));
    let (mut all, mut time_secs, mut n) = (StepReport::default(), 0.0, 0);
    while time_secs < secs {
        let dt = step(n);
        n += 1;
        time_secs += f64::from(dt);
        // The clip's clock goes back at the end of a round, where the pose jumps if the clip does not loop
        // smoothly.
        let on_the_clip = time_secs.rem_euclid(stage.dance.duration_secs);
        let report = simulation.step(&stage.at(Some(on_the_clip)), settings, dt);
        let numbers = [report.max_stretch, report.max_penetration_m, report.kinetic_energy, report.max_speed];
        assert!(numbers.iter().all(|v| v.is_finite()), "step {n}: {report:?}");
        all = worse(all, report);
    }
    // The last positions confirm the reports.
    assert!(stretch(&simulation) < 2.0 * all.max_stretch.max(1e-5));
    all
}

/// A step between 1/144 and 1/30 s, from a seed.
fn uneven(n: u32) -> f32 {
    let mut z = u64::from(n).wrapping_add(77).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let unit = (z >> 40) as f32 / (1_u64 << 24) as f32;
    1.0 / 144.0 + unit * (1.0 / 30.0 - 1.0 / 144.0)
}

fn check(stage: &mut Stage, name: &str, short: f64, step: fn(u32) -> f32) {
    let all = dance(stage, &SimulationSettings::default(), suite::seconds(short, LONG), step);
    println!("{name}: {all:?}");
    assert_eq!(all.recovered_guides, 0, "{name}");
    assert!(all.max_stretch < 1e-5, "{name}: stretch {}", all.max_stretch);
    // No upper limit on the speed: at a cut, hair that is inside the body in the new pose is pushed out in
    // one step.
    assert!(all.max_speed > 1.0, "{name}: {} m/s", all.max_speed);
}

fn shipped(short: f64, step: fn(u32) -> f32) {
    check(&mut stage(), "the shipped dance", short, step);
}

fn captured(step: fn(u32) -> f32) {
    let Some(data) = data_dir() else { return };
    let file = data.join("motion/jesse_dance.bvh");
    let mut stage = stage();
    stage.play(file.to_str().expect("a name in UTF-8")).expect("the captured dance fits the dancer");
    check(&mut stage, "the captured dance", SHORT, step);
}

// One test per rate, so that they run in parallel.
#[test]
fn the_shipped_dance_keeps_its_lengths_at_30_hertz() {
    shipped(A_ROUND_AND_MORE, |_| 1.0 / 30.0);
}

#[test]
fn the_shipped_dance_keeps_its_lengths_at_60_hertz() {
    shipped(SHORT, |_| 1.0 / 60.0);
}

#[test]
fn the_shipped_dance_keeps_its_lengths_at_144_hertz_long_suite() {
    shipped(SHORT, |_| 1.0 / 144.0);
}

#[test]
fn the_shipped_dance_keeps_its_lengths_in_uneven_steps() {
    shipped(SHORT, uneven);
}

#[test]
fn a_captured_dance_keeps_its_lengths_at_30_hertz_long_suite() {
    captured(|_| 1.0 / 30.0);
}

#[test]
fn a_captured_dance_keeps_its_lengths_at_60_hertz_long_suite() {
    captured(|_| 1.0 / 60.0);
}

#[test]
fn a_captured_dance_keeps_its_lengths_at_144_hertz_long_suite() {
    captured(|_| 1.0 / 144.0);
}

#[test]
fn a_captured_dance_keeps_its_lengths_in_uneven_steps_long_suite() {
    captured(uneven);
}

#[test]
fn the_published_relaxation_fails_this_test() {
    // Control: the same dance and the same check with relaxation.
    let settings = SimulationSettings { integrator: Integrator::Relaxation, ..SimulationSettings::default() };
    let all = dance(&mut stage(), &settings, 4.0, |_| 1.0 / 60.0);
    assert!(all.max_stretch > 1e-2, "{all:?}");
}
