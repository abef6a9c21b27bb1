//! Values over a mesh: normals and colours, by the interpolation of their primvar.

use glam::Vec3;
use lovelock_usd::{Layer, Primvar, Value, primvar};

use crate::MotionError;

/// The sizes of a mesh.
#[derive(Clone, Copy)]
pub(super) struct Sizes {
    pub(super) points: usize,
    pub(super) faces: usize,
    pub(super) corners: usize,
}

/// Values over a mesh.
pub(super) struct OverMesh {
    values: Vec<Vec3>,
    indices: Option<Vec<i32>>,
    per: Per,
}

/// What has a value each.
#[derive(Clone, Copy)]
enum Per {
    Mesh,
    Face,
    Corner,
    Point,
}

impl OverMesh {
    /// The normals of a mesh; `None` without some that fit it. Those of `primvars:normals` come before those of `normals`.
    pub(super) fn normals(
        layer: &mut dyn Layer,
        prim: usize,
        sizes: Sizes,
    ) -> Result<Option<Self>, MotionError> {
        let found = primvar(layer, prim, "normals", sizes.corners.max(1))?;
        Ok(found.and_then(|found| Self::of(found, sizes, &[Per::Point, Per::Corner])))
    }

    /// The display colours of a mesh, its own or those of a prim above it; `None` without some that fit it.
    pub(super) fn colors(
        layer: &mut dyn Layer,
        prim: usize,
        sizes: Sizes,
    ) -> Result<Option<Self>, MotionError> {
        let found = primvar(layer, prim, "displayColor", sizes.corners.max(1))?;
        let usual = [Per::Mesh, Per::Point, Per::Corner, Per::Face];
        // Colours that fit nothing are of use by their first.
        Ok(found.and_then(|found| {
            let first = Primvar { indices: Some(vec![0]), ..found.clone() };
            Self::of(found, sizes, &usual).or_else(|| Self::of(first, sizes, &[Per::Mesh]))
        }))
    }

    /// Texture coordinates of a mesh by the name of their primvar, whose third component is 0; `None` without some that fit it.
    pub(super) fn coordinates(
        layer: &mut dyn Layer,
        prim: usize,
        name: &str,
        sizes: Sizes,
    ) -> Result<Option<Self>, MotionError> {
        let found = primvar(layer, prim, name, sizes.corners.max(1))?;
        Ok(found.and_then(|found| Self::of(found, sizes, &[Per::Corner, Per::Point])))
    }

    /// The stated interpolation if the number of values fits it, otherwise the first of `usual` that fits.
    fn of(found: Primvar, sizes: Sizes, usual: &[Per]) -> Option<Self> {
        let Primvar { values, indices, interpolation, .. } = found;
        let values = values.into_vectors();
        let count = indices.as_ref().map_or(values.len(), Vec::len);
        let said = match interpolation.as_deref() {
            Some("constant") => Some(Per::Mesh),
            Some("uniform") => Some(Per::Face),
            Some("faceVarying") => Some(Per::Corner),
            Some("vertex" | "varying") => Some(Per::Point),
            _ => None,
        };
        let wanted = |per: Per| match per {
            Per::Mesh => 1,
            Per::Face => sizes.faces,
            Per::Corner => sizes.corners,
            Per::Point => sizes.points,
        };
        let per = said.into_iter().chain(usual.iter().copied()).find(|&per| wanted(per) == count)?;
        Some(Self { values, indices, per })
    }

    /// The number of the value at a corner of a face, and the value; `None` for one that is missing.
    pub(super) fn at(&self, face: usize, corner: usize, point: usize) -> Option<(u32, Vec3)> {
        let k = match self.per {
            Per::Mesh => 0,
            Per::Face => face,
            Per::Corner => corner,
            Per::Point => point,
        };
        let k = match &self.indices {
            Some(indices) => usize::try_from(*indices.get(k)?).ok()?,
            None => k,
        };
        Some((u32::try_from(k).ok()?, *self.values.get(k)?))
    }

    /// The value of a number.
    pub(super) fn value(&self, k: u32) -> Option<Vec3> {
        self.values.get(k as usize).copied()
    }
}

/// The integers or numbers of a primvar, picked by its indices if it has some; `None` for an index out of range.
pub(super) fn picked<T: Copy>(values: Vec<T>, indices: Option<&[i32]>) -> Option<Vec<T>> {
    let Some(indices) = indices else { return Some(values) };
    indices.iter().map(|&i| usize::try_from(i).ok().and_then(|i| values.get(i)).copied()).collect()
}

/// The influences of joints on points: joints, weights, and how many of each a point has.
pub(super) struct Influences {
    pub(super) joints: Vec<i32>,
    pub(super) weights: Vec<f32>,
    pub(super) is_constant: bool,
    pub(super) per_point: usize,
}

impl Influences {
    /// Those of a mesh, its own or constant ones of a prim above it; `None` without joints.
    pub(super) fn read(layer: &mut dyn Layer, prim: usize, most: usize) -> Result<Option<Self>, MotionError> {
        let Some(joints) = primvar(layer, prim, "skel:jointIndices", most)? else { return Ok(None) };
        let weights = primvar(layer, prim, "skel:jointWeights", most)?;
        let (weights, of_weights) = weights.map_or((None, None), |found| (Some(found.values), found.indices));
        let is_constant = joints.interpolation.as_deref() == Some("constant");
        let per_point = joints.element_size.unwrap_or(1);
        let joints = picked(joints.values.into_ints(), joints.indices.as_deref()).unwrap_or_default();
        let weights = weights.map_or_else(Vec::new, Value::into_floats);
        let weights = picked(weights, of_weights.as_deref()).unwrap_or_default();
        Ok((!joints.is_empty()).then_some(Self { joints, weights, is_constant, per_point }))
    }
}
