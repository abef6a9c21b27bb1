//! Edge loops along the borders of clothes.
//!
//! Colours are per vertex, so a border that passes through triangles is smeared over them, and shows their corners as
//! teeth. Here triangles are cut along the border first, so that edges follow it. Then the border becomes two loops, one for
//! the cloth and one for the skin, joined by a strip of triangles half a millimetre wide, in which the colour changes. The
//! surface stays closed.

use std::collections::BTreeMap;

use glam::Vec3;

use super::mesh::{TriMesh, gradient, project};
use super::remesh::{divide, edges};

/// A function of position.
type Field<'a> = &'a (dyn Fn(Vec3) -> f32 + Sync);

/// Width of the strip in which the colour changes, metres.
const STRIP: f32 = 0.0005;
/// Distance from the border within which a vertex counts as on it, metres.
const ON_BORDER: f32 = 0.000_15;
/// Distance from the border within which a vertex is moved onto it, metres.
const NEAR_BORDER: f32 = 0.0009;
/// Value of a border's function beyond which a change of its sign is not the border but the end of its domain, metres.
const NOT_BORDER: f32 = 0.012;
/// Distance from the border of the place whose colour a vertex on it has, metres: beyond the fade of the painted colour.
const BESIDE: f32 = 0.0012;

/// Cuts the triangles of `mesh` along the zero sets of `borders` and doubles the vertices there. Returns the place whose
/// colour each vertex has: its position, or for vertices of a border one that is clearly on their side of it.
pub(super) fn cut(mesh: &mut TriMesh, distance: Field, borders: &[fn(Vec3) -> f32]) -> Vec<Vec3> {
    let mut beside = BTreeMap::new();
    for border in borders {
        divide_along(mesh, distance, border);
        beside.extend(double(mesh, distance, border));
    }
    (0..mesh.positions.len()).map(|v| beside.get(&(v as u32)).copied().unwrap_or(mesh.positions[v])).collect()
}

/// Direction along the surface in which `border` rises, and its slope.
fn slope(distance: Field, border: Field, p: Vec3) -> Vec3 {
    let normal = gradient(distance, p, 0.0006).normalize_or_zero();
    let slope = gradient(border, p, 0.0004);
    slope - normal * slope.dot(normal)
}

/// The place on the border nearest to a point of the surface close to it, by Newton steps.
fn onto(distance: Field, border: Field, start: Vec3) -> Vec3 {
    (0..4).fold(start, |at, _| {
        let rise = slope(distance, border, at);
        project(distance, at - rise * (border(at) / rise.length_squared().max(0.05)))
    })
}

/// Inserts vertices where edges cross the zero set of `border`, and divides triangles there.
fn divide_along(mesh: &mut TriMesh, distance: Field, border: Field) {
    // The strip must not reach beyond vertices of the skin, so those near the border are moved onto it.
    for p in mesh.positions.iter_mut().filter(|p| border(**p).abs() < NEAR_BORDER) {
        *p = onto(distance, border, *p);
    }
    let values: Vec<f32> = mesh.positions.iter().map(|p| border(*p)).collect();
    let mut middle_of = BTreeMap::new();
    for (edge, _) in edges(mesh) {
        let [a, b] = edge.map(|v| values[v as usize]);
        if a * b >= 0.0 || a.abs().min(b.abs()) < ON_BORDER || a.abs().max(b.abs()) > NOT_BORDER {
            continue;
        }
        let [from, to] = edge.map(|v| mesh.positions[v as usize]);
        let at = onto(distance, border, project(distance, from.lerp(to, a / (a - b))));
        middle_of.insert(edge, mesh.positions.len() as u32);
        mesh.positions.push(at);
    }
    divide(mesh, &middle_of);
}

/// Whether each triangle lies on the negative side of the border, given its function's value at each vertex. After the cut no
/// triangle reaches both sides. Slivers with all corners on the border count as cloth, so that none of them becomes an island.
fn sides(mesh: &TriMesh, values: &[f32]) -> Vec<bool> {
    let is_skin = |t: &[u32; 3]| {
        let at = t.map(|v| values[v as usize]);
        at.into_iter().fold(0.0_f32, |a, b| if b.abs() > a.abs() { b } else { a }) < -ON_BORDER
    };
    mesh.triangles.iter().map(is_skin).collect()
}

/// Gives the skin's side of the border vertices of its own, a strip's width away, and fills the strip with triangles. Returns
/// the places whose colour the vertices near the border have.
fn double(mesh: &mut TriMesh, distance: Field, border: Field) -> BTreeMap<u32, Vec3> {
    let values: Vec<f32> = mesh.positions.iter().map(|p| border(*p)).collect();
    let is_on = |v: u32| values[v as usize].abs() < ON_BORDER;
    let is_skin = sides(mesh, &values);
    let loops: Vec<([u32; 2], [u32; 2])> = edges(mesh)
        .into_iter()
        .filter(|([a, b], [s, t])| is_on(*a) && is_on(*b) && is_skin[*s as usize] != is_skin[*t as usize])
        .collect();
    let mut twin_of = BTreeMap::new();
    for v in loops.iter().flat_map(|(edge, _)| *edge) {
        if twin_of.contains_key(&v) {
            continue;
        }
        let at = mesh.positions[v as usize];
        let rise = slope(distance, border, at).normalize_or_zero();
        twin_of.insert(v, mesh.positions.len() as u32);
        mesh.positions.push(project(distance, at - rise * STRIP));
    }
    for ([a, b], [s, t]) in loops {
        let cloth = mesh.triangles[if is_skin[s as usize] { t } else { s } as usize];
        // The strip runs along the edge against the direction of the cloth's triangle.
        let forward = (0..3).any(|i| cloth[i] == a && cloth[(i + 1) % 3] == b);
        let [a, b] = if forward { [a, b] } else { [b, a] };
        mesh.triangles.extend([[b, a, twin_of[&a]], [b, twin_of[&a], twin_of[&b]]]);
    }
    let mut beside = BTreeMap::new();
    for (triangle, is_skin) in mesh.triangles.iter_mut().zip(is_skin) {
        if is_skin {
            *triangle = triangle.map(|v| twin_of.get(&v).copied().unwrap_or(v));
        }
        let side = if is_skin { -1.0 } else { 1.0 };
        for v in *triangle {
            let at = mesh.positions[v as usize];
            let value = border(at);
            if value * side < BESIDE && value.abs() < NOT_BORDER {
                let rise = slope(distance, border, at).normalize_or_zero();
                beside.insert(v, at + rise * (side * BESIDE - value));
            }
        }
    }
    beside
}
