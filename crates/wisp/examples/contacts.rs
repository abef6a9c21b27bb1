//! What contacts cost: a preset on the dance with the field and without, with tests spared and not, and with no body.
//!
//! `contacts [PRESET] [SECS]`: thread time is not to be had portably, so times are wall time on one thread; the least of
//! five rounds counts.

#![allow(clippy::disallowed_methods, reason = "this example is a stopwatch")]

use std::time::{Duration, Instant};

use lovelock_groom::Preset;
use lovelock_wisp::SimulationSettings;

#[path = "../tests/common/mod.rs"]
mod common;
use common::{STEP_SECS, Stage};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let preset = args
        .next()
        .map_or(Some(Preset::Smooth), |p| Preset::from_id(&p))
        .ok_or("contacts [PRESET] [SECS]")?;
    let secs: f64 = args.next().map_or(Ok(2.0), |s| s.parse())?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    for (what, field, spare, body) in [
        ("no body", true, true, false),
        ("colliders alone", false, true, true),
        ("field, everything tested", true, false, true),
        ("field, tests spared", true, true, true),
    ] {
        let mut stage = Stage::new(preset);
        if !field {
            stage = stage.without_field();
        }
        let steps = (secs / f64::from(STEP_SECS)) as u32;
        let (mut best, mut hash, mut substeps) = (Duration::MAX, 0, 0);
        for _ in 0..5 {
            let mut simulation = stage.simulation(Some(0.0));
            simulation.spare_contacts(spare);
            let mut spent = Duration::ZERO;
            substeps = 0;
            for step in 1..=steps {
                // A quarter of the tempo, so that steps have four substeps.
                let mut input = stage.at(Some(0.25 * f64::from(step) * f64::from(STEP_SECS)));
                if !body {
                    (input.colliders, input.field) = (&[], None);
                }
                let from = Instant::now();
                let report =
                    pool.install(|| simulation.step(&input, &SimulationSettings::default(), STEP_SECS));
                spent += from.elapsed();
                substeps += report.substeps;
            }
            (best, hash) = (best.min(spent), simulation.state_hash());
        }
        println!(
            "{what:<25} {:.3} ms a step of {:.1} substeps, {} colliders, state {hash:016x}",
            1e3 * best.as_secs_f64() / f64::from(steps),
            f64::from(substeps) / f64::from(steps),
            if body { stage.colliders.len() } else { 0 },
        );
    }
    Ok(())
}
