//! Compares interpolation with a reference written from the documentation in double precision, and checks its
//! symmetries.

use glam::{Affine3A, DVec3, Quat, Vec3};
use lovelock_groom::{
    GroomSettings, GuideFrame, Guides, Hairstyle, PlainHead, Preset, Strands, Wisp, WispCurve, grow,
    interpolate,
};

/// Single precision at head size (0.5 m): 2^-24 * 0.5 m is 3e-8 m. There are about twenty roundings, and the frame adds
/// one at each of 30 links over an offset of some centimetres.
const ROUNDING: f32 = 3e-6;

fn preset(preset: Preset) -> Hairstyle {
    grow(&GroomSettings::preset(preset), &PlainHead.scalp(40), &PlainHead).expect("a preset grows")
}

fn moved(style: &Hairstyle, frame: &GuideFrame) -> Strands {
    let mut strands = Strands::default();
    interpolate(style, frame, &mut strands);
    strands
}

/// The guides bent by a smooth change that keeps the roots on the head.
fn blown(style: &Hairstyle, world_from_head: Affine3A) -> GuideFrame {
    let mut frame = GuideFrame::at_rest(&style.guides, world_from_head, 0.0);
    let points = style.guides.points_per_guide;
    for i in 0..frame.guides.x.len() {
        let t = (i % points) as f32 / points as f32;
        let g = (i / points) as f32;
        frame.guides.x[i] += 0.06 * t * t * (5.0 * t + 0.1 * g).sin();
        frame.guides.y[i] += 0.05 * t * t;
        frame.guides.z[i] -= 0.08 * t * t * (3.0 * t + 0.2 * g).cos();
    }
    frame
}

/// `sum_g(weight_g * guide_g(u)) + frame(u) * offset`, point by point, from the documentation alone.
fn twin(style: &Hairstyle, frame: &GuideFrame, wisp: &Wisp, strand: usize, point: usize) -> DVec3 {
    let of = |guides: &Guides, g: u32, p: usize| guides.point(g as usize, p).as_dvec3();
    let n = style.guides.points_per_guide;
    let set = &style.strands;
    // Guides that are further apart than half as much again as at rest are moved toward their mean.
    let radius = |guides: &Guides, p: usize| {
        let mean = wisp.guides.iter().map(|&g| of(guides, g, p)).sum::<DVec3>() / 3.0;
        let squares = wisp.guides.iter().map(|&g| of(guides, g, p).distance_squared(mean));
        ((squares.sum::<f64>() / 3.0).sqrt(), mean)
    };
    let control = |g: u32, p: usize| {
        let (wide, mean) = radius(&frame.guides, p);
        let most =
            if style.widest.is_empty() { f64::MAX } else { 1.5 * radius(&style.guides, p).0.max(0.004) };
        mean + (of(&frame.guides, g, p) - mean) * (most / wide).min(1.0)
    };
    let curve = |g: u32, u: f64| {
        let p = (u.floor() as usize).min(n - 2);
        let t = u - p as f64;
        let (a, b) = (control(g, p), control(g, p + 1));
        let before = if p == 0 { 2.0 * a - b } else { control(g, p - 1) };
        let after = if p + 2 < n { control(g, p + 2) } else { 2.0 * b - a };
        // Barry and Goldman's pyramid, which is independent of the polynomial in the code.
        let lerp = |x: DVec3, y: DVec3, from: f64, to: f64| ((to - t) * x + (t - from) * y) / (to - from);
        let (a1, a2, a3) = (lerp(before, a, -1.0, 0.0), lerp(a, b, 0.0, 1.0), lerp(b, after, 1.0, 2.0));
        let (b1, b2) = (lerp(a1, a2, -1.0, 1.0), lerp(a2, a3, 0.0, 2.0));
        lerp(b1, b2, 0.0, 1.0)
    };
    let u = f64::from(set.guide_param[point]);
    let blend: DVec3 = (0..3).map(|k| f64::from(set.weights[strand][k]) * curve(wisp.guides[k], u)).sum();

    let mean = |guides: &Guides, p: usize| wisp.guides.iter().map(|&g| of(guides, g, p)).sum::<DVec3>() / 3.0;
    let root = (mean(&style.guides, 1) - mean(&style.guides, 0)).normalize_or(DVec3::Y);
    let size = root.abs();
    let axis = if size.x <= size.y && size.x <= size.z {
        DVec3::X
    } else if size.y <= size.z {
        DVec3::Y
    } else {
        DVec3::Z
    };
    let turn =
        |v: DVec3| frame.world_from_head.transform_vector3(v.as_vec3()).as_dvec3().normalize_or(DVec3::Y);
    let (mut tangent, mut normal) = (turn(root), turn((axis - root * axis.dot(root)).normalize_or(DVec3::Y)));
    let last = (u.floor() as usize).min(n - 2);
    let mut ends = [(tangent, normal); 2];
    for p in 1..=last + 1 {
        let next =
            (mean(&frame.guides, (p + 1).min(n - 1)) - mean(&frame.guides, p - 1)).normalize_or(DVec3::Y);
        normal = glam::DQuat::from_rotation_arc(tangent, next) * normal;
        tangent = next;
        ends = [ends[1], (tangent, normal)];
    }
    let t = u - last as f64;
    let along = ends[0].0.lerp(ends[1].0, t).normalize_or(DVec3::Y);
    let side = ends[0].1.lerp(ends[1].1, t);
    let side = (side - along * side.dot(along)).normalize_or(DVec3::Y);
    blend
        + side * f64::from(set.offset_normal[point])
        + along.cross(side) * f64::from(set.offset_binormal[point])
        + along * f64::from(set.offset_tangent[point])
}

/// Largest distance between the engine's strands and the reference, over some strands of every wisp.
fn error_against_reference(style: &Hairstyle, frame: &GuideFrame, strands: &Strands) -> f32 {
    let mut worst = 0.0_f32;
    for wisp in &style.wisps {
        for strand in (wisp.first_strand..wisp.first_strand + wisp.strand_count).step_by(9) {
            let points = &style.strands.first_point[strand as usize..];
            for point in points[0] as usize..points[1] as usize {
                let expected = twin(style, frame, wisp, strand as usize, point).as_vec3();
                worst = worst.max(expected.distance(strands.point(point)));
            }
        }
    }
    worst
}

#[test]
fn equals_the_reference_and_the_test_can_fail() {
    for which in [Preset::Smooth, Preset::Curly] {
        let style = preset(which);
        let turned = Affine3A::from_rotation_translation(
            Quat::from_euler(glam::EulerRot::YXZ, 0.8, -0.3, 0.2),
            Vec3::new(0.3, 1.5, -0.2),
        );
        let frame = blown(&style, turned);
        let strands = moved(&style, &frame);
        let error = error_against_reference(&style, &frame, &strands);
        // Twice the rounding at head size, because this head is at a height of 1.5 m.
        assert!(error < 2.0 * ROUNDING, "{which:?}: {error} m from the twin");

        let mut wrong = style.clone();
        wrong.strands.weights.iter_mut().for_each(|w| w.swap(0, 1));
        let error = error_against_reference(&style, &frame, &moved(&wrong, &frame));
        assert!(error > 1e-3, "swapped guides must be seen, but differ by {error} m");
    }
}

#[test]
fn strands_of_guides_that_part_stay_one_lock() {
    let style = preset(Preset::Long);
    let mut frame = GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0);
    let n = style.guides.points_per_guide;
    // The first guide of every wisp leaves it, by 30 cm at its tip.
    for wisp in &style.wisps {
        let first = wisp.guides[0] as usize * n;
        (0..n).for_each(|i| frame.guides.x[first + i] += 0.3 * (i as f32 / n as f32).powi(2));
    }
    let strands = moved(&style, &frame);
    assert!(error_against_reference(&style, &frame, &strands) < ROUNDING);
    let widest = |style: &Hairstyle, strands: &Strands| {
        let (mut most, rest) =
            (0.0_f32, moved(style, &GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0)));
        for wisp in &style.wisps {
            let tips = |strands: &Strands| -> Vec<Vec3> {
                let of = wisp.first_strand..wisp.first_strand + wisp.strand_count;
                of.map(|s| strands.point(strands.first_point[s as usize + 1] as usize - 1)).collect()
            };
            let spread = |tips: &[Vec3]| {
                let mean = tips.iter().sum::<Vec3>() / tips.len() as f32;
                (tips.iter().map(|p| p.distance_squared(mean)).sum::<f32>() / tips.len() as f32).sqrt()
            };
            most = most.max(spread(&tips(strands)) / spread(&tips(&rest)).max(0.004));
        }
        most
    };
    // Half as much again as at rest, and what strands that end at different points of their guides add.
    let (held, alone) = (widest(&style, &strands), Hairstyle { widest: Vec::new(), ..style.clone() });
    let loose = widest(&alone, &moved(&alone, &frame));
    println!("{held} times as wide as at rest, {loose} times without the limit");
    assert!(held < 2.0 && loose > 4.0, "{held} times as wide as at rest, {loose} times without the limit");
}

#[test]
fn rigid_motion_of_guides_moves_strands_rigidly() {
    let style = preset(Preset::Curly);
    let rest = moved(&style, &GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0));
    for k in 0..8 {
        let world_from_head = Affine3A::from_rotation_translation(
            Quat::from_axis_angle(Vec3::new(0.3, 0.9, 0.1 * k as f32).normalize_or(Vec3::Y), 0.8 * k as f32),
            Vec3::new(0.1, 0.2, 0.3),
        );
        let turned = moved(&style, &GuideFrame::at_rest(&style.guides, world_from_head, 0.0));
        for i in 0..rest.points() {
            let expected = world_from_head.transform_point3(rest.point(i));
            assert!(turned.point(i).distance(expected) < ROUNDING, "point {i} of turn {k}");
        }
    }
}

#[test]
fn roots_stay_on_the_scalp_whatever_the_guides_do() {
    let style = preset(Preset::Smooth);
    let world_from_head =
        Affine3A::from_rotation_translation(Quat::from_rotation_z(0.5), Vec3::new(0.0, 1.0, 0.0));
    let rest = moved(&style, &GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0));
    let blown = moved(&style, &blown(&style, world_from_head));
    for &root in &style.strands.first_point[..style.strands.count()] {
        let expected = world_from_head.transform_point3(rest.point(root as usize));
        let found = blown.point(root as usize);
        assert!(found.distance(expected) < ROUNDING, "{found} is not {expected}");
    }
}

#[test]
fn same_bytes_for_any_number_of_threads_and_for_used_buffers() {
    let style = preset(Preset::Curly);
    let frame = blown(&style, Affine3A::IDENTITY);
    let mut used = Strands::default();
    interpolate(
        &preset(Preset::Smooth),
        &GuideFrame::at_rest(&preset(Preset::Smooth).guides, Affine3A::IDENTITY, 0.0),
        &mut used,
    );
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    one.install(|| interpolate(&style, &frame, &mut used));
    for threads in [2, 8] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let strands = pool.install(|| moved(&style, &frame));
        let bits = |v: &[f32]| v.iter().map(|f| f.to_bits()).collect::<Vec<_>>();
        assert!(
            bits(&strands.x) == bits(&used.x)
                && bits(&strands.y) == bits(&used.y)
                && bits(&strands.z) == bits(&used.z)
        );
        assert_eq!(strands.first_point, used.first_point);
    }
}

#[test]
fn frames_are_orthonormal_and_invert_offsets_even_where_guides_fold() {
    // Straight, bent, folded back on itself, and with all points in one place.
    let shapes: [fn(f32) -> Vec3; 4] = [
        |t| Vec3::new(0.0, -t, 0.0),
        |t| Vec3::new((3.0 * t).sin(), t, (3.0 * t).cos()),
        |t| Vec3::new(0.0, (t - 0.5).abs(), 0.0),
        |_| Vec3::ONE,
    ];
    for shape in shapes {
        let mut guides = Guides { points_per_guide: 11, ..Guides::default() };
        for g in 0..3 {
            let points: Vec<Vec3> =
                (0..11).map(|p| shape(p as f32 / 10.0) + Vec3::X * 0.01 * g as f32).collect();
            guides.push(&points);
        }
        let curve =
            WispCurve::at_rest(&guides, &Wisp { guides: [0, 1, 2], first_strand: 0, strand_count: 0 });
        for k in 0..=200 {
            let u = k as f32 * 0.05;
            let frame = curve.frame(u);
            let unit = frame.transpose() * frame;
            assert!(unit.abs_diff_eq(glam::Mat3::IDENTITY, 1e-6), "at {u}: {unit}");
            assert!((frame.determinant() - 1.0).abs() < 1e-6);
            let (weights, offset) = ([0.5, 0.7, -0.2], Vec3::new(0.01, -0.02, 0.003));
            let back = curve.offset_to(weights, u, curve.point(weights, u, offset));
            assert!(back.distance(offset) < 1e-6, "at {u}: {back}");
        }
        for u in [f32::NAN, -5.0, 1e30, f32::INFINITY] {
            assert!(curve.blend([0.2, 0.3, 0.5], u).is_finite() && curve.frame(u).is_finite());
        }
    }
}

#[test]
fn coinciding_guides_are_followed_for_any_weights() {
    // Partition of unity: weights that sum to 1 do not move a point that all guides share.
    let mut guides = Guides { points_per_guide: 6, ..Guides::default() };
    let points: Vec<Vec3> = (0..6).map(|p| Vec3::new(0.1 * p as f32, 0.02 * (p * p) as f32, 0.3)).collect();
    (0..3).for_each(|_| guides.push(&points));
    let curve = WispCurve::at_rest(&guides, &Wisp { guides: [0, 1, 2], first_strand: 0, strand_count: 0 });
    for (k, &point) in points.iter().enumerate() {
        for weights in [[1.0, 0.0, 0.0], [0.2, 0.3, 0.5], [1.7, -0.4, -0.3]] {
            // The curve passes through its control points.
            assert!(curve.blend(weights, k as f32).distance(point) < 1e-6);
        }
    }
    assert!(curve.blend([0.5, 0.5, 0.5], 3.0).distance(points[3]) > 0.1, "weights of sum 1.5 must move it");
}

#[test]
fn malformed_hairstyles_are_found() {
    let style = preset(Preset::Smooth);
    assert_eq!(style.check(), Ok(()));
    let broken: [fn(&mut Hairstyle); 6] = [
        |s| s.wisps[3].guides[1] = 100_000,
        |s| s.wisps[5].first_strand += 1,
        |s| s.strands.first_point[7] = 0,
        |s| s.strands.weights.truncate(10),
        |s| s.guides.x.truncate(40),
        |s| s.guides.points_per_guide = 1,
    ];
    for (k, breaks) in broken.iter().enumerate() {
        let mut style = style.clone();
        breaks(&mut style);
        assert!(style.check().is_err(), "fault {k} was not found");
    }
    assert!(Hairstyle::default().check().is_err());
}
