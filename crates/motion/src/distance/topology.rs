//! Triangles by their corners, with the normals of faces, edges and vertices.

use std::collections::HashMap;

use glam::Vec3;

/// A surface without degenerate triangles. Vertices in one place count as one.
#[derive(Clone, Debug, Default)]
pub(super) struct Topology {
    pub(super) corners: Vec<[Vec3; 3]>,
    pub(super) face_normals: Vec<Vec3>,
    /// Sum of the normals of the two faces at each edge.
    pub(super) edge_normals: Vec<[Vec3; 3]>,
    /// Angle-weighted normals at each corner.
    pub(super) vertex_normals: Vec<[Vec3; 3]>,
}

impl Topology {
    pub(super) fn new(positions: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let mut ids: HashMap<[u32; 3], u32> = HashMap::new();
        let welded: Vec<u32> = positions
            .iter()
            .map(|p| {
                let next = ids.len() as u32;
                *ids.entry((*p + 0.0).to_array().map(f32::to_bits)).or_insert(next)
            })
            .collect();
        let mut topology = Self::default();
        let mut kept = Vec::new();
        for triangle in triangles {
            let corners = triangle.map(|v| positions[v as usize]);
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            if let Some(normal) = normal.try_normalize() {
                topology.corners.push(corners);
                topology.face_normals.push(normal);
                kept.push(triangle.map(|v| welded[v as usize]));
            }
        }
        let mut at_vertex = vec![Vec3::ZERO; ids.len()];
        let mut at_edge: HashMap<(u32, u32), Vec3> = HashMap::with_capacity(kept.len() * 3 / 2);
        let edge = |ids: &[u32; 3], k: usize| {
            let (a, b) = (ids[k], ids[(k + 1) % 3]);
            (a.min(b), a.max(b))
        };
        for ((ids, corners), &normal) in kept.iter().zip(&topology.corners).zip(&topology.face_normals) {
            for k in 0..3 {
                let (to_next, to_last) =
                    (corners[(k + 1) % 3] - corners[k], corners[(k + 2) % 3] - corners[k]);
                let angle = to_next.cross(to_last).length().atan2(to_next.dot(to_last));
                at_vertex[ids[k] as usize] += normal * angle;
                *at_edge.entry(edge(ids, k)).or_default() += normal;
            }
        }
        topology.edge_normals = kept.iter().map(|ids| [0, 1, 2].map(|k| at_edge[&edge(ids, k)])).collect();
        topology.vertex_normals = kept.iter().map(|ids| ids.map(|v| at_vertex[v as usize])).collect();
        topology
    }
}
