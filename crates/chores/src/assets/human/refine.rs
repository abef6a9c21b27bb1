//! One step of Catmull and Clark on a part of a mesh of quadrilaterals. Edges at the border of the part are only halved, and the
//! faces beside it get the new points as corners, so that no gap opens.

use std::collections::BTreeMap;

use glam::{Vec2, Vec3};

use super::source::Face;

/// A vertex as a mean of vertices of the base mesh with weights that sum to 1.
pub(super) type Stencil = Vec<(u32, f32)>;

/// A corner of a triangle: vertex and texture coordinates.
pub(super) type Corner = (u32, Vec2);

/// The refined mesh.
#[derive(Default)]
pub(super) struct Refined {
    /// The vertices.
    pub(super) stencils: Vec<Stencil>,
    /// Counter-clockwise triangles.
    pub(super) triangles: Vec<[Corner; 3]>,
}

impl Refined {
    /// A quantity at the refined vertices from that at the vertices of the base mesh.
    pub(super) fn values(&self, of: impl Fn(u32) -> Vec3) -> Vec<Vec3> {
        self.stencils.iter().map(|s| s.iter().map(|(v, w)| of(*v) * *w).sum()).collect()
    }
}

fn key(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

fn blend(parts: &[(&Stencil, f32)]) -> Stencil {
    let mut sum: BTreeMap<u32, f32> = BTreeMap::new();
    for (stencil, weight) in parts {
        for (v, w) in *stencil {
            *sum.entry(*v).or_default() += w * weight;
        }
    }
    sum.into_iter().collect()
}

/// Refines the faces that are `chosen`. `positions` decide along which diagonal quadrilaterals are cut.
pub(super) fn refine(faces: &[Face], chosen: &[bool], positions: &[Vec3], uv: &[Vec2]) -> Refined {
    let mut edges: BTreeMap<(u32, u32), Vec<usize>> = BTreeMap::new();
    let mut around: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (f, face) in faces.iter().enumerate() {
        for i in 0..4 {
            edges.entry(key(face.corners[i], face.corners[(i + 1) % 4])).or_default().push(f);
            around.entry(face.corners[i]).or_default().push(f);
        }
    }
    let point = |v: u32| -> Stencil { vec![(v, 1.0)] };
    let face_points: Vec<Stencil> =
        faces.iter().map(|face| face.corners.map(|v| (v, 0.25)).to_vec()).collect();
    let inside = |fs: &[usize], least: usize| fs.len() >= least && fs.iter().all(|f| chosen[*f]);
    let mut out = Refined::default();
    let mut add = |stencil: Stencil| {
        out.stencils.push(stencil);
        out.stencils.len() as u32 - 1
    };
    let mut vertex: BTreeMap<u32, u32> = BTreeMap::new();
    for (&v, fs) in &around {
        let n = fs.len() as f32;
        let spokes: Vec<u32> = fs
            .iter()
            .flat_map(|f| faces[*f].corners)
            .filter(|u| *u != v && edges.contains_key(&key(*u, v)))
            .collect();
        let stencil = if inside(fs, 3) {
            let own = point(v);
            let mut parts: Vec<(&Stencil, f32)> =
                fs.iter().map(|f| (&face_points[*f], 1.0 / (n * n))).collect();
            // Each spoke occurs twice among the corners of the faces around the vertex.
            let ends: Vec<Stencil> = spokes.iter().map(|u| vec![(*u, 0.5), (v, 0.5)]).collect();
            parts.extend(ends.iter().map(|s| (s, 2.0 / (n * ends.len() as f32))));
            parts.push((&own, (n - 3.0) / n));
            blend(&parts)
        } else {
            point(v)
        };
        vertex.insert(v, add(stencil));
    }
    let mut middle: BTreeMap<(u32, u32), u32> = BTreeMap::new();
    for (&(a, b), fs) in &edges {
        if !fs.iter().any(|f| chosen[*f]) {
            continue;
        }
        let half = vec![(a, 0.5), (b, 0.5)];
        let stencil = if inside(fs, 2) && fs.len() == 2 {
            blend(&[(&half, 0.5), (&face_points[fs[0]], 0.25), (&face_points[fs[1]], 0.25)])
        } else {
            half
        };
        middle.insert((a, b), add(stencil));
    }
    let centre: Vec<Option<u32>> =
        (0..faces.len()).map(|f| chosen[f].then(|| add(face_points[f].clone()))).collect();
    let places = out.values(|v| positions[v as usize]);
    let mut quad = |q: [Corner; 4]| {
        let at = |i: usize| places[q[i].0 as usize];
        let (first, second) = if at(0).distance_squared(at(2)) <= at(1).distance_squared(at(3)) {
            ([0, 1, 2], [0, 2, 3])
        } else {
            ([1, 2, 3], [1, 3, 0])
        };
        out.triangles.extend([first, second].map(|t| t.map(|i| q[i])));
    };
    let mut fans: Vec<[Corner; 3]> = Vec::new();
    for (f, face) in faces.iter().enumerate() {
        let corner = |i: usize| (vertex[&face.corners[i % 4]], uv[face.uv[i % 4] as usize]);
        let half = |i: usize| {
            let at = middle.get(&key(face.corners[i % 4], face.corners[(i + 1) % 4]))?;
            Some((*at, 0.5 * (uv[face.uv[i % 4] as usize] + uv[face.uv[(i + 1) % 4] as usize])))
        };
        if let Some(c) = centre[f] {
            let c = (c, face.uv.iter().map(|i| uv[*i as usize]).sum::<Vec2>() * 0.25);
            for i in 0..4 {
                if let (Some(after), Some(before)) = (half(i), half(i + 3)) {
                    quad([corner(i), after, c, before]);
                }
            }
            continue;
        }
        let ring: Vec<(Corner, bool)> =
            (0..4).flat_map(|i| [Some((corner(i), false)), half(i).map(|m| (m, true))]).flatten().collect();
        match ring.iter().position(|(_, is_half)| *is_half) {
            None => quad([0, 1, 2, 3].map(|i| ring[i].0)),
            Some(first) => {
                let at = |k: usize| ring[(first + k) % ring.len()].0;
                fans.extend((1..ring.len() - 1).map(|k| [at(0), at(k), at(k + 1)]));
            }
        }
    }
    out.triangles.extend(fans);
    out
}
