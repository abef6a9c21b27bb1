use glam::{Vec2, Vec3};
use lovelock_groom::{GroomSettings, Hairstyle, NoObstacle, PlainHead, grow};

use super::*;
use crate::operations::Hand;
use crate::operations::testing::{direction, places};
use crate::{Layer, Mask, Operation, Ramp, apply_layer};

fn hair(seed: u32, wisps: u32) -> Hairstyle {
    let settings =
        GroomSettings { seed, wisps, strands_per_wisp: 4, length: 0.3, ..GroomSettings::default() };
    grow(&settings, &PlainHead.scalp(16), &PlainHead).expect("hair")
}

fn applied(edits: &HandEdits, style: &Hairstyle) -> Hairstyle {
    let layer = Layer::of(Hand { edits: edits.clone() });
    apply_layer(&layer, 1.0, style, &NoObstacle).expect("a layer")
}

/// A bend to one side that grows toward the tip.
fn bent() -> HandEdit {
    HandEdit { turns: (0..30).map(|i| Vec2::new(0.03 * i as f32, 0.0)).collect(), ..HandEdit::default() }
}

fn on_left(style: &Hairstyle) -> Vec<usize> {
    (0..style.guides.count()).filter(|guide| style.guides.point(*guide, 0).x > 0.02).collect()
}

fn left_bent(style: &Hairstyle) -> HandEdits {
    let mut edits = HandEdits::default();
    edits.change(&HandRoots::of(style), on_left(style).into_iter().map(|guide| (guide, bent())));
    edits
}

fn lengths(style: &Hairstyle, guide: usize) -> Vec<f32> {
    let point = |i| style.guides.point(guide, i);
    (1..style.guides.points_per_guide).map(|i| point(i).distance(point(i - 1))).collect()
}

#[test]
fn touched_guides_turn_and_all_others_keep_every_byte() {
    let style = hair(1, 60);
    let after = applied(&left_bent(&style), &style);
    after.check().expect("sound");
    let left = on_left(&style);
    for guide in 0..style.guides.count() {
        if left.contains(&guide) {
            let turn = direction(&style, guide, 29).angle_between(direction(&after, guide, 29));
            assert!((turn - 0.87).abs() < 0.02, "{turn}");
            for (own, before) in lengths(&after, guide).iter().zip(lengths(&style, guide)) {
                assert!((own - before).abs() < 2e-6, "{own} {before}");
            }
        } else {
            for i in 0..31 {
                assert_eq!(after.guides.point(guide, i), style.guides.point(guide, i));
            }
        }
    }
}

#[test]
fn hair_of_another_seed_or_count_follows_the_place() {
    let edits = left_bent(&hair(1, 120));
    for (seed, wisps) in [(2, 120), (3, 60), (4, 300)] {
        let other = hair(seed, wisps);
        let after = applied(&edits, &other);
        let mut mean = [(0.0, 0.0); 2];
        for guide in 0..other.guides.count() {
            let x = other.guides.point(guide, 0).x;
            let turn = direction(&other, guide, 29).angle_between(direction(&after, guide, 29));
            // The border is as wide as the distance between roots.
            if x > 0.045 {
                mean[0] = (mean[0].0 + turn, mean[0].1 + 1.0);
            } else if x < -0.01 {
                assert!(turn < 1e-6, "{turn} at {x}");
                mean[1] = (mean[1].0 + turn, mean[1].1 + 1.0);
            }
        }
        let [combed, control] = mean.map(|(sum, count)| sum / count);
        println!("{seed} {wisps}: {combed} of 0.87, control {control}");
        assert!((combed - 0.87).abs() < 0.05 && control < 1e-6);
    }
}

#[test]
fn edits_of_another_hairstyle_give_way_where_hair_is_combed_again() {
    let (first, second) = (hair(1, 80), hair(2, 80));
    let mut edits = left_bent(&first);
    let roots = HandRoots::of(&second);
    let before = edits.of_roots(&roots);
    let touched: Vec<usize> =
        on_left(&second).into_iter().filter(|guide| second.guides.point(*guide, 0).y > 0.15).collect();
    let lifted = HandEdit { turns: vec![Vec2::new(0.0, 0.5); 30], ..HandEdit::default() };
    edits.change(&roots, touched.iter().map(|guide| (*guide, lifted.clone())));
    let after = edits.of_roots(&roots);
    for guide in 0..before.len() {
        let turn = |edit: &Option<HandEdit>| edit.as_ref().map_or(Vec2::ZERO, |edit| edit.turns[29]);
        let wanted = if touched.contains(&guide) { Vec2::new(0.0, 0.5) } else { turn(&before[guide]) };
        assert!(turn(&after[guide]).distance(wanted) < 1e-3, "{} {wanted}", turn(&after[guide]));
    }
}

#[test]
fn text_is_compact_and_keeps_every_byte() {
    let style = hair(1, 120);
    let mut edits = left_bent(&style);
    let mut strange = HandEdit { removed: true, kept: 0.4, length: 1.7, pitch: 0.02, ..bent() };
    for (kind, value) in HandChannel::ALL.into_iter().zip([0.3, 0.02, -2.5, 1.8]) {
        strange.channel_mut(kind, 30).fill(value);
    }
    edits.change(&HandRoots::of(&style), [(5, strange)]);
    let text = edits.to_text();
    let read = HandEdits::from_text(&text).expect("edits");
    assert_eq!(read, edits);
    assert_eq!(read.to_text(), text);
    let bytes = text.len() as f32 / edits.count() as f32;
    println!("{} places, {} bytes, {bytes} each", edits.count(), text.len());
    assert!(bytes < 120.0, "{bytes}");

    let layer = Layer::of(Hand { edits });
    let file = ron::to_string(&layer).expect("text");
    assert_eq!(ron::from_str::<Layer>(&file).expect("a layer"), layer);
}

#[test]
fn damaged_text_is_an_error_and_never_a_panic() {
    let text = left_bent(&hair(1, 12)).to_text();
    let mut errors = 0;
    for i in 0..text.len() {
        let mut bytes = text.clone().into_bytes();
        bytes[i] = if bytes[i] == b'A' { b'B' } else { b'A' };
        let damaged = String::from_utf8(bytes).expect("text");
        match HandEdits::from_text(&damaged) {
            Ok(read) => assert_eq!(HandEdits::from_text(&read.to_text()), Ok(read)),
            Err(error) => {
                assert!(error.starts_with("edits by hand: "), "{error}");
                errors += 1;
            }
        }
    }
    assert!(errors > 3);
    for bad in ["x", "AAAA", "/////w==", &text[..text.len() / 2]] {
        assert!(HandEdits::from_text(bad).is_err(), "{bad}");
    }
    let layer = ron::to_string(&Layer::of(Hand { edits: left_bent(&hair(1, 12)) })).expect("text");
    let error = ron::from_str::<Layer>(&layer.replace(&text, "nonsense")).expect_err("an error");
    assert!(error.to_string().contains("edits by hand: "), "{error}");
}

#[test]
fn mirrored_twice_is_the_same_and_once_is_the_other_side() {
    let style = hair(1, 60);
    let edits = left_bent(&style);
    assert_eq!(edits.mirrored().mirrored().to_text(), edits.to_text());
    assert_ne!(edits.mirrored(), edits);
    // Mirrored hair with mirrored edits is the mirrored shape.
    let mirror = |style: &Hairstyle| {
        let mut out = style.clone();
        out.guides.x.iter_mut().for_each(|x| *x = -*x);
        out
    };
    let wanted = mirror(&applied(&edits, &style));
    let made = applied(&edits.mirrored(), &mirror(&style));
    let furthest = (0..style.guides.count())
        .map(|guide| made.guides.point(guide, 30).distance(wanted.guides.point(guide, 30)))
        .fold(0.0, f32::max);
    println!("tips differ by {furthest} m");
    assert!(furthest < 1e-4);
}

#[test]
fn weight_scales_and_nothing_changes_without_weight_mask_or_edit() {
    let style = hair(1, 40);
    let edits = left_bent(&style);
    let layer = Layer::of(Hand { edits });
    let guide = on_left(&style)[0];
    for weight in [0.5, 2.0] {
        let after =
            apply_layer(&Layer { weight, ..layer.clone() }, 1.0, &style, &NoObstacle).expect("a layer");
        let turn = direction(&style, guide, 29).angle_between(direction(&after, guide, 29));
        assert!((turn - 0.87 * weight).abs() < 0.02, "{turn}");
    }
    let tips = Layer { ramp: Ramp::line(0.0, 1.0), ..layer.clone() };
    let after = apply_layer(&tips, 1.0, &style, &NoObstacle).expect("a layer");
    let turn = |link| direction(&style, guide, link).angle_between(direction(&after, guide, link));
    assert!(turn(15) < 0.6 * 0.45 && turn(29) > 0.8);
    let nowhere = Mask { parts: Vec::new(), inverted: true };
    assert!(apply_layer(&Layer { weight: 0.0, ..layer.clone() }, 1.0, &style, &NoObstacle).is_none());
    assert!(apply_layer(&Layer { mask: nowhere, ..layer }, 1.0, &style, &NoObstacle).is_none());
    let empty = applied(&HandEdits::default(), &style);
    assert_eq!(format!("{empty:?}"), format!("{style:?}"));
    let mut none = HandEdits::default();
    none.change(&HandRoots::of(&style), (0..9).map(|guide| (guide, HandEdit::default())));
    assert_eq!(format!("{:?}", applied(&none, &style)), format!("{style:?}"));
}

#[test]
fn lengths_cuts_and_removal_change_only_their_locks() {
    let style = hair(1, 40);
    let roots = HandRoots::of(&style);
    let change = |edit: HandEdit| {
        let mut edits = HandEdits::default();
        edits.change(&roots, style.wisps[3].guides.map(|guide| (guide as usize, edit.clone())));
        let after = applied(&edits, &style);
        after.check().expect("sound");
        after
    };
    let whole = |style: &Hairstyle, wisp: usize| {
        style.wisps[wisp].guides.map(|g| lengths(style, g as usize).iter().sum::<f32>()).iter().sum::<f32>()
            / 3.0
    };
    for factor in [0.5, 1.0, 1.6] {
        let after = change(HandEdit { length: factor, ..bent() });
        let part = whole(&after, 3) / whole(&style, 3);
        assert!((part - factor).abs() < 0.03, "{part} {factor}");
        assert_eq!(whole(&after, 4), whole(&style, 4));
    }
    let cut = change(HandEdit { kept: 0.5, ..HandEdit::default() });
    let part = whole(&cut, 3) / whole(&style, 3);
    assert!((0.5..0.62).contains(&part), "{part}");
    let removed = change(HandEdit { removed: true, ..HandEdit::default() });
    assert_eq!(removed.wisps[3].strand_count, 0);
    assert_eq!(removed.strands.count() + 4, style.strands.count());
    assert_eq!(removed.wisps[4].strand_count, 4);
}

#[test]
fn strands_spread_twist_curl_and_widen() {
    let settings =
        GroomSettings { wisps: 12, strands_per_wisp: 4, length_variation: 0.0, ..GroomSettings::default() };
    let style = grow(&settings, &PlainHead.scalp(16), &PlainHead).expect("hair");
    let roots = HandRoots::of(&style);
    let change = |kind: HandChannel, value: f32| {
        let mut edit = HandEdit::default();
        edit.channel_mut(kind, 30).fill(value);
        let mut edits = HandEdits::default();
        edits.change(&roots, (0..roots.places.len()).map(|guide| (guide, edit.clone())));
        applied(&edits, &style)
    };
    let middles = |style: &Hairstyle| -> Vec<Vec3> {
        (0..4).map(|strand| places(style, strand)).map(|points| points[points.len() / 2]).collect()
    };
    // The distance from the middle of a strand to another strand.
    let apart = |style: &Hairstyle| {
        let middle = middles(style)[0];
        places(style, 1).into_iter().map(|p| p.distance(middle)).fold(f32::INFINITY, f32::min)
    };
    let before = middles(&style);
    let [close, far] = [0.1, 2.0].map(|value| apart(&change(HandChannel::Spread, value)));
    println!("{close} {} {far}", apart(&style));
    assert!(close < 0.7 * apart(&style) && far > 1.4 * apart(&style));
    let twisted = middles(&change(HandChannel::Twist, 0.5));
    assert!(before.iter().zip(&twisted).any(|(a, b)| a.distance(*b) > 2e-3));
    let round = middles(&change(HandChannel::Twist, 1.0));
    assert!(before.iter().zip(&round).all(|(a, b)| a.distance(*b) < 1e-5));
    let curled = change(HandChannel::Curl, 0.01);
    curled.check().expect("sound");
    assert!(curled.strands.points() > 2 * style.strands.points());
    let wide = change(HandChannel::Width, 1.5);
    assert!((wide.strands.taper[0] / style.strands.taper[0] - 1.5).abs() < 1e-3);
}

#[test]
fn a_thousand_changes_stay_small_and_are_undone_to_the_byte() {
    let style = hair(1, 300);
    let roots = HandRoots::of(&style);
    let mut history = vec![HandEdits::default()];
    let mut texts = Vec::new();
    let mut edits = HandEdits::default();
    for i in 0..1000_usize {
        let centre = roots.directions[i * 37 % 900];
        let near = (0..900).filter(|guide| roots.directions[*guide].distance(centre) < 0.2);
        let edit = HandEdit { turns: vec![Vec2::new(0.001 * i as f32, 0.1); 30], ..HandEdit::default() };
        edits.change(&roots, near.map(|guide| (guide, edit.clone())));
        if i % 100 == 0 {
            texts.push((history.len(), edits.to_text()));
        }
        history.push(edits.clone());
    }
    let bytes: usize = history.windows(2).map(|pair| pair[1].bytes_beside(&pair[0])).sum();
    println!("1,000 steps: {} KB", bytes / 1000);
    assert!(bytes < 40_000_000, "{bytes}");
    for (step, text) in texts.into_iter().rev() {
        assert_eq!(history[step].to_text(), text);
    }
    assert!(history[0].is_empty());
}

#[test]
fn strange_hair_and_strange_edits_are_harmless() {
    let mut edits = HandEdits::default();
    let empty = Hairstyle::default();
    edits.change(&HandRoots::of(&empty), [(0, bent()), (7, bent())]);
    assert!(edits.is_empty());
    let style = hair(1, 5);
    let bad = HandEdit {
        turns: vec![Vec2::NAN, Vec2::splat(1e9), Vec2::splat(f32::NEG_INFINITY)],
        channels: std::array::from_fn(|_| vec![f32::NAN, f32::INFINITY]),
        pitch: f32::NAN,
        length: 0.0,
        kept: -3.0,
        removed: false,
    };
    edits.change(&HandRoots::of(&style), (0..15).map(|guide| (guide, bad.clone())));
    let after = applied(&edits, &style);
    after.check().expect("sound");
    assert!(after.guides.x.iter().chain(&after.strands.offset_normal).all(|v| v.is_finite()));
    let operation = Operation::from(Hand { edits });
    assert_eq!(operation.clamped(), operation);
}
