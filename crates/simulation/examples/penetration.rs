//! Penetration depth of hair in the body over a whole motion, measured against the skinned surface itself.
//!
//! `penetration [--hair PRESET|FILE] [--motion dance|FILE.bvh|backflip] [--wisps N] [--every STEPS]
//! [--settle SECS] [--field off] [--colliders off] [--verbose on] [--set JSON]`
//!
//! Hair first settles for two seconds on the body in the first pose of the motion, as in the program. The
//! defaults are all presets, each with its ties, and dance and backflip. Names of hair and motions may be
//! comma-separated lists. The mean volume is that over the motion, relative to the rest volume.

use lovelock_groom::Preset;
use lovelock_motion::{Skin, skin};
use lovelock_simulation::StepReport;

#[path = "../tests/common/mod.rs"]
mod common;
use common::{Depths, STEP_SECS, Stage, frame, settings_of, worse};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let usage = "see the comment at the top of penetration.rs";
    let list = |names: &str| names.split(',').map(str::to_owned).collect::<Vec<_>>();
    let mut styles: Vec<String> = Preset::ALL.iter().map(|preset| preset.id().to_owned()).collect();
    let mut motions = list("dance,backflip");
    let (mut wisps, mut every, mut field, mut colliders, mut verbose) = (None, 2, true, true, false);
    let (mut chosen, mut settle_secs) = (None, 2.0_f32);
    while let Some(arg) = args.next() {
        let value = args.next().ok_or(usage)?;
        match arg.as_str() {
            "--hair" => styles = list(&value),
            "--motion" => motions = list(&value),
            "--wisps" => wisps = Some(value.parse()?),
            "--every" => every = value.parse::<u32>()?.max(1),
            "--settle" => settle_secs = value.parse::<f32>()?.clamp(0.0, 60.0),
            "--field" => field = value != "off",
            "--colliders" => colliders = value != "off",
            "--verbose" => verbose = value == "on",
            "--set" => chosen = Some(serde_json::from_str(&value)?),
            _ => return Err(usage.into()),
        }
    }
    println!(
        "hair      motion        guides  steps  volume  stretch   reported   deepest in the skin (beyond rest and roots)"
    );
    for style in &styles {
        for motion in &motions {
            let mut stage = Stage::named(style, wisps);
            if !field {
                stage = stage.without_field();
            }
            stage.play(motion)?;
            let settings = chosen.unwrap_or_else(|| settings_of(style));
            let mut simulation = stage.simulation(Some(0.0));
            for step in (0..(settle_secs / STEP_SECS) as u32).rev() {
                let mut input = stage.at(Some(0.0));
                input.time_secs = -f64::from(step) * f64::from(STEP_SECS);
                if !colliders {
                    (input.colliders, input.field) = (&[], None);
                }
                simulation.step(&input, &settings, STEP_SECS);
            }
            let (mut all, mut surface) = (StepReport::default(), Skin::default());
            let (mut depths, mut volume) = (Depths::new(&stage), 0.0);
            let steps = (stage.dance.duration_secs * 60.0) as u32;
            for step in 1..=steps {
                let mut input = stage.at(Some(f64::from(step) * f64::from(STEP_SECS)));
                if !colliders {
                    (input.colliders, input.field) = (&[], None);
                }
                let report = simulation.step(&input, &settings, STEP_SECS);
                if let Some(d) = report.deepest
                    && d.depth_m > 1e-3
                    && verbose
                {
                    let p = frame(&simulation).guides.point(d.guide as usize, d.point as usize);
                    let at = stage.pose.world_from_head.inverse().transform_point3(p);
                    println!("  step {step}: {d:?} at {at} of the head, {} substeps", report.substeps);
                }
                all = worse(all, report);
                volume += report.hair_volume / report.hair_volume_at_rest / steps as f32;
                if step % every == 0 || step == steps {
                    skin(&stage.body, &stage.pose, &mut surface);
                    depths.measure(&stage, &simulation, &surface, step);
                }
            }
            let worst = depths.worst;
            println!(
                "{:<9} {:<13} {:>6} {steps:>6}  {:>4.0} %  {:.1e} {:>7.2} mm {:>7.2} mm: guide {} point {} at {:.2} s, {:.0} mm from the head joint, {}",
                name(style),
                name(motion),
                stage.style.guides.count(),
                100.0 * volume,
                all.max_stretch,
                1e3 * all.max_penetration_m,
                1e3 * worst.depth,
                worst.guide,
                worst.point,
                f64::from(worst.step) / 60.0,
                1e3 * worst.at.length(),
                worst.at
            );
            println!(
                "          deeper than 0.5, 1, 2, 5 mm: {:?} of {} points; arms, hands and lower trunk {:.2} mm",
                depths.over,
                depths.count,
                1e3 * depths.elsewhere.depth
            );
        }
    }
    Ok(())
}

/// The name of a preset or motion; for a file its name without folder and extension.
fn name(of: &str) -> &str {
    std::path::Path::new(of).file_stem().and_then(|stem| stem.to_str()).unwrap_or(of)
}
