//! Building the field of a body: its joints, box, distances and weights.

use std::collections::HashMap;

use glam::{IVec3, UVec3, Vec3};
use rayon::prelude::*;

use super::{BodyField, FIELD_JOINTS, FieldLattice, FieldWeights, lines};
use crate::{Body, RestDistance, head_mesh};

/// Box of the field around the head joint of a body of [`USUAL_SIZE`] metres, metres.
const REACH: [Vec3; 2] = [Vec3::new(-0.27, -0.42, -0.26), Vec3::new(0.27, 0.32, 0.26)];
const USUAL_SIZE: f32 = 1.7;
/// Margin of the field beyond the surface of a body of that height, metres.
const MARGIN: f32 = 0.035;
/// Number of points of the distance lattice.
const POINTS: f32 = 64.0 * 64.0 * 64.0;
/// Quantisation of weights. The error of the surface is at most this fraction of the distance by which two
/// joints move apart.
const STEP: f32 = 1.0 / 64.0;
/// Largest number of different weightings.
const SLOTS: usize = 6_000;
/// Distance between samples of the surface, in spacings of the distance lattice.
const SAMPLE: f32 = 0.75;
/// Largest number of samples.
const SAMPLES: usize = 400_000;

/// A point of the resting surface, head space, with the weights of the field's joints.
struct Sample {
    at: Vec3,
    normal: Vec3,
    weights: FieldWeights,
}

pub(super) fn build(body: &Body, rest: &RestDistance) -> Option<BodyField> {
    let origin: Vec3 = body.skeleton.world_at_rest.get(body.head_joint)?.translation.into();
    let (low, high) = reach(body, origin)?;
    let spacing = ((high - low).element_product() / POINTS).cbrt();
    // An even number of cells, so that the nodes span the same box.
    let cells = ((high - low) / (2.0 * spacing)).ceil().as_uvec3().max(UVec3::ONE) * 2;
    let distances = FieldLattice { low, spacing, size: cells + 1 };
    let nodes = FieldLattice { low, spacing: 2.0 * spacing, size: cells / 2 + 1 };
    let distance = (0..distances.count()).into_par_iter().map(|i| rest.distance(distances.place(i)).0);
    let distance: Vec<f32> = distance.collect();
    if distance.iter().any(|d| !d.is_finite()) {
        return None;
    }
    let joints = joints_of(body, origin, low, high);
    let samples = samples_of(body, origin, &joints, low, high, SAMPLE * spacing);
    let grid = SampleGrid::new(&samples, 2.0 * spacing);
    let wanted: Vec<Option<FieldWeights>> = (0..nodes.count())
        .into_par_iter()
        .map(|i| {
            let p = nodes.place(i);
            let (d, normal) = rest.distance(p);
            (d < 4.0 * nodes.spacing).then(|| grid.weights(p - normal * d, normal, spacing))
        })
        .collect();
    let (slots, slot_of_node) = slots_of(&wanted, joints.len());
    let mut field = BodyField {
        joints,
        rest_from_head: origin,
        distances,
        distance,
        nodes,
        slot_of_node,
        slots,
        outline: Vec::new(),
    };
    field.outline = lines::outline(&field);
    Some(field)
}

/// The box around head and shoulders in head space, with a margin.
fn reach(body: &Body, origin: Vec3) -> Option<(Vec3, Vec3)> {
    let mesh = &body.mesh.positions;
    let (low, high) = bounds(mesh.iter().map(|p| *p - origin))?;
    let scale = (high - low).max_element() / USUAL_SIZE;
    // Heads of animals and machines have other sizes.
    let (head_low, head_high) = bounds(head_mesh(body).positions.into_iter())?;
    let [mut from, mut to] = REACH.map(|corner| corner * scale);
    (from, to) = (from.min(head_low), to.max(head_high));
    let margin = Vec3::splat(MARGIN * scale);
    (from, to) = (from.max(low - margin), to.min(high + margin));
    let size = (to - from).max_element();
    (from.cmplt(to).all() && (1e-3..1e4).contains(&size)).then_some((from, to))
}

fn bounds(points: impl Iterator<Item = Vec3>) -> Option<(Vec3, Vec3)> {
    let ends = points.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), p| (a.min(p), b.max(p)));
    (ends.0.is_finite() && ends.1.is_finite()).then_some(ends)
}

/// The head, and the joints with most weight in the box. Descendants of the head count as the head.
fn joints_of(body: &Body, origin: Vec3, low: Vec3, high: Vec3) -> Vec<usize> {
    let mesh = &body.mesh;
    let mut share = vec![0.0_f64; body.skeleton.joints.len()];
    for (v, p) in mesh.positions.iter().enumerate() {
        let p = *p - origin;
        if p.cmpge(low).all() && p.cmple(high).all() {
            for (&joint, &weight) in mesh.joints[v].iter().zip(&mesh.weights[v]) {
                share[usize::from(joint)] += f64::from(weight);
            }
        }
    }
    let mut order: Vec<usize> =
        (0..share.len()).filter(|&j| share[j] > 0.0 && !body.skeleton.is_below(j, body.head_joint)).collect();
    order.sort_by(|&a, &b| share[b].total_cmp(&share[a]).then(a.cmp(&b)));
    order.truncate(FIELD_JOINTS - 1);
    std::iter::once(body.head_joint).chain(order).collect()
}

/// The joint of the field that represents each joint of the body: itself, or its nearest ancestor in the
/// field.
fn stand_ins(body: &Body, joints: &[usize]) -> Vec<usize> {
    let skeleton = &body.skeleton;
    (0..skeleton.joints.len())
        .map(|j| {
            let mut at = Some(j);
            while let Some(joint) = at {
                if let Some(n) = joints.iter().position(|&own| own == joint) {
                    return n;
                }
                at = skeleton.joints[joint].parent;
            }
            // Ancestors of all of them are represented by the heaviest joint of the trunk.
            1.min(joints.len() - 1)
        })
        .collect()
}

/// Samples the surface in the box evenly, so that coarse meshes give as much information as fine ones.
fn samples_of(
    body: &Body,
    origin: Vec3,
    joints: &[usize],
    low: Vec3,
    high: Vec3,
    spacing: f32,
) -> Vec<Sample> {
    let (mesh, stand_in) = (&body.mesh, stand_ins(body, joints));
    let of_vertex = |v: usize| {
        let mut weights = [0.0; FIELD_JOINTS];
        for (&joint, &weight) in mesh.joints[v].iter().zip(&mesh.weights[v]) {
            weights[stand_in[usize::from(joint)]] += weight;
        }
        weights
    };
    let mut out = Vec::new();
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| mesh.positions[v as usize] - origin);
        let (from, to) = (a.min(b).min(c), a.max(b).max(c));
        let Some(normal) = (b - a).cross(c - a).try_normalize() else { continue };
        if to.cmplt(low).any() || from.cmpgt(high).any() || out.len() >= SAMPLES {
            continue;
        }
        let side = (b - a).length().max((c - a).length()).max((c - b).length());
        let n = ((side / spacing).ceil() as u32).clamp(1, 64);
        let weights = triangle.map(|v| of_vertex(v as usize));
        for i in 0..=n {
            for j in 0..=n - i {
                let (u, v) = (i as f32 / n as f32, j as f32 / n as f32);
                let w = 1.0 - u - v;
                let mixed =
                    std::array::from_fn(|k| w * weights[0][k] + u * weights[1][k] + v * weights[2][k]);
                out.push(Sample { at: a * w + b * u + c * v, normal, weights: mixed });
            }
        }
    }
    out
}

/// Samples by cell.
struct SampleGrid<'a> {
    samples: &'a [Sample],
    cell: f32,
    cells: HashMap<IVec3, Vec<u32>>,
}

impl<'a> SampleGrid<'a> {
    fn new(samples: &'a [Sample], cell: f32) -> Self {
        let mut cells: HashMap<IVec3, Vec<u32>> = HashMap::new();
        for (i, sample) in samples.iter().enumerate() {
            cells.entry((sample.at / cell).floor().as_ivec3()).or_default().push(i as u32);
        }
        Self { samples, cell, cells }
    }

    /// Weighted mean of the weights around a point of the surface, over samples that face the same way.
    fn weights(&self, at: Vec3, normal: Vec3, width: f32) -> FieldWeights {
        let middle = (at / self.cell).floor().as_ivec3();
        let (mut sum, mut total) = ([0.0_f32; FIELD_JOINTS], 0.0_f32);
        let mut nearest = (f32::INFINITY, None);
        for i in 0..27 {
            let cell = middle + IVec3::new(i % 3, i / 3 % 3, i / 9) - 1;
            for &s in self.cells.get(&cell).map_or(&[][..], Vec::as_slice) {
                let sample = &self.samples[s as usize];
                let squared = sample.at.distance_squared(at);
                if squared < nearest.0 {
                    nearest = (squared, Some(s));
                }
                if sample.normal.dot(normal) > 0.0 {
                    let weight = (-squared / (2.0 * width * width)).exp();
                    total += weight;
                    for (sum, w) in sum.iter_mut().zip(&sample.weights) {
                        *sum += weight * w;
                    }
                }
            }
        }
        if total > 1e-6 {
            sum.map(|w| w / total)
        } else {
            let head = std::array::from_fn(|k| f32::from(u8::from(k == 0)));
            nearest.1.map_or(head, |s| self.samples[s as usize].weights)
        }
    }
}

/// Assigns a slot to each node; nodes with nearly equal weights share one. Distant nodes have the head's.
fn slots_of(wanted: &[Option<FieldWeights>], joints: usize) -> (Vec<FieldWeights>, Vec<u16>) {
    let alone = |j: usize| std::array::from_fn(|k| f32::from(u8::from(k == j)));
    let mut slots: Vec<FieldWeights> = (0..joints).map(alone).collect();
    let mut known: HashMap<[u8; FIELD_JOINTS], u16> = HashMap::new();
    let slot_of_node = wanted.iter().map(|weights| {
        let Some(weights) = weights else { return 0 };
        let heaviest = (1..joints).fold(0, |best, k| if weights[k] > weights[best] { k } else { best });
        let key = weights.map(|w| (w / STEP).round() as u8);
        if weights[heaviest] > 1.0 - STEP || slots.len() >= SLOTS {
            return heaviest as u16;
        }
        *known.entry(key).or_insert_with(|| {
            let sum: f32 = key.iter().map(|&k| f32::from(k)).sum();
            slots.push(key.map(|k| f32::from(k) / sum));
            (slots.len() - 1) as u16
        })
    });
    let slot_of_node = slot_of_node.collect();
    (slots, slot_of_node)
}
