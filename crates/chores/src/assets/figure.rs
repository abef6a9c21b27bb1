//! The whole figure in its rest pose: torso, limbs, hands and feet around the [`Head`], as one signed distance.

use glam::Vec3;
use lovelock_base::numbers::smoothstep;

use super::head::Head;
use super::paint;
use super::rig::rest;
use super::sdf::{Loft, ball, ellipsoid, round_cone, smax, smin, turn_x, turn_z};

/// Distance of cloth from the skin in metres.
const CLOTH_THICKNESS: f32 = 0.0013;

/// The parts of the figure. World space of the rest pose, in metres; left is +X.
pub(super) struct Figure {
    head: Head,
    torso: Loft,
    leg: Loft,
    foot: Loft,
    neck: Loft,
    upper_arm: Loft,
    forearm: Loft,
    palm: Loft,
}

/// A row of a loft that is symmetric in its first coordinate.
fn row(s: f32, half: f32, front: f32, middle: f32, back: f32) -> [f32; 6] {
    [s, half, -half, front, middle, back]
}

impl Figure {
    /// The sections of every part.
    pub(super) fn new() -> Self {
        let torso = Loft {
            origin: Vec3::ZERO,
            axis: Vec3::Y,
            side: Vec3::X,
            front: Vec3::Z,
            exponent: 2.3,
            sections: vec![
                row(0.820, 0.078, 0.046, -0.004, -0.062),
                row(0.852, 0.134, 0.078, -0.004, -0.090),
                row(0.890, 0.156, 0.089, -0.006, -0.098),
                row(0.930, 0.151, 0.094, -0.004, -0.092),
                row(0.985, 0.132, 0.090, 0.002, -0.078),
                row(1.050, 0.1130, 0.084, 0.004, -0.068),
                row(1.090, 0.1120, 0.084, 0.001, -0.070),
                row(1.150, 0.1210, 0.091, -0.006, -0.083),
                row(1.210, 0.1300, 0.095, -0.012, -0.098),
                row(1.270, 0.1350, 0.088, -0.018, -0.108),
                row(1.320, 0.1320, 0.073, -0.024, -0.110),
                row(1.365, 0.1120, 0.052, -0.030, -0.102),
                row(1.395, 0.0780, 0.032, -0.034, -0.088),
                row(1.415, 0.0520, 0.016, -0.036, -0.076),
            ],
        };
        let leg_row = |y: f32, middle: f32, outer: f32, inner: f32, front: f32, z: f32, back: f32| {
            [y, middle + outer, middle - inner, z + front, z, z - back]
        };
        let leg = Loft {
            origin: Vec3::ZERO,
            axis: Vec3::Y,
            side: Vec3::X,
            front: Vec3::Z,
            exponent: 2.0,
            sections: vec![
                leg_row(0.060, 0.0760, 0.0270, 0.0270, 0.0300, -0.032, 0.0300),
                leg_row(0.085, 0.0762, 0.0300, 0.0300, 0.0310, -0.032, 0.0350),
                leg_row(0.115, 0.0765, 0.0290, 0.0280, 0.0330, -0.031, 0.0350),
                leg_row(0.170, 0.0775, 0.0320, 0.0320, 0.0360, -0.026, 0.0380),
                leg_row(0.250, 0.0790, 0.0430, 0.0410, 0.0420, -0.020, 0.0510),
                leg_row(0.330, 0.0800, 0.0510, 0.0500, 0.0460, -0.016, 0.0620),
                leg_row(0.380, 0.0805, 0.0510, 0.0510, 0.0480, -0.011, 0.0610),
                leg_row(0.430, 0.0810, 0.0480, 0.0480, 0.0490, -0.003, 0.0540),
                leg_row(0.475, 0.0820, 0.0490, 0.0500, 0.0540, 0.002, 0.0520),
                leg_row(0.510, 0.0825, 0.0520, 0.0530, 0.0570, 0.003, 0.0560),
                leg_row(0.580, 0.0845, 0.0600, 0.0600, 0.0660, 0.002, 0.0640),
                leg_row(0.680, 0.0875, 0.0710, 0.0720, 0.0780, 0.000, 0.0750),
                leg_row(0.770, 0.0890, 0.0770, 0.0800, 0.0840, -0.002, 0.0840),
                leg_row(0.850, 0.0880, 0.0780, 0.0700, 0.0840, -0.002, 0.0860),
                leg_row(0.900, 0.0860, 0.0700, 0.0500, 0.0740, -0.002, 0.0740),
            ],
        };
        let foot_axis = rest::foot_direction();
        let foot = Loft {
            origin: Vec3::new(rest::ANKLE.x, 0.0, rest::ANKLE.z),
            axis: foot_axis,
            side: Vec3::Y.cross(foot_axis),
            front: Vec3::Y,
            exponent: 2.2,
            sections: vec![
                [-0.030, 0.0215, -0.0215, 0.052, 0.026, 0.0010],
                [-0.010, 0.0270, -0.0270, 0.074, 0.030, 0.0000],
                [0.020, 0.0280, -0.0285, 0.082, 0.032, 0.0010],
                [0.060, 0.0310, -0.0300, 0.0610, 0.027, 0.0035],
                [0.095, 0.0360, -0.0350, 0.0430, 0.020, 0.0010],
                [0.130, 0.0385, -0.0385, 0.0300, 0.014, 0.0000],
                [0.155, 0.0320, -0.0370, 0.0225, 0.012, 0.0005],
                [0.170, 0.0180, -0.0290, 0.0180, 0.011, 0.0025],
            ],
        };
        let neck_axis = Vec3::new(0.0, 0.160, 0.026).normalize_or(Vec3::Y);
        let neck = Loft {
            origin: Vec3::new(0.0, 1.385, -0.0350),
            axis: neck_axis,
            side: Vec3::X,
            front: Vec3::X.cross(neck_axis),
            exponent: 2.0,
            sections: vec![
                row(-0.010, 0.0700, 0.056, 0.0, -0.054),
                row(0.030, 0.0510, 0.046, 0.0, -0.051),
                row(0.070, 0.0455, 0.043, 0.0, -0.048),
                row(0.115, 0.0460, 0.042, 0.0, -0.048),
                row(0.150, 0.0490, 0.044, 0.0, -0.050),
            ],
        };
        let (upper, fore) = (rest::upper_arm_direction(), rest::forearm_direction());
        // A section's sides are up (toward the back of the hand) and front (toward the thumb).
        let arm = |origin: Vec3, axis: Vec3, sections: Vec<[f32; 6]>| {
            let front = (Vec3::Z - axis * axis.z).normalize_or(Vec3::Z);
            Loft { origin, axis, side: front.cross(axis), front, exponent: 2.0, sections }
        };
        let upper_arm = arm(
            rest::SHOULDER,
            upper,
            vec![
                [0.000, 0.0430, -0.0420, 0.0420, 0.0, -0.0440],
                [0.070, 0.0420, -0.0400, 0.0400, 0.0, -0.0430],
                [0.140, 0.0370, -0.0390, 0.0400, 0.0, -0.0410],
                [0.210, 0.0330, -0.0340, 0.0350, 0.0, -0.0350],
                [0.285, 0.0310, -0.0310, 0.0290, 0.0, -0.0330],
            ],
        );
        let forearm = arm(
            rest::ELBOW,
            fore,
            vec![
                [0.000, 0.0310, -0.0300, 0.0290, 0.0, -0.0330],
                [0.055, 0.0350, -0.0340, 0.0340, 0.0, -0.0330],
                [0.110, 0.0300, -0.0300, 0.0310, 0.0, -0.0300],
                [0.180, 0.0205, -0.0205, 0.0250, 0.0, -0.0240],
                [0.238, 0.0165, -0.0165, 0.0235, 0.0, -0.0225],
            ],
        );
        let palm = arm(
            rest::WRIST,
            fore,
            vec![
                [-0.010, 0.0160, -0.0160, 0.0230, 0.0, -0.0220],
                [0.020, 0.0135, -0.0160, 0.0270, 0.0, -0.0260],
                [0.050, 0.0125, -0.0150, 0.0320, 0.0, -0.0320],
                [0.080, 0.0105, -0.0120, 0.0335, 0.0, -0.0330],
            ],
        );
        Self { head: Head::new(), torso, leg, foot, neck, upper_arm, forearm, palm }
    }

    /// Distance to the clothed figure.
    pub(super) fn distance(&self, p: Vec3) -> f32 {
        let d = self.skin(p);
        if d.abs() > 0.02 || p.y > paint::STRAPS_Y || p.distance(Vec3::new(0.0, 1.49, 0.0)) < 0.068 {
            return d;
        }
        d - CLOTH_THICKNESS * smoothstep(-0.0025, 0.0025, paint::inside_cloth(p))
    }

    /// Distance to the bare figure.
    fn skin(&self, p: Vec3) -> f32 {
        let head_away = ellipsoid(p - Vec3::new(0.0, 1.585, 0.005), Vec3::new(0.10, 0.125, 0.13));
        let head = if head_away > 0.06 { head_away } else { self.head.distance(p) };
        if p.y > 1.57 {
            return head;
        }
        let body = self.body(Vec3::new((p.x * p.x + 4e-6).sqrt(), p.y, p.z));
        smin(head, body, 0.022)
    }

    fn body(&self, p: Vec3) -> f32 {
        let v = Vec3::new;
        let across = v(-p.x, p.y, p.z);
        let mut d = 1.0_f32;
        if p.y > 0.70 {
            d = self.trunk(p, across);
        }
        if p.y < 1.02 {
            let mut legs = self.lower_limb(p);
            if p.x < 0.06 && p.y > 0.62 {
                legs = smin(legs, self.lower_limb(across), 0.012);
            }
            d = smin(d, legs, 0.030);
        }
        let arm_away = p.x > 0.06 && p.y > 0.78;
        if arm_away {
            d = smin(d, self.arm(p), 0.030);
        }
        d
    }

    fn trunk(&self, p: Vec3, across: Vec3) -> f32 {
        let v = Vec3::new;
        let mut d = self.torso.distance(p);
        // Bust: two soft forms that meet over the breastbone.
        let breast = |q: Vec3| ellipsoid(turn_x(q - v(0.066, 1.212, 0.060), 0.25), v(0.0560, 0.0570, 0.0520));
        d = smin(d, smin(breast(p), breast(across), 0.016), 0.030);
        // The lower belly, down to between the thighs.
        d = smin(d, ellipsoid(p - v(0.0, 0.852, 0.018), v(0.064, 0.060, 0.058)), 0.034);
        // Seat.
        let seat = |q: Vec3| ellipsoid(q - v(0.072, 0.868, -0.052), v(0.078, 0.080, 0.066));
        d = smin(d, smin(seat(p), seat(across), 0.014), 0.034);
        if p.y > 1.12 {
            d = smin(d, self.neck.distance(p), 0.030);
            // Trapezius, breast muscle and the back's broad muscle around the armpit.
            d = smin(d, round_cone(p, v(0.020, 1.460, -0.050), v(0.140, 1.382, -0.030), 0.026, 0.026), 0.050);
            d = smin(d, round_cone(p, v(0.060, 1.300, 0.030), v(0.150, 1.340, -0.006), 0.036, 0.028), 0.035);
            d = smin(d, round_cone(p, v(0.090, 1.230, -0.058), v(0.150, 1.335, -0.040), 0.040, 0.030), 0.035);
            d = smin(d, round_cone(p, v(0.050, 1.345, 0.012), v(0.130, 1.362, -0.006), 0.030, 0.028), 0.040);
            // Collar bones, and the muscles from behind the ears to the pit of the throat.
            d = smin(
                d,
                round_cone(p, v(0.016, 1.3890, 0.0200), v(0.125, 1.4020, -0.0080), 0.0075, 0.0070),
                0.016,
            );
            d = smin(
                d,
                round_cone(p, v(0.050, 1.5400, -0.024), v(0.013, 1.4000, 0.0130), 0.0100, 0.0075),
                0.016,
            );
        }
        d
    }

    fn arm(&self, p: Vec3) -> f32 {
        let v = Vec3::new;
        let along = rest::upper_arm_direction();
        if p.distance(rest::ELBOW) > 0.55 {
            return p.distance(rest::ELBOW) - 0.45;
        }
        let mut d = smin(self.upper_arm.distance(p), self.forearm.distance(p), 0.020);
        // Deltoid.
        let q = p - rest::SHOULDER - along * 0.042;
        let axial = q.dot(along);
        let local = v(axial, q.dot(v(-along.y, along.x, 0.0)) - 0.004, q.z);
        d = smin(d, ellipsoid(local, v(0.082, 0.0475, 0.0500)), 0.022);
        if p.distance(rest::WRIST) < 0.26 {
            d = smin(d, self.hand(p), 0.014);
        }
        d
    }

    /// Fingers held together with soft grooves, the middle finger lowered a little, and a thumb.
    fn hand(&self, p: Vec3) -> f32 {
        let (axis, side, front) = (self.palm.axis, self.palm.side, self.palm.front);
        let at = |along: f32, up: f32, thumb: f32| rest::WRIST + axis * along + side * up + front * thumb;
        let mut d = self.palm.distance(p);
        let fingers: [(f32, f32, f32, f32); 4] = [
            (0.0255, 0.070, 0.0, 0.0098),
            (0.0085, 0.078, -0.004, 0.0),
            (-0.0085, 0.073, -0.003, 0.0),
            (-0.0250, 0.058, 0.001, -0.006),
        ];
        for (offset, length, drop, spread) in fingers {
            let knuckle = at(0.078, -0.001, offset);
            let middle = at(0.078 + 0.52 * length, -0.004 + 0.5 * drop, offset + 0.4 * spread);
            let tip = at(0.078 + length, -0.016 + drop, offset + 0.7 * spread);
            let finger = smin(
                round_cone(p, knuckle, middle, 0.0100, 0.0086),
                round_cone(p, middle, tip, 0.0086, 0.0068),
                0.004,
            );
            d = smin(d, finger, 0.0055);
        }
        let (root, joint, tip) =
            (at(0.016, -0.006, 0.022), at(0.050, -0.014, 0.047), at(0.080, -0.020, 0.054));
        let thumb = smin(
            round_cone(p, root, joint, 0.0145, 0.0105),
            round_cone(p, joint, tip, 0.0105, 0.0078),
            0.004,
        );
        smin(d, thumb, 0.018)
    }

    fn lower_limb(&self, p: Vec3) -> f32 {
        let v = Vec3::new;
        let mut d = self.leg.distance(p);
        if p.y < 0.62 && p.y > 0.32 {
            // Kneecap.
            d = smin(d, ellipsoid(p - v(0.082, 0.480, 0.036), v(0.026, 0.034, 0.022)), 0.020);
        }
        if p.y < 0.25 {
            let ankle = rest::ANKLE;
            let mut foot = self.foot.distance(p);
            foot = smin(
                foot,
                ellipsoid(turn_z(p - v(ankle.x, 0.030, ankle.z - 0.030), 0.0), v(0.025, 0.031, 0.027)),
                0.02,
            );
            d = smin(d, foot, 0.030);
            d = smin(d, ball(p, ankle + v(0.022, 0.006, 0.0), 0.0100), 0.014);
            d = smin(d, ball(p, ankle + v(-0.022, 0.010, 0.004), 0.0100), 0.014);
            // The sole is flat.
            d = smax(d, -p.y, 0.006);
        }
        d
    }
}

/// Desired length of the mesh's edges at a point of the surface in metres, short where the shape or the colouring is fine.
pub(super) fn edge_length(p: Vec3) -> f32 {
    let q = Vec3::new(p.x.abs(), p.y, p.z);
    let v = Vec3::new;
    let mut size = 0.0146_f32;
    // For each place: radius of the fine region, length of its edges, and growth of the length outside.
    let mut near = |distance: f32, reach: f32, fine: f32, growth: f32| {
        size = size.min(fine + growth * (distance - reach).max(0.0));
    };
    near(
        round_cone(q, rest::WRIST, rest::WRIST + rest::forearm_direction() * 0.16, 0.0, 0.0),
        0.055,
        0.0055,
        0.11,
    );
    near(round_cone(q, v(rest::ANKLE.x, 0.02, -0.07), v(0.10, 0.01, 0.14), 0.0, 0.0), 0.045, 0.0080, 0.10);
    near(paint::seam(q).abs(), 0.0025, 0.0048, 0.36);
    if p.y > 1.30 {
        near(ellipsoid(q - v(0.0, 1.590, 0.0), v(0.085, 0.120, 0.110)).max(0.0), 0.0, 0.0056, 0.10);
        if p.z > 0.0 {
            near(ellipsoid(q - v(0.0, 1.545, 0.085), v(0.050, 0.075, 0.040)).max(0.0), 0.0, 0.0036, 0.14);
            near((q - super::head::EYE - v(0.0, 0.0, 0.010)).length(), 0.0165, 0.0012, 0.15);
            near(round_cone(q, v(0.0, 1.512, 0.100), v(0.018, 1.512, 0.092), 0.0, 0.0), 0.010, 0.0016, 0.15);
            near(round_cone(q, v(0.0, 1.548, 0.112), v(0.008, 1.540, 0.105), 0.0, 0.0), 0.010, 0.0021, 0.15);
            near(
                round_cone(q, v(0.014, 1.602, 0.098), v(0.046, 1.604, 0.078), 0.0, 0.0),
                0.006,
                0.0019,
                0.15,
            );
        }
        near((q - super::head::EAR).length(), 0.032, 0.0026, 0.12);
    }
    size
}
