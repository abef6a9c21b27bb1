//! Skeletons as joints.

use std::collections::HashMap;

use glam::{Affine3A, DMat4, Quat, Vec3};
use lovelock_usd::{Layer, Value};

use super::{MAX_NAMES, affine, affine_of, tokens};
use crate::{Joint, MotionError, Skeleton};

/// One skeleton of a stage.
pub(super) struct OneSkeleton {
    /// Its prim.
    pub(super) prim: usize,
    /// Paths of its joints, as the file names them.
    pub(super) paths: Vec<String>,
    /// The joint of the figure for each.
    pub(super) joints: Vec<usize>,
    /// World transform of each joint when meshes were bound, in the skeleton's own space.
    pub(super) bind: Vec<Affine3A>,
}

/// All skeletons of a stage as one tree. Its first joint stands for the stage.
pub(super) struct Figure {
    pub(super) skeleton: Skeleton,
    pub(super) skeletons: Vec<OneSkeleton>,
}

impl Figure {
    pub(super) fn read(
        file: &str,
        layer: &mut dyn Layer,
        metres_from_stage: DMat4,
        needs_mesh: bool,
    ) -> Result<Self, MotionError> {
        let mut figure = Self { skeleton: Skeleton::default(), skeletons: Vec::new() };
        figure.add("stage", None, &affine_of(&metres_from_stage));
        for (prim, _) in layer.prims(&["Skeleton"])? {
            let in_stage = affine_of(&lovelock_usd::to_stage(layer, prim)?);
            let path = layer.path(prim);
            let name = path.rsplit('/').next().unwrap_or_default().to_owned();
            let root = figure.add(&name, Some(0), &in_stage);
            figure.add_skeleton(file, layer, prim, root)?;
        }
        if figure.skeletons.is_empty() && !needs_mesh {
            // Animation alone: its own joints, as they stand at its first time.
            if let Some(&(prim, _)) = layer.prims(&["SkelAnimation"])?.first() {
                figure.add_skeleton(file, layer, prim, 0)?;
            }
        }
        if figure.skeleton.joints.len() >= usize::from(u16::MAX) {
            let problem = format!("{} joints; must be at most {}", figure.skeleton.joints.len(), u16::MAX);
            return Err(MotionError::malformed(file, "the skeletons", problem));
        }
        figure.skeleton.update_rest();
        Ok(figure)
    }

    fn add(&mut self, name: &str, parent: Option<usize>, local: &Affine3A) -> usize {
        let local = if local.is_finite() && local.matrix3.determinant().abs() > 1e-30 {
            *local
        } else {
            Affine3A::IDENTITY
        };
        let (scale, rotation, translation) = local.to_scale_rotation_translation();
        self.push(Joint { name: name.to_owned(), parent, translation, rotation: unit(rotation), scale })
    }

    fn push(&mut self, joint: Joint) -> usize {
        self.skeleton.joints.push(joint);
        self.skeleton.joints.len() - 1
    }

    /// Adds the joints of a prim below a joint.
    fn add_skeleton(
        &mut self,
        file: &str,
        layer: &mut dyn Layer,
        prim: usize,
        root: usize,
    ) -> Result<(), MotionError> {
        let path_of_prim = layer.path(prim);
        let refuse = |problem: String| MotionError::malformed(file, path_of_prim.clone(), problem);
        let paths = tokens(layer, prim, "joints")?;
        let mut matrices = |name: &str| -> Result<Vec<Affine3A>, MotionError> {
            let value = layer.attribute(prim, name, MAX_NAMES)?.map_or_else(Vec::new, Value::into_matrices);
            Ok(value.iter().map(|rows| affine(rows).unwrap_or(Affine3A::IDENTITY)).collect())
        };
        let (bind, rest) = (matrices("bindTransforms")?, matrices("restTransforms")?);
        for (name, count) in [("bindTransforms", bind.len()), ("restTransforms", rest.len())] {
            if count != 0 && count != paths.len() {
                return Err(refuse(format!("{count} {name} for {} joints", paths.len())));
            }
        }
        let index: HashMap<&str, usize> = paths.iter().enumerate().map(|(k, p)| (p.as_str(), k)).collect();
        let parents: Vec<Option<usize>> = paths.iter().map(|path| parent_of(path, &index)).collect();
        let translations = layer.attribute(prim, "translations", MAX_NAMES)?;
        let translations = translations.map_or_else(Vec::new, Value::into_vectors);
        let rotations = layer.attribute(prim, "rotations", MAX_NAMES)?;
        let rotations = rotations.map_or_else(Vec::new, Value::into_quaternions);
        let mut of_figure = vec![0; paths.len()];
        let mut worlds = vec![Affine3A::IDENTITY; paths.len()];
        // Parents first: a path is shorter than those below it.
        let mut order: Vec<usize> = (0..paths.len()).collect();
        order.sort_by_key(|&k| (paths[k].matches('/').count(), k));
        for k in order {
            let above = parents[k].map_or(Affine3A::IDENTITY, |p| worlds[p]);
            let local = match (bind.get(k), rest.get(k)) {
                (Some(world), _) if above.matrix3.determinant().abs() > 1e-30 => above.inverse() * *world,
                (_, Some(local)) => *local,
                _ => Affine3A::from_rotation_translation(
                    rotations.get(k).map_or(Quat::IDENTITY, quaternion),
                    translations.get(k).copied().unwrap_or_default(),
                ),
            };
            let name = paths[k].rsplit('/').next().unwrap_or_default();
            let parent = parents[k].map_or(root, |p| of_figure[p]);
            of_figure[k] = self.add(name, Some(parent), &local);
            worlds[k] = above * self.skeleton.local_at_rest(of_figure[k]);
        }
        let bind = if bind.is_empty() { worlds } else { bind };
        self.skeletons.push(OneSkeleton { prim, paths, joints: of_figure, bind });
        Ok(())
    }

    /// Number of joints of all skeletons.
    pub(super) fn joints_of_skeletons(&self) -> usize {
        self.skeletons.iter().map(|skeleton| skeleton.joints.len()).sum()
    }
}

/// The nearest joint above a path that is in the list.
fn parent_of(path: &str, index: &HashMap<&str, usize>) -> Option<usize> {
    let mut rest = path;
    while let Some((above, _)) = rest.rsplit_once('/') {
        if let Some(&parent) = index.get(above) {
            return Some(parent);
        }
        rest = above;
    }
    None
}

/// A rotation of unit length from a quaternion with the real part first.
pub(super) fn quaternion(q: &[f32; 4]) -> Quat {
    unit(Quat::from_xyzw(q[1], q[2], q[3], q[0]))
}

fn unit(q: Quat) -> Quat {
    let length = q.length();
    if length.is_finite() && length > 1e-6 { q * (1.0 / length) } else { Quat::IDENTITY }
}

/// Scales of zero would make joints singular; USD writes them where nothing is meant.
pub(super) fn scale(v: Vec3) -> Vec3 {
    if v.is_finite() { v } else { Vec3::ONE }
}
