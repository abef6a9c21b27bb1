//! Surface nets (Gibson 1998) over a grid, and the projection of vertices onto the surface.

use std::collections::BTreeMap;

use glam::Vec3;
use rayon::prelude::*;

/// A closed triangle mesh; triangles are counter-clockwise seen from outside.
#[derive(Clone, Debug, Default)]
pub(super) struct TriMesh {
    /// Vertex positions, metres.
    pub(super) positions: Vec<Vec3>,
    /// Vertex indices.
    pub(super) triangles: Vec<[u32; 3]>,
}

/// The lines of a grid along each axis.
pub(super) struct Grid {
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
    /// A box from `low` to `high` with lines `spacing` metres apart.
    pub(super) fn even(low: Vec3, high: Vec3, spacing: f32) -> Self {
        let [xs, ys, zs] = [0, 1, 2].map(|axis| lines(low[axis], high[axis], |_| spacing));
        Self { xs, ys, zs }
    }

    fn at(&self, i: usize, j: usize, k: usize) -> Vec3 {
        Vec3::new(self.xs[i], self.ys[j], self.zs[k])
    }
}

/// The zero set of `distance` as a mesh, one vertex for each sheet of it in a cell.
pub(super) fn surface_nets(grid: &Grid, distance: &(dyn Fn(Vec3) -> f32 + Sync)) -> TriMesh {
    let (nx, ny, nz) = (grid.xs.len(), grid.ys.len(), grid.zs.len());
    let index = |i: usize, j: usize, k: usize| (j * nz + k) * nx + i;
    let values: Vec<f32> = (0..ny * nz)
        .into_par_iter()
        .flat_map_iter(|row| {
            let (j, k) = (row / nz, row % nz);
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
    let mut vertices = CellVertices { first: vec![u32::MAX; values.len()], split: BTreeMap::new() };
    for j in 0..ny - 1 {
        for k in 0..nz - 1 {
            for i in 0..nx - 1 {
                let corner = |c: usize| (i + (c & 1), j + ((c >> 1) & 1), k + ((c >> 2) & 1));
                let value: [f32; 8] = std::array::from_fn(|c| {
                    let (i, j, k) = corner(c);
                    values[index(i, j, k)]
                });
                let inside = value.map(|v| v < 0.0);
                if inside == [false; 8] || inside == [true; 8] {
                    continue;
                }
                let (sheet, count) = sheets(inside);
                let mut sums = [(Vec3::ZERO, 0.0); 4];
                for (edge, (a, b)) in CELL_EDGES.into_iter().enumerate() {
                    if inside[a] != inside[b] {
                        let (pa, pb) = (corner(a), corner(b));
                        let t = value[a] / (value[a] - value[b]);
                        let crossing = grid.at(pa.0, pa.1, pa.2).lerp(grid.at(pb.0, pb.1, pb.2), t);
                        let sum = &mut sums[usize::from(sheet[edge])];
                        *sum = (sum.0 + crossing, sum.1 + 1.0);
                    }
                }
                vertices.first[index(i, j, k)] = mesh.positions.len() as u32;
                if count > 1 {
                    vertices.split.insert(index(i, j, k), sheet);
                }
                mesh.positions.extend(sums[..count].iter().map(|(sum, crossings)| *sum / *crossings));
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
                    let mut quad = around[axis].map(|(a, b, c)| {
                        // The grid edge starts at this corner of the cell.
                        let start = a + 2 * b + 4 * c;
                        vertices.at(index(i - a, j - b, k - c), (start, start | (1 << axis)))
                    });
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

/// The edges of a cell by their corners; bit 0 of a corner is x, bit 1 y, bit 2 z.
const CELL_EDGES: [(usize, usize); 12] =
    [(0, 1), (2, 3), (4, 5), (6, 7), (0, 2), (1, 3), (4, 6), (5, 7), (0, 4), (1, 5), (2, 6), (3, 7)];

/// The corners of a cell's faces, in turn around each.
const CELL_FACES: [[usize; 4]; 6] =
    [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];

/// Index of the edge between two corners of a cell.
fn cell_edge(a: usize, b: usize) -> usize {
    CELL_EDGES.iter().position(|edge| *edge == (a.min(b), a.max(b))).unwrap_or(0)
}

/// Which sheet of the surface crosses each edge of a cell, and how many sheets there are (Nielson 2004): each gets a
/// vertex of its own, so that thin gaps do not weld. On a face with two inside corners across, these stay apart.
fn sheets(inside: [bool; 8]) -> ([u8; 12], usize) {
    let mut label: [usize; 12] = std::array::from_fn(|edge| edge);
    let mut join = |a: usize, b: usize| {
        let (keep, drop) = (label[a].min(label[b]), label[a].max(label[b]));
        for entry in &mut label {
            if *entry == drop {
                *entry = keep;
            }
        }
    };
    for face in CELL_FACES {
        let edge = |i: usize| cell_edge(face[i % 4], face[(i + 1) % 4]);
        let crossed: Vec<usize> = (0..4).filter(|i| inside[face[*i]] != inside[face[(*i + 1) % 4]]).collect();
        match crossed[..] {
            [a, b] => join(edge(a), edge(b)),
            [_, _, _, _] => (0..4).filter(|i| inside[face[*i]]).for_each(|i| join(edge(i + 3), edge(i))),
            _ => {}
        }
    }
    let mut sheet = [0; 12];
    let mut roots: Vec<usize> = Vec::new();
    for (edge, (a, b)) in CELL_EDGES.into_iter().enumerate() {
        if inside[a] == inside[b] {
            continue;
        }
        let at = roots.iter().position(|root| *root == label[edge]).unwrap_or_else(|| {
            roots.push(label[edge]);
            roots.len() - 1
        });
        sheet[edge] = at as u8;
    }
    (sheet, roots.len())
}

/// The vertices of the cells.
struct CellVertices {
    /// The first vertex of each cell.
    first: Vec<u32>,
    /// The sheet at each edge, of the cells with more than one.
    split: BTreeMap<usize, [u8; 12]>,
}

impl CellVertices {
    /// The vertex of the sheet that crosses an edge of a cell.
    fn at(&self, cell: usize, edge: (usize, usize)) -> u32 {
        let sheet = self.split.get(&cell).map_or(0, |sheet| sheet[cell_edge(edge.0, edge.1)]);
        self.first[cell] + u32::from(sheet)
    }
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
