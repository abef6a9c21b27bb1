//! Vertices of a mesh whose faces have normals or materials of their own.

use std::collections::HashMap;

use glam::Vec3;

/// The vertices of a mesh, split where normals or materials of its faces differ, and its triangles between them.
#[derive(Default)]
pub(crate) struct Corners {
    /// Vertex of the file and material of each.
    pub(crate) vertices: Vec<(usize, u32)>,
    pub(crate) normals: Vec<Vec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
    known: HashMap<(usize, u32, [i16; 3]), u32>,
}

impl Corners {
    /// Number of the vertex of a corner of a face, which is added if it is new.
    pub(crate) fn corner(&mut self, vertex: usize, material: u32, normal: Vec3) -> u32 {
        // Steps of half a degree: exporters write the same normal with different rounding.
        let rounded = (normal * 127.0).round().to_array().map(|c| c as i16);
        *self.known.entry((vertex, material, rounded)).or_insert_with(|| {
            self.vertices.push((vertex, material));
            self.normals.push(normal);
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
