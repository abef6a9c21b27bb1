//! The cost of contacts: a preset on the dance with and without the field, with and without culling, without
//! a body, and with hair that is out of reach of the body: what is left then is all that a further culling of
//! bodies away from hair could save.
//!
//! `contacts [PRESET] [SECS] [CASE]`: CPU time on one thread, which does not include other work on the
//! machine; the minimum of five rounds. With a case, of which the beginning suffices, only that one runs.

use std::sync::Arc;
use std::time::Duration;

use lovelock_groom::{Hairstyle, Preset};
use lovelock_simulation::SimulationSettings;
use lovelock_testkit::clock::process_time;

#[path = "../tests/common/mod.rs"]
mod common;
use common::{STEP_SECS, Stage};

/// Distance by which hair is moved out of reach, metres.
const AWAY: f32 = 2.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let preset = args
        .next()
        .map_or(Some(Preset::Smooth), |p| Preset::from_id(&p))
        .ok_or("contacts [PRESET] [SECS] [CASE]")?;
    let secs: f64 = args.next().map_or(Ok(2.0), |s| s.parse())?;
    let only = args.next().unwrap_or_default();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    for (what, field, culling, body, away) in [
        ("no body", true, true, false, false),
        ("colliders only", false, true, true, false),
        ("field, no culling", true, false, true, false),
        ("field, culling", true, true, true, false),
        ("away, no body", true, true, false, true),
        ("away, colliders only", false, true, true, true),
        ("away, field, culling", true, true, true, true),
    ] {
        if !what.starts_with(&only) {
            continue;
        }
        let mut stage = Stage::new(preset);
        if !field {
            stage = stage.without_field();
        }
        if away {
            let mut style = Hairstyle::clone(&stage.style);
            style.guides.x.iter_mut().for_each(|x| *x += AWAY);
            stage.style = Arc::new(style);
        }
        let steps = (secs / f64::from(STEP_SECS)) as u32;
        let (mut best, mut hash, mut substeps) = (Duration::MAX, 0, 0);
        for _ in 0..5 {
            let mut simulation = stage.simulation(Some(0.0));
            simulation.set_contact_culling(culling);
            let mut spent = Duration::ZERO;
            substeps = 0;
            for step in 1..=steps {
                // A quarter of the tempo, so that steps have four substeps.
                let mut input = stage.at(Some(0.25 * f64::from(step) * f64::from(STEP_SECS)));
                if !body {
                    (input.colliders, input.field) = (&[], None);
                }
                let from = process_time();
                let report =
                    pool.install(|| simulation.step(&input, &SimulationSettings::default(), STEP_SECS));
                spent += process_time().saturating_sub(from);
                substeps += report.substeps;
            }
            (best, hash) = (best.min(spent), simulation.state_hash());
        }
        println!(
            "{what:<25} {:.3} ms per step of {:.1} substeps, {} colliders, state {hash:016x}",
            1e3 * best.as_secs_f64() / f64::from(steps),
            f64::from(substeps) / f64::from(steps),
            if body { stage.colliders.len() } else { 0 },
        );
    }
    Ok(())
}
