//! The shapes of strands on the skin.

use glam::Vec3;
use lovelock_base::random::SplitMix64;

use super::roots::{SkinRoot, point_of};
use super::{Course, SkinGroom, SkinSurface};

/// Points of a strand.
pub(super) const POINTS: usize = 7;

/// Parts of the mask of half of the face, from the middle of the face outward, for its centre line.
const PARTS: usize = 8;
/// The least value of the mask where the extent of the mask is measured.
const MARKED: f32 = 0.25;

/// The mask of half of the face.
#[derive(Clone, Copy, Debug, Default)]
struct Half {
    /// Its least and largest distance from the middle of the face, metres.
    across: [f32; 2],
    /// The height of its centre line in each part, and half of its own height there, metres.
    height: [f32; PARTS],
    extent: [f32; PARTS],
}

/// The halves of a mask: that at smaller x, and that at larger x.
pub(super) struct Halves {
    middle: f32,
    of: [Half; 2],
}

impl Halves {
    /// Those of a mask on the vertices of a surface.
    pub fn of(surface: &SkinSurface, mask: &[f32]) -> Self {
        let marked = || {
            let values = surface.positions.iter().zip(mask);
            values.filter(|(p, value)| **value >= MARKED && p.is_finite()).map(|(p, value)| (*p, *value))
        };
        let (low, high) = marked()
            .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), (p, _)| (low.min(p.x), high.max(p.x)));
        let middle = if low <= high { 0.5 * (low + high) } else { 0.0 };
        let half = |is_right: bool| {
            let own = || marked().filter(|(p, _)| (p.x >= middle) == is_right);
            let (near, far) = own().fold((f32::INFINITY, 0.0_f32), |(near, far), (p, _)| {
                let away = (p.x - middle).abs();
                (near.min(away), far.max(away))
            });
            let mut half = Half { across: [near.min(far), far], ..Half::default() };
            let mut sums = [[0.0_f32; 3]; PARTS];
            for (p, value) in own() {
                let part = ((half.along(p, middle) * PARTS as f32) as usize).min(PARTS - 1);
                for (sum, add) in sums[part].iter_mut().zip([value, value * p.y, value * p.y * p.y]) {
                    *sum += add;
                }
            }
            let (mut last, mean) = (None, own().map(|(p, _)| p.y).sum::<f32>() / own().count().max(1) as f32);
            for (part, [weight, y, yy]) in sums.into_iter().enumerate() {
                if weight > 0.0 {
                    let centre = y / weight;
                    // An even band has a deviation of its half height by the root of 3.
                    last = Some([centre, (3.0 * (yy / weight - centre * centre).max(0.0)).sqrt()]);
                }
                [half.height[part], half.extent[part]] = last.unwrap_or([mean, 0.0]);
            }
            half
        };
        Self { middle, of: [half(false), half(true)] }
    }

    fn at(&self, p: Vec3) -> Place {
        let is_right = p.x >= self.middle;
        let half = &self.of[usize::from(is_right)];
        let along = half.along(p, self.middle);
        let place = (along * PARTS as f32 - 0.5).clamp(0.0, (PARTS - 1) as f32);
        let first = (place as usize).min(PARTS - 2);
        let t = place - first as f32;
        let mix = |of: &[f32; PARTS]| of[first] + (of[first + 1] - of[first]) * t;
        let width = (half.across[1] - half.across[0]).max(1e-6) / PARTS as f32;
        // Over three parts, so that a few vertices more or less do not turn the line.
        let (before, after) = (first.saturating_sub(1), (first + 2).min(PARTS - 1));
        let slope = (half.height[after] - half.height[before]) / (width * (after - before).max(1) as f32);
        Place {
            out: if is_right { 1.0 } else { -1.0 },
            along,
            slope: if slope.is_finite() { slope.clamp(-1.0, 1.0) } else { 0.0 },
            above: ((p.y - mix(&half.height)) / mix(&half.extent).max(1e-5)).clamp(-1.0, 1.0),
        }
    }
}

impl Half {
    /// 0 at the end next to the middle of the face, 1 at the outer end.
    fn along(&self, p: Vec3, middle: f32) -> f32 {
        let [near, far] = self.across;
        (((p.x - middle).abs() - near) / (far - near).max(1e-6)).clamp(0.0, 1.0)
    }
}

/// A place in the mask of half of the face.
#[derive(Clone, Copy, Debug)]
struct Place {
    /// The sign of x away from the middle of the face.
    out: f32,
    /// 0 at the inner end, 1 at the outer end.
    along: f32,
    /// Slope of the centre line outward.
    slope: f32,
    /// -1 at the lower edge, 1 at the upper edge.
    above: f32,
}

/// The points of a strand at a root, world space, on a head `scale` times as large as the dancer's. The first one is the root.
pub(super) fn strand_at(
    surface: &SkinSurface,
    (groom, halves): (&SkinGroom, &Halves),
    root: SkinRoot,
    scale: f32,
    random: &mut SplitMix64,
) -> Option<[Vec3; POINTS]> {
    let at = point_of(surface, root)?;
    let place = halves.at(at);
    let [short, long] = groom.length;
    let share = match groom.course {
        // Hairs of the ends of a brow are shorter.
        Course::Temple { .. } => 1.0 - (2.0 * place.along - 0.9).powi(2) * 0.6,
        // The longest lashes are beyond the middle of a lid.
        Course::Forward { .. } => 1.0 - (1.6 * (place.along - 0.62)).powi(2),
    };
    let share = (share + 0.2 * random.signed()).clamp(0.0, 1.0);
    let length = (short + (long - short) * share) * scale;
    let normal = normal_at(surface, root)?;
    let points = match groom.course {
        Course::Temple { lift } => lying(place, normal, lift, length, random),
        Course::Forward { elevation, spread } => standing(place, elevation, spread, length, random),
    };
    Some(points.map(|p| at + p))
}

/// A hair that lies on the skin toward the temple, relative to its root.
fn lying(place: Place, normal: Vec3, lift: f32, length: f32, random: &mut SplitMix64) -> [Vec3; POINTS] {
    let on_skin = |v: Vec3| (v - normal * v.dot(normal)).normalize_or(v);
    let along = on_skin(Vec3::new(place.out, place.slope, 0.0));
    let up = (Vec3::Y - normal * normal.y - along * along.y).normalize_or(Vec3::Y);
    // Inner hairs stand up. Those of the lower edge lean up and those of the upper edge down, so that they meet along the brow.
    let inner = 1.15 * (1.0 - place.along / 0.4).clamp(0.0, 1.0).powi(2);
    let angle = 0.22 + inner - (0.32 * (1.0 - 0.7 * inner)) * place.above + 0.14 * random.signed();
    let bend = -0.35 * angle + 0.1 * random.signed();
    let lift = lift * (0.8 + 0.4 * random.unit());
    let step = length / (POINTS - 1) as f32;
    let mut at = Vec3::ZERO;
    std::array::from_fn(|k| {
        let here = at;
        let t = (k as f32 + 0.5) / (POINTS - 1) as f32;
        let (sin, cos) = (angle + bend * t).sin_cos();
        // It leaves the skin, and lies on it from the middle on.
        let (rise, run) = (lift * (1.0 - 1.4 * t)).sin_cos();
        at += step * (run * (cos * along + sin * up) + rise * normal);
        here
    })
}

/// A hair that stands away from the face, relative to its root.
fn standing(
    place: Place,
    elevation: [f32; 2],
    spread: f32,
    length: f32,
    random: &mut SplitMix64,
) -> [Vec3; POINTS] {
    // From the inner end, where it leans to the nose, to the outer end.
    let side = place.out * spread * (2.0 * place.along - 0.85) + 0.12 * random.signed();
    let ahead = Vec3::new(side, 0.0, 1.0).normalize_or(Vec3::Z);
    let tilt = 0.12 * random.signed();
    let step = length / (POINTS - 1) as f32;
    let mut at = Vec3::ZERO;
    std::array::from_fn(|k| {
        let here = at;
        let t = (k as f32 + 0.5) / (POINTS - 1) as f32;
        let angle = elevation[0] + (elevation[1] - elevation[0]) * t + tilt;
        let (sin, cos) = angle.sin_cos();
        at += step * (cos * ahead + sin * Vec3::Y);
        here
    })
}

/// The normal of the surface at a root.
fn normal_at(surface: &SkinSurface, root: SkinRoot) -> Option<Vec3> {
    let triangle = *surface.triangles.get(root.triangle)?;
    let [a, b, c] = surface.corners(triangle)?;
    let flat = (b - a).cross(c - a).normalize_or(Vec3::Z);
    let of = |k: usize| surface.normals.get(triangle[k] as usize).copied().unwrap_or(flat);
    let smooth: Vec3 = (0..3).map(|k| of(k) * root.weights[k]).sum();
    Some(if smooth.is_finite() { smooth.normalize_or(flat) } else { flat })
}
