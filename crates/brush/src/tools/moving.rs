//! Tools that move hair.

use glam::Vec3;
use lovelock_base::numbers::smoothstep;
use lovelock_groom::{Blade, Bounded, GuideFrame, Haircut, Hairstyle, Obstacle};
use lovelock_style::hand::smallest_turn;

use super::Stamp;
use crate::touch::Touched;

/// How far hair moves at a dab of a tool that does not follow the brush, as a part of the radius.
const REACH: f32 = 0.15;
/// Hair that is combed away from a parting moves wholly from this distance from its root on, metres.
const PART_FROM: f32 = 0.03;
/// The distances from the root between which a parting has less and less effect, metres.
const PART_FADES: [f32; 2] = [0.05, 0.18];
/// Clearance of flattened hair from the body, metres.
const FLAT: f32 = 0.004;

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
    pub fn of(touched: &Touched, mirrored: bool) -> Option<Self> {
        let weights = touched.weights.iter().enumerate().skip(1);
        let (point, weight) = weights.max_by(|a, b| a.1.total_cmp(b.1))?;
        (*weight > 0.0).then_some(Self { guide: touched.guide, point, weight: *weight, mirrored })
    }
}

impl Stamp<'_> {
    fn moved(touched: &Touched, by: impl Fn(usize, Vec3) -> Vec3) -> Vec<Vec3> {
        let new = |(i, p): (usize, &Vec3)| {
            let weight = touched.weights[i];
            if weight > 0.0 && i > 0 { *p + by(i, *p) * weight } else { *p }
        };
        touched.points.iter().enumerate().map(new).collect()
    }

    pub(super) fn combed(&self, touched: &Touched) -> Vec<Vec3> {
        Self::moved(touched, |_, _| self.dab.step)
    }

    pub(super) fn puffed(&self, touched: &Touched) -> Vec<Vec3> {
        let root = touched.points[0];
        let outward = Bounded(self.obstacle).distance(root).1;
        Self::moved(touched, |_, _| outward * (REACH * self.dab.radius))
    }

    pub(super) fn flattened(&self, touched: &Touched) -> Vec<Vec3> {
        let body = Bounded(self.obstacle);
        Self::moved(touched, |_, p| {
            let (distance, normal) = body.distance(p);
            -normal * (distance - FLAT).clamp(0.0, REACH * self.dab.radius)
        })
    }

    pub(super) fn attracted(&self, touched: &Touched) -> Vec<Vec3> {
        let reach = REACH * self.dab.radius;
        Self::moved(touched, |_, p| {
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

    /// Hair is moved by the side on which its root is.
    pub(super) fn parted(&self, touched: &Touched) -> Option<Vec<Vec3>> {
        let root = touched.points[0];
        let normal = Bounded(self.obstacle).distance(self.dab.centre).1;
        let side = normal.cross(self.dab.step).try_normalize()?;
        let away = root.distance(self.dab.centre) / self.dab.radius;
        if away >= 1.0 {
            return None;
        }
        let weight =
            self.settings.strength * self.dab.pressure * self.settings.falloff.at(away).clamp(0.0, 1.0);
        let to_left = (root - self.dab.centre).dot(side) >= 0.0;
        let side = if to_left == self.inverted { -side } else { side };
        let mut metres = 0.0;
        let mut out = touched.points.clone();
        for (i, p) in out.iter_mut().enumerate().skip(1) {
            metres += touched.points[i].distance(touched.points[i - 1]);
            let fade = 1.0 - smoothstep(PART_FADES[0], PART_FADES[1], metres);
            let amount = weight * fade * (metres / PART_FROM).min(1.0);
            *p += side * (3.0 * REACH * self.dab.radius * amount);
        }
        Some(out)
    }

    /// A guide turns about its root as a whole, so that its grabbed point follows the brush.
    pub(super) fn placed(&self, touched: &Touched) -> Option<Vec<Vec3>> {
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
    pub(super) fn cut(&self, touched: &Touched) -> Option<f32> {
        let mut style = Hairstyle::default();
        style.guides.points_per_guide = touched.points.len();
        style.guides.push(&touched.points);
        let frame = GuideFrame::at_rest(&style.guides, glam::Affine3A::IDENTITY, 0.0);
        let blade = Blade::Sphere { centre: self.dab.centre, radius: self.dab.radius };
        let cut = Haircut::of(&style, &frame, &blade)?;
        Some(cut.kept[0] * (touched.points.len() - 1) as f32)
    }
}
