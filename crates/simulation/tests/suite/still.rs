//! Nothing jitters once the body stands still: measures the motion seconds after stops at several times of a
//! dance.

use glam::Vec3;
use lovelock_groom::{GuideFrame, Preset};
use lovelock_simulation::{Locks, SimulationSettings};
use lovelock_testkit::suite;

use crate::common::{STEP_SECS, Stage, frame};

/// Number of steps over which hair is observed.
const WATCHED: usize = 30;

/// Motion of the points over the observed steps after a stop.
#[derive(Clone, Copy, Debug, Default)]
struct Moves {
    /// Largest displacement of a point per step, metres: shows buzzing.
    step: f32,
    /// Diagonal of the largest bounding box of one point's positions, metres: shows whirling, swinging and
    /// creeping.
    extent: f32,
    /// Guide and point of that box.
    at: (usize, usize),
}

fn moves(film: &[GuideFrame]) -> Moves {
    let (guides, n) = (film[0].guides.count(), film[0].guides.points_per_guide);
    let mut out = Moves::default();
    for (g, k) in (0..guides).flat_map(|g| (0..n).map(move |k| (g, k))) {
        let (mut low, mut high, mut last) = (Vec3::INFINITY, Vec3::NEG_INFINITY, None);
        for f in film {
            let p = f.guides.point(g, k);
            (low, high) = (low.min(p), high.max(p));
            out.step = out.step.max(last.map_or(0.0, |last| p.distance(last)));
            last = Some(p);
        }
        if (high - low).length() > out.extent {
            (out.extent, out.at) = ((high - low).length(), (g, k));
        }
    }
    out
}

/// For hair of `wisps` wisps and stops of the dance at each of the times `at`: the motion in the last half
/// second before `after` seconds of standing.
fn after_stops(
    preset: Preset,
    wisps: u32,
    settings: &SimulationSettings,
    at: &[f64],
    after: f64,
) -> Vec<Moves> {
    let mut stage = Stage::of_wisps(preset, wisps);
    let mut dancing = stage.simulation(Some(0.0));
    let steps = |secs: f64| (secs / f64::from(STEP_SECS)).round() as u32;
    let secs = |steps: u32| f64::from(steps) * f64::from(STEP_SECS);
    let mut done = 0;
    let mut out = Vec::new();
    for &stop in at {
        while done < steps(stop) {
            done += 1;
            dancing.step(&stage.at(Some(secs(done))), settings, STEP_SECS);
        }
        let (mut standing, mut film) = (dancing.clone(), Vec::new());
        for step in 1..=steps(after) {
            // Time continues; the body stays where it is.
            let mut input = stage.at(Some(secs(done)));
            input.time_secs = secs(done + step);
            standing.step(&input, settings, STEP_SECS);
            if step as usize + WATCHED >= steps(after) as usize {
                film.push(frame(&standing));
            }
        }
        let moves = moves(&film);
        println!("{preset:?} stopped at {stop} s, {after} s later: {moves:?}");
        out.push(moves);
    }
    out
}

/// The largest of both over all stops.
fn worst(moves: &[Moves]) -> (f32, f32) {
    let most = |of: fn(&Moves) -> f32| moves.iter().map(of).fold(0.0, f32::max);
    (most(|m| m.step), most(|m| m.extent))
}

#[test]
fn nothing_jitters_seconds_after_a_stop_long_suite() {
    // Measured: at most 0.10 mm per frame and 0.35 mm; long hair 0.26 and 0.27 mm. Single long guides may still slide off
    // a shoulder seconds after a stop, which is not jitter.
    let (all, few) = (&[1.0, 3.8, 5.75, 8.2][..], &[3.8, 8.2][..]);
    let short = suite::cases(few, all);
    for (preset, wisps, stops, after, step, extent) in [
        (Preset::Smooth, 40, short, 4.0, 5e-4, 1e-3),
        (Preset::Curly, 40, short, 4.0, 5e-4, 1e-3),
        (Preset::Ponytail, 20, &[1.0, 5.75], 6.0, 5e-4, 1e-3),
        (Preset::Long, 40, &[3.8], 8.0, 5e-4, 1e-3),
        // All wisps: one guide that whirls is enough to fail.
        (Preset::Long, 180, &[5.75], 8.0, 5e-4, 1e-3),
    ] {
        let settings = SimulationSettings::preset(preset);
        let found = worst(&after_stops(preset, wisps, &settings, stops, after));
        assert!(found.0 < step && found.1 < extent, "{preset:?}: {found:?} m");
    }
}

#[test]
fn undamped_hair_fails_this_test() {
    // Control: stiffness alone brings hair back to its style, and nothing dissipates its energy.
    let restless = SimulationSettings {
        bend_damping: 0.0,
        settle: 0.0,
        drag: 0.0,
        friction: 0.0,
        cloth_friction: 0.0,
        hair_friction: 0.0,
        locks: Locks { friction: 0.0, ..Locks::default() },
        ..SimulationSettings::default()
    };
    let found = worst(&after_stops(Preset::Smooth, 16, &restless, &[3.8], 4.0));
    assert!(found.0 > 1e-3 && found.1 > 2e-3, "{found:?} m");
}
