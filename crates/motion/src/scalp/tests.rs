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
    painted.paint(Vec3::Z, 0.5, 1.0, true);
    let painted = fitted_scalp(&body, &rest, &painted);
    let mean = |fitted: &FittedScalp| fitted.head.scalp.iter().sum::<f32>() / fitted.head.scalp.len() as f32;
    assert!(painted.scale == 2.0 && mean(&painted) < 0.95 * mean(&masked), "{}", mean(&painted));
    assert_eq!(painted.body_mask, painted.head.scalp);
}
