//! Whether a surface is closed: then its back faces are hidden from outside and need not be drawn.

use std::sync::Arc;

use glam::Vec3;
use lovelock_motion::{Body, Mesh};
use rayon::prelude::*;

/// Caches the result for the last body.
#[derive(Clone, Debug, Default)]
pub(crate) struct Closedness {
    body: Option<Arc<Body>>,
    closed: bool,
}

impl Closedness {
    /// Whether the surface of the body is closed and faces outward.
    pub fn of(&mut self, body: &Arc<Body>) -> bool {
        if !self.body.as_ref().is_some_and(|old| Arc::ptr_eq(old, body)) {
            self.closed = is_closed(&body.mesh) && volume(&body.mesh) > 0.0;
            self.body = Some(Arc::clone(body));
        }
        self.closed
    }
}

/// Whether every edge has a triangle on each side, once in each direction.
fn is_closed(mesh: &Mesh) -> bool {
    let edges = mesh.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    let mut there: Vec<(u32, u32)> = edges.clone().collect();
    let mut back: Vec<(u32, u32)> = edges.map(|(a, b)| (b, a)).collect();
    there.sort_unstable();
    back.sort_unstable();
    !there.is_empty() && there == back && there.windows(2).all(|pair| pair[0] != pair[1])
}

/// Six times the volume that a closed surface encloses; negative if it faces inward.
fn volume(mesh: &Mesh) -> f64 {
    let at = |i: u32| mesh.positions.get(i as usize).copied().unwrap_or(Vec3::NAN).as_dvec3();
    mesh.triangles.iter().map(|&[a, b, c]| at(a).dot(at(b).cross(at(c)))).sum()
}

/// Whether `eye` lies inside a closed surface: the sum of the crossings of a ray toward +X, signed by their orientation.
pub(crate) fn encloses(eye: Vec3, positions: &[Vec3], triangles: &[[u32; 3]]) -> bool {
    let crossing = |triangle: &[u32; 3]| -> i32 {
        let [a, b, c] = triangle.map(|i| positions.get(i as usize).map_or(Vec3::NAN, |&p| p - eye));
        // Barycentric coordinates: where the ray passes through the triangle, all have the same sign.
        let side = |p: Vec3, q: Vec3| p.y * q.z - p.z * q.y;
        let (of_a, of_b, of_c) = (side(b, c), side(c, a), side(a, b));
        let front = of_a > 0.0 && of_b > 0.0 && of_c > 0.0;
        let back = of_a < 0.0 && of_b < 0.0 && of_c < 0.0;
        let ahead = (a.x * of_a + b.x * of_b + c.x * of_c) / (of_a + of_b + of_c) > 0.0;
        i32::from(front && ahead) - i32::from(back && ahead)
    };
    triangles.par_chunks(8192).map(|piece| piece.iter().map(crossing).sum::<i32>()).sum::<i32>() != 0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tetrahedron_is_closed_and_an_open_or_twisted_one_is_not() {
        let mut mesh =
            Mesh { triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], ..Mesh::default() };
        assert!(is_closed(&mesh));
        mesh.triangles[3] = [0, 2, 3];
        assert!(!is_closed(&mesh), "one turned round");
        mesh.triangles.truncate(3);
        assert!(!is_closed(&mesh), "one left out");
        assert!(!is_closed(&Mesh::default()));
    }

    #[test]
    fn inside_and_outside_of_a_tetrahedron() {
        let positions = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        let triangles = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        assert!(encloses(Vec3::splat(0.2), &positions, &triangles));
        for outside in
            [Vec3::splat(-0.2), Vec3::splat(0.5), Vec3::new(-1.0, 0.2, 0.2), Vec3::new(2.0, 0.2, 0.2)]
        {
            assert!(!encloses(outside, &positions, &triangles), "{outside}");
        }
        assert!(!encloses(Vec3::ZERO, &[], &[]));
        let mut mesh = Mesh { positions: positions.into(), triangles: triangles.into(), ..Mesh::default() };
        assert!((volume(&mesh) - 1.0).abs() < 1e-12);
        mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(0, 1));
        assert!(volume(&mesh) < 0.0, "inside out");
    }
}
