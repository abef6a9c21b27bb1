//! Meshes as pieces of the surface: triangles, normals, weights and blend shapes.

use std::collections::BTreeMap;

use glam::{Affine3A, DMat4, Vec2, Vec3};
use lovelock_base::words::counted;
use lovelock_usd::{Layer, Undrawn, Value, primvar, undrawn};

use super::look::{FIRST_SET, Materials};
use super::over_mesh::{Influences, OverMesh, Sizes};
use super::skeleton::{Figure, OneSkeleton};
use super::{affine, affine_of, inherited_target, tokens};
use crate::MotionError;
use crate::character::Hidden;
use crate::surface::{CLAY, Corners, MorphPiece, Palette, Piece, Surface, VertexWeights, WeightSums};

/// The morph targets of each skeleton by the name of their shape.
pub(super) type Shapes = BTreeMap<(usize, String), Vec<usize>>;

/// Why a prim is not drawn, if it is not.
pub(super) fn hidden(layer: &mut dyn Layer, prim: usize) -> Result<Option<Hidden>, MotionError> {
    let start = layer.sample_times(prim, "points")?.first().copied();
    Ok(undrawn(layer, prim, start)?.map(|why| match why {
        Undrawn::Invisible => Hidden::Invisible,
        Undrawn::StandIn => Hidden::StandIn,
        Undrawn::Prototype => Hidden::Prototype,
    }))
}

/// Reads meshes.
pub(super) struct Reader<'a, 'b> {
    pub(super) file: &'a str,
    pub(super) figure: &'a Figure,
    pub(super) surface: &'a mut Surface,
    pub(super) palette: &'a mut Palette,
    pub(super) shapes: &'a mut Shapes,
    pub(super) materials: &'a mut Materials<'b>,
    pub(super) dropped: &'a mut BTreeMap<String, u64>,
}

impl Reader<'_, '_> {
    pub(super) fn mesh(
        &mut self,
        layer: &mut dyn Layer,
        prim: usize,
        metres_from_stage: DMat4,
    ) -> Result<(), MotionError> {
        let path = layer.path(prim);
        let refuse = |problem: String| MotionError::malformed(self.file, path.clone(), problem);
        let points = layer.attribute(prim, "points", usize::MAX)?.map_or_else(Vec::new, Value::into_vectors);
        let most = points.len().saturating_mul(16).max(1 << 16);
        let mut ints = |name: &str| -> Result<Vec<i32>, MotionError> {
            Ok(layer.attribute(prim, name, most)?.map_or_else(Vec::new, Value::into_ints))
        };
        let (counts, indices) = (ints("faceVertexCounts")?, ints("faceVertexIndices")?);
        let sum = counts.iter().try_fold(0_usize, |sum, &count| {
            usize::try_from(count).ok().and_then(|count| sum.checked_add(count))
        });
        if sum != Some(indices.len()) {
            let corners = counted(indices.len(), "corner", "corners");
            let faces = counted(counts.len(), "face", "faces");
            let problem = format!("{corners} in {faces} that do not add up");
            return Err(refuse(problem));
        }
        if let Some(&wrong) =
            indices.iter().find(|&&i| usize::try_from(i).is_ok_and(|i| i >= points.len()) || i < 0)
        {
            let points = counted(points.len(), "point", "points");
            return Err(refuse(format!("a corner at point {wrong}; the mesh has {points}")));
        }
        let sizes = Sizes { points: points.len(), faces: counts.len(), corners: indices.len() };
        let normals = OverMesh::normals(layer, prim, sizes)?;
        let parts = self.materials.parts(layer, prim, sizes.faces)?;
        // The colour of a material comes before display colours.
        let has_colors = parts.coats.iter().all(|coat| coat.color.is_some());
        let colors = if has_colors { None } else { OverMesh::colors(layer, prim, sizes)? };
        let mut coordinates = None;
        for name in FIRST_SET {
            if coordinates.is_none() {
                coordinates = OverMesh::coordinates(layer, prim, name, sizes)?;
            }
        }
        let second = match self.materials.second_set.as_deref() {
            Some(name) => OverMesh::coordinates(layer, prim, name, sizes)?,
            None => None,
        };
        let has_second = self.materials.second_set.is_some() && (second.is_some() || coordinates.is_some());
        let coats = parts.coats.len() as u32;
        let left_handed =
            layer.attribute(prim, "orientation", 1)?.is_some_and(|o| o.token() == Some("leftHanded"));
        let mut corners = Corners::default();
        let mut first = 0;
        for (face, &count) in counts.iter().enumerate() {
            let count = count as usize;
            let at = |k: usize| (indices[first + k] as usize, first + k);
            for k in 1..count.saturating_sub(1) {
                let [b, c] = if left_handed { [k + 1, k] } else { [k, k + 1] };
                let triangle = [0, b, c].map(|k| {
                    let (point, corner) = at(k);
                    let of = |values: &Option<OverMesh>| values.as_ref()?.at(face, corner, point);
                    let color = of(&colors).map_or(0, |(color, _)| color);
                    let coat = parts.of_face(face);
                    let place = |values: &Option<OverMesh>| {
                        of(values).map_or(Vec2::ZERO, |(_, at)| Vec2::new(at.x, 1.0 - at.y))
                    };
                    // A mesh without the second set is painted by its first.
                    let both = [&coordinates, if second.is_some() { &second } else { &coordinates }];
                    let at = if has_second { both.map(place) } else { [place(&coordinates), Vec2::ZERO] };
                    let normal = of(&normals).map_or(Vec3::ZERO, |(_, normal)| normal.normalize_or_zero());
                    corners.corner(point, color.wrapping_mul(coats).wrapping_add(coat), normal, at)
                });
                corners.triangles.push(triangle);
            }
            first += count;
        }
        let skeleton = inherited_target(layer, prim, "skel:skeleton")?;
        let skeleton = self.figure.skeletons.iter().find(|of| Some(of.prim) == skeleton);
        let weights = self.weights(layer, prim, skeleton, points.len(), metres_from_stage)?;
        let mut piece = Piece {
            color: Vec3::ONE,
            normals: std::mem::take(&mut corners.normals),
            triangles: std::mem::take(&mut corners.triangles),
            ..Piece::default()
        };
        let coat_of = |number: u32| parts.coats[(number % coats) as usize];
        let of_triangles =
            piece.triangles.iter().map(|[a, ..]| coat_of(corners.vertices[*a as usize].1).material);
        piece.materials = of_triangles.collect();
        let [of_first, of_second] = std::mem::take(&mut corners.coordinates);
        if coordinates.is_some() {
            piece.coordinates[0] = of_first;
        }
        if has_second {
            piece.coordinates[1] = of_second;
        }
        for &(point, number) in &corners.vertices {
            piece.positions.push(points[point]);
            piece.weights.push(weights[point]);
            let own = colors.as_ref().and_then(|colors| colors.value(number / coats));
            let color = coat_of(number).color.or(own.filter(|color| color.is_finite()));
            piece.colors.push(color.unwrap_or(CLAY));
        }
        if let Some(skeleton) = skeleton {
            piece.morphs = self.shapes(layer, prim, skeleton, &corners.copies(points.len()))?;
        }
        self.surface.add(piece, self.dropped).map_err(refuse)
    }

    /// The weights of each point of a mesh. Without a skeleton it follows the stage.
    fn weights(
        &mut self,
        layer: &mut dyn Layer,
        prim: usize,
        skeleton: Option<&OneSkeleton>,
        points: usize,
        metres_from_stage: DMat4,
    ) -> Result<Vec<VertexWeights>, MotionError> {
        let path = layer.path(prim);
        let refuse = |problem: String| MotionError::malformed(self.file, path.clone(), problem);
        let too_many = || refuse(format!("more than {} different binds", u16::MAX));
        let most = points.saturating_mul(64).max(64);
        let influences = Influences::read(layer, prim, most)?;
        let (Some(skeleton), Some(influences)) = (skeleton, influences) else {
            // `metres_from_stage` is the first joint.
            let _ = metres_from_stage;
            let in_stage = affine_of(&lovelock_usd::to_stage(layer, prim)?);
            let bind = self.palette.add(0, in_stage).ok_or_else(too_many)?;
            return Ok(vec![VertexWeights::rigid(bind); points]);
        };
        let Influences { joints, weights: amounts, is_constant, per_point: size } = influences;
        if joints.len() != amounts.len() {
            return Err(refuse(format!(
                "{} joint indices and {} joint weights",
                joints.len(),
                amounts.len()
            )));
        }
        let geometry = primvar(layer, prim, "skel:geomBindTransform", 1)?;
        let geometry = geometry.and_then(|found| found.values.numbers().first_chunk::<16>().and_then(affine));
        let geometry = geometry.unwrap_or(Affine3A::IDENTITY);
        // A mesh may have an order of joints of its own.
        let own = tokens(layer, prim, "skel:joints")?;
        let position = |k: usize| match own.get(k) {
            Some(name) => skeleton.paths.iter().position(|path| path == name),
            None if own.is_empty() => Some(k),
            None => None,
        };
        let count = if own.is_empty() { skeleton.joints.len() } else { own.len() };
        let mut binds = Vec::with_capacity(count);
        for k in 0..count {
            let joint = position(k).and_then(|k| Some((*skeleton.joints.get(k)?, skeleton.bind.get(k)?)));
            binds.push(match joint {
                Some((joint, bind)) if bind.matrix3.determinant().abs() > 1e-30 => {
                    Some(self.palette.add(joint, bind.inverse() * geometry).ok_or_else(too_many)?)
                }
                _ => None,
            });
        }
        let per_point = match (is_constant, joints.len()) {
            (true, all) => all,
            (false, all) if points > 0 && all % points == 0 && all / points != size => all / points,
            _ => size,
        };
        if !is_constant && per_point.checked_mul(points) != Some(joints.len()) {
            return Err(refuse(format!("{} joint indices for {points} points of {per_point}", joints.len())));
        }
        // Without any usable joint the mesh follows the stage.
        let otherwise = match binds.iter().flatten().next() {
            Some(&bind) => bind,
            None => self.palette.add(0, geometry).ok_or_else(too_many)?,
        };
        let mut sums = WeightSums::default();
        let weights = (0..points)
            .map(|point| {
                let first = if is_constant { 0 } else { point * per_point };
                for k in first..first + per_point {
                    let joint = usize::try_from(joints[k]).ok();
                    sums.add(joint.and_then(|joint| binds.get(joint).copied().flatten()), amounts[k]);
                }
                sums.take(otherwise)
            })
            .collect();
        sums.report(self.dropped);
        Ok(weights)
    }

    /// The blend shapes of a mesh.
    fn shapes(
        &mut self,
        layer: &mut dyn Layer,
        prim: usize,
        skeleton: &OneSkeleton,
        copies: &[Vec<u32>],
    ) -> Result<Vec<MorphPiece>, MotionError> {
        let names = tokens(layer, prim, "skel:blendShapes")?;
        let targets = layer.targets(prim, "skel:blendShapeTargets")?;
        let mut pieces = Vec::new();
        for (name, target) in names.into_iter().zip(targets) {
            let Some(shape) = layer.prim_at(&target) else { continue };
            let mut vectors = |attribute: &str| -> Result<Vec<Vec3>, MotionError> {
                let value = layer.attribute(shape, attribute, copies.len())?;
                Ok(value.map_or_else(Vec::new, Value::into_vectors))
            };
            let (offsets, turns) = (vectors("offsets")?, vectors("normalOffsets")?);
            let points = layer.attribute(shape, "pointIndices", copies.len())?;
            let points = points.map(Value::into_ints);
            let mut moved = Vec::with_capacity(offsets.len());
            for (k, &offset) in offsets.iter().enumerate() {
                let point = match &points {
                    Some(points) => points.get(k).and_then(|&point| usize::try_from(point).ok()),
                    None => Some(k),
                };
                let of_point = point.and_then(|point| copies.get(point)).map_or(&[][..], Vec::as_slice);
                let turn = turns.get(k).copied().unwrap_or_default();
                moved.extend(of_point.iter().map(|&copy| (copy, offset, turn)));
            }
            let morph = self.surface.add_morph(name.clone(), 0.0);
            self.shapes.entry((skeleton.prim, name)).or_default().push(morph);
            pieces.push(MorphPiece { morph, moved });
        }
        Ok(pieces)
    }
}
