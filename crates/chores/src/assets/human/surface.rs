//! Surfaces whose vertices carry all that the file says about them.

use std::collections::BTreeMap;

use glam::{Vec2, Vec3};

/// Joints of the skeleton.
pub(super) const JOINTS: usize = 28;
/// Morph targets of the face, by the preset names of VRM. The last one keeps lids that are half closed outside of the eyeball.
pub(super) const MORPHS: [&str; 6] = ["blink", "lookLeft", "lookRight", "lookUp", "lookDown", "blinkHalf"];

/// A vertex.
#[derive(Clone, Debug)]
pub(super) struct Vertex {
    /// Rest position, metres.
    pub(super) place: Vec3,
    /// Unit normal.
    pub(super) normal: Vec3,
    /// Texture coordinates, v down as in glTF.
    pub(super) uv: Vec2,
    /// Weight of each joint.
    pub(super) weights: [f32; JOINTS],
    /// What each morph target moves it by, metres.
    pub(super) moves: [Vec3; MORPHS.len()],
    /// 1 where hair, brows, upper and lower lashes grow.
    pub(super) grows: [f32; 4],
    /// Share of light from all directions that gets here.
    pub(super) open: f32,
}

impl Vertex {
    /// A vertex at a place, with nothing else.
    pub(super) fn at(place: Vec3, normal: Vec3) -> Self {
        Self {
            place,
            normal,
            uv: Vec2::ZERO,
            weights: [0.0; JOINTS],
            moves: [Vec3::ZERO; MORPHS.len()],
            grows: [0.0; 4],
            open: 1.0,
        }
    }

    /// The vertex a fraction `t` of the way to another one.
    pub(super) fn mix(&self, other: &Self, t: f32) -> Self {
        let f = |a: f32, b: f32| a + (b - a) * t;
        Self {
            place: self.place.lerp(other.place, t),
            normal: self.normal.lerp(other.normal, t).normalize_or(self.normal),
            uv: self.uv.lerp(other.uv, t),
            weights: std::array::from_fn(|i| f(self.weights[i], other.weights[i])),
            moves: std::array::from_fn(|i| self.moves[i].lerp(other.moves[i], t)),
            grows: std::array::from_fn(|i| f(self.grows[i], other.grows[i])),
            open: f(self.open, other.open),
        }
    }
}

/// Triangles whose vertices are shared, apart from their texture coordinates, which each corner has.
#[derive(Clone, Default)]
pub(super) struct Surface {
    /// The vertices; their own texture coordinates mean nothing.
    pub(super) vertices: Vec<Vertex>,
    /// Vertices of each triangle, counter-clockwise.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Texture coordinates of each corner.
    pub(super) uv: Vec<[Vec2; 3]>,
}

impl Surface {
    /// The normals from the triangles, weighted by their angles.
    pub(super) fn update_normals(&mut self) {
        let places: Vec<Vec3> = self.vertices.iter().map(|v| v.place).collect();
        for (vertex, normal) in self.vertices.iter_mut().zip(normals(&places, &self.triangles)) {
            vertex.normal = normal;
        }
    }

    /// The neighbours of each vertex.
    pub(super) fn neighbours(&self) -> Vec<Vec<u32>> {
        let mut all = vec![Vec::new(); self.vertices.len()];
        for t in &self.triangles {
            for i in 0..3 {
                all[t[i] as usize].extend([t[(i + 1) % 3], t[(i + 2) % 3]]);
            }
        }
        for list in &mut all {
            list.sort_unstable();
            list.dedup();
        }
        all
    }

    /// The triangles that pass a test, with the vertices that they use.
    pub(super) fn part(&self, keep: impl Fn([u32; 3]) -> bool) -> Self {
        let mut out = Self::default();
        let mut slot = vec![u32::MAX; self.vertices.len()];
        for (t, uv) in self.triangles.iter().zip(&self.uv).filter(|(t, _)| keep(**t)) {
            out.triangles.push(t.map(|v| {
                if slot[v as usize] == u32::MAX {
                    slot[v as usize] = out.vertices.len() as u32;
                    out.vertices.push(self.vertices[v as usize].clone());
                }
                slot[v as usize]
            }));
            out.uv.push(*uv);
        }
        out
    }

    /// The surface with a vertex for each pair of a vertex and its texture coordinates, as files have them.
    pub(super) fn split(&self) -> (Vec<Vertex>, Vec<[u32; 3]>) {
        let mut slot: BTreeMap<(u32, [i32; 2]), u32> = BTreeMap::new();
        let mut vertices: Vec<Vertex> = Vec::new();
        let triangles = self.triangles.iter().zip(&self.uv).map(|(t, uv)| {
            [0, 1, 2].map(|i| {
                let fine = (uv[i] * 65536.0).round().as_ivec2().to_array();
                *slot.entry((t[i], fine)).or_insert_with(|| {
                    vertices.push(Vertex { uv: uv[i], ..self.vertices[t[i] as usize].clone() });
                    vertices.len() as u32 - 1
                })
            })
        });
        let triangles: Vec<[u32; 3]> = triangles.collect();
        (vertices, triangles)
    }
}

/// Unit normals at the vertices, weighted by the angles of the triangles.
pub(super) fn normals(places: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut sums = vec![Vec3::ZERO; places.len()];
    for t in triangles {
        let [a, b, c] = t.map(|v| places[v as usize]);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        for (i, (p, q, r)) in [(a, b, c), (b, c, a), (c, a, b)].into_iter().enumerate() {
            sums[t[i] as usize] += normal * (q - p).angle_between(r - p).max(0.0);
        }
    }
    sums.into_iter().map(|n| n.normalize_or(Vec3::Y)).collect()
}
