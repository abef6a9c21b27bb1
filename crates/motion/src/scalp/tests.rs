use std::path::Path;

use super::*;
use crate::load_character;

#[test]
fn the_outline_is_that_of_the_shipped_dancer() {
    let body =
        load_character(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/dancer.glb").as_path())
            .expect("the dancer")
            .body;
    let rest = RestDistance::new(&body);
    let scalp = fitted_scalp(&body, &rest, &ScalpFit::default());
    let skull = scalp.skull.expect("a skull");
    println!("skull {skull:?} scale {}", scalp.scale);
    let head = head_mesh(&body);
    let hairy = |p: Vec3| {
        let near = (0..head.positions.len())
            .min_by(|a, b| {
                head.positions[*a].distance_squared(p).total_cmp(&head.positions[*b].distance_squared(p))
            })
            .expect("vertices");
        head.scalp[near] >= 0.5
    };
    let distance = |p: Vec3| rest.distance(p).0;
    let mut measured = Vec::new();
    for k in 0..19 {
        let azimuth = (10.0 * k as f32).to_radians();
        let mut line = 85.0_f32;
        while line > -80.0 {
            let e = (line - 1.0).to_radians();
            let along = Vec3::new(e.cos() * azimuth.sin(), e.sin(), e.cos() * azimuth.cos()) * skull.half;
            let length = along.length();
            let Some(t) = skull::surface(skull.middle, along / length, 1.55 * length, &distance) else {
                break;
            };
            if !hairy(skull.middle + along / length * t) {
                break;
            }
            line -= 1.0;
        }
        measured.push(line);
    }
    println!("{measured:?}");
    assert!((skull.scale() - 1.0).abs() < 0.02);
    for (k, (found, kept)) in measured.iter().zip(outline::HAIRLINE).enumerate() {
        assert!((found - kept).abs() <= 2.5, "{found} at {} degrees, {kept} in the table", 10 * k);
    }
}

/// A ball as a body with one joint: `lift` is where its middle is above the joint, and `size` its radius, metres.
fn ball(size: f32, lift: f32) -> Body {
    let (rows, columns) = (24, 48);
    let mut mesh = crate::Mesh::default();
    for row in 0..=rows {
        for column in 0..columns {
            let polar = std::f32::consts::PI * row as f32 / rows as f32;
            let azimuth = std::f32::consts::TAU * column as f32 / columns as f32;
            let n = Vec3::new(polar.sin() * azimuth.sin(), polar.cos(), polar.sin() * azimuth.cos());
            mesh.positions.push(n * size + Vec3::Y * lift);
            mesh.normals.push(n);
            mesh.colors.push(Vec3::ONE);
            mesh.joints.push([0; 8]);
            mesh.weights.push([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        }
    }
    let vertex = |row: usize, column: usize| (row * columns + column % columns) as u32;
    for row in 0..rows {
        for column in 0..columns {
            let [a, b] = [vertex(row, column), vertex(row, column + 1)];
            let [c, d] = [vertex(row + 1, column), vertex(row + 1, column + 1)];
            mesh.triangles.extend([[a, c, b], [b, c, d]]);
        }
    }
    let joint = crate::Joint {
        name: "head".to_owned(),
        parent: None,
        translation: Vec3::ZERO,
        rotation: glam::Quat::IDENTITY,
        scale: Vec3::ONE,
    };
    let mut skeleton = crate::Skeleton { joints: vec![joint], ..crate::Skeleton::default() };
    skeleton.update_rest();
    Body { skeleton, mesh, ..Body::default() }
}

#[test]
fn the_skull_of_a_ball_is_the_ball() {
    for size in [0.01, 0.08, 3.0] {
        let body = ball(size, 1.5 * size);
        let found = fitted_scalp(&body, &RestDistance::new(&body), &ScalpFit::default());
        let skull = found.skull.expect("a skull");
        assert!(!found.is_a_cap);
        assert!((skull.middle / size - Vec3::Y * 1.5).length() < 0.05, "{skull:?} of a ball of {size}");
        assert!((skull.half / size - 1.0).abs().max_element() < 0.05, "{skull:?} of a ball of {size}");
        let hairy = found.head.positions.iter().zip(&found.head.scalp).filter(|(_, mask)| **mask >= 0.5);
        for (p, _) in hairy {
            assert!((p.distance(Vec3::Y * 1.5 * size) / size - 1.0).abs() < 0.02, "{p} is off the skin");
            let at = skull.relative(*p);
            assert!(!(at.z > 0.4 && at.y < 0.2 && at.x.abs() < 0.4), "{at} is in the face");
        }
        let bare = ScalpFit { up: f32::NAN, width: -3.0, ..ScalpFit::default() };
        assert!(bare.clamped().width >= 0.5 && bare.clamped().up == 0.0);
    }
}

#[test]
fn a_sheet_has_a_cap_and_nothing_has_no_scalp() {
    let mut body = ball(0.1, 0.0);
    body.mesh.positions.iter_mut().for_each(|p| p.z = 0.0);
    let found = fitted_scalp(&body, &RestDistance::new(&body), &ScalpFit::default());
    assert!(found.is_a_cap && found.head.scalp.iter().any(|mask| *mask > 0.9));
    assert!(found.head.positions.iter().all(|p| p.is_finite()));
    let body = Body::default();
    let found = fitted_scalp(&body, &RestDistance::new(&body), &ScalpFit::default());
    assert!(found.skull.is_none() && found.head.triangles.is_empty());
}

/// A figure of 1.64 m without joints: a ball as its head, and a trunk that is thicker than it.
fn figure() -> Body {
    let mut body = ball(0.09, 1.55);
    let trunk = ball(1.0, 0.0).mesh;
    let first = body.mesh.positions.len() as u32;
    body.mesh.positions.extend(trunk.positions.iter().map(|p| Vec3::new(0.2, 0.7, 0.14) * p + 0.7 * Vec3::Y));
    body.mesh.normals.extend(&trunk.normals);
    body.mesh.colors.extend(&trunk.colors);
    body.mesh.joints.extend(&trunk.joints);
    body.mesh.weights.extend(&trunk.weights);
    body.mesh.triangles.extend(trunk.triangles.iter().map(|triangle| triangle.map(|v| v + first)));
    body
}

#[test]
fn the_skull_of_a_whole_figure_without_joints_is_in_its_head() {
    let body = figure();
    let found = fitted_scalp(&body, &RestDistance::new(&body), &ScalpFit::default());
    let skull = found.skull.expect("a skull");
    assert!(!found.is_a_cap && skull.middle.distance(1.55 * Vec3::Y) < 0.02, "{skull:?}");
    assert!((skull.half / 0.09 - 1.0).abs().max_element() < 0.15, "{skull:?}");
    // Negative control: a flat figure has no skull.
    let mut flat = body;
    flat.mesh.positions.iter_mut().for_each(|p| p.z = 0.0);
    assert!(fitted_scalp(&flat, &RestDistance::new(&flat), &ScalpFit::default()).is_a_cap);
}

#[test]
fn a_real_body_without_joints_has_its_scalp_on_its_head() {
    let Some(data) = lovelock_testkit::data_dir() else { return };
    let path = data.join("reports/whole_body_without_joints.glb");
    let body = load_character(&path).expect("a body").body;
    // The file has one node; the other joint is that of the head that was found.
    assert_eq!((body.skeleton.joints.len(), body.head_joint), (2, 1));
    let joint = body.skeleton.rest_position(1);
    assert!((1.36..1.45).contains(&joint.y) && joint.x.abs() < 0.01, "{joint}");
    let found = fitted_scalp(&body, &RestDistance::new(&body), &ScalpFit::default());
    let skull = found.skull.expect("a skull");
    let skull = Skull { middle: skull.middle + joint, ..skull };
    println!("{skull:?}, scale {}", found.scale);
    // The eyes are at 1.498 m, the top at 1.604 m.
    assert!(!found.is_a_cap && (1.48..1.58).contains(&skull.middle.y), "{skull:?}");
    assert!(skull.half.min_element() > 0.06 && skull.half.max_element() < 0.13, "{skull:?}");
    for x in [-0.03, 0.03] {
        let eye = skull.relative(Vec3::new(x, 1.498, 0.11));
        assert!(eye.z > 0.3 && eye.length() < 1.3, "{eye}");
    }
    let hairy = found.head.positions.iter().zip(&found.head.scalp).filter(|(_, mask)| **mask >= 0.5);
    let heights: Vec<f32> = hairy.map(|(p, _)| p.y + joint.y).collect();
    assert!(heights.len() > 100 && heights.iter().all(|y| (1.35..1.62).contains(y)));
    // Negative control: the chest is far outside of the skull.
    assert!(skull.relative(Vec3::new(0.0, 1.2, 0.05)).length() > 2.0);
}

#[test]
fn a_handle_brings_the_hairline_to_the_pointer_and_paint_adds_and_removes() {
    let skull = Skull { middle: Vec3::Y, half: Vec3::new(0.08, 0.09, 0.1) };
    let mut fit = ScalpFit::default();
    for i in 0..ScalpFit::PLACES.len() {
        let azimuth = ScalpFit::PLACES[i].1.to_radians();
        let before = hairline_place(&skull, &fit, azimuth);
        let to = before + Vec3::Y * 0.01;
        raise_hairline(&skull, &mut fit, i, to);
        let after = hairline_place(&skull, &fit, azimuth);
        let wanted = skull.place(skull.relative(to).normalize_or(Vec3::Y));
        assert!(after.distance(wanted) < 1e-3, "{after} for {wanted} at {}", ScalpFit::PLACES[i].0);
        assert!(after.y > before.y);
    }
    let moved = ScalpFit { up: 0.2, forward: -0.1, nod: 0.3, width: 1.2, ..ScalpFit::default() };
    for degrees in [0.0_f32, 40.0, 90.0, 200.0] {
        let place = skull.relative(hairline_place(&skull, &moved, degrees.to_radians()));
        assert!((place.length() - 1.0).abs() < 1e-4, "on the skull");
        assert!(
            (outline::mask(place, &moved) - 0.5).abs() < 0.02,
            "on the line at {degrees}: {}",
            outline::mask(place, &moved)
        );
    }
    let (face, crown) = (Vec3::new(0.0, -0.3, 1.0).normalize_or(Vec3::Z), Vec3::Y);
    let mask = |fit: &ScalpFit, at: Vec3| fit.painted(at, outline::mask(at, fit));
    let mut fit = ScalpFit::default();
    assert_eq!((mask(&fit, face), mask(&fit, crown), fit.is_automatic()), (0.0, 1.0, true));
    fit.paint(face, 0.3, 1.0, false);
    fit.paint(crown, 0.3, 1.0, true);
    assert!(mask(&fit, face) > 0.9 && mask(&fit, crown) < 0.1 && !fit.is_automatic());
    fit.paint(face, 0.3, 1.0, true);
    assert!(mask(&fit, face) < 0.1, "what was added is removed again");
}

#[test]
fn fur_grows_on_the_whole_skin_in_its_own_size() {
    let mut body = ball(0.3, 0.1);
    let rest = RestDistance::new(&body);
    let fit = ScalpFit { area: ScalpArea::Skin, ..ScalpFit::default() };
    let fur = fitted_scalp(&body, &rest, &fit);
    assert_eq!((fur.head.positions.len(), fur.scale), (body.mesh.positions.len(), 1.0));
    assert!(fur.head.scalp.iter().all(|mask| *mask == 1.0) && fur.body_mask == fur.head.scalp);
    // Control: on the head there is a hairline, and hair has the size of the head.
    let hair = fitted_scalp(&body, &rest, &ScalpFit::default());
    assert!(hair.head.scalp.contains(&0.0) && hair.scale > 2.0, "{}", hair.scale);
    // The mask of the file, what is painted, and the size that is asked for.
    body.mesh.scalp = body.mesh.positions.iter().map(|p| f32::from(p.z > 0.0)).collect();
    let masked = fitted_scalp(&body, &rest, &fit);
    assert!(masked.head.scalp == body.mesh.scalp && masked.body_mask.is_empty());
    let mut painted = ScalpFit { size: 2.0, ..fit };
    painted.paint(Vec3::Z, 1.0, 1.0, true);
    let painted = fitted_scalp(&body, &rest, &painted);
    let mean = |fitted: &FittedScalp| fitted.head.scalp.iter().sum::<f32>() / fitted.head.scalp.len() as f32;
    assert!(painted.scale == 2.0 && mean(&painted) < 0.95 * mean(&masked), "{}", mean(&painted));
    assert_eq!(painted.body_mask, painted.head.scalp);
}
