use std::f32::consts::{FRAC_PI_2, PI};

use glam::{Quat, Vec3};

use super::shape::{ShapedHead, find_head};

/// A surface of rings: their heights, middles along z and half sizes.
fn tower(rings: &[(f32, f32, [f32; 2])]) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    const AROUND: u32 = 24;
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for &(y, z, [wide, deep]) in rings {
        for k in 0..AROUND {
            let (sin, cos) = (k as f32 / AROUND as f32 * 2.0 * PI).sin_cos();
            positions.push(Vec3::new(wide * sin, y, z + deep * cos));
        }
    }
    for ring in 0..rings.len() as u32 - 1 {
        for k in 0..AROUND {
            let [a, b] = [k, (k + 1) % AROUND].map(|k| ring * AROUND + k);
            triangles.extend([[a, b, a + AROUND], [b, b + AROUND, a + AROUND]]);
        }
    }
    (positions, triangles)
}

/// An adult of 1.7 m without arms, from the soles to the crown.
const ADULT: [(f32, f32, [f32; 2]); 14] = [
    (0.0, 0.05, [0.15, 0.12]),
    (0.05, 0.0, [0.14, 0.06]),
    (0.5, 0.0, [0.15, 0.07]),
    (0.85, 0.0, [0.18, 0.11]),
    (1.05, 0.0, [0.14, 0.09]),
    (1.3, 0.0, [0.19, 0.11]),
    (1.4, -0.01, [0.2, 0.08]),
    (1.44, -0.01, [0.1, 0.06]),
    (1.47, 0.0, [0.055, 0.06]),
    (1.5, 0.02, [0.06, 0.085]),
    (1.54, 0.03, [0.07, 0.095]),
    (1.6, 0.03, [0.078, 0.1]),
    (1.66, 0.02, [0.065, 0.08]),
    (1.7, 0.02, [0.01, 0.01]),
];

fn found(rings: &[(f32, f32, [f32; 2])], turn: Quat) -> Option<ShapedHead> {
    let (positions, triangles) = tower(rings);
    let positions: Vec<Vec3> = positions.iter().map(|p| turn * *p + Vec3::new(0.4, -0.2, 3.0)).collect();
    find_head(&positions, &triangles)
}

#[test]
fn the_head_of_a_standing_a_lying_and_a_halved_figure_is_found() {
    let joint = Vec3::new(0.4, 1.49 - 0.2, 3.0);
    let standing = found(&ADULT, Quat::IDENTITY).expect("a head");
    assert_eq!((standing.up, standing.ahead), (Vec3::Y, Vec3::Z));
    assert!(standing.joint.distance(joint) < 0.04, "{}", standing.joint);
    assert!(standing.to_upright().is_none());
    assert!(standing.has(Vec3::new(0.4, 1.4, 3.1)) && !standing.has(Vec3::new(0.4, 1.1, 3.0)));
    assert!(!standing.has(Vec3::new(0.9, 1.45, 3.0)), "a hand that is raised beside it");
    let bust = found(&ADULT[5..], Quat::IDENTITY).expect("the head of a bust");
    assert!(bust.joint.distance(joint) < 0.04, "{}", bust.joint);
    // It faces back.
    let back = found(&ADULT, Quat::from_rotation_y(PI)).expect("a head");
    assert_eq!((back.up, back.ahead), (Vec3::Y, Vec3::NEG_Z));
    // On its back with the crown toward -Z, on its side, and by an exporter with Z up.
    for turn in [
        Quat::from_rotation_x(-FRAC_PI_2),
        Quat::from_rotation_z(FRAC_PI_2),
        Quat::from_rotation_x(FRAC_PI_2),
        Quat::from_rotation_z(FRAC_PI_2) * Quat::from_rotation_y(FRAC_PI_2),
    ] {
        let lying = found(&ADULT, turn).expect("a head");
        assert!(lying.up.abs_diff_eq(turn * Vec3::Y, 1e-6), "{}", lying.up);
        assert!(lying.ahead.abs_diff_eq(turn * Vec3::Z, 1e-6), "{}", lying.ahead);
        let upright = lying.to_upright().expect("it lies");
        assert!((upright * lying.up).abs_diff_eq(Vec3::Y, 1e-6));
        assert!((upright * lying.ahead).abs_diff_eq(Vec3::Z, 1e-6));
    }
}

#[test]
fn things_without_neck_and_shoulders_have_no_head() {
    let box_of = |half: [f32; 2]| [(0.0, 0.0, half), (0.5, 0.0, half), (1.0, 0.0, half)];
    assert!(found(&box_of([0.5, 0.5]), Quat::IDENTITY).is_none(), "a drum");
    assert!(found(&box_of([0.5, 0.1]), Quat::IDENTITY).is_none(), "a board");
    assert!(found(&ADULT[9..], Quat::IDENTITY).is_none(), "a head alone");
    // A bottle with a knob is round.
    let bottle = [(0.0, 0.2), (0.6, 0.2), (0.7, 0.06), (0.8, 0.05), (0.85, 0.08), (0.95, 0.08), (1.0, 0.01)];
    assert!(found(&bottle.map(|(y, half)| (y, 0.0, [half, half])), Quat::IDENTITY).is_none());
    assert!(find_head(&[], &[]).is_none());
    assert!(find_head(&[Vec3::NAN; 3], &[[0, 1, 2], [7, 8, 9]]).is_none());
    assert!(find_head(&[Vec3::ZERO, Vec3::X, Vec3::splat(f32::MAX)], &[[0, 1, 2]]).is_none());
}

#[test]
fn a_real_body_is_found_standing_lying_and_as_a_bust() {
    let Some(data) = lovelock_testkit::data_dir() else { return };
    let path = data.join("reports/whole_body_without_joints.glb");
    let mesh = crate::load_character(&path).expect("a body").body.mesh.clone();
    let standing = find_head(&mesh.positions, &mesh.triangles).expect("a head");
    assert_eq!((standing.up, standing.ahead), (Vec3::Y, Vec3::Z));
    // The chin is at 1.40 m, the crown at 1.60 m.
    assert!((1.36..1.45).contains(&standing.joint.y), "{}", standing.joint);
    for turn in [
        Quat::from_rotation_x(-FRAC_PI_2),
        Quat::from_rotation_x(FRAC_PI_2),
        Quat::from_rotation_z(FRAC_PI_2),
        Quat::from_rotation_y(PI),
    ] {
        let positions: Vec<Vec3> = mesh.positions.iter().map(|p| turn * *p).collect();
        let turned = find_head(&positions, &mesh.triangles).expect("a head");
        assert!(turned.up.abs_diff_eq(turn * Vec3::Y, 1e-5), "{turned:?}");
        assert!(turned.ahead.abs_diff_eq(turn * Vec3::Z, 1e-5), "{turned:?}");
        assert!(turned.joint.distance(turn * standing.joint) < 0.03, "{turned:?}");
    }
    let above = |least: f32| -> Vec<[u32; 3]> {
        let is_above = |triangle: &&[u32; 3]| triangle.iter().all(|&i| mesh.positions[i as usize].y > least);
        mesh.triangles.iter().filter(is_above).copied().collect()
    };
    let cropped = |least: f32| {
        let triangles = above(least);
        let mut kept: Vec<u32> = triangles.iter().flatten().copied().collect();
        kept.sort_unstable();
        kept.dedup();
        let positions: Vec<Vec3> = kept.iter().map(|&i| mesh.positions[i as usize]).collect();
        let slot = |i: u32| kept.binary_search(&i).expect("kept") as u32;
        let triangles: Vec<[u32; 3]> = triangles.iter().map(|triangle| triangle.map(slot)).collect();
        find_head(&positions, &triangles)
    };
    let bust = cropped(1.15).expect("the head of a bust");
    assert!(bust.up == Vec3::Y && bust.joint.distance(standing.joint) < 0.03, "{bust:?}");
    // A head alone has no shoulders: all of it is the head.
    assert_eq!(cropped(1.39), None);
}
