//! Garments: the skin moved outward and smoothed, cut along a smooth line, with a turned hem.

use std::collections::BTreeMap;

use glam::{Vec2, Vec3};
use lovelock_base::numbers::smoothstep;

use super::surface::{MORPHS, Surface, Vertex};

/// A function of position that is positive inside the cloth: about the distance to its edge, metres.
pub(super) type Cut<'a> = &'a dyn Fn(Vec3) -> f32;

/// How far the turned hem goes back below the cloth, and how far its fold stands out, metres.
const TURNED: f32 = 0.005;
const FOLD: f32 = 0.0011;
/// A vertex nearer to the line than this, relative to its shortest edge, is moved onto it.
const SNAP: f32 = 0.28;

/// A garment `thickness` metres outside of the skin.
pub(super) fn make(skin: &Surface, cut: Cut, thickness: f32) -> Surface {
    let near: Vec<bool> = skin.vertices.iter().map(|v| cut(v.place) > -0.035).collect();
    let mut cloth = skin.part(|t| t.iter().any(|v| near[*v as usize]));
    let mut inside: Vec<f32> = cloth.vertices.iter().map(|v| cut(v.place)).collect();
    snap(&mut cloth, &mut inside, cut);
    let outward: Vec<Vec3> = cloth.vertices.iter().map(|v| v.normal).collect();
    let height = heights(&cloth, &inside);
    for ((vertex, normal), height) in cloth.vertices.iter_mut().zip(&outward).zip(&height) {
        vertex.place += *normal * (thickness + height);
        vertex.grows = [0.0; 4];
        vertex.moves = [Vec3::ZERO; MORPHS.len()];
    }
    cloth.update_normals();
    let mut cloth = clip(&cloth, &inside);
    hem(&mut cloth, cut, thickness);
    cloth
}

/// Moves vertices that are close to the line onto it, so that no slivers are cut. They get the weights of the place that they are moved to:
/// with their own, the line would be uneven in other poses.
fn snap(cloth: &mut Surface, inside: &mut [f32], cut: Cut) {
    let neighbours = cloth.neighbours();
    let before = cloth.vertices.clone();
    let places: Vec<Vec3> = before.iter().map(|v| v.place).collect();
    let mut around = vec![Vec::new(); before.len()];
    for (t, triangle) in cloth.triangles.iter().enumerate() {
        for v in triangle {
            around[*v as usize].push(t);
        }
    }
    for (v, ring) in neighbours.iter().enumerate() {
        let shortest = ring.iter().map(|u| places[*u as usize].distance(places[v])).fold(f32::MAX, f32::min);
        if inside[v].abs() > SNAP * shortest {
            continue;
        }
        let vertex = &mut cloth.vertices[v];
        for _ in 0..3 {
            let slope = tangent_slope(cut, vertex.place, vertex.normal);
            let step = slope * (cut(vertex.place) / slope.length_squared().max(0.05));
            vertex.place -= step.clamp_length_max(SNAP * shortest);
        }
        inside[v] = 0.0;
        let at = around[v].iter().map(|t| {
            let triangle = cloth.triangles[*t];
            (triangle, shares(triangle.map(|v| places[v as usize]), vertex.place))
        });
        let best = at.max_by(|(_, a), (_, b)| least(a).total_cmp(&least(b)));
        if let Some((triangle, share)) = best {
            let share = share.map(|s| s.max(0.0));
            let total: f32 = share.iter().sum();
            let corners = triangle.map(|v| &before[v as usize].weights);
            vertex.weights =
                std::array::from_fn(|j| (0..3).map(|k| corners[k][j] * share[k]).sum::<f32>() / total);
        }
    }
}

/// The smallest of three numbers.
fn least(of: &[f32; 3]) -> f32 {
    of.iter().copied().fold(f32::MAX, f32::min)
}

/// Barycentric coordinates of a point in a triangle, or beside it, in its plane.
fn shares([a, b, c]: [Vec3; 3], p: Vec3) -> [f32; 3] {
    let normal = (b - a).cross(c - a);
    let part =
        |from: Vec3, to: Vec3| (to - from).cross(p - from).dot(normal) / normal.length_squared().max(1e-20);
    [part(b, c), part(c, a), part(a, b)]
}

/// The gradient of the cut along the surface.
fn tangent_slope(cut: Cut, p: Vec3, normal: Vec3) -> Vec3 {
    let d = |v: Vec3| cut(p + v * 0.001) - cut(p - v * 0.001);
    let slope = Vec3::new(d(Vec3::X), d(Vec3::Y), d(Vec3::Z)) / 0.002;
    slope - normal * slope.dot(normal)
}

/// How far the cloth stands off the skin beyond its thickness: it bridges hollows and leaves small forms out; at its edge it lies on.
fn heights(cloth: &Surface, inside: &[f32]) -> Vec<f32> {
    let neighbours = cloth.neighbours();
    let places: Vec<Vec3> = cloth.vertices.iter().map(|v| v.place).collect();
    let smoothed = |rounds: usize, back: f32| {
        let mut now = places.clone();
        for round in 0..rounds {
            // Every second step swells what the first one shrank (Taubin 1995).
            let factor = if round % 2 == 1 { back } else { 0.5 };
            let before = now.clone();
            for (v, ring) in neighbours.iter().enumerate() {
                let mean = ring.iter().map(|u| before[*u as usize]).sum::<Vec3>() / ring.len().max(1) as f32;
                now[v] = before[v] + (mean - before[v]) * factor;
            }
        }
        now
    };
    let (even, bridged) = (smoothed(160, -0.51), smoothed(30, 0.5));
    (0..places.len())
        .map(|v| {
            let along = |p: Vec3| (p - places[v]).dot(cloth.vertices[v].normal);
            let free = smoothstep(0.012, 0.045, inside[v]);
            free * along(even[v]).clamp(-0.014, 0.016).max(along(bridged[v]).clamp(-0.020, 0.016))
        })
        .collect()
}

/// The part of a surface where `inside` is not negative; triangles across the line are cut.
fn clip(cloth: &Surface, inside: &[f32]) -> Surface {
    let mut out = Surface { vertices: cloth.vertices.clone(), ..Surface::default() };
    let mut cuts: BTreeMap<(u32, u32), u32> = BTreeMap::new();
    for (t, uv) in cloth.triangles.iter().zip(&cloth.uv) {
        let value = t.map(|v| inside[v as usize]);
        if value.iter().all(|x| *x <= 0.0) {
            continue;
        }
        let mut ring: Vec<(u32, Vec2)> = Vec::new();
        for i in 0..3 {
            let j = (i + 1) % 3;
            if value[i] >= 0.0 {
                ring.push((t[i], uv[i]));
            }
            if (value[i] > 0.0 && value[j] < 0.0) || (value[i] < 0.0 && value[j] > 0.0) {
                let (a, b) = (t[i].min(t[j]), t[i].max(t[j]));
                let share = inside[a as usize] / (inside[a as usize] - inside[b as usize]);
                let vertex = *cuts.entry((a, b)).or_insert_with(|| {
                    let mixed = out.vertices[a as usize].mix(&out.vertices[b as usize], share);
                    out.vertices.push(mixed);
                    out.vertices.len() as u32 - 1
                });
                let t = value[i] / (value[i] - value[j]);
                ring.push((vertex, uv[i].lerp(uv[j], t)));
            }
        }
        for k in 1..ring.len().saturating_sub(1) {
            let corners = [ring[0], ring[k], ring[k + 1]];
            out.triangles.push(corners.map(|c| c.0));
            out.uv.push(corners.map(|c| c.1));
        }
    }
    out.part(|_| true)
}

/// Adds the fold of the hem and its turned part along every edge.
fn hem(cloth: &mut Surface, cut: Cut, thickness: f32) {
    let mut edges: BTreeMap<(u32, u32), (usize, usize)> = BTreeMap::new();
    for (t, triangle) in cloth.triangles.iter().enumerate() {
        for i in 0..3 {
            edges.insert((triangle[i], triangle[(i + 1) % 3]), (t, i));
        }
    }
    let border: Vec<((u32, u32), (usize, usize))> =
        edges.iter().filter(|((a, b), _)| !edges.contains_key(&(*b, *a))).map(|(e, at)| (*e, *at)).collect();
    let mut folded: BTreeMap<u32, [u32; 2]> = BTreeMap::new();
    for ((a, b), (t, i)) in border {
        let mut fold = |v: u32| {
            *folded.entry(v).or_insert_with(|| {
                let vertex = cloth.vertices[v as usize].clone();
                let (place, normal) = (vertex.place, vertex.normal);
                let out = -tangent_slope(cut, place, normal).normalize_or_zero();
                let mut add = |place: Vec3, normal: Vec3| {
                    cloth.vertices.push(Vertex { place, normal: normal.normalize_or(out), ..vertex.clone() });
                    cloth.vertices.len() as u32 - 1
                };
                let edge = add(place + out * FOLD - normal * (0.5 * thickness), out + 0.2 * normal);
                let back = add(place - out * TURNED - normal * (thickness - 0.0003), out - normal);
                [edge, back]
            })
        };
        let ([edge_a, back_a], [edge_b, back_b]) = (fold(a), fold(b));
        let (uv_a, uv_b) = (cloth.uv[t][i], cloth.uv[t][(i + 1) % 3]);
        for [p, q, r, s] in [[a, b, edge_b, edge_a], [edge_a, edge_b, back_b, back_a]] {
            cloth.triangles.extend([[q, p, s], [q, s, r]]);
            cloth.uv.extend([[uv_b, uv_a, uv_a], [uv_b, uv_a, uv_b]]);
        }
    }
}
