//! Surface nets (Gibson 1998) over a curvilinear grid, and the projection of vertices onto the surface.

use glam::Vec3;
use rayon::prelude::*;

use super::sdf::smoothstep;

/// A closed triangle mesh; triangles are counter-clockwise seen from outside.
#[derive(Clone, Debug, Default)]
pub(super) struct TriMesh {
    /// Vertex positions, metres.
    pub(super) positions: Vec<Vec3>,
    /// Vertex indices.
    pub(super) triangles: Vec<[u32; 3]>,
}

/// Grid lines whose spacing shrinks toward the head and the hands. The lines along x and z converge above the
/// shoulders, so that the head gets fine cells without the torso paying for them.
struct Grid {
    xs: Vec<f32>,
    ys: Vec<f32>,
    zs: Vec<f32>,
}

/// Lines from `low` to `high` with the spacing given at each place.
fn lines(low: f32, high: f32, spacing: impl Fn(f32) -> f32) -> Vec<f32> {
    let mut out = vec![low];
    let mut at = low;
    while at < high {
        at += spacing(at);
        out.push(at);
    }
    out
}

impl Grid {
    fn new() -> Self {
        let half = lines(0.0, 0.74, |x| 0.0100 - 0.0050 * smoothstep(0.46, 0.52, x));
        let xs = half.iter().skip(1).rev().map(|x| -x).chain(half.iter().copied()).collect();
        let ys = lines(-0.03, 1.74, |y| {
            let hands = smoothstep(0.82, 0.86, y) * smoothstep(1.06, 1.02, y);
            let head = smoothstep(1.42, 1.47, y);
            0.0095 - 0.0042 * hands - 0.0065 * head
        });
        Self { xs, ys, zs: lines(-0.41, 0.41, |_| 0.0095) }
    }

    fn at(&self, i: usize, j: usize, k: usize) -> Vec3 {
        let y = self.ys[j];
        let head = smoothstep(1.39, 1.48, y);
        let scale = 1.0 - 0.70 * head;
        Vec3::new(self.xs[i] * scale, y, self.zs[k] * scale + 0.02)
    }
}

/// The zero set of `distance` as a mesh, one vertex a cell that it passes through.
pub(super) fn surface_nets(distance: &(dyn Fn(Vec3) -> f32 + Sync)) -> TriMesh {
    let grid = Grid::new();
    let (nx, ny, nz) = (grid.xs.len(), grid.ys.len(), grid.zs.len());
    let index = |i: usize, j: usize, k: usize| (j * nz + k) * nx + i;
    let values: Vec<f32> = (0..ny * nz)
        .into_par_iter()
        .flat_map_iter(|row| {
            let (j, k) = (row / nz, row % nz);
            let grid = &grid;
            // The distance bounds how far the surface is: points surely away from it copy their neighbour's.
            let mut free = 0.0_f32;
            let mut last = 0.0;
            let mut previous = grid.at(0, j, k);
            (0..nx).map(move |i| {
                let p = grid.at(i, j, k);
                free -= p.distance(previous);
                previous = p;
                if free <= 0.0 {
                    last = distance(p);
                    free = 0.5 * last.abs() - 0.02;
                }
                last
            })
        })
        .collect();

    let mut mesh = TriMesh::default();
    let mut vertex_of = vec![u32::MAX; values.len()];
    for j in 0..ny - 1 {
        for k in 0..nz - 1 {
            for i in 0..nx - 1 {
                let corner = |c: usize| (i + (c & 1), j + ((c >> 1) & 1), k + ((c >> 2) & 1));
                let value: [f32; 8] = std::array::from_fn(|c| {
                    let (i, j, k) = corner(c);
                    values[index(i, j, k)]
                });
                let inside = value.iter().filter(|v| **v < 0.0).count();
                if inside == 0 || inside == 8 {
                    continue;
                }
                let (mut sum, mut crossings) = (Vec3::ZERO, 0.0);
                for a in 0..8 {
                    for bit in [1, 2, 4] {
                        let b = a | bit;
                        if b == a || (value[a] < 0.0) == (value[b] < 0.0) {
                            continue;
                        }
                        let (pa, pb) = (corner(a), corner(b));
                        let t = value[a] / (value[a] - value[b]);
                        sum += grid.at(pa.0, pa.1, pa.2).lerp(grid.at(pb.0, pb.1, pb.2), t);
                        crossings += 1.0;
                    }
                }
                vertex_of[index(i, j, k)] = mesh.positions.len() as u32;
                mesh.positions.push(sum / crossings);
            }
        }
    }
    // A quad around each grid edge that crosses the surface.
    for j in 1..ny - 1 {
        for k in 1..nz - 1 {
            for i in 1..nx - 1 {
                let here = values[index(i, j, k)] < 0.0;
                let next = [index(i + 1, j, k), index(i, j + 1, k), index(i, j, k + 1)];
                // Cells around the edge, counter-clockwise seen from the edge's end.
                let around = [
                    [(0, 0, 0), (0, 1, 0), (0, 1, 1), (0, 0, 1)],
                    [(0, 0, 0), (0, 0, 1), (1, 0, 1), (1, 0, 0)],
                    [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)],
                ];
                for axis in 0..3 {
                    let there = values[next[axis]] < 0.0;
                    if here == there {
                        continue;
                    }
                    let mut quad = around[axis].map(|(a, b, c)| vertex_of[index(i - a, j - b, k - c)]);
                    if there {
                        quad.reverse();
                    }
                    let [a, b, c, d] = quad;
                    let at = |v: u32| mesh.positions[v as usize];
                    if at(a).distance_squared(at(c)) < at(b).distance_squared(at(d)) {
                        mesh.triangles.extend([[a, b, c], [a, c, d]]);
                    } else {
                        mesh.triangles.extend([[b, c, d], [b, d, a]]);
                    }
                }
            }
        }
    }
    mesh
}

/// Gradient of `distance` by central differences over `step` metres.
pub(super) fn gradient(distance: &(dyn Fn(Vec3) -> f32 + Sync), p: Vec3, step: f32) -> Vec3 {
    let d = |v: Vec3| distance(p + v * step) - distance(p - v * step);
    Vec3::new(d(Vec3::X), d(Vec3::Y), d(Vec3::Z)) / (2.0 * step)
}

/// The nearest point of the surface, by Newton steps of at most 4 mm.
pub(super) fn project(distance: &(dyn Fn(Vec3) -> f32 + Sync), start: Vec3) -> Vec3 {
    let mut p = start;
    for _ in 0..5 {
        let d = distance(p);
        if d.abs() < 1e-6 {
            break;
        }
        let g = gradient(distance, p, 0.0006);
        let step = g * (d / g.length_squared().max(0.05));
        p -= step.clamp_length_max(0.004);
    }
    p
}

/// Outward unit normals of the surface at `positions`.
pub(super) fn normals(distance: &(dyn Fn(Vec3) -> f32 + Sync), positions: &[Vec3]) -> Vec<Vec3> {
    positions.par_iter().map(|&p| gradient(distance, p, 0.0008).normalize_or(Vec3::Y)).collect()
}
