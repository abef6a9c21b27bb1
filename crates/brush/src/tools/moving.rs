//! Tools that move hair.

use glam::Vec3;
use lovelock_base::numbers::smoothstep;
use lovelock_groom::{Blade, Bounded, GuideFrame, Haircut, Hairstyle, Obstacle};
use lovelock_style::hand::smallest_turn;

use super::Stamp;
use crate::touch::TouchedGuide;

/// How far hair moves at a dab of a tool that does not follow the brush, as a part of the radius.
const REACH: f32 = 0.15;
/// Hair turns into the direction of a comb within about this way, in radii.
const COMBS_WITHIN: f32 = 0.8;
/// The side to which a lock falls is that of its points at this part of its length.
const FALLS_AT: f32 = 0.2;
/// A parting turns hair over in an upright mirror if that is turned from the tangent of the head by at most this cosine.
const UPRIGHT: f32 = 0.5;
/// Hair up to this far from the body keeps its distance while it is turned over, metres.
const LIES: f32 = 0.03;
/// Wisps that a parting touches less than this stay.
const PARTS_FROM: f32 = 0.2;
/// Clearance of flattened hair from the body, metres.
const FLAT: f32 = 0.004;
/// Hair up to the first distance from the body lies on it, or on other hair that does, and slides along it under a comb. From the second
/// distance on it hangs free and follows the comb. Metres.
const SLIDES: [f32; 2] = [0.06, 0.12];
/// The same for a comb that presses hair toward the body.
const PRESSED: [f32; 2] = [0.01, 0.04];
/// Combed hair that was nearer to the body than this may come up to here, metres.
const LOOSE: f32 = 0.012;

/// A guide that was grabbed when a stroke began.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grab {
    pub guide: usize,
    /// The point that follows the brush.
    pub point: usize,
    /// How closely it follows.
    pub weight: f32,
    /// Whether it follows the brush on the other side of the head.
    pub mirrored: bool,
}

impl Grab {
    /// The point of a guide that is touched most.
    pub fn of(touched: &TouchedGuide, mirrored: bool) -> Option<Self> {
        let weights = touched.weights.iter().enumerate().skip(1);
        let (point, weight) = weights.max_by(|a, b| a.1.total_cmp(b.1))?;
        (*weight > 0.0).then_some(Self { guide: touched.guide, point, weight: *weight, mirrored })
    }
}

impl Stamp<'_> {
    fn moved(touched: &TouchedGuide, weights: &[f32], by: impl Fn(usize, Vec3) -> Vec3) -> Vec<Vec3> {
        let new = |(i, p): (usize, &Vec3)| {
            let weight = weights[i];
            if weight > 0.0 && i > 0 { *p + by(i, *p) * weight } else { *p }
        };
        touched.points.iter().enumerate().map(new).collect()
    }

    /// What is left of a movement of hair at `p` that slides along the surface of the head and of the hair on it.
    fn along_surface(&self, p: Vec3, step: Vec3) -> Vec3 {
        let (distance, normal) = Bounded(self.obstacle).distance(p);
        let lift = step.dot(normal);
        let [from, to] = if lift > 0.0 { SLIDES } else { PRESSED };
        step - normal * (lift * (1.0 - smoothstep(from, to, distance)))
    }

    /// Hair goes with the brush along the surface, and the part of it that is under the brush turns into the direction in which the brush
    /// moves there. Along a stroke that begins at the roots, the brush so reaches one link after the other, and the hair follows its way.
    /// Hair that lies on the head does not come off it.
    pub(super) fn combed(&self, touched: &TouchedGuide) -> Vec<Vec3> {
        let (points, trailing) = (&touched.points, touched.trailing());
        let mut step = Vec3::ZERO;
        let mut steps = Vec::with_capacity(points.len());
        for (p, weight) in points.iter().zip(&touched.weights) {
            // Hair beyond the brush follows what it hangs on.
            if *weight > 0.0 {
                step = self.along_surface(*p, self.dab.step);
            }
            steps.push(step);
        }
        let moved = Self::moved(touched, &trailing, |i, _| steps[i]);
        let rate = self.dab.step.length() / (COMBS_WITHIN * self.dab.radius);
        let mut out = Vec::with_capacity(moved.len());
        out.push(moved[0]);
        for (i, pair) in moved.windows(2).enumerate() {
            let link = pair[1] - pair[0];
            let weight = touched.weights[i].max(touched.weights[i + 1]);
            let direction = link.normalize_or_zero();
            let Some(wanted) = steps[i + 1].try_normalize().filter(|_| weight > 0.0) else {
                out.push(out[i] + link);
                continue;
            };
            // Hair is pushed aside by a brush that crosses it more than it turns, and hardly turns where the surface holds it.
            let along = 0.5 + 0.5 * direction.dot(wanted);
            let free = steps[i + 1].length() / self.dab.step.length();
            let part = (1.0 - (-weight * rate * free).exp()) * along;
            let turned = direction.lerp(wanted, part).normalize_or(direction);
            out.push(out[i] + turned * link.length());
        }
        let body = Bounded(self.obstacle);
        for (i, p) in out.iter_mut().enumerate().skip(1).filter(|(i, _)| touched.weights[*i] > 0.0) {
            let before = body.distance(points[i]).0;
            let (distance, normal) = body.distance(*p);
            let lift = (distance - before.max(LOOSE)).max(0.0);
            *p -= normal * (touched.weights[i] * lift * (1.0 - smoothstep(SLIDES[0], SLIDES[1], before)));
        }
        out
    }

    pub(super) fn puffed(&self, touched: &TouchedGuide) -> Vec<Vec3> {
        let root = touched.points[0];
        let outward = Bounded(self.obstacle).distance(root).1;
        Self::moved(touched, &touched.trailing(), |_, _| outward * (REACH * self.dab.radius))
    }

    pub(super) fn flattened(&self, touched: &TouchedGuide) -> Vec<Vec3> {
        let body = Bounded(self.obstacle);
        Self::moved(touched, &touched.weights, |_, p| {
            let (distance, normal) = body.distance(p);
            -normal * (distance - FLAT).clamp(0.0, REACH * self.dab.radius)
        })
    }

    pub(super) fn attracted(&self, touched: &TouchedGuide) -> Vec<Vec3> {
        let reach = REACH * self.dab.radius;
        Self::moved(touched, &touched.weights, |_, p| {
            let pairs = self.path.windows(2).map(|pair| {
                let along = pair[1] - pair[0];
                let t = (p - pair[0]).dot(along) / along.length_squared().max(1e-12);
                pair[0] + along * t.clamp(0.0, 1.0)
            });
            let places = pairs.chain(self.path.last().copied());
            let nearest = places.min_by(|a, b| a.distance_squared(p).total_cmp(&b.distance_squared(p)));
            let toward = (nearest.unwrap_or(p) - p).clamp_length_max(reach);
            if self.inverted { -toward.normalize_or_zero() * reach } else { toward }
        })
    }

    /// A lock falls to the side of the line on which its root is. One that falls to the other is turned over as a mirror would show it, so
    /// that it lies on the head as it did before. Wisps are not divided, because their strands would stand up between the two sides.
    pub(super) fn parted(&self, touched: &TouchedGuide) -> Option<Vec<Vec3>> {
        let centre = self.dab.centre;
        let normal = Bounded(self.obstacle).distance(centre).1;
        let side = normal.cross(self.dab.step).try_normalize()?;
        let lock = self.locks.of_guide(touched.guide);
        let mean = |of: &dyn Fn(usize) -> Vec3| lock.iter().map(|guide| of(*guide)).sum::<Vec3>() / 3.0;
        let root = mean(&|guide| self.seen.point(guide, 0));
        let away = root.distance(centre) / self.dab.radius;
        let weight =
            self.settings.strength * self.dab.pressure * self.settings.falloff.at(away).clamp(0.0, 1.0);
        if away >= 1.0 || weight < PARTS_FROM {
            return None;
        }
        let at = ((self.seen.points_per_guide - 1) as f32 * FALLS_AT).ceil() as usize;
        let falls = mean(&|guide| self.seen.point(guide, at)) - root;
        let is_left = (root - centre).dot(side) >= 0.0;
        let away_from_line = if is_left == self.inverted { -side } else { side };
        if falls.dot(away_from_line) >= 0.0 {
            return None;
        }
        // The mirror is upright where it can be, because hair hangs down on both sides of it.
        let upright = Vec3::Y.cross(self.dab.step).normalize_or_zero();
        let across = if upright.dot(side).abs() > UPRIGHT { upright } else { side };
        let (own, body) = (touched.points[0], Bounded(self.obstacle));
        let mirrored = |p: &Vec3| {
            let other = *p - across * (2.0 * across.dot(*p - own));
            // As far from the body as before.
            let (distance, normal) = body.distance(other);
            other + normal * (body.distance(*p).0.clamp(0.0, LIES) - distance).max(0.0)
        };
        Some(touched.points.iter().map(mirrored).collect())
    }

    /// A guide turns about its root as a whole, so that its grabbed point follows the brush.
    pub(super) fn placed(&self, touched: &TouchedGuide) -> Option<Vec<Vec3>> {
        let grab = self
            .grab
            .iter()
            .find(|grab| grab.guide == touched.guide && grab.mirrored == self.dab.mirrored)?;
        let root = touched.points[0];
        let from = *touched.points.get(grab.point)? - root;
        let to = from + self.dab.step * grab.weight;
        let turn = smallest_turn(from.try_normalize()?, to.try_normalize()?);
        Some(touched.points.iter().map(|p| root + turn * (*p - root)).collect())
    }

    /// Where the brush cuts a guide, in links.
    pub(super) fn cut(&self, touched: &TouchedGuide) -> Option<f32> {
        let mut style = Hairstyle::default();
        style.guides.points_per_guide = touched.points.len();
        style.guides.push(&touched.points);
        let frame = GuideFrame::at_rest(&style.guides, glam::Affine3A::IDENTITY, 0.0);
        let blade = Blade::Sphere { centre: self.dab.centre, radius: self.dab.radius };
        let cut = Haircut::of(&style, &frame, &blade)?;
        Some(cut.kept[0] * (touched.points.len() - 1) as f32)
    }
}
