//! Every tool does what it says.

use glam::Vec3;
use lovelock_base::settings::Choices as _;
use lovelock_groom::WispCurve;
use lovelock_style::hand::{HandChannel, HandRoots};

use super::*;
use crate::BrushMirror;

fn on_head(tool: Tool) -> (Arc<Hairstyle>, Stroked, Hairstyle) {
    let style = hair(1, 60);
    let made = stroked((tool, false), &brush(), &style, &across(), &PlainHead);
    let after = applied(&made.edits, &style, &PlainHead);
    (style, made, after)
}

/// Sum of the angles between the links of a guide.
fn bends(guides: &Guides, guide: usize) -> f32 {
    let way = |i| guides.point(guide, i + 1) - guides.point(guide, i);
    (1..guides.points_per_guide - 1).map(|i| way(i).angle_between(way(i - 1))).filter(|a| a.is_finite()).sum()
}

#[test]
fn every_tool_changes_what_it_touches_and_no_other_guide() {
    let style = hair(1, 60);
    for tool in Tool::ALL {
        let way = if *tool == Tool::Part { beside_the_parting() } else { across() };
        let made = stroked((*tool, false), &brush(), &style, &way, &PlainHead);
        let frozen = *tool == Tool::Freeze;
        assert_eq!(made.touched.contains(&true), !frozen, "{tool:?}");
        assert_eq!(made.edits.is_empty(), frozen, "{tool:?}");
        for (guide, touched) in made.touched.iter().enumerate() {
            for i in (0..31).filter(|i| !touched || *i == 0) {
                assert_eq!(made.frame.guides.point(guide, i), style.guides.point(guide, i), "{tool:?}");
            }
        }
        let after = applied(&made.edits, &style, &PlainHead);
        assert!(after.guides.x.iter().chain(&after.strands.offset_normal).all(|v| v.is_finite()), "{tool:?}");
        if !frozen {
            assert_ne!(format!("{after:?}"), format!("{:?}", *style), "{tool:?}");
        }
    }
}

#[test]
fn combed_hair_follows_the_brush_keeps_its_length_and_stays_out_of_the_head() {
    let (style, made, after) = on_head(Tool::Comb);
    let shift = mean(&made.touched, |g| after.guides.point(g, 20).z - style.guides.point(g, 20).z);
    assert!(shift < -0.01, "{shift}");
    let mut deepest = 0.0_f32;
    for guide in 0..style.guides.count() {
        for i in 1..31 {
            let link = |guides: &Guides| guides.point(guide, i).distance(guides.point(guide, i - 1));
            assert!((link(&made.frame.guides) - link(&style.guides)).abs() < 3e-6);
            let depth = |guides: &Guides| PlainHead.distance(guides.point(guide, i)).0.min(0.0);
            deepest = deepest.min(depth(&made.frame.guides) - depth(&style.guides));
        }
    }
    println!("shift {shift} m, deeper than before by {deepest} m");
    assert!(deepest > -0.002);
    let loose = BrushSettings { keep_lengths: false, ..brush() };
    let longer = stroked((Tool::Comb, false), &loose, &style, &across(), &FREE);
    let change =
        mean(&longer.touched, |g| (length(&longer.frame.guides, g) / length(&style.guides, g) - 1.0).abs());
    let off = apart(&applied(&longer.edits, &style, &FREE).guides, &longer.frame.guides);
    println!("stretched by {change}, comes back within {off} m");
    assert!(change > 1e-3 && off < 2e-3, "{change} {off}");
}

#[test]
fn puffed_hair_rises_and_flattened_hair_sinks() {
    let (style, up, _) = on_head(Tool::Puff);
    let (_, down, _) = on_head(Tool::Flatten);
    let rise = |made: &Stroked| {
        mean(&made.touched, |g| height(&made.frame.guides, g, 3) - height(&style.guides, g, 3))
    };
    let (rise, sink) = (rise(&up), rise(&down));
    println!("{rise} {sink}");
    assert!(rise > 0.002 && sink < -0.001, "{rise} {sink}");
    let inverted = stroked((Tool::Puff, true), &brush(), &style, &across(), &PlainHead);
    assert_eq!(inverted.edits, down.edits);
}

#[test]
fn smoothed_and_straightened_hair_bends_less() {
    let plain = hair(1, 60);
    let wave = lovelock_style::operations::Wave { length: 0.05, ..Default::default() };
    let style = Arc::new(apply_layer(&Layer::of(wave), 1.0, &plain, &FREE).expect("waves"));
    for tool in [Tool::Smooth, Tool::Straighten] {
        let made = stroked((tool, false), &brush(), &style, &across(), &FREE);
        let part = mean(&made.touched, |g| bends(&made.frame.guides, g) / bends(&style.guides, g));
        println!("{tool:?}: {part}");
        assert!(part < 0.9, "{tool:?}: {part}");
    }
}

/// Mean distance of the strands of touched wisps from the middle of their wisp at 60 % of the guides.
fn width(style: &Hairstyle, touched: &[bool]) -> f32 {
    let (mut sum, mut count) = (0.0, 0.0);
    for wisp in style.wisps.iter().filter(|wisp| wisp.guides.iter().all(|g| touched[*g as usize])) {
        let curve = WispCurve::at_rest(&style.guides, wisp);
        for strand in wisp.first_strand..wisp.first_strand + wisp.strand_count {
            let set = &style.strands;
            let range =
                set.first_point[strand as usize] as usize..set.first_point[strand as usize + 1] as usize;
            let Some(i) = range.clone().find(|i| set.guide_param[*i] > 14.0) else { continue };
            let u = set.guide_param[i];
            let offset = Vec3::new(set.offset_normal[i], set.offset_binormal[i], 0.0);
            let apart = curve.blend(set.weights[strand as usize], u) - curve.blend([1.0 / 3.0; 3], u);
            sum += ((curve.frame(u).transpose() * apart) + offset).truncate().length();
            count += 1.0;
        }
    }
    assert!(count > 0.0);
    sum / count
}

#[test]
fn strands_pinch_spread_twist_and_curl() {
    let (style, made, pinched) = on_head(Tool::Pinch);
    let (_, _, spread) = on_head(Tool::Spread);
    let [before, close, far] = [&style, &pinched, &spread].map(|style| width(style, &made.touched));
    println!("{close} {before} {far}");
    assert!(close < 0.85 * before && far > 1.15 * before);
    let (_, twisted, after) = on_head(Tool::Twist);
    assert_ne!(after.strands.offset_normal, style.strands.offset_normal);
    assert!((width(&after, &twisted.touched) / before - 1.0).abs() < 0.05);
    let (_, made, curled) = on_head(Tool::Curl);
    assert!(curled.strands.points() > style.strands.points());
    let edits = made.edits.of_roots(&HandRoots::of(&style));
    let most = edits.iter().flatten().flat_map(|edit| &edit.channels[HandChannel::Curl as usize]);
    let most = most.copied().fold(0.0, f32::max);
    assert!(most > 0.004 && most <= 0.00801, "{most}");
}

#[test]
fn hair_grows_shrinks_is_cut_and_is_removed() {
    let lengths = |tool| {
        let (style, made, after) = on_head(tool);
        mean(&made.touched, |g| length(&after.guides, g) / length(&style.guides, g))
    };
    let (grown, shrunk, cut) = (lengths(Tool::Grow), lengths(Tool::Shrink), lengths(Tool::Cut));
    println!("{grown} {shrunk} {cut}");
    assert!(grown > 1.15 && shrunk < 0.9 && cut < 0.8);
    let (style, made, after) = on_head(Tool::Remove);
    assert!(after.strands.count() < style.strands.count());
    for (w, wisp) in style.wisps.iter().enumerate() {
        let gone = wisp.guides.iter().any(|g| made.touched[*g as usize]);
        assert_eq!(after.wisps[w].strand_count == 0, gone, "wisp {w}");
    }
    // The inverted tool brings them back: the layer changes nothing.
    let mut edits = made.edits.clone();
    let rest = Arc::clone(&style);
    let mut brush = Brush::new(Tool::Remove, true, &brush(), [&style, &rest], &edits, &[]).expect("a stroke");
    let mut frame = GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0);
    for sample in across() {
        brush.stroke_to(&mut frame, &BrushSurroundings { obstacle: &PlainHead }, &sample);
    }
    brush.write(&mut edits);
    assert_eq!(format!("{:?}", applied(&edits, &style, &PlainHead)), format!("{:?}", *style));
}

#[test]
fn hair_goes_to_a_line_and_away_from_a_parting() {
    let style = hair(1, 60);
    let line: Vec<Vec3> = across().iter().map(|s| s.position).collect();
    let away = |guides: &Guides, g: usize| {
        let from = |p: Vec3| line.iter().map(|q| q.distance(p)).fold(f32::INFINITY, f32::min);
        (1..31).map(|i| from(guides.point(g, i))).fold(f32::INFINITY, f32::min)
    };
    let made = stroked((Tool::Attract, false), &brush(), &style, &across(), &FREE);
    let change = mean(&made.touched, |g| away(&made.frame.guides, g) - away(&style.guides, g));
    assert!(change < -0.002, "{change}");
}

/// From the front to the back over the top of the head, beside the parting that the hair has.
fn beside_the_parting() -> Vec<StrokeSample> {
    samples(Vec3::new(0.04, 0.205, 0.05), Vec3::new(0.04, 0.205, -0.06), 24)
        .into_iter()
        .map(|s| StrokeSample { view: Vec3::NEG_Y, ..s })
        .collect()
}

#[test]
fn locks_at_a_parting_fall_to_the_side_of_their_roots() {
    let style = hair(1, 200);
    let line = 0.04;
    // Wisps beside the line that fall over it, and all locks beside it.
    let over = |guides: &Guides| {
        let mut counts = [0, 0];
        for wisp in &style.wisps {
            let mean = |i| wisp.guides.iter().map(|g| guides.point(*g as usize, i)).sum::<Vec3>() / 3.0;
            let (root, at) = (mean(0), mean(6));
            if root.y > 0.15 && (-0.05..0.04).contains(&root.z) && (root.x - line).abs() < 0.035 {
                counts[0] += usize::from((at.x - root.x) * (root.x - line) < 0.0);
                counts[1] += 1;
            }
        }
        counts
    };
    let settings = BrushSettings { radius: 0.06, strength: 1.0, ..brush() };
    let made =
        |inverted| stroked((Tool::Part, inverted), &settings, &style, &beside_the_parting(), &PlainHead);
    let [before, after, inverted] =
        [&style.guides, &made(false).frame.guides, &made(true).frame.guides].map(over);
    println!("over the line: {before:?}, with a parting there {after:?}, inverted {inverted:?}");
    assert!(before[0] > 3 && after[0] <= before[0] / 4 && inverted[0] > before[0] + 3);
}

#[test]
fn a_placed_lock_turns_as_a_whole() {
    let style = hair(1, 60);
    let way = samples(Vec3::new(0.1, 0.08, -0.04), Vec3::new(0.16, 0.08, -0.04), 24);
    let made = stroked((Tool::Place, false), &brush(), &style, &way, &PlainHead);
    for guide in (0..style.guides.count()).filter(|g| made.touched[*g]) {
        let bend = (bends(&made.frame.guides, guide) - bends(&style.guides, guide)).abs();
        assert!(bend < 1.0, "{bend}");
    }
    let shift = mean(&made.touched, |g| made.frame.guides.point(g, 30).distance(style.guides.point(g, 30)));
    assert!(shift > 0.02, "{shift}");
}

#[test]
fn frozen_locks_stay_and_are_freed_again() {
    let style = hair(1, 60);
    let around = BrushSurroundings { obstacle: &PlainHead };
    let mut frame = GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0);
    let run = |frame: &mut GuideFrame, tool, inverted, frozen: &[bool]| {
        let edits = HandEdits::default();
        let mut brush =
            Brush::new(tool, inverted, &brush(), [&style, &style], &edits, frozen).expect("a stroke");
        for sample in across() {
            brush.stroke_to(frame, &around, &sample);
        }
        (brush.touched().to_vec(), brush.frozen().to_vec())
    };
    let (_, frozen) = run(&mut frame, Tool::Freeze, false, &[]);
    assert!(frozen.contains(&true) && frozen.contains(&false));
    let (touched, _) = run(&mut frame, Tool::Comb, false, &frozen);
    assert!(!touched.iter().zip(&frozen).any(|(touched, frozen)| *touched && *frozen));
    assert!(!run(&mut frame, Tool::Freeze, true, &frozen).1.contains(&true));
}

#[test]
fn a_mirrored_line_and_a_mirrored_lock_are_on_the_other_side() {
    let style = hair(1, 120);
    let settings = BrushSettings { mirror: BrushMirror::Own, ..brush() };
    let way = samples(Vec3::new(0.1, 0.08, -0.04), Vec3::new(0.16, 0.08, -0.04), 24);
    for tool in [Tool::Place, Tool::Attract] {
        let made = stroked((tool, false), &settings, &style, &way, &FREE);
        let outward = |left: bool| {
            let side: Vec<bool> =
                (0..360).map(|g| made.touched[g] && (style.guides.point(g, 0).x > 0.0) == left).collect();
            let sign = if left { 1.0 } else { -1.0 };
            mean(&side, |g| sign * (made.frame.guides.point(g, 15).x - style.guides.point(g, 15).x))
        };
        println!("{tool:?}: {} m on the left, {} m on the right", outward(true), outward(false));
        assert!(outward(true) > 2e-4 && (outward(false) / outward(true) - 1.0).abs() < 0.7);
    }
}

#[test]
fn the_other_side_gets_its_own_shape_or_the_same() {
    let style = hair(1, 120);
    let side = |touched: &[bool], left: bool| {
        let of = |g: usize| (style.guides.point(g, 0).x > 0.0) == left;
        touched.iter().enumerate().filter(|(g, touched)| **touched && of(*g)).count()
    };
    let run = |mirror| {
        let settings = BrushSettings { mirror, ..brush() };
        stroked((Tool::Comb, false), &settings, &style, &across(), &FREE)
    };
    let off = run(BrushMirror::Off);
    let own = run(BrushMirror::Own);
    let same = run(BrushMirror::Same);
    assert!(side(&off.touched, false) < 4);
    for made in [&own, &same] {
        let (left, right) = (side(&made.touched, true), side(&made.touched, false));
        println!("{left} guides on the left, {right} on the right");
        assert!(right > left / 2 && left > right / 2, "{left} {right}");
        let off = apart(&applied(&made.edits, &style, &FREE).guides, &made.frame.guides);
        assert!(off < 3e-4, "{off}");
    }
    let shift = |made: &Stroked| {
        let right: Vec<bool> =
            (0..360).map(|g| made.touched[g] && style.guides.point(g, 0).x < -0.03).collect();
        mean(&right, |g| made.frame.guides.point(g, 20).z - style.guides.point(g, 20).z)
    };
    println!("{} {}", shift(&own), shift(&same));
    assert!(shift(&own) < -0.005 && shift(&same) < -0.005);
}
