//! A guess of the scalp for heads whose file has no mask.

use glam::Vec3;

/// Height of the hairline around a head as a fraction of the distance from chin to crown, by the angle from
/// the front in degrees. It follows the proportions of adult heads: the forehead is the upper third of the
/// face; temples recede; the line comes down in front of the ear, passes behind it, and ends at the nape.
const HAIRLINE: [(f32, f32); 11] = [
    (0.0, 0.855),
    (25.0, 0.85),
    (45.0, 0.80),
    (58.0, 0.70),
    (70.0, 0.60),
    (84.0, 0.50),
    (96.0, 0.50),
    (112.0, 0.40),
    (130.0, 0.27),
    (150.0, 0.17),
    (180.0, 0.13),
];

/// Length over which the mask fades at the hairline, as a fraction of the head's height: 12 mm.
const FADE: f32 = 0.05;

/// Guesses a scalp mask for vertices in head space. `of_head` marks the vertices of the head, as opposed to
/// the neck.
pub(super) fn guess_scalp(positions: &[Vec3], normals: &[Vec3], of_head: &[bool]) -> Vec<f32> {
    let head = || positions.iter().zip(of_head).filter(|(_, of_head)| **of_head).map(|(p, _)| *p);
    let Some(frame) = HeadFrame::new(&head().collect::<Vec<_>>()) else {
        return vec![0.0; positions.len()];
    };
    positions.iter().zip(normals).map(|(&p, &n)| frame.mask(p, n)).collect()
}

/// Measurements of a head: chin, crown, and the centre of the skull.
struct HeadFrame {
    chin: f32,
    height: f32,
    middle: Vec3,
    /// Half the width and depth of the skull, metres.
    half: Vec3,
}

impl HeadFrame {
    fn new(head: &[Vec3]) -> Option<Self> {
        let crown = head.iter().map(|p| p.y).reduce(f32::max)?;
        // The upper part of the skull, without nose, jaw and neck. A head is about 1.2 times as high as deep.
        let extent = |points: &mut dyn Iterator<Item = Vec3>| {
            points.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
        };
        let (low, high) = extent(&mut head.iter().copied());
        let rough = ((high.z - low.z) * 1.2).min(high.y - low.y).max(1e-3);
        let (low, high) = extent(&mut head.iter().copied().filter(|p| p.y > crown - 0.4 * rough));
        let depth = (high.z - low.z).max(high.x - low.x);
        let middle = 0.5 * (low + high);
        // The chin is the lowest point of the front; the throat is cut off there if the head's weights
        // include it.
        let front = head.iter().filter(|p| p.z > middle.z + 0.2 * depth);
        let chin = front.map(|p| p.y).reduce(f32::min).unwrap_or(low.y);
        let height = (crown - chin).clamp(1.0 * depth, 1.3 * depth).max(1e-3);
        let half = (0.5 * (high - low)).max(Vec3::splat(1e-3));
        Some(Self { chin: crown - height, height, middle: middle.with_y(crown - 0.45 * height), half })
    }

    fn mask(&self, p: Vec3, normal: Vec3) -> f32 {
        let from_middle = p - self.middle;
        let angle = from_middle.x.abs().atan2(from_middle.z).to_degrees();
        let height = (p.y - self.chin) / self.height;
        let above = (height - hairline(angle)) / FADE;
        // Ears stand off the skull; the insides of mouth and eyes face inward.
        let ring = Vec3::new(from_middle.x / self.half.x, 0.0, from_middle.z / self.half.z).length();
        let ear = if height < 0.62 && (60.0..135.0).contains(&angle) {
            ((ring - 1.02) / 0.06).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let outward = if normal.dot(from_middle) > 0.0 { 1.0 } else { 0.0 };
        let u = above.clamp(0.0, 1.0);
        u * u * (3.0 - 2.0 * u) * (1.0 - ear) * outward
    }
}

/// Height of the hairline at an angle from the front, degrees.
fn hairline(angle: f32) -> f32 {
    let next = HAIRLINE.iter().position(|(a, _)| *a >= angle).unwrap_or(HAIRLINE.len() - 1).max(1);
    let ((a0, h0), (a1, h1)) = (HAIRLINE[next - 1], HAIRLINE[next]);
    h0 + (h1 - h0) * ((angle - a0) / (a1 - a0)).clamp(0.0, 1.0)
}
