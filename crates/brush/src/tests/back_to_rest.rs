//! What is combed in a pose comes back at rest.

use glam::{Quat, Vec3};
use lovelock_style::hand::{hand_input, link_frames};

use super::*;
use crate::carry::link_turns;

#[test]
fn hair_combed_at_rest_is_the_style_that_was_combed() {
    let style = hair(1, 60);
    for tool in [Tool::Comb, Tool::Smooth, Tool::Straighten, Tool::Puff, Tool::Place] {
        let made = stroked((tool, false), &brush(), &style, &across(), &FREE);
        let moved = apart(&made.frame.guides, &style.guides);
        let off = apart(&applied(&made.edits, &style, &FREE).guides, &made.frame.guides);
        println!("{tool:?}: moved by {moved} m, comes back within {off} m");
        assert!(moved > 0.003 && off < 1e-4, "{tool:?} {moved} {off}");
    }
}

#[test]
fn many_strokes_of_one_layer_come_back_too() {
    let style = hair(1, 60);
    let mut edits = HandEdits::default();
    let mut rest = Arc::clone(&style);
    let mut frame = GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0);
    for i in 0..20 {
        let tool = [Tool::Comb, Tool::Grow, Tool::Puff, Tool::Comb, Tool::Shrink][i % 5];
        let turn = Quat::from_rotation_x(0.3 * i as f32);
        let samples = across().into_iter().map(|s| StrokeSample { drag: turn * s.drag, ..s });
        let mut stroke = Brush::new(tool, false, &brush(), [&style, &rest], &edits, &[]).expect("a stroke");
        for sample in samples {
            stroke.stroke_to(&mut frame, &BrushSurroundings { obstacle: &FREE }, &sample);
        }
        stroke.write(&mut edits);
        rest = Arc::new(applied(&edits, &style, &FREE));
    }
    let off = apart(&rest.guides, &frame.guides);
    println!("after 20 strokes within {off} m");
    assert!(off < 1.5e-3, "{off}");
}

#[test]
fn hair_combed_in_another_pose_of_the_head_is_the_same_at_rest() {
    let style = hair(1, 60);
    let pose = Affine3A::from_rotation_translation(
        Quat::from_rotation_y(0.8) * Quat::from_rotation_x(-0.4),
        Vec3::new(0.3, 1.6, -0.2),
    );
    let at_rest = stroked((Tool::Comb, false), &brush(), &style, &across(), &FREE);
    let samples: Vec<StrokeSample> = across()
        .into_iter()
        .map(|s| StrokeSample {
            position: pose.transform_point3(s.position),
            view: pose.transform_vector3(s.view),
            drag: pose.transform_vector3(s.drag),
            ..s
        })
        .collect();
    let frame = GuideFrame::at_rest(&style.guides, pose, 0.0);
    let posed = stroked_in((Tool::Comb, false), &brush(), &style, frame, &samples, &FREE);
    let [a, b] = [&at_rest, &posed].map(|made| applied(&made.edits, &style, &FREE).guides);
    let off = apart(&a, &b);
    println!("differ by {off} m");
    assert!(off < 1e-4, "{off}");
}

/// Each link of a guide turned in its frame by an angle that grows along the guide, as wind or a dance bends it.
fn bent(guides: &Guides, roots: &[Vec3], angle: f32) -> Guides {
    let mut out = guides.clone();
    for (guide, outward) in roots.iter().enumerate() {
        let points = hand_input(guides, guide, 1.0).expect("points");
        let frames = link_frames(&points, *outward);
        let mut at = points[0];
        for (i, frame) in frames.iter().enumerate() {
            let local = frame.inverse() * (points[i + 1] - points[i]);
            at += *frame * (Quat::from_rotation_z(angle * i as f32 / 30.0) * local);
            let k = guide * guides.points_per_guide + i + 1;
            (out.x[k], out.y[k], out.z[k]) = (at.x, at.y, at.z);
        }
    }
    out
}

/// How far a stroke moves bent hair, and how far from there its shape at rest is when it is bent again.
fn bent_again(samples: &[StrokeSample]) -> [f32; 2] {
    let style = hair(1, 60);
    let roots = lovelock_style::hand::HandRoots::of(&style).directions;
    let mut frame = GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0);
    frame.guides = bent(&style.guides, &roots, 0.5);
    let before = frame.guides.clone();
    let made = stroked_in((Tool::Comb, false), &brush(), &style, frame, samples, &FREE);
    let after = applied(&made.edits, &style, &FREE);
    let mut off = 0.0_f32;
    for guide in 0..style.guides.count() {
        let of = |guides: &Guides| hand_input(guides, guide, 1.0).expect("points");
        let [rest, pose, new] = [&style.guides, &before, &after.guides].map(of);
        let turns = link_turns(&rest, &pose);
        let mut at = new[0];
        for i in 0..new.len() - 1 {
            at += turns[i] * (new[i + 1] - new[i]);
            off = off.max(at.distance(made.frame.guides.point(guide, i + 1)));
        }
    }
    [apart(&before, &made.frame.guides), off]
}

#[test]
fn hair_combed_while_it_is_bent_has_the_combed_shape_when_it_is_bent_again() {
    let [moved, off] = bent_again(&samples(Vec3::new(0.1, 0.08, 0.0), Vec3::new(0.1, 0.08, -0.0101), 2));
    println!("one dab: moved by {moved} m, comes back within {off} m");
    assert!(moved > 0.006 && off < 2e-5, "{moved} {off}");
    // Later dabs go through the turns of hair that is combed already, which are twisted a little against those of the first.
    let [moved, off] = bent_again(&across());
    println!("a stroke: moved by {moved} m, comes back within {off} m");
    assert!(moved > 0.03 && off < 0.08 * moved, "{moved} {off}");
}

#[test]
fn the_shape_does_not_depend_on_the_number_of_samples() {
    let style = hair(1, 60);
    let way = |count| samples(Vec3::new(0.1, 0.08, 0.05), Vec3::new(0.1, 0.05, -0.07), count);
    let top = |count| samples(Vec3::new(0.04, 0.205, 0.05), Vec3::new(0.04, 0.205, -0.06), count);
    let way_of = |tool, count| if tool == Tool::Part { top(count) } else { way(count) };
    for tool in [Tool::Comb, Tool::Puff, Tool::Smooth, Tool::Part, Tool::Place, Tool::Attract] {
        let [coarse, fine] =
            [10, 100].map(|count| stroked((tool, false), &brush(), &style, &way_of(tool, count), &PlainHead));
        let (moved, off) =
            (apart(&coarse.frame.guides, &style.guides), apart(&coarse.frame.guides, &fine.frame.guides));
        println!("{tool:?}: moved by {moved} m, differ by {off} m");
        assert!(moved > 2e-3 && off < 5e-4 + 0.01 * moved, "{tool:?}: {off} of {moved}");
    }
}

#[test]
fn strokes_reach_hair_of_another_seed_and_leave_the_other_side() {
    let (style, other) = (hair(1, 120), hair(7, 90));
    let settings = BrushSettings { radius: 0.08, ..brush() };
    let made = stroked((Tool::Comb, false), &settings, &style, &across(), &FREE);
    let after = applied(&made.edits, &style, &FREE);
    let there = applied(&made.edits, &other, &FREE);
    // Mean shift of the middles of guides beside the left ear.
    let shift = |before: &Hairstyle, after: &Hairstyle| {
        let near: Vec<bool> = (0..before.guides.count())
            .map(|guide| before.guides.point(guide, 0).distance(Vec3::new(0.07, 0.14, 0.0)) < 0.04)
            .collect();
        mean(&near, |guide| after.guides.point(guide, 15).z - before.guides.point(guide, 15).z)
    };
    let (own, others) = (shift(&style, &after), shift(&other, &there));
    println!("own {own} m, other seed {others} m");
    assert!(own < -0.01 && (others / own - 1.0).abs() < 0.35);
    for guide in (0..other.guides.count()).filter(|guide| other.guides.point(*guide, 0).x < -0.03) {
        for i in 0..31 {
            assert_eq!(there.guides.point(guide, i), other.guides.point(guide, i));
        }
    }
}
