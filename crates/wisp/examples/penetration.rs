//! How deep hair gets into the body over a whole motion, measured against the skinned surface itself.
//!
//! `penetration [--preset ID] [--motion dance|FILE.bvh|backflip] [--wisps N] [--every STEPS] [--field off]
//! [--colliders off] [--verbose on] [--set JSON]`
//!
//! Without a preset all of them, without a motion all three of dance, the file and the backflip.

use lovelock_groom::{GroomSettings, Preset};
use lovelock_motion::{Skin, skin};
use lovelock_wisp::{SimulationSettings, StepReport};

#[path = "../tests/common/mod.rs"]
mod common;
use common::{Depths, STEP_SECS, Stage, frame, worse};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let usage = "see the head of penetration.rs";
    let (mut presets, mut motions) = (Preset::ALL.to_vec(), vec!["dance".to_owned(), "backflip".to_owned()]);
    let (mut wisps, mut every, mut field, mut colliders, mut verbose) = (None, 2, true, true, false);
    let mut settings = SimulationSettings::default();
    while let Some(arg) = args.next() {
        let value = args.next().ok_or(usage)?;
        match arg.as_str() {
            "--preset" => presets = vec![Preset::from_id(&value).ok_or(usage)?],
            "--motion" => motions = value.split(',').map(str::to_owned).collect(),
            "--wisps" => wisps = Some(value.parse()?),
            "--every" => every = value.parse::<u32>()?.max(1),
            "--field" => field = value != "off",
            "--colliders" => colliders = value != "off",
            "--verbose" => verbose = value == "on",
            "--set" => settings = serde_json::from_str(&value)?,
            _ => return Err(usage.into()),
        }
    }
    println!(
        "preset    motion        guides  steps  stretch   reported   deepest in the skin (beyond rest and roots)"
    );
    for preset in presets {
        let mut groom = GroomSettings::preset(preset);
        groom.wisps = wisps.unwrap_or(groom.wisps);
        for motion in &motions {
            let mut stage = Stage::grown(&groom);
            if !field {
                stage = stage.without_field();
            }
            stage.play(motion)?;
            let mut simulation = stage.simulation(Some(0.0));
            let (mut all, mut surface) = (StepReport::default(), Skin::default());
            let mut depths = Depths::new(&stage);
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
                if step % every == 0 || step == steps {
                    skin(&stage.body, &stage.pose, &mut surface);
                    depths.measure(&stage, &simulation, &surface, step);
                }
            }
            let name = std::path::Path::new(motion)
                .file_stem()
                .map_or(motion.as_str(), |s| s.to_str().unwrap_or(motion));
            let worst = depths.worst;
            println!(
                "{:<9} {name:<13} {:>6} {steps:>6}  {:.1e} {:>7.2} mm {:>7.2} mm: guide {} point {} at {:.2} s, {:.0} mm from the head joint, {}",
                preset.id(),
                stage.style.guides.count(),
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
