//! Hair against the skinned surface itself, not against its approximations.

use lovelock_groom::Preset;
use lovelock_motion::{Skin, skin};
use lovelock_simulation::SimulationSettings;
use lovelock_testkit::suite;

use crate::common::{Depths, STEP_SECS, Stage};

/// Deepest penetration of a preset's hair into the skin of head, neck, shoulders and upper back over a
/// motion, metres.
fn deepest(preset: Preset, motion: &str, colliders: bool) -> f32 {
    let mut stage = Stage::of_wisps(preset, 12);
    stage.play(motion).expect("the motion");
    let mut simulation = stage.simulation(Some(0.0));
    let (mut depths, mut surface) = (Depths::new(&stage), Skin::default());
    for step in 1..=(stage.dance.duration_secs * 60.0) as u32 {
        let mut input = stage.at(Some(f64::from(step) * f64::from(STEP_SECS)));
        if !colliders {
            (input.colliders, input.field) = (&[], None);
        }
        simulation.step(&input, &SimulationSettings::default(), STEP_SECS);
        if step % 12 == 0 {
            skin(&stage.body, &stage.pose, &mut surface);
            depths.measure(&stage, &simulation, &surface, step);
        }
    }
    println!("{preset:?}, {motion}: {:.3} mm, of {} points", 1e3 * depths.worst.depth, depths.count);
    depths.worst.depth
}

#[test]
fn presets_enter_the_skin_by_less_than_a_millimetre_in_dance_and_backflip() {
    for &preset in suite::cases(&[Preset::Smooth, Preset::Long], &Preset::ALL) {
        for motion in ["dance", "backflip"] {
            let depth = deepest(preset, motion, true);
            assert!(depth < 1e-3, "{preset:?} in the {motion}: {depth} m");
        }
    }
    let control = deepest(Preset::Long, "backflip", false);
    assert!(control > 0.02, "without a body hair is no deeper than {control} m: the test proves nothing");
}

// With all guides, every second step: long hair 2.4 mm, two points of 4.7 million; see docs/simulation.md.
#[test]
fn presets_enter_the_skin_by_less_than_a_millimetre_in_a_captured_dance() {
    let Some(data) = lovelock_testkit::data_dir() else { return };
    let file = data.join("motion/jesse_dance.bvh");
    let motion = file.to_str().expect("a name in UTF-8");
    for &preset in suite::cases(&[Preset::Smooth, Preset::Long], &Preset::ALL) {
        let depth = deepest(preset, motion, true);
        assert!(depth < 1e-3, "{preset:?}: {depth} m");
    }
    let control = deepest(Preset::Long, motion, false);
    assert!(control > 0.02, "without a body hair is no deeper than {control} m: the test proves nothing");
}
