//! Random sequences of actions on a simulation: the same as the fuzz target (`fuzz/`), on inputs that are the
//! same in every run.

use glam::{Affine3A, Vec3};
use lovelock_base::random::SplitMix64;
use lovelock_groom::{GuideFrame, Guides};

use crate::drive::{Coverage, drive, is_sound};

fn bytes(seed: u64, count: usize) -> Vec<u8> {
    let mut random = SplitMix64::new(seed);
    (0..count).map(|_| (random.bits() >> 56) as u8).collect()
}

#[test]
fn random_sequences_of_actions_do_not_break_the_hair_long_suite() {
    let mut all = Coverage::default();
    for seed in 0..80 {
        all.add(&drive(&bytes(seed, 700)));
    }
    println!("{all:?}");
    // The drives cover all kinds of actions.
    assert!(all.steps > 4000 && all.jumps > 100 && all.styles > 100 && all.resets > 100, "{all:?}");
    assert!(all.restored > 15 && all.refused > 25 && all.fastest > 1.0, "{all:?}");
    assert!(
        all.with_field > 1000 && all.in_skin > 100 && all.folded > 20 && all.lifted > 50 && all.edited > 30,
        "{all:?}"
    );
    assert!(all.bent > 100 && all.tied > 10 && all.cut > 30 && all.regrown > 30, "{all:?}");
}

#[test]
fn non_finite_and_lost_points_are_detected() {
    let mut guides = Guides { points_per_guide: 2, ..Guides::default() };
    guides.push(&[Vec3::ZERO, Vec3::X]);
    let good = GuideFrame::at_rest(&guides, Affine3A::IDENTITY, 0.0);
    assert!(is_sound(&good));
    for wrong in [f32::NAN, f32::INFINITY, 1e6] {
        let mut bad = good.clone();
        bad.guides.y[1] = wrong;
        assert!(!is_sound(&bad), "{wrong}");
    }
}

#[test]
fn short_inputs_are_valid() {
    for count in 0..40 {
        drive(&bytes(count as u64 + 1000, count));
    }
}
