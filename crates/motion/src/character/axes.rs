//! Rotates a figure upright, with its face toward +Z.

use std::f32::consts::{FRAC_PI_2, PI};

use glam::{Quat, Vec3};

use crate::{
    Body, BodySettings, Clip, Facing, Joint, UpAxis,
    head::ShapedHead,
    humanoid::{Humanoid, Role, Side},
    skinning::update_rest_surface,
};

/// Rotates the body according to the settings, otherwise according to the figure. glTF requires Y up and the
/// face toward +Z, and files violate the second more often than the first.
pub(super) fn turn_to_face(
    body: &mut Body,
    clips: &mut [Clip],
    (settings, head): (BodySettings, Option<ShapedHead>),
    notes: &mut Vec<String>,
) {
    let mut lies = false;
    if settings.up == UpAxis::Z {
        insert_root(body, clips, "up axis", Quat::from_rotation_x(-FRAC_PI_2));
    } else if settings.up == UpAxis::Auto
        && let Some(upright) = head.and_then(ShapedHead::to_upright)
    {
        notes.push("the crown of the figure does not point up; it was stood up".to_owned());
        insert_root(body, clips, "up axis", upright);
        lies = true;
    }
    let facing = match settings.facing {
        // It was turned to its face already.
        Facing::Auto if lies => Facing::PlusZ,
        Facing::Auto => match head.filter(|_| settings.up != UpAxis::Z) {
            Some(head) => facing_along(head.ahead),
            None => guess_facing(body),
        },
        chosen => chosen,
    };
    let (angle, axis) = match facing {
        Facing::Auto | Facing::PlusZ => return,
        Facing::PlusX => (-FRAC_PI_2, "+X"),
        Facing::MinusZ => (PI, "-Z"),
        Facing::MinusX => (FRAC_PI_2, "-X"),
    };
    if settings.facing == Facing::Auto {
        notes.push(format!("the rest pose faces {axis}; turned to face +Z"));
    }
    insert_root(body, clips, "facing", Quat::from_rotation_y(angle));
}

/// The axis that the rest pose faces, from the thighs if names distinguish left and right, otherwise from the
/// toes.
fn guess_facing(body: &Body) -> Facing {
    let figure = Humanoid::of_skeleton(&body.skeleton);
    let thigh = |side: Side| figure.get(Role::Thigh(side)).map(|j| body.skeleton.rest_position(j));
    let forward = match (thigh(Side::Left), thigh(Side::Right)) {
        (Some(left), Some(right)) => (left - right).normalize_or_zero().cross(Vec3::Y),
        _ => sole_direction(body).unwrap_or(Vec3::Z),
    };
    facing_along(forward)
}

/// The axis nearest to a direction across Y. Only clear quarter turns are undone.
fn facing_along(forward: Vec3) -> Facing {
    match (forward.x, forward.z) {
        (x, z) if x.abs() < 2.0 * z.abs() && z >= -0.5 * forward.length() => Facing::PlusZ,
        (x, z) if z < -2.0 * x.abs() => Facing::MinusZ,
        (x, z) if x > 2.0 * z.abs() => Facing::PlusX,
        (x, z) if x < -2.0 * z.abs() => Facing::MinusX,
        _ => Facing::PlusZ,
    }
}

/// Direction in which the soles extend from the ankles, for an upright figure without names.
fn sole_direction(body: &Body) -> Option<Vec3> {
    let height = body.height();
    let low = body.mesh.positions.iter().map(|p| p.y).reduce(f32::min)?;
    let mean = |from: f32, to: f32| {
        let band =
            body.mesh.positions.iter().filter(|p| (from..to).contains(&((p.y - low) / height.max(1e-6))));
        let (sum, count) = band.fold((Vec3::ZERO, 0), |(sum, count), p| (sum + *p, count + 1));
        (count > 8).then(|| sum / count as f32)
    };
    let out = (mean(-0.01, 0.03)? - mean(0.06, 0.14)?) * Vec3::new(1.0, 0.0, 1.0);
    // Feet extend by a few hundredths of the height; less is not significant.
    (out.length() > 0.01 * height).then(|| out.normalize_or_zero())
}

/// Adds a rotated root joint above all others.
fn insert_root(body: &mut Body, clips: &mut [Clip], name: &str, rotation: Quat) {
    for joint in &mut body.skeleton.joints {
        joint.parent = Some(joint.parent.map_or(0, |p| p + 1));
    }
    let root = Joint { name: name.into(), parent: None, translation: Vec3::ZERO, rotation, scale: Vec3::ONE };
    body.skeleton.joints.insert(0, root);
    body.skeleton.update_rest();
    let named = std::mem::take(&mut body.skeleton.named);
    body.skeleton.named = named.into_iter().map(|(joint, bone)| (joint + 1, bone)).collect();
    body.skin.palette.iter_mut().for_each(|bind| bind.joint += 1);
    body.mesh.joints.iter_mut().flatten().for_each(|joint| *joint += 1);
    clips.iter_mut().flat_map(|c| &mut c.joints).for_each(|tracks| tracks.joint += 1);
    update_rest_surface(body);
}
