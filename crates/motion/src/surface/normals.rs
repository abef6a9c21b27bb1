//! Smooth normals for surfaces without normals.

use std::collections::HashMap;

use glam::Vec3;

/// Computes a normal for every vertex from `first` on that has none (zero): the mean of its triangles'
/// normals weighted by their angles there (Thürmer and Wüthrich 1998). Vertices at the same position share
/// it, so that seams are invisible.
pub(super) fn fill_normals(positions: &[Vec3], triangles: &[[u32; 3]], first: usize, normals: &mut [Vec3]) {
    if normals[first..].iter().all(|n| *n != Vec3::ZERO) {
        return;
    }
    let key = |p: Vec3| (p + 0.0).to_array().map(f32::to_bits);
    let mut sums: HashMap<[u32; 3], Vec3> = HashMap::with_capacity(positions.len() - first);
    for triangle in triangles {
        let p = triangle.map(|v| positions[v as usize]);
        let face = (p[1] - p[0]).cross(p[2] - p[0]).normalize_or_zero();
        for k in 0..3 {
            let (to_next, to_last) = (p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
            let angle = to_next.cross(to_last).length().atan2(to_next.dot(to_last));
            *sums.entry(key(p[k])).or_default() += face * angle;
        }
    }
    for v in first..normals.len() {
        if normals[v] == Vec3::ZERO {
            normals[v] = sums.get(&key(positions[v])).map_or(Vec3::Y, |sum| sum.normalize_or(Vec3::Y));
        }
    }
}
