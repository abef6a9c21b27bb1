//! Skin weights. Each vertex starts with the joint whose part contains it, and the parts then diffuse over the surface
//! (implicit Euler steps of the heat equation), so that weights spread around an armpit and not across it.

use glam::Vec3;

use super::head;
use super::mesh::TriMesh;
use super::rig::{self, rest};

/// Joints and weights of a vertex, largest first; the weights are 65535ths that sum to 65535.
pub(super) type Influences = [(u8, u16); 4];

/// Steps of the heat equation; two make the blend bell-shaped where one leaves a cusp.
const STEPS: usize = 2;
/// Gauss-Seidel sweeps per step. The largest diffusion number is about 30, which converges to 0.1 % in fewer sweeps.
const SWEEPS: usize = 120;

/// Whether a vertex belongs to the head and moves with it rigidly: the scalp, the face and the jaw.
fn rigid_head(p: Vec3) -> bool {
    let plane = 1.500 - 0.28 * (p.z + 0.06);
    p.y > plane || (p.y > 1.44 && head::inside_hairline(p) > -0.012)
}

/// The joint whose part contains `p`, and the width of the blend at its edge in metres.
fn part(p: Vec3) -> (usize, f32) {
    let q = Vec3::new(p.x.abs(), p.y, p.z);
    let right = usize::from(p.x < 0.0);
    let arm = rig::CLAVICLE + right * rig::ARM_JOINTS;
    let leg = rig::THIGH + right * rig::LEG_JOINTS;
    if rigid_head(p) {
        return (rig::HEAD, 0.0);
    }
    let from_shoulder = q - rest::SHOULDER;
    let (upper, fore) = (rest::upper_arm_direction(), rest::forearm_direction());
    // The border of the shoulder slopes outward below, so that the ribs under the armpit belong to the chest.
    let past_shoulder = from_shoulder.dot(Vec3::new(0.93, 0.30, 0.0));
    if past_shoulder > 0.004 && q.x > if q.y > 1.2 { 0.14 } else { 0.22 } {
        let along = from_shoulder.dot(upper);
        if (q - rest::ELBOW).dot((upper + fore).normalize_or(Vec3::X)) < 0.0 {
            return if along < 0.095 {
                (arm + rig::UPPER_ARM_TWIST, 0.026)
            } else {
                (arm + rig::UPPER_ARM, 0.024)
            };
        }
        let along = (q - rest::ELBOW).dot(fore);
        return match along {
            a if a < 0.080 => (arm + rig::FOREARM, 0.018),
            a if a < 0.205 => (arm + rig::FOREARM_TWIST, 0.018),
            a if a < 0.238 => (arm + rig::FOREARM_TWIST, 0.012),
            _ => (arm + rig::HAND, 0.011),
        };
    }
    let crease = 0.800 + 0.70 * (q.x - 0.012).clamp(0.0, 0.150);
    if q.y < crease {
        let foot = (q - rest::ANKLE).dot(Vec3::new(0.0, -0.9, 0.45));
        let toe = (q - rest::TOE).dot(rest::foot_direction());
        return match q.y {
            y if y > 0.730 => (leg + rig::THIGH_TWIST, 0.032),
            y if y > rest::KNEE.y => (leg, if y > 0.6 { 0.032 } else { 0.024 }),
            _ if foot < 0.0 => (leg + rig::SHIN, if q.y > 0.2 { 0.024 } else { 0.015 }),
            _ if toe < 0.0 => (leg + rig::FOOT, 0.013),
            _ => (leg + rig::TOES, 0.009),
        };
    }
    if q.x > 0.060 && q.y > 1.315 + 0.25 * (0.15 - q.x) && q.y < 1.44 {
        return (arm, 0.030);
    }
    match q.y {
        y if y < 0.985 => (rig::HIPS, 0.036),
        y if y < 1.075 => (rig::SPINE, 0.036),
        y if y < 1.180 => (rig::SPINE_1, 0.036),
        y if y < 1.415 => (rig::CHEST, 0.032),
        _ => (rig::NECK, 0.018),
    }
}

/// Influences of every vertex.
pub(super) fn influences(mesh: &TriMesh, joint_count: usize) -> Vec<Influences> {
    let count = mesh.positions.len();
    let mut neighbours: Vec<Vec<u32>> = vec![Vec::new(); count];
    for triangle in &mesh.triangles {
        for i in 0..3 {
            // Each edge occurs once in this direction, because the mesh is closed.
            neighbours[triangle[i] as usize].push(triangle[(i + 1) % 3]);
        }
    }
    let parts: Vec<(usize, f32)> = mesh.positions.iter().map(|p| part(*p)).collect();
    // The diffusion number of a vertex: reach squared over the mean squared length of its edges.
    let number: Vec<f32> = (0..count)
        .map(|i| {
            let at = mesh.positions[i];
            let ring = &neighbours[i];
            let length = ring.iter().map(|j| at.distance_squared(mesh.positions[*j as usize])).sum::<f32>();
            4.0 * parts[i].1 * parts[i].1 / STEPS as f32 / length.max(1e-9)
        })
        .collect();
    let mut all = vec![vec![0.0_f32; joint_count]; count];
    for (joint, column) in (0..joint_count).map(|joint| (joint, diffuse(joint, &parts, &number, &neighbours)))
    {
        for (row, value) in all.iter_mut().zip(column) {
            row[joint] = value;
        }
    }
    all.iter().map(|row| strongest(row)).collect()
}

/// One joint's weights after [`STEPS`] steps.
fn diffuse(joint: usize, parts: &[(usize, f32)], number: &[f32], neighbours: &[Vec<u32>]) -> Vec<f32> {
    let mut w: Vec<f32> = parts.iter().map(|(part, _)| f32::from(u8::from(*part == joint))).collect();
    if !parts.iter().any(|(part, _)| *part == joint) {
        return w;
    }
    for _ in 0..STEPS {
        let before = w.clone();
        for _ in 0..SWEEPS {
            for i in 0..w.len() {
                let sum: f32 = neighbours[i].iter().map(|j| w[*j as usize]).sum();
                let k = number[i];
                w[i] = (before[i] + k * sum) / (1.0 + k * neighbours[i].len() as f32);
            }
        }
    }
    w
}

/// The four largest weights, in 65535ths.
fn strongest(row: &[f32]) -> Influences {
    let mut order: Vec<usize> = (0..row.len()).collect();
    order.sort_by(|a, b| row[*b].total_cmp(&row[*a]).then(a.cmp(b)));
    // The weight of the fifth joint is subtracted from all, so that a joint fades in without a jump.
    let floor = row[order[4]];
    let kept: [f32; 4] = std::array::from_fn(|i| (row[order[i]] - floor).max(0.0));
    let total: f32 = kept.iter().sum();
    let mut out: Influences =
        std::array::from_fn(|i| (order[i] as u8, (kept[i] / total * 65535.0).round() as u16));
    let rest: i32 = 65535 - out[1..].iter().map(|(_, w)| i32::from(*w)).sum::<i32>();
    out[0].1 = rest.clamp(0, 65535) as u16;
    for entry in &mut out {
        if entry.1 == 0 {
            entry.0 = 0;
        }
    }
    out
}
