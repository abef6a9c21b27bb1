//! Vertices of a mesh whose faces have normals, materials or texture coordinates of their own.

use std::collections::HashMap;

use glam::{Vec2, Vec3};

/// What a corner of a face has of its own: normal, material and texture coordinates.
type Own = (u32, [i16; 3], [u32; 4]);

/// The vertices of a mesh, split where normals, materials or texture coordinates of its faces differ, and its triangles between them.
#[derive(Default)]
pub(crate) struct Corners {
    /// Vertex of the file and material of each.
    pub(crate) vertices: Vec<(usize, u32)>,
    pub(crate) normals: Vec<Vec3>,
    pub(crate) coordinates: [Vec<Vec2>; 2],
    pub(crate) triangles: Vec<[u32; 3]>,
    known: HashMap<(usize, Own), u32>,
}

impl Corners {
    /// Number of the vertex of a corner of a face, which is added if it is new.
    pub(crate) fn corner(
        &mut self,
        vertex: usize,
        material: u32,
        normal: Vec3,
        coordinates: [Vec2; 2],
    ) -> u32 {
        // Steps of half a degree: exporters write the same normal with different rounding.
        let rounded = (normal * 127.0).round().to_array().map(|c| c as i16);
        let [a, b] = coordinates.map(|at| at.to_array().map(f32::to_bits));
        *self.known.entry((vertex, (material, rounded, [a[0], a[1], b[0], b[1]]))).or_insert_with(|| {
            self.vertices.push((vertex, material));
            self.normals.push(normal);
            for (list, at) in self.coordinates.iter_mut().zip(coordinates) {
                list.push(at);
            }
            self.vertices.len() as u32 - 1
        })
    }

    /// For each vertex of the file the vertices that it was split into.
    pub(crate) fn copies(&self, vertices: usize) -> Vec<Vec<u32>> {
        let mut copies: Vec<Vec<u32>> = vec![Vec::new(); vertices];
        for (copy, &(vertex, _)) in self.vertices.iter().enumerate() {
            if let Some(of_vertex) = copies.get_mut(vertex) {
                of_vertex.push(copy as u32);
            }
        }
        copies
    }
}
