//! The head: cranium, face, eyes and ears, as one signed distance.
//!
//! World space of the rest pose, metres; the head is 0.23 m from chin (y = 1.47) to crown (y = 1.70), and the
//! face looks toward +Z. Brow, nose base and chin divide the face below the hairline in thirds.

use glam::Vec3;

use super::sdf::{Loft, ball, curve, ellipsoid, round_cone, smax, smin, turn_x, turn_y, turn_z};

/// Height of the chin's lowest point.
pub(super) const CHIN_Y: f32 = 1.47;
/// Height of the crown.
pub(super) const CROWN_Y: f32 = 1.70;
/// Height of the brow; the hairline at the middle is 65 mm above.
pub(super) const BROW_Y: f32 = 1.600;
/// Centre of the left eyeball; the right one is its mirror image.
pub(super) const EYE: Vec3 = Vec3::new(0.0315, 1.585, 0.0785);
/// Radius of an eyeball.
pub(super) const EYE_RADIUS: f32 = 0.0125;
/// Centre of the left ear.
pub(super) const EAR: Vec3 = Vec3::new(0.0765, 1.567, -0.012);
/// Half width of the opening between the eyelids.
const LID_HALF_WIDTH: f32 = 0.0145;

/// The head's lofts, made once.
pub(super) struct Head {
    face: Loft,
}

impl Head {
    /// The sections of the face.
    pub(super) fn new() -> Self {
        let row =
            |y: f32, half: f32, front: f32, middle: f32, back: f32| [y, half, -half, front, middle, back];
        Self {
            face: Loft {
                origin: Vec3::ZERO,
                axis: Vec3::Y,
                side: Vec3::X,
                front: Vec3::Z,
                exponent: 2.25,
                sections: vec![
                    row(1.4745, 0.0150, 0.0840, 0.070, 0.0560),
                    row(1.4800, 0.0240, 0.0885, 0.060, 0.0400),
                    row(1.4900, 0.0350, 0.0895, 0.048, 0.0150),
                    row(1.5020, 0.0450, 0.0885, 0.036, -0.005),
                    row(1.5170, 0.0530, 0.0900, 0.026, -0.025),
                    row(1.5350, 0.0595, 0.0915, 0.020, -0.035),
                    row(1.5550, 0.0650, 0.0915, 0.018, -0.045),
                    row(1.5750, 0.0690, 0.0930, 0.015, -0.050),
                    row(1.5950, 0.0710, 0.0975, 0.012, -0.055),
                    row(1.6150, 0.0700, 0.0990, 0.010, -0.055),
                    row(1.6400, 0.0600, 0.0850, 0.010, -0.050),
                ],
            },
        }
    }

    /// Distance to the head's surface.
    pub(super) fn distance(&self, world: Vec3) -> f32 {
        // The mirror is rounded by 1.5 mm, so that halves meet smoothly at the middle.
        let p = Vec3::new((world.x * world.x + 2.3e-6).sqrt(), world.y, world.z);
        let frontal = ellipsoid(p - Vec3::new(0.0, 1.6215, 0.020), Vec3::new(0.0690, 0.0755, 0.0805));
        let parietal = ellipsoid(p - Vec3::new(0.0, 1.6240, -0.0180), Vec3::new(0.0775, 0.0760, 0.0745));
        let occiput = ellipsoid(p - Vec3::new(0.0, 1.5850, -0.0380), Vec3::new(0.058, 0.055, 0.0480));
        let mut d = smin(smin(frontal, parietal, 0.025), occiput, 0.030);
        d = smin(d, self.face.distance(p), 0.018);
        d = self.features(p, d);
        smin(d, ear(p), 0.006)
    }

    /// Everything of the face that is finer than the loft.
    fn features(&self, p: Vec3, skull: f32) -> f32 {
        let v = Vec3::new;
        let mut d = skull;
        if p.z < 0.0 {
            return jaw(p, d);
        }
        d = jaw(p, d);
        // Brow ridge, then the sockets below it.
        d = smin(d, round_cone(p, v(0.012, 1.6015, 0.0935), v(0.045, 1.6040, 0.0775), 0.0075, 0.0065), 0.014);
        d = smax(
            d,
            -ellipsoid(turn_y(p - v(0.0300, 1.5850, 0.1010), 0.25), v(0.0200, 0.0125, 0.0130)),
            0.014,
        );
        // Cheekbones and the soft cheek below.
        d = smin(d, ellipsoid(turn_y(p - v(0.0470, 1.5560, 0.0600), -0.6), v(0.0200, 0.0135, 0.0200)), 0.022);
        d = smin(d, ellipsoid(p - v(0.0330, 1.5260, 0.0640), v(0.0200, 0.0220, 0.0200)), 0.020);
        // The muzzle that carries the lips, and the chin.
        d = smin(d, ellipsoid(p - v(0.0, 1.5160, 0.0740), v(0.0290, 0.0240, 0.0235)), 0.016);
        d = smin(d, ellipsoid(p - v(0.0, 1.4830, 0.0800), v(0.0170, 0.0135, 0.0155)), 0.014);
        d = nose(p, d);
        d = lips(p, d);
        eye(p, d)
    }
}

fn jaw(p: Vec3, d: f32) -> f32 {
    let v = Vec3::new;
    let ramus = round_cone(p, v(0.0560, 1.560, -0.004), v(0.0515, 1.5200, 0.0060), 0.008, 0.0100);
    let body = round_cone(p, v(0.0515, 1.5200, 0.0060), v(0.0150, 1.4820, 0.0740), 0.0100, 0.0100);
    smin(d, smin(ramus, body, 0.010), 0.020)
}

fn nose(p: Vec3, face: f32) -> f32 {
    let v = Vec3::new;
    let bridge = round_cone(p, v(0.0, 1.5920, 0.0930), v(0.0, 1.5500, 0.1110), 0.0068, 0.0065);
    let tip = ellipsoid(p - v(0.0, 1.5460, 0.1120), v(0.0082, 0.0076, 0.0088));
    let wing = ellipsoid(turn_y(p - v(0.0098, 1.5420, 0.1020), -0.35), v(0.0058, 0.0062, 0.0092));
    let mut n = smin(smin(bridge, tip, 0.008), wing, 0.006);
    let nostril = ellipsoid(turn_y(p - v(0.0058, 1.5355, 0.1070), -0.30), v(0.0028, 0.0030, 0.0046));
    n = smax(n, -nostril, 0.003);
    smin(face, n, 0.009)
}

/// The line between the lips: height and depth of the surface at a distance from the middle.
fn mouth_line(x: f32) -> (f32, f32) {
    let [_, y, z] = curve(
        &[[0.0, 1.5125, 0.0985], [0.006, 1.5118, 0.0980], [0.014, 1.5122, 0.0945], [0.023, 1.5130, 0.0870]],
        x,
    );
    (y, z)
}

fn lips(p: Vec3, face: f32) -> f32 {
    let v = Vec3::new;
    let mut upper = round_cone(p, v(0.0040, 1.5162, 0.0985), v(0.0205, 1.5132, 0.0875), 0.0042, 0.0018);
    upper = smin(upper, ball(p, v(0.0, 1.5150, 0.0985), 0.0042), 0.004);
    let lower = round_cone(p, v(0.0, 1.5070, 0.0965), v(0.0185, 1.5112, 0.0870), 0.0052, 0.0020);
    let mut d = smin(face, upper, 0.005);
    d = smin(d, lower, 0.005);
    let (line_y, line_z) = mouth_line(p.x);
    let reach = (p.x - 0.0225).max(0.0);
    let groove = v(p.y - line_y, (p.z - line_z - 0.0045) * 0.35, reach).length() - 0.0011;
    d = smax(d, -groove, 0.0022);
    let philtrum = round_cone(p, v(0.0, 1.5330, 0.1040), v(0.0, 1.5205, 0.1045), 0.0018, 0.0024);
    smax(d, -philtrum, 0.004)
}

/// Positive outside of the opening between the lids, negative in it, metres, seen from the front.
pub(super) fn lid_opening(p: Vec3) -> f32 {
    let x = p.x.abs() - EYE.x;
    let t = x / LID_HALF_WIDTH;
    // The outer corner is a little higher than the inner one.
    let y = p.y - EYE.y - 0.0010 * t - 0.0002;
    let arc = (1.0 - t * t).max(-0.5);
    let upper = 0.0046 * arc.signum() * arc.abs().powf(0.75);
    let lower = -0.0040 * arc.signum() * arc.abs().powf(0.90);
    let slope = 1.0 / (1.0 + (0.55 * t).powi(2)).sqrt();
    ((y - upper).max(lower - y)).max(x.abs() - LID_HALF_WIDTH) * slope
}

/// Distance to the left or right eyeball.
pub(super) fn eyeball(p: Vec3) -> f32 {
    ball(Vec3::new(p.x.abs(), p.y, p.z), EYE, EYE_RADIUS)
}

fn eye(p: Vec3, face: f32) -> f32 {
    let near = p.distance(EYE);
    if near > 0.03 {
        return face;
    }
    let opening = lid_opening(p);
    // Lids: a shell over the ball, thicker along the rims; a crease above.
    let lid = near - EYE_RADIUS - 0.0013 - 0.0006 * (-((opening - 0.0012) / 0.0015).powi(2)).exp();
    let mut d = smin(face, lid, 0.006);
    let crease_y = p.y - EYE.y - 0.0085 + 22.0 * (p.x - EYE.x).powi(2);
    let crease = Vec3::new(crease_y, near - EYE_RADIUS - 0.0035, 0.0).length() - 0.0012;
    d = smax(d, -crease, 0.004);
    // Within the opening nothing lies outside of the ball.
    let cut = opening.max(EYE_RADIUS - near);
    smax(d, -cut, 0.0010)
}

/// An ear: a tilted shell with a bowl, a rim and a lobe.
pub(super) fn ear(p: Vec3) -> f32 {
    let q = p - EAR;
    if q.length() > 0.09 {
        return q.length() - 0.05;
    }
    // Leans back and stands off the head.
    let q = turn_y(turn_x(q, 0.20), -0.38);
    let q = turn_z(q, 0.10);
    let outline = ellipsoid(q - Vec3::new(0.0, 0.004, -0.002), Vec3::new(0.0058, 0.0275, 0.0180));
    let lobe = ellipsoid(q - Vec3::new(0.0, -0.0220, 0.0040), Vec3::new(0.0048, 0.0100, 0.0090));
    let mut d = smin(outline, lobe, 0.008);
    let bowl = ellipsoid(q - Vec3::new(0.0062, -0.003, 0.003), Vec3::new(0.0050, 0.0130, 0.0088));
    let groove = ellipsoid(q - Vec3::new(0.0066, 0.0125, -0.003), Vec3::new(0.0040, 0.0105, 0.0105));
    d = smax(d, -bowl, 0.003);
    d = smax(d, -groove, 0.003);
    let tragus = ellipsoid(q - Vec3::new(0.0020, -0.004, 0.0135), Vec3::new(0.0036, 0.0060, 0.0045));
    smin(d, tragus, 0.003)
}

/// How far inside the hair's region a point of the surface lies, metres, negative outside. The line runs 65 mm
/// above the brow, before the ears at the temples, behind them, and to the nape.
pub(super) fn inside_hairline(p: Vec3) -> f32 {
    // Azimuth about the skull's axis in degrees, 0 at the face; height of the line.
    const LINE: [[f32; 2]; 16] = [
        [0.0, 1.6650],
        [14.0, 1.6665],
        [30.0, 1.6650],
        [44.0, 1.6540],
        [56.0, 1.6370],
        [66.0, 1.6220],
        [74.0, 1.6020],
        [80.0, 1.5800],
        [85.0, 1.5740],
        [91.0, 1.5900],
        [100.0, 1.6080],
        [112.0, 1.6060],
        [122.0, 1.5820],
        [132.0, 1.5480],
        [150.0, 1.5180],
        [180.0, 1.5090],
    ];
    let azimuth = p.x.abs().atan2(p.z - 0.002).to_degrees();
    let at = |a: f32| curve(&LINE, a.clamp(0.0, 180.0))[1];
    let radius = p.x.hypot(p.z - 0.002).max(0.02);
    let rise = (at(azimuth + 1.0) - at(azimuth - 1.0)) / (2.0_f32.to_radians() * radius);
    let line = (p.y - at(azimuth)) / (1.0 + rise * rise).sqrt();
    line.min(ear(Vec3::new(p.x.abs(), p.y, p.z)) - 0.0045)
}
