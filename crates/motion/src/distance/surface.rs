//! The triangles of a surface, and whether they enclose a volume.

use glam::Vec3;

/// Corners of the usable triangles: finite, and with an area.
pub(super) fn corners(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<[Vec3; 3]> {
    let corners = triangles.iter().filter_map(|&[a, b, c]| {
        let at = |v: u32| positions.get(v as usize).copied().filter(|p| p.is_finite());
        Some([at(a)?, at(b)?, at(c)?])
    });
    corners.filter(|&[a, b, c]| (b - a).cross(c - a).try_normalize().is_some()).collect()
}

/// Whether a surface has no border, that is, each edge occurs equally often in both directions. Corners at
/// the same position count as one, because seams of texture coordinates and normals split vertices. The
/// winding number of such a surface is an integer and changes only where the surface is crossed, even if the
/// surface intersects itself.
pub(super) fn is_closed(corners: &[[Vec3; 3]]) -> bool {
    let mut places: Vec<([u32; 3], u32)> = (corners.iter().flatten().zip(0..))
        .map(|(p, corner)| ((*p + 0.0).to_array().map(f32::to_bits), corner))
        .collect();
    places.sort_unstable();
    let mut vertices = vec![0_u32; places.len()];
    let mut vertex = 0;
    for (i, (place, corner)) in places.iter().enumerate() {
        vertex += u32::from(i > 0 && *place != places[i - 1].0);
        vertices[*corner as usize] = vertex;
    }
    let mut edges: Vec<(u32, u32, i8)> = (vertices.chunks_exact(3))
        .flat_map(|v| [(v[0], v[1]), (v[1], v[2]), (v[2], v[0])])
        .map(|(a, b)| (a.min(b), a.max(b), if a < b { 1 } else { -1 }))
        .collect();
    edges.sort_unstable();
    edges
        .chunk_by(|a, b| (a.0, a.1) == (b.0, b.1))
        .all(|edge| edge.iter().map(|(_, _, way)| i64::from(*way)).sum::<i64>() == 0)
}
