//! Generalised disks along wisps.

use glam::{Mat3, Vec2, Vec3};
use lovelock_groom::{GuideFrame, Hairstyle, WispCurve};
use lovelock_satf::disk::{GuideSection, place_of};
use lovelock_satf::{DiskFrames, DiskPlan};

use crate::hair::{LINKS, Made, at_rest, corners, guides, lively, random_weights, style};

fn frames_of(style: &Hairstyle, frame: &GuideFrame, along: usize) -> (DiskPlan, DiskFrames) {
    let wisps = (0..style.wisps.len() as u32).collect();
    let plan = DiskPlan::through_guides(style, wisps, along, 1e-4);
    let mut frames = DiskFrames::default();
    frames.place(style, frame, &plan);
    (plan, frames)
}

fn curve_of(style: &Hairstyle, frame: &GuideFrame) -> WispCurve {
    let mut curve = WispCurve::default();
    curve.place(&style.guides, &style.wisps[0], &style.widest, &frame.guides, frame.world_from_head);
    curve
}

/// The point of the disk that lies at `point`, from the axes of the disk alone.
fn disk_point(frames: &DiskFrames, i: usize, point: Vec3) -> Vec2 {
    let axes = Mat3::from_cols(frames.x[i], frames.y[i], frames.tangent[i]);
    (axes.inverse() * (point - frames.centre[i])).truncate()
}

#[test]
fn a_strand_has_constant_places_along_the_wisp_and_in_time() {
    let style = style(&[(lively(), vec![Made::plain([1.0, 0.0, 0.0])])]);
    let mut moved = at_rest(&style);
    for i in 0..moved.guides.x.len() {
        let (guide, at) = (i / (LINKS + 1), (i % (LINKS + 1)) as f32 / LINKS as f32);
        moved.guides.x[i] += at * (0.004 * guide as f32 + 0.03);
        moved.guides.z[i] -= at * at * (0.003 * guide as f32);
    }
    let mut changed = 0.0_f32;
    for frame in [at_rest(&style), moved] {
        let (plan, frames) = frames_of(&style, &frame, 24);
        let curve = curve_of(&style, &frame);
        for weights in random_weights(3, 20) {
            let wanted = place_of(weights);
            for i in 0..plan.samples {
                let param = plan.param(0, i);
                let point = curve.blend(weights, param);
                let found = disk_point(&frames, i, point);
                assert!(found.distance(wanted) < 5e-5, "{i}: {found} for {wanted}");
                // In fixed axes of the frame it is not constant.
                let offset = curve.frame(param).transpose() * (point - frames.centre[i]);
                changed = changed.max((offset.truncate() / 0.01).distance(wanted));
            }
        }
    }
    assert!(changed > 0.5, "the control: {changed}");
}

#[test]
fn places_are_constant_to_rounding() {
    // The same in the plane of the frame, where no point of a wisp in metres is rounded.
    let style = style(&[(lively(), vec![Made::plain([1.0, 0.0, 0.0])])]);
    let curve = curve_of(&style, &at_rest(&style));
    for weights in random_weights(8, 10) {
        let wanted = place_of(weights);
        for i in 0..=48 {
            let section = GuideSection::of(&curve, 0.25 * i as f32);
            let guides = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|w| {
                (section.frame.transpose() * (curve.blend(w, 0.25 * i as f32) - section.mean)).truncate()
            });
            let offset = guides[0] * weights[0] + guides[1] * weights[1] + guides[2] * weights[2];
            assert!((section.map.inverse() * offset).distance(wanted) < 1e-5);
        }
    }
}

#[test]
fn both_forms_of_the_disk_agree() {
    let style = style(&[(lively(), vec![Made::plain([1.0, 0.0, 0.0])])]);
    let (plan, frames) = frames_of(&style, &at_rest(&style), 16);
    let (mut without_phi, mut twisted) = (0.0_f32, 0.0_f32);
    for i in 0..plan.samples {
        let e = frames.ellipse[i];
        let binormal = frames.tangent[i].cross(frames.normal[i]);
        for (v, u) in [(1.0, 0.0), (0.4, 2.0), (0.9, -1.1)] {
            let at = Vec2::new(e.a * v * (e.theta + u).cos(), e.b * v * (e.theta + u).sin());
            let world = |q: Vec2| frames.centre[i] + q.x * frames.normal[i] + q.y * binormal;
            let point = frames.point(0, i, v, u);
            assert!(world(Vec2::from_angle(e.phi).rotate(at)).abs_diff_eq(point, 1e-6));
            // Equation 1 as printed has no φ.
            without_phi = without_phi.max(world(at).distance(point));
        }
        if i > 0 {
            let before = frames.ellipse[i - 1];
            twisted = twisted.max((e.phi - before.phi).abs().max((e.theta - before.theta).abs()));
        }
        assert!(e.a >= e.b && e.b > 0.0);
    }
    assert!(without_phi > 1e-3, "the control: {without_phi}");
    assert!(twisted < 0.6, "angles are continuous: {twisted}");
}

#[test]
fn the_ellipse_goes_through_the_guides() {
    let style = style(&[(lively(), vec![Made::plain([1.0, 0.0, 0.0])])]);
    let frame = at_rest(&style);
    let (plan, frames) = frames_of(&style, &frame, 8);
    let curve = curve_of(&style, &frame);
    for i in 0..plan.samples {
        for weights in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
            let found = disk_point(&frames, i, curve.blend(weights, plan.param(0, i)));
            assert!((found.length() - 1.0).abs() < 1e-3, "{i}: {found}");
        }
    }
}

#[test]
fn guides_in_any_arrangement_make_disks_of_some_width() {
    let point = guides(|_| [Vec2::ZERO; 3]);
    let line = guides(|_| [Vec2::X * -0.01, Vec2::ZERO, Vec2::X * 0.01]);
    let collapsed = [(); 3].map(|()| vec![Vec3::new(0.1, 0.2, 0.3); LINKS + 1]);
    let folded = guides(|_| corners(0.01)).map(|mut guide| {
        let half = guide.len() / 2;
        for i in half..guide.len() {
            guide[i] = guide[2 * half - i];
        }
        guide
    });
    let mirrored = guides(|_| {
        let [a, b, c] = corners(0.01);
        [a, c, b]
    });
    let flattening = guides(|p| corners(0.01).map(|q| Vec2::new(q.x, q.y * (1.0 - p as f32 / LINKS as f32))));
    for (name, of) in [
        ("point", point),
        ("line", line),
        ("collapsed", collapsed),
        ("folded", folded),
        ("mirrored", mirrored),
        ("flattening", flattening),
    ] {
        let style = style(&[(of, vec![Made::plain([0.2, 0.3, 0.5])])]);
        let (plan, frames) = frames_of(&style, &at_rest(&style), 10);
        // Where guides fold back, the tangent turns round and the disk with it.
        let keeps_side = name != "folded";
        let area = |i: usize| frames.x[i].cross(frames.y[i]).dot(frames.tangent[i]);
        for i in 0..plan.samples {
            let all = [frames.centre[i], frames.x[i], frames.y[i], frames.tangent[i], frames.normal[i]];
            assert!(all.iter().all(|v| v.is_finite()), "{name} {i}");
            let e = frames.ellipse[i];
            let least = 1e-4_f32.max(0.1 * e.a.max(e.b.abs())) * 0.999;
            assert!(e.a >= least && e.b.abs() >= least, "{name} {i}: {e:?}");
            assert!(area(i).abs() > 1e-9, "{name} {i}");
            // The disk never turns inside out along a wisp.
            assert!(!keeps_side || (area(i) > 0.0) == (area(0) > 0.0), "{name} {i}");
        }
    }
}

#[test]
fn exchanged_guides_mirror_the_disk_and_keep_every_strand_in_place() {
    let area = |exchanged: bool| {
        let of = guides(|_| {
            let [a, b, c] = corners(0.01);
            if exchanged { [a, c, b] } else { [a, b, c] }
        });
        let style = style(&[(of, vec![Made::plain([0.2, 0.3, 0.5])])]);
        let frame = at_rest(&style);
        let (_, frames) = frames_of(&style, &frame, 4);
        let curve = curve_of(&style, &frame);
        for weights in random_weights(1, 10) {
            let at = place_of(weights);
            let point = frames.point(0, 2, at.length(), at.to_angle());
            assert!(point.distance(curve.blend(weights, 6.0)) < 1e-6);
        }
        frames.x[0].cross(frames.y[0]).dot(frames.tangent[0])
    };
    assert!(area(false) * area(true) < 0.0);
}

#[test]
fn guides_of_two_points_and_no_wisps_are_enough() {
    let mut small = style(&[(guides(|_| corners(0.01)), vec![Made::plain([0.2, 0.3, 0.5])])]);
    let keep = |values: &[f32]| {
        values.chunks(LINKS + 1).flat_map(|guide| [guide[0], guide[LINKS]]).collect::<Vec<_>>()
    };
    small.guides.points_per_guide = 2;
    (small.guides.x, small.guides.y, small.guides.z) =
        (keep(&small.guides.x), keep(&small.guides.y), keep(&small.guides.z));
    let (plan, frames) = frames_of(&small, &at_rest(&small), 3);
    assert_eq!((plan.samples, frames.centre.len()), (4, 4));
    assert!((frames.centre[3] - frames.centre[0]).abs_diff_eq(Vec3::new(0.0, -0.24, 0.0), 1e-5));
    let none = style(&[]);
    assert!(frames_of(&none, &at_rest(&none), 3).1.centre.is_empty());
}
