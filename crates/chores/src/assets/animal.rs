//! A four-legged animal for fur: a trunk, a neck, a head with a muzzle and ears, legs and a bushy tail, of the size of a fox. It looks
//! along +Z and stands at y = 0.

use glam::Vec3;
use lovelock_base::numbers::smoothstep;

use super::glb::Model;
use super::mesh::{Grid, project, surface_nets};
use super::remesh::remesh;
use super::rigid;
use super::sdf::{ball, round_cone, smax, smin};

/// Where its joint is: the middle of the trunk, metres.
const MIDDLE: Vec3 = Vec3::new(0.0, 0.36, 0.0);
/// The left eye and the tip of the nose.
const EYE: Vec3 = Vec3::new(0.030, 0.532, 0.368);
const NOSE: Vec3 = Vec3::new(0.0, 0.484, 0.470);

/// Skin, eyes and nose, linear sRGB.
const SKIN: Vec3 = Vec3::new(0.30, 0.20, 0.15);
const DARK: Vec3 = Vec3::new(0.012, 0.010, 0.010);

/// Builds it.
pub(super) fn make() -> Model {
    let grid = Grid::even(Vec3::new(-0.16, -0.03, -0.72), Vec3::new(0.16, 0.72, 0.52), 0.0105);
    let mut net = surface_nets(&grid, &distance);
    net.positions.iter_mut().for_each(|p| *p = project(&distance, *p));
    remesh(&mut net, &distance, &edge_length, 5);
    rigid("animal", net, &distance, (&colour, &scalp), MIDDLE)
}

/// A chain of balls, joined by cones.
fn chain(p: Vec3, balls: &[(Vec3, f32)]) -> f32 {
    let cones = balls.windows(2).map(|pair| round_cone(p, pair[0].0, pair[1].0, pair[0].1, pair[1].1));
    cones.reduce(|a, b| smin(a, b, 0.02)).unwrap_or(f32::MAX)
}

/// Signed distance of its surface.
fn distance(p: Vec3) -> f32 {
    let v = Vec3::new;
    // The left half; the right one is its mirror image.
    let q = v(p.x.abs(), p.y, p.z);
    let trunk = chain(
        q,
        &[
            (v(0.0, 0.365, 0.185), 0.083),
            (v(0.0, 0.352, 0.120), 0.094),
            (v(0.0, 0.362, 0.000), 0.086),
            (v(0.0, 0.378, -0.110), 0.074),
            (v(0.0, 0.372, -0.190), 0.078),
        ],
    );
    let neck = chain(q, &[(v(0.0, 0.400, 0.190), 0.070), (v(0.0, 0.480, 0.275), 0.056)]);
    let head = chain(
        q,
        &[
            (v(0.0, 0.525, 0.310), 0.060),
            (v(0.0, 0.515, 0.350), 0.050),
            (v(0.0, 0.492, 0.420), 0.026),
            (v(0.0, 0.484, 0.460), 0.014),
        ],
    );
    let cheek = ball(q, v(0.034, 0.505, 0.335), 0.034);
    let ear = {
        let tip = chain(q, &[(v(0.036, 0.560, 0.295), 0.026), (v(0.052, 0.650, 0.285), 0.006)]);
        // Hollow in front.
        smax(tip, -ball(q, v(0.046, 0.605, 0.325), 0.031), 0.008)
    };
    let fore = chain(
        q,
        &[
            (v(0.048, 0.330, 0.165), 0.050),
            (v(0.052, 0.205, 0.140), 0.026),
            (v(0.052, 0.110, 0.160), 0.018),
            (v(0.052, 0.030, 0.155), 0.018),
        ],
    );
    let hind = chain(
        q,
        &[
            (v(0.046, 0.345, -0.175), 0.062),
            (v(0.058, 0.225, -0.135), 0.036),
            (v(0.056, 0.130, -0.215), 0.019),
            (v(0.056, 0.030, -0.190), 0.018),
        ],
    );
    let paws = [0.172, -0.172].map(|z| {
        let paw = chain(q, &[(v(0.053, 0.022, z - 0.010), 0.021), (v(0.054, 0.018, z + 0.014), 0.019)]);
        // The sole is flat.
        smax(paw, -p.y, 0.006)
    });
    let tail = chain(
        q,
        &[
            (v(0.0, 0.395, -0.245), 0.026),
            (v(0.0, 0.370, -0.340), 0.030),
            (v(0.0, 0.285, -0.470), 0.036),
            (v(0.0, 0.235, -0.580), 0.030),
            (v(0.0, 0.225, -0.660), 0.010),
        ],
    );
    let mut d = smin(trunk, neck, 0.06);
    d = smin(d, head, 0.035);
    d = smin(d, cheek, 0.025);
    d = smin(d, ear, 0.012);
    d = smin(d, fore, 0.035);
    d = smin(d, hind, 0.040);
    d = smin(d, tail, 0.030);
    for paw in paws {
        d = smin(d, paw, 0.012);
    }
    smin(d, ball(q, EYE, 0.0085), 0.003)
}

/// Desired length of the mesh's edges, metres.
fn edge_length(p: Vec3) -> f32 {
    let q = Vec3::new(p.x.abs(), p.y, p.z);
    let near = |at: Vec3, reach: f32, fine: f32| fine + 0.16 * (q.distance(at) - reach).max(0.0);
    let ear = round_cone(q, Vec3::new(0.036, 0.560, 0.295), Vec3::new(0.052, 0.650, 0.285), 0.0, 0.0);
    let fine = [near(EYE, 0.010, 0.0035), near(NOSE, 0.012, 0.005), 0.007 + 0.16 * (ear - 0.025).max(0.0)];
    // Legs and tail are thin.
    let limbs =
        0.010 + 0.10 * (q.y - 0.22).max(0.0) + if q.z < -0.24 { 0.0 } else { 0.06 * (q.y - 0.30).max(0.0) };
    fine.into_iter().fold(limbs.min(0.0175), f32::min)
}

/// 1 on the bare skin of eyes and nose, 0 elsewhere.
fn bare(p: Vec3) -> f32 {
    let q = Vec3::new(p.x.abs(), p.y, p.z);
    let within = |at: Vec3, reach: f32| smoothstep(reach + 0.0015, reach - 0.0015, q.distance(at));
    within(EYE, 0.0095).max(within(NOSE, 0.013))
}

/// 1 where fur grows: not on eyes, nose and soles.
fn scalp(p: Vec3) -> f32 {
    (1.0 - bare(p)) * smoothstep(0.004, 0.010, p.y)
}

fn colour(p: Vec3) -> Vec3 {
    SKIN.lerp(DARK, bare(p))
}
