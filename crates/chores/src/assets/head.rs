//! The head: cranium, face, eyes and ears, as one signed distance function.
//!
//! World space of the rest pose, metres; the head is 0.23 m from chin (y = 1.47) to crown (y = 1.70), and the
//! face looks toward +Z. Brow, nose base and chin divide the face below the hairline in thirds.

use glam::Vec3;

use super::sdf::{Loft, ball, curve, ellipsoid, round_cone, smax, smin, turn_x, turn_y, turn_z};

/// Height of the chin's lowest point.
pub(super) const CHIN_Y: f32 = 1.47;
/// Height of the brow; the hairline at the middle is 65 mm above.
pub(super) const BROW_Y: f32 = 1.600;
/// Centre of the left eyeball; the right one is its mirror image.
pub(super) const EYE: Vec3 = Vec3::new(0.0315, 1.585, 0.0785);
/// Radius of an eyeball.
pub(super) const EYE_RADIUS: f32 = 0.0130;
/// Centre of the left ear.
pub(super) const EAR: Vec3 = Vec3::new(0.0690, 1.567, -0.010);
/// Half width of the opening between the eyelids.
const LID_HALF_WIDTH: f32 = 0.0153;

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
                    row(1.4850, 0.0190, 0.0845, 0.070, 0.0560),
                    row(1.4900, 0.0285, 0.0872, 0.055, 0.0240),
                    row(1.5000, 0.0370, 0.0880, 0.043, 0.0040),
                    row(1.5120, 0.0455, 0.0890, 0.034, -0.010),
                    row(1.5250, 0.0525, 0.0905, 0.027, -0.022),
                    row(1.5400, 0.0590, 0.0920, 0.022, -0.035),
                    row(1.5570, 0.0640, 0.0925, 0.018, -0.045),
                    row(1.5750, 0.0680, 0.0935, 0.015, -0.050),
                    row(1.5950, 0.0700, 0.0970, 0.012, -0.055),
                    row(1.6150, 0.0690, 0.0985, 0.010, -0.055),
                    row(1.6400, 0.0600, 0.0850, 0.010, -0.050),
                ],
            },
        }
    }

    /// Distance to the head's surface.
    pub(super) fn distance(&self, world: Vec3) -> f32 {
        // The mirror is rounded by 1.5 mm, so that halves meet smoothly at the middle.
        let p = Vec3::new((world.x * world.x + 2.3e-6).sqrt(), world.y, world.z);
        let frontal = ellipsoid(p - Vec3::new(0.0, 1.6185, 0.020), Vec3::new(0.0700, 0.0720, 0.0805));
        let parietal = ellipsoid(p - Vec3::new(0.0, 1.6240, -0.0180), Vec3::new(0.0775, 0.0760, 0.0745));
        let occiput = ellipsoid(p - Vec3::new(0.0, 1.5850, -0.0380), Vec3::new(0.058, 0.055, 0.0480));
        let mut d = smin(smin(frontal, parietal, 0.025), occiput, 0.030);
        d = smin(d, self.face.distance(p), 0.018);
        d = features(p, d);
        smin(d, ear(p), 0.006)
    }
}

/// Details of the face that are finer than the loft.
fn features(p: Vec3, skull: f32) -> f32 {
    let v = Vec3::new;
    let mut d = skull;
    if p.z < 0.0 {
        return jaw(p, d);
    }
    d = jaw(p, d);
    // Brow ridge, then the sockets below it.
    d = smin(d, round_cone(p, v(0.010, 1.6015, 0.0920), v(0.044, 1.6045, 0.0770), 0.0070, 0.0060), 0.022);
    d = smax(d, -ellipsoid(turn_y(p - v(0.0300, 1.5850, 0.1020), 0.25), v(0.0190, 0.0120, 0.0125)), 0.016);
    // Cheekbones and the soft cheek below.
    d = smin(d, ellipsoid(turn_y(p - v(0.0410, 1.5570, 0.0560), -0.5), v(0.0210, 0.0150, 0.0210)), 0.028);
    d = smin(d, ellipsoid(p - v(0.0330, 1.5320, 0.0600), v(0.0210, 0.0240, 0.0220)), 0.024);
    // The muzzle that carries the lips, and the chin.
    d = smin(d, ellipsoid(p - v(0.0, 1.5150, 0.0700), v(0.0300, 0.0260, 0.0290)), 0.022);
    d = smin(d, ellipsoid(p - v(0.0, 1.4870, 0.0790), v(0.0165, 0.0135, 0.0150)), 0.020);
    // The floor of the mouth slopes from the chin to the throat.
    d = smin(d, round_cone(p, v(0.0, 1.4895, 0.0680), v(0.0, 1.5080, 0.0250), 0.0140, 0.0210), 0.024);
    d = nose(p, d);
    d = lips(p, d);
    eye(p, d)
}

fn jaw(p: Vec3, d: f32) -> f32 {
    let v = Vec3::new;
    let ramus = round_cone(p, v(0.0520, 1.565, 0.002), v(0.0430, 1.5265, 0.0100), 0.007, 0.0085);
    let body = round_cone(p, v(0.0430, 1.5265, 0.0100), v(0.0080, 1.4895, 0.0680), 0.0085, 0.0085);
    smin(d, smin(ramus, body, 0.024), 0.030)
}

fn nose(p: Vec3, face: f32) -> f32 {
    let v = Vec3::new;
    let bridge = round_cone(p, v(0.0, 1.5930, 0.0900), v(0.0, 1.5500, 0.1090), 0.0080, 0.0075);
    let tip = ellipsoid(p - v(0.0, 1.5455, 0.1115), v(0.0085, 0.0078, 0.0090));
    let wing = ellipsoid(turn_y(p - v(0.0090, 1.5420, 0.1020), -0.35), v(0.0056, 0.0062, 0.0082));
    let root = round_cone(p, v(0.0, 1.5860, 0.0850), v(0.0, 1.5470, 0.0960), 0.0085, 0.0115);
    let mut n = smin(smin(smin(bridge, root, 0.012), tip, 0.010), wing, 0.009);
    let nostril = ellipsoid(turn_y(p - v(0.0054, 1.5350, 0.1060), -0.30), v(0.0026, 0.0030, 0.0046));
    n = smax(n, -nostril, 0.004);
    smin(face, n, 0.014)
}

/// The line between the lips: height and depth of the surface at a distance from the middle.
fn mouth_line(x: f32) -> (f32, f32) {
    let [_, y, z] = curve(
        &[[0.0, 1.5125, 0.1000], [0.006, 1.5118, 0.0990], [0.014, 1.5122, 0.0945], [0.023, 1.5130, 0.0860]],
        x,
    );
    (y, z)
}

fn lips(p: Vec3, face: f32) -> f32 {
    let v = Vec3::new;
    let mut upper = round_cone(p, v(0.0040, 1.5164, 0.0985), v(0.0205, 1.5132, 0.0865), 0.0040, 0.0018);
    upper = smin(upper, ball(p, v(0.0, 1.5152, 0.0990), 0.0042), 0.004);
    let lower = round_cone(p, v(0.0, 1.5070, 0.0970), v(0.0185, 1.5112, 0.0865), 0.0050, 0.0020);
    let mut d = smin(face, upper, 0.007);
    d = smin(d, lower, 0.007);
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
    let upper = 0.0052 * arc.signum() * arc.abs().powf(0.75);
    let lower = -0.0043 * arc.signum() * arc.abs().powf(0.90);
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
    // Within the opening nothing is outside the eyeball.
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
    let q = turn_y(turn_x(q, 0.20), -0.32);
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

/// Distance of a point of the surface from the edge of the hair's region in metres, negative outside. The hairline runs 65 mm
/// above the brow, in front of the ears at the temples, behind the ears, and to the nape.
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
        [132.0, 1.5440],
        [150.0, 1.5110],
        [180.0, 1.5030],
    ];
    let azimuth = p.x.abs().atan2(p.z - 0.002).to_degrees();
    let at = |a: f32| curve(&LINE, a.clamp(0.0, 180.0))[1];
    let radius = p.x.hypot(p.z - 0.002).max(0.02);
    let rise = (at(azimuth + 1.0) - at(azimuth - 1.0)) / (2.0_f32.to_radians() * radius);
    let line = (p.y - at(azimuth)) / (1.0 + rise * rise).sqrt();
    line.min(ear(Vec3::new(p.x.abs(), p.y, p.z)) - 0.0045)
}
