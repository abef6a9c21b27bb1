//! The net of directions on the skin.

use glam::{Quat, Vec3};
use lovelock_base::numbers::smoothstep;
use rayon::prelude::*;

use super::skull::{Distance, Skull, surface};
use super::{ScalpFit, outline};
use crate::head::neck_joints;
use crate::{Body, HeadMesh};

/// Rows of the net from the crown down, and columns around. About 5 mm on the head of an adult.
const ROWS: usize = 58;
const COLUMNS: usize = 120;
/// The angle from the crown at which the net ends, radians.
const LOWEST: f32 = 2.6;
/// Skin farther from the middle than this, relative to the skull, belongs to something else.
const REACH: f32 = 1.55;
/// What is narrower than twice this angle and stands out of the head grows no hair, radians.
const OPENING: f32 = 0.22;
/// How far it stands out, relative to the skull: hair fades away between the two.
const STANDS_OUT: [f32; 2] = [0.16, 0.3];
/// Skin that faces down grows no hair: the heights of its normals between which hair fades away.
const BENEATH: [f32; 2] = [-0.85, -0.65];

/// The outline laid on the skin of a body; on the skull itself without a `distance`.
pub(super) fn fitted(body: &Body, skull: &Skull, fit: &ScalpFit, distance: Option<Distance<'_>>) -> HeadMesh {
    let directions = directions();
    // Distances from the middle, relative to the skull.
    let found: Vec<Option<f32>> = directions
        .par_iter()
        .map(|d| {
            let Some(distance) = distance else { return Some(1.0) };
            let along = *d * skull.half;
            let length = along.length();
            surface(skull.middle, along / length, REACH * length, distance).map(|t| t / length)
        })
        .collect();
    let opened = opened(&directions, &found);
    let place = |i: usize| {
        let [least, most] = STANDS_OUT;
        let out = found[i].map_or(1.0, |k| k - opened[i]);
        let k = found[i].unwrap_or(opened[i].min(1.2));
        let stands_out = smoothstep(least, most, out);
        (skull.place(directions[i] * (k + (opened[i] - k) * stands_out)), stands_out)
    };
    let places: Vec<(Vec3, f32)> = (0..directions.len()).map(place).collect();
    let positions: Vec<Vec3> = places.iter().map(|(p, _)| *p).collect();
    let shares =
        if distance.is_some() { shares(body, skull, &positions) } else { vec![1.0; positions.len()] };
    let mut out = HeadMesh { positions, scalp_is_guessed: true, ..HeadMesh::default() };
    let all_found = |t: &[u32; 3]| t.iter().all(|&v| found[v as usize].is_some());
    out.triangles = triangles().filter(all_found).collect();
    out.normals = normals(&out, &directions, skull);
    out.scalp = directions
        .par_iter()
        .enumerate()
        .map(|(i, d)| {
            let skin = if found[i].is_some() { smoothstep(0.35, 0.6, shares[i]) } else { 0.0 };
            let beneath = smoothstep(BENEATH[0], BENEATH[1], out.normals[i].y);
            let hair = outline::mask(*d, fit) * (1.0 - places[i].1) * beneath;
            fit.painted(*d, hair) * skin
        })
        .collect();
    out
}

/// A unit vector for each vertex, row after row.
fn directions() -> Vec<Vec3> {
    let place = |i: usize| {
        let polar = LOWEST * (i / COLUMNS) as f32 / (ROWS - 1) as f32;
        let azimuth = std::f32::consts::TAU * (i % COLUMNS) as f32 / COLUMNS as f32;
        Vec3::new(polar.sin() * azimuth.sin(), polar.cos(), polar.sin() * azimuth.cos())
    };
    (0..ROWS * COLUMNS).map(place).collect()
}

fn triangles() -> impl Iterator<Item = [u32; 3]> {
    let vertex = |row: usize, column: usize| (row * COLUMNS + column % COLUMNS) as u32;
    (0..ROWS - 1).flat_map(move |row| {
        (0..COLUMNS).flat_map(move |column| {
            let [a, b] = [vertex(row, column), vertex(row, column + 1)];
            let [c, d] = [vertex(row + 1, column), vertex(row + 1, column + 1)];
            [(row > 0).then_some([a, c, b]), Some([b, c, d])].into_iter().flatten()
        })
    })
}

/// The distances without what is narrow and stands out: the least around each direction, then the most of those.
fn opened(directions: &[Vec3], found: &[Option<f32>]) -> Vec<f32> {
    let near = OPENING.cos();
    // Within the rows that the angle reaches.
    let rows = (OPENING / LOWEST * (ROWS - 1) as f32).ceil() as usize;
    let around = |i: usize| {
        let row = i / COLUMNS;
        (row.saturating_sub(rows) * COLUMNS..((row + rows + 1) * COLUMNS).min(directions.len()))
            .filter(move |&j| directions[i].dot(directions[j]) >= near)
    };
    let filter = |from: &[f32], best: fn(f32, f32) -> f32| -> Vec<f32> {
        (0..from.len()).into_par_iter().map(|i| around(i).map(|j| from[j]).fold(from[i], best)).collect()
    };
    let raw: Vec<f32> = found.iter().map(|k| k.unwrap_or(REACH)).collect();
    filter(&filter(&raw, f32::min), f32::max)
}

/// The share of head and neck in what moves the skin near each place.
fn shares(body: &Body, skull: &Skull, places: &[Vec3]) -> Vec<f32> {
    let (mesh, skeleton) = (&body.mesh, &body.skeleton);
    let mut of_head: Vec<bool> =
        (0..skeleton.joints.len()).map(|j| skeleton.is_below(j, body.head_joint)).collect();
    for j in neck_joints(body) {
        of_head[j] = true;
    }
    let origin = skeleton.rest_position(body.head_joint);
    let near: Vec<(Vec3, f32)> = mesh
        .positions
        .iter()
        .enumerate()
        .map(|(v, p)| (*p - origin, v))
        .filter(|(p, _)| skull.relative(*p).length() < 1.3 * REACH)
        .map(|(p, v)| {
            let pairs = mesh.joints[v].iter().zip(&mesh.weights[v]);
            (p, pairs.filter(|(j, _)| of_head[usize::from(**j)]).map(|(_, w)| w).sum())
        })
        .collect();
    // A head that moves hardly any skin stands for the whole body.
    if near.iter().filter(|(_, share)| *share >= 0.5).count() < 8 {
        return vec![1.0; places.len()];
    }
    let share = |p: &Vec3| {
        let nearest =
            near.iter().min_by(|a, b| a.0.distance_squared(*p).total_cmp(&b.0.distance_squared(*p)));
        nearest.map_or(1.0, |(_, share)| *share)
    };
    places.par_iter().map(share).collect()
}

/// The mask at the vertices of a body: that of the net where it lies on them.
pub(super) fn on_body(body: &Body, skull: &Skull, net: &HeadMesh) -> Vec<f32> {
    let origin = body.skeleton.rest_position(body.head_joint);
    let near = 0.12 * skull.half.min_element();
    let hairy: Vec<(Vec3, f32)> = net
        .positions
        .iter()
        .copied()
        .zip(net.scalp.iter().copied())
        .filter(|(_, mask)| *mask > 0.0)
        .collect();
    let mask = |p: &Vec3| {
        let p = *p - origin;
        let reach = skull.relative(p).length();
        if reach.is_nan() || reach >= REACH {
            return 0.0;
        }
        let nearest = hairy.iter().min_by(|a, b| a.0.distance_squared(p).total_cmp(&b.0.distance_squared(p)));
        nearest.filter(|(at, _)| at.distance(p) < near).map_or(0.0, |(_, mask)| *mask)
    };
    body.mesh.positions.par_iter().map(mask).collect()
}

/// Smooth outward normals.
fn normals(mesh: &HeadMesh, directions: &[Vec3], skull: &Skull) -> Vec<Vec3> {
    let mut sums = vec![Vec3::ZERO; mesh.positions.len()];
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
        for v in t {
            sums[*v as usize] += (b - a).cross(c - a);
        }
    }
    let crown: Vec3 = sums[..COLUMNS].iter().sum();
    sums[..COLUMNS].fill(crown);
    let of_skull = |i: usize| (directions[i] / skull.half).normalize_or(Vec3::Y);
    sums.iter().enumerate().map(|(i, n)| n.normalize_or(of_skull(i))).collect()
}

/// An ellipsoid around the box of a head, for skin that encloses nothing.
pub(super) fn cap_around(head: &[Vec3]) -> Option<Skull> {
    let finite = head.iter().copied().filter(|p| p.is_finite());
    let (low, high) = finite.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), p| (a.min(p), b.max(p)));
    let size = (high - low).max_element();
    if !(size.is_finite() && size > 0.0) {
        return None;
    }
    // A head is not flat, and no longer than this compared with its width.
    let half = (0.5 * (high - low)).max(Vec3::splat(0.3 * size));
    let half = half.min(Vec3::splat(1.4 * half.min_element()));
    let middle = (0.5 * (low + high)).with_y(high.y - half.y);
    Some(Skull { middle, half })
}

/// The direction of the hairline, relative to the skull, at an angle from the front toward the wearer's left.
pub(super) fn hairline_direction(fit: &ScalpFit, azimuth: f32) -> Vec3 {
    let folded = azimuth.rem_euclid(std::f32::consts::TAU);
    let folded = if folded > std::f32::consts::PI { std::f32::consts::TAU - folded } else { folded };
    let elevation = outline::hairline(folded, fit);
    let line = Vec3::new(elevation.cos() * azimuth.sin(), elevation.sin(), elevation.cos() * azimuth.cos());
    // Along this direction from the outline's middle to the sphere.
    let along = Quat::from_rotation_x(fit.nod) * line * Vec3::new(fit.width, 1.0, 1.0);
    let from = Vec3::new(0.0, fit.up, fit.forward);
    let (a, b, c) = (along.length_squared(), along.dot(from), from.length_squared() - 1.0);
    let t = (-b + (b * b - a * c).max(0.0).sqrt()) / a;
    (from + along * t).normalize_or(line)
}
