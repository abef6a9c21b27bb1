//! Isotropic remeshing with edge lengths from a function of position: split long edges, collapse short ones, flip edges toward
//! valence six, relax vertices along the surface, and project them back (Botsch and Kobbelt 2004).
//!
//! A pass never touches the neighbourhood of a change that it made, so its lists stay valid. The result depends only on the
//! order of edges: equal input gives equal output.

use std::collections::BTreeMap;

use glam::Vec3;
use rayon::prelude::*;

use super::mesh::{TriMesh, gradient, project};

/// A function of position.
type Field<'a, T> = &'a (dyn Fn(Vec3) -> T + Sync);

/// Remeshes the zero set of `distance` so that edges have the lengths of `edge_length`, in metres.
pub(super) fn remesh(mesh: &mut TriMesh, distance: Field<f32>, edge_length: Field<f32>, rounds: usize) {
    for round in 0..rounds {
        if round < rounds - 1 {
            while split(mesh, edge_length) > mesh.triangles.len() / 50 {}
            mesh.positions.par_iter_mut().for_each(|p| *p = project(distance, *p));
            for _ in 0..6 {
                if collapse(mesh, edge_length) == 0 {
                    break;
                }
            }
        }
        for _ in 0..3 {
            if flip(mesh) == 0 {
                break;
            }
        }
        for _ in 0..3 {
            relax(mesh, distance, edge_length);
        }
    }
}

/// Undirected edges with the two triangles at each, in order of their ends.
fn edges(mesh: &TriMesh) -> Vec<([u32; 2], [u32; 2])> {
    let mut half: Vec<(u32, u32, u32)> = Vec::with_capacity(mesh.triangles.len() * 3);
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        for i in 0..3 {
            let (a, b) = (triangle[i], triangle[(i + 1) % 3]);
            half.push((a.min(b), a.max(b), t as u32));
        }
    }
    half.sort_unstable();
    half.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1))
        .filter(|pair| pair.len() == 2)
        .map(|pair| ([pair[0].0, pair[0].1], [pair[0].2, pair[1].2]))
        .collect()
}

/// Splits every edge longer than 4/3 of its desired length. Triangles are divided depending on how many of their edges are split.
fn split(mesh: &mut TriMesh, edge_length: Field<f32>) -> usize {
    let mut middle_of: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    for (edge, _) in edges(mesh) {
        let [a, b] = edge.map(|v| mesh.positions[v as usize]);
        let middle = 0.5 * (a + b);
        let wanted = 4.0 / 3.0 * edge_length(middle);
        if a.distance_squared(b) > wanted * wanted {
            middle_of.insert(edge, mesh.positions.len() as u32);
            mesh.positions.push(middle);
        }
    }
    let mut out = Vec::with_capacity(mesh.triangles.len() * 2);
    for &triangle in &mesh.triangles {
        let cut: [Option<u32>; 3] = std::array::from_fn(|i| {
            let (a, b) = (triangle[i], triangle[(i + 1) % 3]);
            middle_of.get(&[a.min(b), a.max(b)]).copied()
        });
        // Rotated so that the first edge is split, and the last one is not if only two are.
        let first = match cut {
            [Some(_), _, None] | [Some(_), Some(_), Some(_)] => 0,
            [None, Some(_), _] => 1,
            [_, None, Some(_)] => 2,
            [None, None, None] => {
                out.push(triangle);
                continue;
            }
        };
        let [a, b, c] = std::array::from_fn(|i| triangle[(first + i) % 3]);
        let [ab, bc, ca] = std::array::from_fn(|i| cut[(first + i) % 3]);
        let Some(ab) = ab else { continue };
        match (bc, ca) {
            (Some(bc), Some(ca)) => out.extend([[a, ab, ca], [ab, b, bc], [bc, c, ca], [ab, bc, ca]]),
            (Some(bc), None) => {
                out.push([ab, b, bc]);
                let at = |v: u32| mesh.positions[v as usize];
                if at(ab).distance_squared(at(c)) < at(a).distance_squared(at(bc)) {
                    out.extend([[a, ab, c], [ab, bc, c]]);
                } else {
                    out.extend([[a, ab, bc], [a, bc, c]]);
                }
            }
            _ => out.extend([[a, ab, c], [ab, b, c]]),
        }
    }
    mesh.triangles = out;
    middle_of.len()
}

/// Triangles around each vertex.
fn fans(mesh: &TriMesh) -> Vec<Vec<u32>> {
    let mut fans = vec![Vec::new(); mesh.positions.len()];
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        for v in triangle {
            fans[*v as usize].push(t as u32);
        }
    }
    fans
}

/// Vertices next to `v`, in order of index.
fn ring(mesh: &TriMesh, fans: &[Vec<u32>], v: u32) -> Vec<u32> {
    let mut ring: Vec<u32> = fans[v as usize]
        .iter()
        .flat_map(|t| mesh.triangles[*t as usize])
        .filter(|other| *other != v)
        .collect();
    ring.sort_unstable();
    ring.dedup();
    ring
}

fn face_normal(corners: [Vec3; 3]) -> Vec3 {
    (corners[1] - corners[0]).cross(corners[2] - corners[0])
}

/// Collapses every edge shorter than 4/5 of its desired length, shortest first, if the mesh stays a manifold, no edge becomes
/// too long and no triangle is flipped over.
fn collapse(mesh: &mut TriMesh, edge_length: Field<f32>) -> usize {
    let fans = fans(mesh);
    let mut short: Vec<(f32, [u32; 2])> = edges(mesh)
        .into_iter()
        .filter_map(|(edge, _)| {
            let [a, b] = edge.map(|v| mesh.positions[v as usize]);
            let ratio = a.distance(b) / edge_length(0.5 * (a + b));
            (ratio < 0.8).then_some((ratio, edge))
        })
        .collect();
    short.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
    let mut locked = vec![false; mesh.positions.len()];
    let mut target: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    let mut count = 0;
    for (_, [a, b]) in short {
        if locked[a as usize] || locked[b as usize] {
            continue;
        }
        let (ring_a, ring_b) = (ring(mesh, &fans, a), ring(mesh, &fans, b));
        if ring_a.iter().chain(&ring_b).any(|v| locked[*v as usize]) {
            continue;
        }
        let common = ring_a.iter().filter(|v| ring_b.binary_search(v).is_ok()).count();
        if common != 2 || ring_a.len() + ring_b.len() < 10 {
            continue;
        }
        let at = |v: u32| mesh.positions[v as usize];
        let middle = 0.5 * (at(a) + at(b));
        let too_long = ring_a.iter().chain(&ring_b).any(|v| {
            *v != a && *v != b && at(*v).distance(middle) > 4.0 / 3.0 * edge_length(0.5 * (at(*v) + middle))
        });
        let turned = fans[a as usize].iter().chain(&fans[b as usize]).any(|t| {
            let triangle = mesh.triangles[*t as usize];
            if triangle.contains(&a) && triangle.contains(&b) {
                return false;
            }
            let moved = triangle.map(|v| if v == a || v == b { middle } else { at(v) });
            let (before, after) = (face_normal(triangle.map(at)), face_normal(moved));
            before.dot(after) < 0.5 * before.length() * after.length()
        });
        if too_long || turned {
            continue;
        }
        mesh.positions[a as usize] = middle;
        target[b as usize] = a;
        for v in ring_a.iter().chain(&ring_b) {
            locked[*v as usize] = true;
        }
        count += 1;
    }
    for triangle in &mut mesh.triangles {
        *triangle = triangle.map(|v| target[v as usize]);
    }
    mesh.triangles.retain(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]);
    compact(mesh);
    count
}

/// Removes unused vertices.
fn compact(mesh: &mut TriMesh) {
    let mut new_of = vec![u32::MAX; mesh.positions.len()];
    for v in mesh.triangles.iter().flatten() {
        new_of[*v as usize] = 0;
    }
    let mut next = 0;
    let old = std::mem::take(&mut mesh.positions);
    for (slot, position) in new_of.iter_mut().zip(old) {
        if *slot == 0 {
            *slot = next;
            next += 1;
            mesh.positions.push(position);
        }
    }
    for triangle in &mut mesh.triangles {
        *triangle = triangle.map(|v| new_of[v as usize]);
    }
}

/// Flips edges if that brings the four vertices around them nearer to six neighbours each.
fn flip(mesh: &mut TriMesh) -> usize {
    let fans = fans(mesh);
    let mut locked = vec![false; mesh.positions.len()];
    let mut count = 0;
    for ([a, b], [s, t]) in edges(mesh) {
        let opposite =
            |triangle: u32| mesh.triangles[triangle as usize].into_iter().find(|v| *v != a && *v != b);
        let (Some(c), Some(d)) = (opposite(s), opposite(t)) else { continue };
        if [a, b, c, d].iter().any(|v| locked[*v as usize]) || c == d {
            continue;
        }
        let valence = |v: u32| fans[v as usize].len() as i32;
        let off = |change: [i32; 4]| -> i32 {
            [a, b, c, d].iter().zip(change).map(|(v, by)| (valence(*v) + by - 6).pow(2)).sum()
        };
        if off([-1, -1, 1, 1]) >= off([0; 4]) || ring(mesh, &fans, c).binary_search(&d).is_ok() {
            continue;
        }
        // Triangle `s` may run along the edge in either direction.
        let forward = {
            let triangle = mesh.triangles[s as usize];
            (0..3).any(|i| triangle[i] == a && triangle[(i + 1) % 3] == b)
        };
        let (c, d) = if forward { (c, d) } else { (d, c) };
        let at = |v: u32| mesh.positions[v as usize];
        let old = face_normal([a, b, c].map(at)).normalize_or_zero()
            + face_normal([b, a, d].map(at)).normalize_or_zero();
        let new = [[c, d, b], [d, c, a]];
        if new.iter().any(|tri| {
            let normal = face_normal(tri.map(at));
            normal.normalize_or_zero().dot(old) < 1.6
        }) {
            continue;
        }
        mesh.triangles[s as usize] = new[0];
        mesh.triangles[t as usize] = new[1];
        for v in [a, b, c, d] {
            locked[v as usize] = true;
        }
        count += 1;
    }
    count
}

/// Moves each vertex along the surface toward the mean of its neighbours, weighted by the desired size of triangles there, and
/// back onto the surface.
fn relax(mesh: &mut TriMesh, distance: Field<f32>, edge_length: Field<f32>) {
    let fans = fans(mesh);
    let old = mesh.positions.clone();
    let shared: &TriMesh = mesh;
    let moved: Vec<Vec3> = (0..old.len())
        .into_par_iter()
        .map(|i| {
            let p = old[i];
            let (mut sum, mut total) = (Vec3::ZERO, 0.0);
            for t in &fans[i] {
                let corners = shared.triangles[*t as usize].map(|v| old[v as usize]);
                let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
                let size = edge_length(middle);
                let weight = face_normal(corners).length() / (size * size * size);
                sum += middle * weight;
                total += weight;
            }
            if total <= 0.0 {
                return p;
            }
            let normal = gradient(distance, p, 0.0006).normalize_or_zero();
            let step = sum / total - p;
            project(distance, p + 0.7 * (step - normal * step.dot(normal)))
        })
        .collect();
    mesh.positions = moved;
}
