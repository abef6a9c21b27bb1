use glam::{Affine3A, Quat};
use lovelock_motion::ColliderShape;

use super::*;
use crate::colliders::shape::Shape;
use crate::lanes::Map;

fn still(shape: ColliderShape) -> MovingShape {
    let shape = Shape::new(&shape);
    let (min, max) = shape.expect("a shape").bounds();
    MovingShape {
        shape,
        min,
        max,
        velocity_at: Map { turn: glam::Mat3::ZERO, shift: Vec3::ZERO },
        on_head: false,
    }
}

fn splat(p: Vec3) -> Lane3 {
    crate::lanes::splat3(p)
}

const RULES: ContactRules =
    ContactRules { margin: 0.0, layering: 0.0, skin_friction: 0.0, cloth_friction: 0.0, h: 1.0 / 240.0 };

/// Places a point at the end of a link from `from` toward `wanted`, over one collider, without friction.
fn place(shape: ColliderShape, from: Vec3, wanted: Vec3, length: f32) -> Vec3 {
    let shapes = [still(shape)];
    let near = Near {
        shapes: &shapes,
        active: &[0],
        boxes: &Boxes::of(&shapes),
        rest_distance: &[Lane::splat(1.0)],
        points: 1,
        carried: 0,
        root_penetration: &[ZERO],
        link: &ZERO,
        friction: &[],
        field: None,
    };
    let placed = place_point(
        0,
        &splat(from),
        &splat(wanted),
        &splat(wanted),
        &splat(Vec3::Y),
        &Lane::splat(length),
        &near,
        &RULES,
        &mut no_planes(),
    )
    .placed;
    at(&placed, 7)
}

/// Planes of a row without a field.
fn no_planes() -> PlaneRow {
    PlaneRow::unknown(PlaneRow::NO_SKIN)
}

/// Points next to the surface of a shape of about 0.1 m, with links that would enter it.
fn cases() -> impl Iterator<Item = (Vec3, Vec3, f32)> {
    (0..300).map(|i| {
        let (u, v, w) = (i as f32 * 0.37, i as f32 * 0.73, i as f32 * 1.19);
        let out = Vec3::new(u.sin() * v.cos(), u.sin() * v.sin(), u.cos());
        let inward = -out + 0.9 * Vec3::new(w.cos(), w.sin(), (2.0 * w).cos());
        (out * 0.125, out * 0.125 + inward * 0.02, 0.006 + 0.0001 * i as f32)
    })
}

#[test]
fn push_out_of_a_sphere_is_exact_in_distance_and_length() {
    let c = Vec3::new(0.001, 0.002, 0.0);
    let mut pushed = 0;
    for (from, wanted, length) in cases() {
        let sphere = ColliderShape::Capsule { a: c, b: c, radius_a: 0.12, radius_b: 0.12 };
        let x = place(sphere, from, wanted, length);
        let free = from + (wanted - from).normalize_or_zero() * length;
        // Positions of 0.1 m in f32: 1e-8 each, a dozen operations.
        assert!(((x - from).length() - length).abs() < 2e-7, "length {}", (x - from).length());
        if (free - c).length() < 0.12 {
            pushed += 1;
            assert!(((x - c).length() - 0.12).abs() < 1e-6, "distance {}", (x - c).length());
        } else {
            assert!((x - free).length() < 1e-7);
        }
    }
    assert!(pushed > 100, "only {pushed} cases touched: the test proves nothing");
}

#[test]
fn push_out_of_capsules_and_ellipsoids_ends_on_the_surface() {
    let capsule = ColliderShape::Capsule {
        a: Vec3::new(0.0, -0.02, 0.0),
        b: Vec3::new(0.0, 0.03, 0.0),
        radius_a: 0.09,
        radius_b: 0.11,
    };
    let from_unit = Affine3A::from_scale_rotation_translation(
        Vec3::new(0.10, 0.12, 0.115),
        Quat::from_rotation_x(0.5),
        Vec3::ZERO,
    );
    for (shape, exact) in [(capsule, 1e-4), (ColliderShape::Ellipsoid { from_unit }, 1e-4)] {
        let query = Shape::new(&shape).expect("a shape");
        let mut pushed = 0;
        for (from, wanted, length) in cases() {
            let free = from + (wanted - from).normalize_or_zero() * length;
            if query.distance(free) >= 0.0 || query.distance(from) < 0.0 {
                continue;
            }
            pushed += 1;
            let x = place(shape, from, wanted, length);
            assert!(((x - from).length() - length).abs() < 2e-7);
            // Two iterations with the touching sphere leave at most a tenth of a hair's width.
            assert!(query.distance(x).abs() < exact, "{} m off {shape:?}", query.distance(x));
        }
        assert!(pushed > 50, "only {pushed} cases touched");
    }
}

#[test]
fn a_link_that_cannot_reach_the_surface_points_out() {
    let x = push_out(Vec3::new(0.0, 0.05, 0.0), Vec3::ZERO, 0.01, Vec3::ZERO, 0.1);
    assert!((x - Vec3::new(0.0, 0.06, 0.0)).length() < 1e-6, "{x}");
}

#[test]
fn a_point_inside_at_rest_stays_inside() {
    let c = Vec3::ZERO;
    let shapes = [still(ColliderShape::Capsule { a: c, b: c, radius_a: 0.1, radius_b: 0.1 })];
    let near = Near {
        shapes: &shapes,
        active: &[0],
        boxes: &Boxes::of(&shapes),
        rest_distance: &[Lane::splat(-0.02)],
        points: 1,
        carried: 0,
        root_penetration: &[ZERO],
        link: &ZERO,
        friction: &[],
        field: None,
    };
    let rules = ContactRules { margin: 0.003, ..RULES };
    let (from, wanted) = (splat(Vec3::new(0.0, 0.07, 0.0)), splat(Vec3::new(0.0, 0.08, 0.0)));
    let placed =
        place_point(0, &from, &wanted, &wanted, &from, &Lane::splat(0.01), &near, &rules, &mut no_planes())
            .placed;
    assert!((at(&placed, 0) - Vec3::new(0.0, 0.08, 0.0)).length() < 1e-7);
    let deeper = splat(Vec3::new(0.0, 0.0, 0.0));
    let placed =
        place_point(0, &from, &deeper, &deeper, &from, &Lane::splat(0.01), &near, &rules, &mut no_planes())
            .placed;
    assert!(at(&placed, 0).length() > 0.0799, "it must not go deeper than at rest: {}", at(&placed, 0));
}

#[test]
fn friction_is_limited_by_its_coefficient() {
    let c = Vec3::ZERO;
    let was = Vec3::new(0.0, 1.0, 0.0);
    let p = Vec3::new(0.01, 1.0, 0.0);
    let half = slide(p, was, c, 0.01, 0.5, Vec3::ZERO, 1.0);
    assert!((half.x - 0.005).abs() < 1e-4, "half of the sliding remains: {half}");
    let stuck = slide(p, was, c, 0.1, 0.5, Vec3::ZERO, 1.0);
    assert!(stuck.x.abs() < 1e-4, "friction never reverses the sliding: {stuck}");
    assert_eq!(slide(p, was, c, 0.1, 0.0, Vec3::ZERO, 1.0), p);
}

#[test]
fn hair_with_an_enclosed_root_leaves_along_a_slope() {
    let c = Vec3::ZERO;
    let shapes = [still(ColliderShape::Capsule { a: c, b: c, radius_a: 0.1, radius_b: 0.1 })];
    let length = Lane::splat(0.01);
    let rest = [Lane::splat(0.001); 12];
    // The surface has risen 2 cm above a root that was 1 mm outside.
    let root = splat(Vec3::new(0.0, 0.08, 0.0));
    let deep = [root_penetration(&root, &shapes[0], &rest[0])];
    assert!((deep[0][0] - 0.02).abs() < 1e-6);
    let near = Near {
        shapes: &shapes,
        active: &[0],
        boxes: &Boxes::of(&shapes),
        rest_distance: &rest,
        points: 12,
        carried: 0,
        root_penetration: &deep,
        link: &length,
        friction: &[],
        field: None,
    };
    let mut before = root;
    for i in 1..12 {
        // Unconstrained, it would continue inside.
        let wanted = splat(at(&before, 0) + Vec3::new(0.01, -0.002, 0.0));
        let placed =
            place_point(i, &before, &wanted, &wanted, &root, &length, &near, &RULES, &mut no_planes()).placed;
        let least = (0.1 - 0.02 + 0.005 * i as f32).min(0.1);
        assert!(
            at(&placed, 0).length() > least - 2e-4,
            "point {i} is {} from the centre",
            at(&placed, 0).length()
        );
        // Straight up would be 1 cm per link; the slope is half of that.
        if i == 1 {
            assert!(at(&placed, 0).length() < 0.0865, "point {i} rises too steeply: {}", at(&placed, 0));
        }
        before = placed;
    }
}
