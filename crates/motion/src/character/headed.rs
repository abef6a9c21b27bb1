//! A joint for the head of a figure that is a mere surface.

use glam::{Quat, Vec3};

use crate::{
    Bind, Body, Joint,
    head::find_head,
    humanoid::{Role, role_of},
    skinning::update_rest_surface,
};

/// Whether nothing in a file says where the head of a body is: it has no skins, and no node is named after a head.
pub(super) fn is_mere_surface(body: &Body, skins: usize) -> bool {
    let skeleton = &body.skeleton;
    skins == 0
        && skeleton.named.is_empty()
        && !skeleton.joints.iter().any(|joint| role_of(&joint.name) == Some(Role::Head))
}

/// Gives an upright figure a joint of its head, below the one that carries it so far, and binds what is above the neck to it. Returns
/// whether there is a head.
pub(super) fn add_head(body: &mut Body) -> bool {
    let Some(head) = find_head(&body.mesh.positions, &body.mesh.triangles) else { return false };
    add_joint(body, head.joint, |p, _| head.has(p))
}

/// Where the joint of a head alone is between the lower and the upper end of the figure.
const JOINT_OF_ALL: f32 = 0.13;

/// Gives a figure of which all is taken for a head a joint in its bounds, if that which carries it is outside of them, such as a node at
/// the origin of a head that stands elsewhere. Returns whether it did. What other nodes carry stays theirs.
pub(super) fn add_head_of_all(body: &mut Body) -> bool {
    let (low, high) = body
        .mesh
        .positions
        .iter()
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
    let carrier = body.head_joint;
    let Some(joint) = body.skeleton.world_at_rest.get(carrier) else { return false };
    let at = Vec3::from(joint.translation);
    if at.cmpge(low).all() && at.cmple(high).all() {
        return false;
    }
    let middle = 0.5 * (low + high);
    let at = middle.with_y(low.y + JOINT_OF_ALL * (high.y - low.y));
    add_joint(body, at, |_, of| usize::from(of) == carrier)
}

/// Adds the joint of a head at a place, below the one that carries it so far, and binds to it what `has` says,
/// which gets the place of a vertex and the joint that moves it.
fn add_joint(body: &mut Body, at: Vec3, has: impl Fn(Vec3, u16) -> bool) -> bool {
    let parent = body.head_joint;
    let (Some(&parent_at_rest), Ok(joint)) =
        (body.skeleton.world_at_rest.get(parent), u16::try_from(body.skeleton.joints.len()))
    else {
        return false;
    };
    let translation = parent_at_rest.inverse().transform_point3(at);
    if !translation.is_finite() {
        return false;
    }
    let own = Joint {
        name: "head".to_owned(),
        parent: Some(parent),
        translation,
        rotation: Quat::IDENTITY,
        scale: Vec3::ONE,
    };
    body.skeleton.joints.push(own);
    body.skeleton.update_rest();
    let head_from_world = body.skeleton.world_at_rest[usize::from(joint)].inverse();
    // The entry of the palette that stands for each of before.
    let mut moved: Vec<Option<u16>> = vec![None; body.skin.palette.len()];
    for v in 0..body.mesh.positions.len() {
        let place = body.mesh.positions[v];
        for (k, bind) in body.skin.binds[v].iter_mut().enumerate() {
            let Some(&Bind { joint: before, joint_from_bind }) = body.skin.palette.get(usize::from(*bind))
            else {
                continue;
            };
            if body.mesh.weights[v][k] <= 0.0 || before == joint || !has(place, before) {
                continue;
            }
            let entry = moved[usize::from(*bind)].or_else(|| {
                let entry = u16::try_from(body.skin.palette.len()).ok()?;
                let world = body.skeleton.world_at_rest[usize::from(before)];
                let joint_from_bind = head_from_world * world * joint_from_bind;
                body.skin.palette.push(Bind { joint, joint_from_bind });
                Some(entry)
            });
            let Some(entry) = entry else { continue };
            moved[usize::from(*bind)] = Some(entry);
            *bind = entry;
            body.mesh.joints[v][k] = joint;
        }
    }
    body.head_joint = usize::from(joint);
    update_rest_surface(body);
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Mesh, Skeleton, SkinData};

    #[test]
    fn a_head_alone_has_its_joint_within_its_bounds() {
        let positions = vec![Vec3::new(-1.0, 5.0, 0.0), Vec3::new(1.0, 5.0, 0.0), Vec3::new(0.0, 8.0, 2.0)];
        let joint = Joint {
            name: "node".to_owned(),
            parent: None,
            translation: Vec3::ZERO,
            rotation: Quat::IDENTITY,
            scale: Vec3::ONE,
        };
        let mut body = Body {
            skeleton: Skeleton { joints: vec![joint], ..Skeleton::default() },
            mesh: Mesh {
                positions: positions.clone(),
                normals: vec![Vec3::Z; 3],
                triangles: vec![[0, 1, 2]],
                joints: vec![[0; 8]; 3],
                weights: vec![[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]; 3],
                ..Mesh::default()
            },
            skin: SkinData {
                positions: positions.clone(),
                normals: vec![Vec3::Z; 3],
                binds: vec![[0; 8]; 3],
                palette: vec![Bind { joint: 0, joint_from_bind: glam::Affine3A::IDENTITY }],
                ..SkinData::default()
            },
            ..Body::default()
        };
        body.skeleton.update_rest();
        let mut around = body.clone();
        around.mesh.positions[0] = Vec3::new(-1.0, -1.0, -1.0);
        assert!(!add_head_of_all(&mut around), "its joint is within it");
        assert!(add_head_of_all(&mut body));
        let at = body.skeleton.rest_position(body.head_joint);
        assert!(at.abs_diff_eq(Vec3::new(0.0, 5.39, 1.0), 1e-5), "{at}");
        assert!((0..3).all(|v| body.dominant_joint(v) == body.head_joint));
        for (now, before) in body.mesh.positions.iter().zip(&positions) {
            assert!(now.abs_diff_eq(*before, 1e-5), "{now} {before}");
        }
    }
}
