use glam::{Quat, Vec3};

use super::*;
use crate::{Bind, Joint, Mesh, Skeleton, Skin, SkinData, pose_at, skin};

/// A pillar of 40 cm with a head on top: two joints, whose weights blend over 10 cm.
fn pillar() -> Body {
    let joint = |name: &str, parent, y: f32| Joint {
        name: name.into(),
        parent,
        translation: Vec3::new(0.0, y, 0.0),
        rotation: Quat::IDENTITY,
        scale: Vec3::ONE,
    };
    let mut skeleton = Skeleton {
        joints: vec![joint("chest", None, 1.0), joint("head", Some(0), 0.2)],
        ..Skeleton::default()
    };
    skeleton.update_rest();
    let (around, rows) = (48_u32, 40_u32);
    let mut mesh = Mesh::default();
    for row in 0..=rows {
        for i in 0..around {
            let (sin, cos) = (std::f32::consts::TAU * i as f32 / around as f32).sin_cos();
            let y = 0.95 + 0.5 * row as f32 / rows as f32;
            let closed = if row == 0 || row == rows { 0.0 } else { 0.06 };
            mesh.positions.push(Vec3::new(closed * cos, y, closed * sin));
            mesh.normals.push(Vec3::new(cos, 0.0, sin));
            let head = ((y - 1.15) / 0.1).clamp(0.0, 1.0);
            let (heavy, light) =
                if head > 0.5 { ((1, head), (0, 1.0 - head)) } else { ((0, 1.0 - head), (1, head)) };
            mesh.joints.push([heavy.0, light.0, 0, 0, 0, 0, 0, 0]);
            mesh.weights.push([heavy.1, light.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        }
    }
    for row in 0..rows {
        for i in 0..around {
            let next = (i + 1) % around;
            let (a, b) = (row * around, (row + 1) * around);
            mesh.triangles.push([a + i, b + i, a + next]);
            mesh.triangles.push([a + next, b + i, b + next]);
        }
    }
    let palette = (0..2)
        .map(|j| Bind { joint: j, joint_from_bind: skeleton.world_at_rest[usize::from(j)].inverse() })
        .collect();
    let skin = SkinData {
        positions: mesh.positions.clone(),
        normals: mesh.normals.clone(),
        palette,
        binds: mesh.joints.clone(),
        morphs: Vec::new(),
    };
    Body { name: "pillar".into(), skeleton, mesh, skin, head_joint: 1, ..Body::default() }
}

#[test]
fn a_field_matches_the_distance_and_its_outline_lies_on_the_skin() {
    let body = pillar();
    let rest = RestDistance::new(&body);
    let field = BodyField::new(&body, &rest).expect("a field");
    assert_eq!(field.joints(), [1, 0]);
    assert!(field.distance_lattice().count() > 200_000);
    let (mut inside, mut outside) = (0, 0);
    for i in 0..500 {
        let (u, v) = (i as f32 * 0.37, i as f32 * 0.0011);
        let r = 0.03 + 0.006 * (i % 10) as f32;
        let p = Vec3::new(r * u.sin() * v.cos(), 0.1 * (u * 0.3).cos() - 0.02, r * u.cos());
        let Some((d, _)) = field.sample(p) else { continue };
        // Cells of about 4 mm on a pillar of 6 cm: h^2 / 8 r is 0.03 mm; its rims are sharp.
        assert!((d - rest.distance(p).0).abs() < 1.5e-3, "found {d}, expected {}", rest.distance(p).0);
        inside += i32::from(d < 0.0);
        outside += i32::from(d > 0.0);
    }
    assert!(inside > 50 && outside > 50, "{inside} and {outside}: too few to prove anything");
    assert!(field.sample(Vec3::splat(9.0)).is_none() && field.sample(Vec3::NAN).is_none());

    // With the head thrown back the outline lies on the skin.
    let mut pose = Pose::default();
    pose_at(&body, None, 0.0, &mut pose);
    pose.world_from_joint[1] *= Affine3A::from_rotation_x(-0.7);
    let (mut placed, mut lines, mut surface) = (FieldPose::default(), Vec::new(), Skin::default());
    field.place(&body, &pose, 0.0, &mut placed);
    field.lines(&placed, &mut lines);
    skin(&body, &pose, &mut surface);
    let now = RestDistance::of_triangles(&surface.positions, &body.mesh.triangles);
    let worst =
        |lines: &[[Vec3; 2]]| lines.iter().flatten().fold(0.0_f32, |w, &p| w.max(now.distance(p).0.abs()));
    assert!(lines.len() > 500);
    // Ends take the weights of the nearest node, up to 4 mm away; the outline is only for drawing.
    assert!(worst(&lines) < 4e-3, "{}", worst(&lines));
    let mut stiff = Vec::new();
    pose_at(&body, None, 0.0, &mut pose);
    field.place(&body, &pose, 0.0, &mut placed);
    field.lines(&placed, &mut stiff);
    assert!(worst(&stiff) > 0.02, "control: the outline at rest is elsewhere: {}", worst(&stiff));
}

#[test]
fn nothing_to_measure_gives_no_field() {
    let body = Body::default();
    assert!(BodyField::new(&body, &RestDistance::new(&body)).is_none());
}
