//! What the operations of colour do to the absorption of strands.

use std::collections::BTreeMap;

use glam::Vec3;
use lovelock_groom::fine::locks_of_wisps;
use lovelock_groom::{
    COLOUR_SAMPLES, ColourSamples, GroomSettings, HairLook, Hairstyle, PlainHead, StrandColour, grow,
};

use super::{Dye, Gradient, GradientPigment, Grey, Highlights, Melanin, Streak, dyed, natural};
use crate::scope::strand_roots;
use crate::{HeadBox, Layer, Mask, MaskPart, MaskRegion, Operation, Ramp, apply_layer};

fn plain() -> Hairstyle {
    let settings = GroomSettings { wisps: 60, strands_per_wisp: 40, ..GroomSettings::default() };
    grow(&settings, &PlainHead.scalp(32), &PlainHead).expect("hair")
}

fn applied(style: &Hairstyle, layer: &Layer) -> Hairstyle {
    let made = apply_layer(layer, 1.0, style, &PlainHead).expect("a change");
    made.check().expect("sound");
    made
}

fn colours(style: &Hairstyle, operation: impl Into<Operation>) -> Vec<ColourSamples> {
    applied(style, &Layer::of(operation.into())).strands.colours.strands().to_vec()
}

fn below() -> Vec3 {
    HairLook::default().absorption()
}

fn is_changed(samples: &ColourSamples) -> bool {
    samples.iter().any(|colour| *colour != StrandColour::BELOW)
}

/// The share of strands that were changed.
fn changed(colours: &[ColourSamples]) -> f32 {
    colours.iter().filter(|samples| is_changed(samples)).count() as f32 / colours.len() as f32
}

#[test]
fn full_colours_are_those_of_a_look() {
    let style = plain();
    let red = HairLook { eumelanin: 0.3, pheomelanin: 0.8, ..HairLook::default() };
    let pink = Vec3::new(0.7, 0.2, 0.4);
    let dyed_look = HairLook { dye: pink, dye_amount: 1.0, ..HairLook::default() };
    let half_look = HairLook { dye_amount: 0.5, ..dyed_look };
    for (name, operation, look) in [
        ("melanin", Operation::from(Melanin { eumelanin: 0.3, pheomelanin: 0.8 }), red),
        ("dye", Dye { color: pink, ..Dye::default() }.into(), dyed_look),
        ("half a dye", Dye { color: pink, amount: 0.5, ..Dye::default() }.into(), half_look),
    ] {
        for samples in colours(&style, operation) {
            for colour in samples {
                let found = colour.absorption(below());
                assert!(found.abs_diff_eq(look.absorption(), 1e-6), "{name}: {found}");
            }
        }
    }
    let half = applied(&style, &Layer { weight: 0.5, ..Layer::of(Dye { color: pink, ..Dye::default() }) });
    let mean = half.strands.colours.mean().absorption(below());
    assert!(mean.abs_diff_eq(half_look.absorption(), 1e-5), "weight is amount: {mean}");
}

#[test]
fn a_tint_only_darkens_and_bleach_without_dye_only_lightens() {
    let style = plain();
    let light = |operation: Operation| {
        let colour = colours(&style, operation)[0][0].absorption(below());
        HairLook::body_color(colour).element_sum()
    };
    let natural = HairLook::body_color(below()).element_sum();
    assert!(light(Dye { bleach: 0.0, ..Dye::default() }.into()) < natural);
    let bleached = Streak { amount: 0.0, width: 2.0, back: -1.5, ..Streak::default() };
    let made = colours(&style, bleached);
    let white = made.iter().find(|samples| is_changed(samples)).expect("a streak")[0];
    assert!(HairLook::body_color(white.absorption(below())).element_sum() > 2.9);
}

#[test]
fn a_gradient_keeps_roots_and_reaches_its_colour_at_tips() {
    let style = plain();
    let color = Vec3::new(0.1, 0.3, 0.6);
    for (operation, tip) in [
        (Gradient::default(), natural(0.22, 0.12)),
        (Gradient { pigment: GradientPigment::Dye, color, ..Gradient::default() }, dyed(color)),
    ] {
        let made = colours(&style, operation);
        let mut seen = BTreeMap::new();
        for samples in &made {
            assert_eq!(samples[0], StrandColour::BELOW);
            let found = samples[COLOUR_SAMPLES - 1].absorption(below());
            assert!(found.abs_diff_eq(tip, 1e-6), "{found}");
            assert!(samples.windows(2).all(|pair| pair[1].kept <= pair[0].kept), "one way");
            *seen.entry(samples[3].kept.to_bits()).or_insert(0) += 1;
        }
        assert!(seen.len() > 50, "locks differ: {}", seen.len());
    }
    let even = colours(&style, Gradient { variation: 0.0, ..Gradient::default() });
    assert!(even.iter().all(|samples| *samples == even[0]), "without variation they do not");
}

#[test]
fn grey_is_a_share_of_strands_and_follows_weight_and_mask() {
    let style = plain();
    for share in [0.1, 0.4, 0.8] {
        let made = colours(&style, Grey { share, ..Grey::default() });
        let found = changed(&made);
        println!("{share}: {found}");
        // Three standard deviations of 2,400 strands.
        assert!((found - share).abs() < 0.031, "{found}");
        assert!(made.iter().filter(|s| is_changed(s)).all(|s| (s[0].kept - 0.03).abs() < 1e-6));
    }
    let half = Layer { weight: 0.5, ..Layer::of(Grey { share: 0.8, ..Grey::default() }) };
    let found = changed(applied(&style, &half).strands.colours.strands());
    assert!((found - 0.4).abs() < 0.031, "weight takes strands and not their whiteness: {found}");
    let temples = Mask::of(MaskPart::region(MaskRegion::Temples));
    let layer = Layer { mask: temples.clone(), ..Layer::of(Grey { share: 1.0, ..Grey::default() }) };
    let made = applied(&style, &layer);
    let head = HeadBox::of(&style.scalp);
    for (root, samples) in strand_roots(&style).iter().zip(made.strands.colours.strands()) {
        let mask = temples.at(&head, *root);
        if mask == 0.0 || mask == 1.0 {
            assert_eq!(is_changed(samples), mask == 1.0);
        }
    }
}

#[test]
fn strands_of_a_lock_are_lightened_together() {
    let style = plain();
    let whole = Highlights { strands: 1.0, share: 0.3, ..Highlights::default() };
    let made = colours(&style, whole.clone());
    let found = changed(&made);
    println!("whole locks: {found}");
    assert!((found - 0.3).abs() < 0.08, "{found}");
    let locks = locks_of_wisps(&style.strands, whole.locks as usize);
    let mut by_lock: BTreeMap<u32, Vec<&ColourSamples>> = BTreeMap::new();
    for (lock, samples) in locks.iter().zip(&made) {
        by_lock.entry(*lock).or_default().push(samples);
    }
    assert!(by_lock.len() > 200);
    assert!(by_lock.values().all(|of| of.iter().all(|samples| *samples == of[0])));
    // By strand, a lock is mixed.
    let some = colours(&style, Highlights { strands: 0.5, ..whole });
    assert!((changed(&some) - 0.5 * found).abs() < 0.05);
    let first = by_lock.iter().find(|(_, of)| is_changed(of[0]) && of.len() > 5).expect("a lightened lock").0;
    let of: Vec<bool> =
        locks.iter().zip(&some).filter(|(lock, _)| *lock == first).map(|(_, s)| is_changed(s)).collect();
    assert!(some.iter().zip(&made).all(|(a, b)| !is_changed(a) || is_changed(b)), "of the same locks");
    assert!(of.iter().any(|lit| !lit), "{of:?}");
    // Roots stay, tips have the pigment that lightening leaves.
    let lit = made.iter().find(|s| is_changed(s)).expect("one");
    assert!(lit[0] == StrandColour::BELOW && (lit[COLOUR_SAMPLES - 1].kept - 0.35).abs() < 1e-6);
}

#[test]
fn a_streak_is_where_it_is_set() {
    let style = plain();
    let streak = Streak { ragged: 0.0, width: 0.4, ..Streak::default() };
    let made = colours(&style, streak);
    let head = HeadBox::of(&style.scalp);
    let mut inside = 0;
    for (root, samples) in strand_roots(&style).iter().zip(&made) {
        let at = head.relative(*root);
        let wanted = (at.x - 0.4).abs() <= 0.2 && at.z >= 0.0;
        assert_eq!(is_changed(samples), wanted, "{at}");
        inside += usize::from(wanted);
    }
    assert!(inside > 30, "{inside}");
}

#[test]
fn ramps_and_masks_limit_every_operation_of_colour() {
    let style = plain();
    let head = HeadBox::of(&style.scalp);
    let left = Mask::of(MaskPart { softness: 0.0, ..MaskPart::region(MaskRegion::Left) });
    let roots = strand_roots(&style);
    let first = applied(&style, &Layer::of(Dye { color: Vec3::new(0.02, 0.1, 0.3), ..Dye::default() }));
    for operation in [
        Operation::from(Melanin::default()),
        Dye::default().into(),
        Gradient::default().into(),
        Highlights::default().into(),
        Grey::default().into(),
        Streak { sideways: 0.0, width: 1.0, ..Streak::default() }.into(),
    ] {
        let id = operation.id().to_owned();
        let ramp = Ramp { points: vec![[0.0, 0.0], [0.6, 0.0], [0.61, 1.0]], ..Ramp::default() };
        let layer = Layer { mask: left.clone(), ramp, ..Layer::of(operation) };
        // Also over another colour.
        for before in [&style, &first] {
            let made = applied(before, &layer);
            let mut tips = 0;
            for (strand, samples) in made.strands.colours.strands().iter().enumerate() {
                let old = before.strands.colours.strands().get(strand).copied().unwrap_or_default();
                assert_eq!(samples[..4], old[..4], "{id}: where the ramp is 0");
                let outside = left.at(&head, roots[strand]) == 0.0;
                assert!(!outside || *samples == old, "{id}: outside the mask");
                tips += usize::from(samples[COLOUR_SAMPLES - 1] != old[COLOUR_SAMPLES - 1]);
            }
            assert!(tips > 10, "{id} acts at {tips} tips");
        }
    }
}

#[test]
fn seeds_choose_other_strands_and_colours_are_repeatable() {
    let style = plain();
    let of = |seed| applied(&style, &Layer { seed, ..Layer::of(Grey::default()) }).strands.colours;
    assert_eq!(of(1), of(1));
    assert_ne!(of(1), of(2));
}
