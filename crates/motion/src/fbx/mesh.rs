//! Meshes as pieces of the surface: triangles, normals, weights and blend shapes.

use std::collections::BTreeMap;

use glam::{Affine3A, Vec2, Vec3};
use ufbx::{BlendShape, Mesh, Node, Scene, SkinDeformer};

use super::material::{Coat, Materials};
use super::nodes::Nodes;
use super::visible::Visibility;
use super::{affine, vec3};
use crate::character::{HiddenMeshes, WornHair};
use crate::surface::{Corners, MorphPiece, Palette, Piece, Surface, VertexWeights, WeightSums};
use crate::{BodySettings, MotionError};

/// The shapes of each channel by the number of its element: one list for each node that shows the mesh.
pub(super) type MorphsOfChannels = BTreeMap<u32, Vec<Vec<ShapeOfChannel>>>;

/// One shape of a channel: its morph target, and the weight of the channel at which it is reached. A channel has several if it goes
/// through shapes in between.
#[derive(Clone, Copy)]
pub(super) struct ShapeOfChannel {
    pub(super) morph: usize,
    pub(super) reached_at: f64,
}

/// The weight of each shape of a channel at a weight of the channel: linear from shape to shape.
pub(super) fn weights_of_shapes(shapes: &[ShapeOfChannel], weight: f64) -> Vec<f32> {
    let mut weights = vec![0.0; shapes.len()];
    // The shape at weight 0 is the surface itself.
    let reached = |k: usize| if k == 0 { 0.0 } else { shapes[k - 1].reached_at };
    let Some(last) = shapes.len().checked_sub(1) else { return weights };
    // The span in which the weight lies; the first and the last go on beyond their ends.
    let span = (0..last).find(|&k| weight <= reached(k + 1)).unwrap_or(last);
    let (from, to) = (reached(span), reached(span + 1));
    let share = if (to - from).abs() > 1e-9 { ((weight - from) / (to - from)) as f32 } else { 1.0 };
    weights[span] = share;
    if span > 0 {
        weights[span - 1] = 1.0 - share;
    }
    weights
}

/// Reads all meshes of a scene.
pub(super) struct Reader<'a, 'b> {
    pub(super) file: &'a str,
    pub(super) nodes: &'a Nodes,
    pub(super) surface: &'a mut Surface,
    pub(super) palette: &'a mut Palette,
    pub(super) morphs: &'a mut MorphsOfChannels,
    pub(super) materials: &'a mut Materials<'b>,
    pub(super) dropped: &'a mut BTreeMap<String, u64>,
}

impl<'b> Reader<'_, 'b> {
    pub(super) fn all(
        mut self,
        scene: &'b Scene,
        settings: BodySettings,
        hidden: &mut HiddenMeshes,
        notes: &mut Vec<String>,
    ) -> Result<(), MotionError> {
        let visibility = Visibility::new(scene);
        let mut parts: Vec<(&'b Node, &'b Mesh)> = Vec::new();
        for node in &scene.nodes {
            let Some(mesh) = node.mesh.as_ref().filter(|mesh| mesh.num_triangles > 0) else { continue };
            if hidden.reads(visibility.hidden(node)) {
                parts.push((node, mesh));
            }
        }
        let mut worn = WornHair::new(settings);
        for &(node, mesh) in &parts {
            worn.offer(&[&node.element.name, &mesh.element.name]);
        }
        let worn = worn.decide(notes);
        for ((node, mesh), is_hair) in parts.into_iter().zip(worn) {
            if !is_hair {
                self.mesh(node, mesh, notes)?;
            }
        }
        Ok(())
    }

    fn mesh(&mut self, node: &'b Node, mesh: &'b Mesh, notes: &mut Vec<String>) -> Result<(), MotionError> {
        let refuse = |problem: String| MotionError::malformed(self.file, "the meshes", problem);
        let weights = self.weights(node, mesh, notes)?;
        let mut corners = split(mesh);
        let coats: Vec<Coat> = (0..mesh.materials.len().max(1))
            .map(|k| {
                self.materials.coat(
                    mesh,
                    mesh.materials.get(k).map(|material| &**material),
                    &node.element.name,
                )
            })
            .collect();
        let coat =
            |material: u32| coats.get(material as usize).or(coats.first()).copied().unwrap_or_default();
        let materials =
            corners.triangles.iter().map(|[a, ..]| coat(corners.vertices[*a as usize].1).material);
        let materials = materials.collect();
        let coordinates = std::mem::take(&mut corners.coordinates);
        let mut piece = Piece {
            color: Vec3::ONE,
            triangles: std::mem::take(&mut corners.triangles),
            materials,
            coordinates: [0, 1].map(|set| {
                let has_set = mesh.uv_sets.get(set).is_some() || set == 0 && mesh.vertex_uv.exists;
                if has_set { coordinates[set].clone() } else { Vec::new() }
            }),
            ..Piece::default()
        };
        for (&(vertex, material), &normal) in corners.vertices.iter().zip(&corners.normals) {
            piece.positions.push(mesh.vertices.get(vertex).map_or(Vec3::NAN, |&p| vec3(p)));
            piece.normals.push(normal);
            piece.colors.push(coat(material).color);
            piece.weights.push(weights.get(vertex).copied().unwrap_or(VertexWeights::rigid(0)));
        }
        let copies = corners.copies(mesh.num_vertices);
        for deformer in &mesh.blend_deformers {
            for channel in &deformer.channels {
                let first = self.surface.morphs();
                let shapes: Vec<ShapeOfChannel> = channel
                    .keyframes
                    .iter()
                    .enumerate()
                    .map(|(k, key)| ShapeOfChannel { morph: first + k, reached_at: key.target_weight })
                    .collect();
                let at_rest = weights_of_shapes(&shapes, channel.weight);
                for (key, &rest_weight) in channel.keyframes.iter().zip(&at_rest) {
                    let name = if channel.element.name.is_empty() {
                        key.shape.element.name.to_string()
                    } else {
                        channel.element.name.to_string()
                    };
                    let morph = self.surface.add_morph(name, rest_weight);
                    piece.morphs.push(MorphPiece { morph, moved: moved(&key.shape, &copies) });
                }
                self.morphs.entry(channel.element.element_id).or_default().push(shapes);
            }
        }
        self.surface.add(piece, self.dropped).map_err(refuse)
    }

    /// The weights of each vertex of a mesh, which follows its node where no skin moves it.
    fn weights(
        &mut self,
        node: &Node,
        mesh: &Mesh,
        notes: &mut Vec<String>,
    ) -> Result<Vec<VertexWeights>, MotionError> {
        let too_many = || {
            let problem = format!("more than {} different binds", u16::MAX);
            MotionError::malformed(self.file, "the skins", problem)
        };
        let own = self.nodes.joint_of_node(node).unwrap_or(0);
        let rigid = self.palette.add(own, Affine3A::IDENTITY).ok_or_else(too_many)?;
        let Some(skin) = mesh.skin_deformers.into_iter().next() else {
            return Ok(vec![VertexWeights::rigid(rigid); mesh.num_vertices]);
        };
        if mesh.skin_deformers.len() > 1 {
            notes.push(format!("`{}` has several skins; the first is used", &*node.element.name));
        }
        let mut binds = Vec::with_capacity(skin.clusters.len());
        for cluster in &skin.clusters {
            let joint = cluster.bone_node.as_ref().and_then(|bone| self.nodes.joint_of_node(bone));
            let bind = affine(&cluster.geometry_to_bone);
            binds.push(match joint {
                Some(joint) if bind.is_finite() => Some(self.palette.add(joint, bind).ok_or_else(too_many)?),
                _ => None,
            });
        }
        Ok(self.weights_of_skin(skin, &binds, mesh.num_vertices, rigid))
    }

    fn weights_of_skin(
        &mut self,
        skin: &SkinDeformer,
        binds: &[Option<u16>],
        vertices: usize,
        rigid: u16,
    ) -> Vec<VertexWeights> {
        let mut sums = WeightSums::default();
        let weights = (0..vertices)
            .map(|v| {
                let of_vertex = skin.vertices.get(v).map_or(0..0, |range| {
                    let begin = range.weight_begin as usize;
                    begin..begin.saturating_add(range.num_weights as usize)
                });
                for weight in skin.weights.get(of_vertex).unwrap_or_default() {
                    sums.add(
                        binds.get(weight.cluster_index as usize).copied().flatten(),
                        weight.weight as f32,
                    );
                }
                sums.take(rigid)
            })
            .collect();
        sums.report(self.dropped);
        weights
    }
}

/// Splits a mesh into triangles.
fn split(mesh: &Mesh) -> Corners {
    let mut corners = Corners::default();
    let mut indices = vec![0_u32; (mesh.max_face_triangles * 3).max(3)];
    for (f, &face) in mesh.faces.iter().enumerate() {
        if face.num_indices < 3 || mesh.face_hole.get(f).copied().unwrap_or(false) {
            continue;
        }
        let material = mesh.face_material.get(f).copied().unwrap_or(0);
        let count = mesh.triangulate_face(&mut indices, face) as usize;
        for triangle in indices[..(count * 3).min(indices.len())].as_chunks::<3>().0 {
            let placed = triangle.map(|index| {
                let index = index as usize;
                let vertex = mesh.vertex_indices.get(index).map_or(usize::MAX, |&v| v as usize);
                corners.corner(vertex, material, normal(mesh, index), coordinates(mesh, index))
            });
            corners.triangles.push(placed);
        }
    }
    corners
}

/// The normal at a corner; zero if the file has none.
fn normal(mesh: &Mesh, index: usize) -> Vec3 {
    let normals = &mesh.vertex_normal;
    if !normals.exists {
        return Vec3::ZERO;
    }
    let of_corner = normals.indices.get(index).and_then(|&at| normals.values.get(at as usize));
    of_corner.map_or(Vec3::ZERO, |&n| vec3(n).normalize_or_zero())
}

/// The texture coordinates at a corner, counted from above; 0 where the file has none.
fn coordinates(mesh: &Mesh, index: usize) -> [Vec2; 2] {
    [0, 1].map(|set| {
        let own = mesh.uv_sets.get(set).map(|set| &set.vertex_uv).or((set == 0).then_some(&mesh.vertex_uv));
        let at = own.and_then(|uvs| uvs.values.get(*uvs.indices.get(index)? as usize));
        at.map_or(Vec2::ZERO, |at| Vec2::new(at.x as f32, 1.0 - at.y as f32))
    })
}

fn moved(shape: &BlendShape, copies: &[Vec<u32>]) -> Vec<(u32, Vec3, Vec3)> {
    let mut moved = Vec::with_capacity(shape.num_offsets);
    for (k, &vertex) in shape.offset_vertices.iter().enumerate() {
        let at = |offsets: &[ufbx::Vec3]| offsets.get(k).map_or(Vec3::ZERO, |&v| vec3(v));
        let (position, normal) = (at(&shape.position_offsets), at(&shape.normal_offsets));
        let of_vertex = copies.get(vertex as usize).map(Vec::as_slice).unwrap_or_default();
        moved.extend(of_vertex.iter().map(|&copy| (copy, position, normal)));
    }
    moved
}

#[cfg(test)]
mod tests {
    use super::{ShapeOfChannel, weights_of_shapes};

    #[test]
    fn a_channel_goes_from_shape_to_shape() {
        let shapes = [0.5, 1.0].map(|reached_at| ShapeOfChannel { morph: 0, reached_at });
        for (weight, expected) in
            [(0.0, [0.0, 0.0]), (0.25, [0.5, 0.0]), (0.5, [1.0, 0.0]), (0.75, [0.5, 0.5]), (1.0, [0.0, 1.0])]
        {
            assert_eq!(weights_of_shapes(&shapes, weight), expected, "{weight}");
        }
        assert_eq!(weights_of_shapes(&shapes[1..], 1.5), [1.5]);
        assert!(weights_of_shapes(&[], 1.0).is_empty());
    }
}
