//! The tree of nodes as joints, parents first.

use std::collections::BTreeSet;

use glam::{Affine3A, Quat, Vec3};
use ufbx::{Node, Scene};

use super::{affine, quat, vec3};
use crate::{Joint, MotionError, Skeleton};

/// The joints of a scene.
pub(super) struct Nodes {
    skeleton: Skeleton,
    /// The joint of each node by the node's number.
    joint_of: Vec<Option<usize>>,
}

impl Nodes {
    /// The joints of skins, bones, and with `needs_mesh` nodes with meshes, together with the nodes above them. Without it all nodes
    /// are joints.
    pub(super) fn new(file: &str, scene: &Scene, needs_mesh: bool) -> Result<Self, MotionError> {
        let mut wanted = vec![!needs_mesh; scene.nodes.len()];
        for node in &scene.nodes {
            if let Some(is_wanted) = wanted.get_mut(number(node)) {
                *is_wanted |= node.bone.is_some() || node.mesh.is_some();
            }
        }
        for cluster in &scene.skin_clusters {
            if let Some(is_wanted) = cluster.bone_node.as_ref().and_then(|bone| wanted.get_mut(number(bone)))
            {
                *is_wanted = true;
            }
        }
        // Parents first, by a stack, so that a deep tree cannot exhaust the call stack.
        let mut order = Vec::with_capacity(scene.nodes.len());
        let mut seen = vec![false; scene.nodes.len()];
        let mut stack: Vec<&Node> = vec![&scene.root_node];
        while let Some(node) = stack.pop() {
            match seen.get_mut(number(node)) {
                Some(was_seen) if !*was_seen => *was_seen = true,
                _ => continue,
            }
            order.push(node);
            let mut children: Vec<&Node> = node.children.into_iter().collect();
            children.reverse();
            stack.append(&mut children);
        }
        for node in order.iter().rev() {
            if let (true, Some(parent)) = (wanted[number(node)], &node.parent)
                && let Some(is_wanted) = wanted.get_mut(number(parent))
            {
                *is_wanted = true;
            }
        }
        let mut nodes = Self { skeleton: Skeleton::default(), joint_of: vec![None; scene.nodes.len()] };
        for node in order.into_iter().filter(|node| wanted[number(node)]) {
            let local = &node.local_transform;
            let (translation, scale) = (vec3(local.translation), vec3(local.scale));
            let (translation, rotation, scale) = if translation.is_finite() && scale.is_finite() {
                (translation, quat(local.rotation), scale)
            } else {
                (Vec3::ZERO, Quat::IDENTITY, Vec3::ONE)
            };
            // The root stands for the file and mostly changes nothing.
            if node.is_root
                && (translation, rotation, scale) == (Vec3::ZERO, Quat::IDENTITY, Vec3::ONE)
                && !node.children.is_empty()
            {
                continue;
            }
            let parent = node.parent.as_ref().and_then(|parent| nodes.joint_of_node(parent));
            let name = node.element.name.to_string();
            nodes.joint_of[number(node)] = Some(nodes.skeleton.joints.len());
            nodes.skeleton.joints.push(Joint { name, parent, translation, rotation, scale });
        }
        let count = nodes.skeleton.joints.len();
        if count >= usize::from(u16::MAX) {
            let problem = format!("{count} joints; must be at most {}", u16::MAX);
            return Err(MotionError::malformed(file, "the scene", problem));
        }
        nodes.rest_in_bind_pose(scene);
        Ok(nodes)
    }

    /// Puts joints where they were when skins were bound. The transforms that a file gives its nodes are mostly those of the frame at
    /// which it was exported, in the middle of a motion.
    fn rest_in_bind_pose(&mut self, scene: &Scene) {
        let mut bound: Vec<Option<Affine3A>> = vec![None; self.skeleton.joints.len()];
        let mut put = |node: &Node, world: &ufbx::Matrix| {
            let world = affine(world);
            if let (Some(joint), true) = (self.joint_of_node(node), world.is_finite()) {
                bound[joint].get_or_insert(world);
            }
        };
        for cluster in &scene.skin_clusters {
            if let Some(bone) = &cluster.bone_node {
                put(bone, &cluster.bind_to_world);
            }
        }
        // Poses also hold joints that move no vertex.
        for pose in scene.poses.into_iter().filter(|pose| pose.is_bind_pose) {
            for bone in pose.bone_poses.iter().filter(|bone| bone.bone_node.bone.is_some()) {
                put(&bone.bone_node, &bone.bone_to_world);
            }
        }
        let skeleton = &mut self.skeleton;
        let mut worlds: Vec<Affine3A> = Vec::with_capacity(bound.len());
        for (j, bound) in bound.into_iter().enumerate() {
            let parent = skeleton.joints[j].parent.map_or(Affine3A::IDENTITY, |p| worlds[p]);
            let local = bound.and_then(|world| without_shear(parent.inverse() * world));
            if let Some((scale, rotation, translation)) = local {
                let joint = &mut skeleton.joints[j];
                (joint.scale, joint.rotation, joint.translation) = (scale, rotation, translation);
            }
            worlds.push(parent * skeleton.local_at_rest(j));
        }
        skeleton.update_rest();
    }

    /// The joint of a node.
    pub(super) fn joint_of_node(&self, node: &Node) -> Option<usize> {
        self.joint(node.element.typed_id)
    }

    /// The joint of the node of a number.
    pub(super) fn joint(&self, node: u32) -> Option<usize> {
        self.joint_of.get(node as usize).copied().flatten()
    }

    /// Number of joints that skins use; of all joints if there is no skin.
    pub(super) fn joints_of_skins(&self, scene: &Scene) -> usize {
        let used: BTreeSet<u32> = scene
            .skin_clusters
            .into_iter()
            .filter_map(|cluster| cluster.bone_node.as_ref().map(|bone| bone.element.typed_id))
            .collect();
        if used.is_empty() { self.skeleton.joints.len() } else { used.len() }
    }

    pub(super) fn skeleton(&self) -> &Skeleton {
        &self.skeleton
    }
}

/// Scale, rotation and translation that a transform consists of; `None` if it shears or is singular.
fn without_shear(local: Affine3A) -> Option<(Vec3, Quat, Vec3)> {
    if !local.is_finite() || local.matrix3.determinant().abs() < 1e-12 {
        return None;
    }
    let (scale, rotation, translation) = local.to_scale_rotation_translation();
    let again = Affine3A::from_scale_rotation_translation(scale, rotation, translation);
    let same = again.matrix3.abs_diff_eq(local.matrix3, 1e-3 * scale.abs().max_element());
    // Rounding in files leaves scales such as 0.9999998.
    let scale = if scale.abs_diff_eq(Vec3::ONE, 1e-5) { Vec3::ONE } else { scale };
    same.then(|| (scale, rotation.normalize(), translation))
}

fn number(node: &Node) -> usize {
    node.element.typed_id as usize
}
