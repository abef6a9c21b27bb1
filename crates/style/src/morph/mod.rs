//! Turning one hairstyle into another without a jump.
//!
//! A [`Morph`] has one layout of guides and strands for all amounts between the two hairstyles, so hair keeps moving while the amount
//! changes. At 0 and 1 its strands are those of one hairstyle. In between, guides turn link by link from one shape to the other, and
//! strands that only one of them has grow out of the scalp or draw back into it.

mod matching;

use std::sync::Arc;

use glam::Vec3;
use lovelock_groom::{
    Bounded, ColourSamples, Guides, Hairstyle, MotionFactors, Obstacle, Rope, StrandColours, StrandSet, Wisp,
    WispCurve, widest_radii,
};
use rayon::prelude::*;

use crate::guides::{turn_between, turned};
use matching::{WispMatch, matched};

/// The part of itself that is left of a strand which the hairstyle does not have.
const STUB: f32 = 1e-3;
/// Clearance between guides and the body, metres, where both hairstyles have that much.
const CLEAR: f32 = 0.003;

/// Two hairstyles on one head, and everything between them.
#[derive(Debug)]
pub struct Morph {
    styles: [Arc<Hairstyle>; 2],
    wisps: Vec<WispMatch>,
    points_per_guide: usize,
    /// The guides of each wisp in both hairstyles, three by three, with the same number of points.
    guides: [Vec<Vec3>; 2],
    /// Which guide of the wisp each of the three is, in both hairstyles.
    order: Vec<[[usize; 3]; 2]>,
}

impl Morph {
    /// Matches two hairstyles on the same head by the places of their roots.
    pub fn new(styles: [Arc<Hairstyle>; 2]) -> Self {
        let [a, b] = styles.each_ref().map(|style| &**style);
        let wisps = matched([a, b]);
        let points_per_guide = a.guides.points_per_guide.max(b.guides.points_per_guide).max(2);
        let mut morph =
            Self { order: Vec::new(), guides: [Vec::new(), Vec::new()], styles, points_per_guide, wisps };
        for index in 0..morph.wisps.len() {
            let of = morph.wisps[index].of;
            let shapes = [0, 1].map(|side| of[side].map(|wisp| morph.resampled(side, wisp as usize)));
            let order = match &shapes {
                [Some(a), Some(b)] => [[0, 1, 2], nearest_order(a, b)],
                _ => [[0, 1, 2]; 2],
            };
            for side in 0..2 {
                // A hairstyle that lacks the wisp has the shape of the other.
                let from = if shapes[side].is_some() { side } else { 1 - side };
                for k in order[side] {
                    morph.guides[side].extend(shapes[from].iter().flat_map(|shape| &shape[k]));
                }
            }
            morph.order.push(order);
        }
        morph
    }

    /// Whether this is the morph of these two allocations.
    pub fn is_of(&self, styles: [&Arc<Hairstyle>; 2]) -> bool {
        self.styles.iter().zip(styles).all(|(own, other)| Arc::ptr_eq(own, other))
    }

    /// The hairstyle at `amount`, 0 to 1, outside the body as far as the two are. A tie holds on the half that is nearer to its
    /// hairstyle.
    pub fn at(&self, amount: f32, obstacle: &dyn Obstacle) -> Hairstyle {
        let amount = if amount.is_finite() { amount.clamp(0.0, 1.0) } else { 0.0 };
        let near = usize::from(amount >= 0.5);
        let nearer = &self.styles[near];
        let guides = self.guides_at(amount, obstacle);
        let mut wisps = Vec::with_capacity(self.wisps.len());
        let mut first_strand = 0;
        for (w, wisp) in self.wisps.iter().enumerate() {
            let strand_count = wisp.strands.len() as u32;
            wisps.push(Wisp { guides: [0, 1, 2].map(|k| (3 * w + k) as u32), first_strand, strand_count });
            first_strand += strand_count;
        }
        let strands = self.strands_at(amount, &guides, &wisps);
        let widest = self.widest(amount, &wisps);
        Hairstyle {
            name: nearer.name.clone(),
            scalp: nearer.scalp.clone(),
            held: self.held(near),
            ropes: self.ropes(near),
            look: nearer.look,
            widest,
            motion: self.motion(amount),
            wisps,
            guides,
            strands,
        }
    }

    /// Links of the morph per link of a hairstyle.
    fn scale(&self, side: usize) -> f32 {
        (self.points_per_guide - 1) as f32 / (self.styles[side].guides.points_per_guide - 1) as f32
    }

    /// The three guides of a wisp, with the points of the morph.
    fn resampled(&self, side: usize, wisp: usize) -> [Vec<Vec3>; 3] {
        let guides = &self.styles[side].guides;
        let step = 1.0 / self.scale(side);
        self.styles[side].wisps[wisp].guides.map(|g| {
            let at = |p: usize| curve_point(guides, g as usize, p as f32 * step);
            (0..self.points_per_guide).map(at).collect()
        })
    }

    fn guides_at(&self, amount: f32, obstacle: &dyn Obstacle) -> Guides {
        let n = self.points_per_guide;
        let [a, b] = &self.guides;
        let of = |(a, b): (&[Vec3], &[Vec3])| {
            if amount == 0.0 || a == b {
                return a.to_vec();
            }
            if amount == 1.0 {
                return b.to_vec();
            }
            between(a, b, amount, &Bounded(obstacle))
        };
        let all: Vec<Vec<Vec3>> = a.par_chunks(n).zip(b.par_chunks(n)).map(of).collect();
        let mut out = Guides { points_per_guide: n, ..Guides::default() };
        for points in &all {
            out.push(points);
        }
        out
    }

    fn strands_at(&self, amount: f32, guides: &Guides, wisps: &[Wisp]) -> StrandSet {
        let turns = |w: usize| self.turns(w, &WispCurve::root_frame(guides, &wisps[w]));
        let of = |(w, wisp)| self.strands_of(w, wisp, amount, turns(w));
        let parts: Vec<StrandSet> = self.wisps.par_iter().enumerate().map(of).collect();
        let mut out = StrandSet { first_point: vec![0], ..StrandSet::default() };
        for part in parts {
            let before = out.guide_param.len() as u32;
            out.first_point.extend(part.first_point.iter().map(|first| first + before));
            out.wisp.extend(part.wisp);
            out.weights.extend(part.weights);
            out.shade.extend(part.shade);
            out.guide_param.extend(part.guide_param);
            out.offset_normal.extend(part.offset_normal);
            out.offset_binormal.extend(part.offset_binormal);
            out.offset_tangent.extend(part.offset_tangent);
            out.taper.extend(part.taper);
        }
        out.colours = self.colours_at(amount);
        out
    }

    /// The colours of strands. A strand that one hairstyle lacks has its colours all the while.
    fn colours_at(&self, amount: f32) -> StrandColours {
        if self.styles.iter().all(|style| style.strands.colours.is_empty()) {
            return StrandColours::default();
        }
        let of = |strand: &[Option<u32>; 2]| -> ColourSamples {
            let [a, b] = [0, 1].map(|side| {
                let colours = self.styles[side].strands.colours.strands();
                strand[side].map(|strand| colours.get(strand as usize).copied().unwrap_or_default())
            });
            match (a, b) {
                (Some(a), Some(b)) => std::array::from_fn(|k| a[k].mixed(b[k], amount)),
                (one, other) => one.or(other).unwrap_or_default(),
            }
        };
        StrandColours::new(self.wisps.iter().flat_map(|wisp| &wisp.strands).map(of).collect())
    }

    /// The angles by which the frames of a wisp in both hairstyles are turned about its root against its frame `now`. The axis that a
    /// frame is made from changes abruptly with the direction of the root, and these angles with it, so that strands stay.
    fn turns(&self, w: usize, now: &[Vec3; 3]) -> [f32; 2] {
        let frames = [0, 1].map(|side| {
            let style = &self.styles[side];
            self.wisps[w].of[side].map(|of| WispCurve::root_frame(&style.guides, &style.wisps[of as usize]))
        });
        match &frames {
            [Some(a), Some(b)] => {
                let a_now = turn_between(a, now, None);
                [a_now, a_now - turn_between(a, b, None)]
            }
            [Some(one), None] | [None, Some(one)] => [turn_between(one, now, None); 2],
            [None, None] => [0.0; 2],
        }
    }

    /// The strands of one wisp; `first_point` holds the end of each.
    fn strands_of(&self, w: usize, wisp: &WispMatch, amount: f32, turns: [f32; 2]) -> StrandSet {
        let turns = turns.map(f32::sin_cos);
        let mut out = StrandSet::default();
        for strand in &wisp.strands {
            let read = |side: usize| {
                let strand = strand[side]? as usize;
                let set = &self.styles[side].strands;
                let (scale, order, turn) = (self.scale(side), self.order[w][side], turns[side]);
                Some(StrandOf { set, strand, scale, order, turn })
            };
            let (a, b, amount, part) = match [read(0), read(1)] {
                [Some(a), Some(b)] => (a, b, amount, 1.0),
                [Some(a), None] => (a, a, 0.0, 1.0 - amount),
                [None, Some(b)] => (b, b, 0.0, amount),
                [None, None] => continue,
            };
            let points = a.points().max(b.points());
            let mix = |a: f32, b: f32| if a == b { a } else { a * (1.0 - amount) + b * amount };
            for i in 0..points {
                let whole = i as f32 / (points - 1) as f32;
                let place = whole * part.max(STUB);
                let [x, y] = [a.point(place), b.point(place)];
                out.guide_param.push(mix(x[0], y[0]));
                out.offset_normal.push(mix(x[1], y[1]));
                out.offset_binormal.push(mix(x[2], y[2]));
                out.offset_tangent.push(mix(x[3], y[3]));
                // A strand that grows has its tip all the while.
                out.taper.push(mix(a.taper(whole), b.taper(whole)));
            }
            let (x, y) = (a.weights(), b.weights());
            out.weights.push([0, 1, 2].map(|k| mix(x[k], y[k])));
            out.shade.push(mix(a.set.shade[a.strand], b.set.shade[b.strand]));
            out.wisp.push(w as u32);
            out.first_point.push(out.guide_param.len() as u32);
        }
        out
    }

    /// What ties hold, of one of the hairstyles.
    fn held(&self, side: usize) -> Vec<f32> {
        self.per_point(side, &self.styles[side].held, -1.0)
    }

    /// How wide wisps may be.
    fn widest(&self, amount: f32, wisps: &[Wisp]) -> Vec<f32> {
        if self.styles.iter().all(|style| style.widest.is_empty()) {
            return Vec::new();
        }
        let [a, b] = [0, 1].map(|side| {
            let style = &self.styles[side];
            if !style.widest.is_empty() {
                return self.per_point(side, &style.widest, f32::NAN);
            }
            let mut guides = Guides { points_per_guide: self.points_per_guide, ..Guides::default() };
            self.guides[side].chunks(self.points_per_guide).for_each(|points| guides.push(points));
            widest_radii(&guides, wisps)
        });
        // A wisp that one hairstyle lacks has the width of the other.
        let mix = |(a, b): (f32, f32)| match (a.is_nan(), b.is_nan()) {
            (true, _) => b,
            (_, true) => a,
            _ => a * (1.0 - amount) + b * amount,
        };
        a.into_iter().zip(b).map(mix).collect()
    }

    /// A row in the layout of the guides of one hairstyle, in that of the morph; `missing` where the hairstyle has no such guide. An empty
    /// row stays empty.
    fn per_point(&self, side: usize, row: &[f32], missing: f32) -> Vec<f32> {
        let style = &self.styles[side];
        if row.is_empty() {
            return Vec::new();
        }
        let n = self.points_per_guide;
        let before = style.guides.points_per_guide;
        let mut out = Vec::with_capacity(3 * n * self.wisps.len());
        for (w, wisp) in self.wisps.iter().enumerate() {
            for k in self.order[w][side] {
                out.extend((0..n).map(|p| {
                    let Some(of) = wisp.of[side] else { return missing };
                    let point = ((p as f32 / self.scale(side)).round() as usize).min(before - 1);
                    row[style.wisps[of as usize].guides[k] as usize * before + point]
                }));
            }
        }
        out
    }

    /// The factors on how guides move, mixed in a straight line. A wisp that one hairstyle lacks has those of the other.
    fn motion(&self, amount: f32) -> MotionFactors {
        let mut out = MotionFactors::default();
        for (kind, to) in out.lists_mut().into_iter().enumerate() {
            let [a, b] = [0, 1].map(|side| self.styles[side].motion.lists()[kind].1);
            if a.is_empty() && b.is_empty() {
                continue;
            }
            let [a, b] = [(0, a), (1, b)].map(|(side, row)| {
                let even = vec![1.0; self.styles[side].guides.x.len()];
                self.per_point(side, if row.is_empty() { &even } else { row }, f32::NAN)
            });
            let mix = |(a, b): (f32, f32)| match (a.is_nan(), b.is_nan()) {
                (true, _) => b,
                (_, true) => a,
                _ => a * (1.0 - amount) + b * amount,
            };
            *to = a.into_iter().zip(b).map(mix).collect();
        }
        out
    }

    /// The ropes of one of the hairstyles.
    fn ropes(&self, side: usize) -> Vec<Rope> {
        let style = &self.styles[side];
        let mut copies = vec![Vec::new(); style.guides.count()];
        for (w, wisp) in self.wisps.iter().enumerate() {
            let Some(of) = wisp.of[side] else { continue };
            for (slot, k) in self.order[w][side].into_iter().enumerate() {
                copies[style.wisps[of as usize].guides[k] as usize].push((3 * w + slot) as u32);
            }
        }
        let scale = self.scale(side);
        let rope = |rope: &Rope| {
            let mut out = Rope { guides: Vec::new(), ahead: Vec::new(), ..rope.clone() };
            for (i, &(guide, first)) in rope.guides.iter().enumerate() {
                let first = (first as f32 * scale).round() as u32;
                for &copy in &copies[guide as usize] {
                    out.guides.push((copy, first));
                    out.ahead.extend(rope.ahead.get(i));
                }
            }
            out
        };
        style.ropes.iter().map(rope).collect()
    }
}

/// A strand of one of the hairstyles.
#[derive(Clone, Copy)]
struct StrandOf<'a> {
    set: &'a StrandSet,
    strand: usize,
    /// Links of the morph per link of the hairstyle.
    scale: f32,
    order: [usize; 3],
    /// Sine and cosine of the angle from the frame of the morph to that of the hairstyle.
    turn: (f32, f32),
}

impl StrandOf<'_> {
    fn points(&self) -> usize {
        (self.set.first_point[self.strand + 1] - self.set.first_point[self.strand]) as usize
    }

    /// The value of a row at a place along the strand, 0 to 1.
    fn value(&self, row: &[f32], place: f32) -> f32 {
        let first = self.set.first_point[self.strand] as usize;
        let last = self.points() - 1;
        let at = place * last as f32;
        let i = (at as usize).min(last);
        let j = (i + 1).min(last);
        let t = at - i as f32;
        let (a, b) = (row[first + i], row[first + j]);
        // Places that are points give their values exactly.
        if t < 1e-4 {
            a
        } else if t > 1.0 - 1e-4 {
            b
        } else {
            a + (b - a) * t
        }
    }

    /// Parameter along the guides of the morph, and the offsets along normal, binormal and tangent.
    fn point(&self, place: f32) -> [f32; 4] {
        let set = self.set;
        let (sin, cos) = self.turn;
        let (x, y) = (self.value(&set.offset_normal, place), self.value(&set.offset_binormal, place));
        [
            self.value(&set.guide_param, place) * self.scale,
            x * cos - y * sin,
            x * sin + y * cos,
            self.value(&set.offset_tangent, place),
        ]
    }

    fn taper(&self, place: f32) -> f32 {
        self.value(&self.set.taper, place)
    }

    fn weights(&self) -> [f32; 3] {
        self.order.map(|k| self.set.weights[self.strand][k])
    }
}

/// A point of the Catmull-Rom curve of a guide, at a parameter in links.
fn curve_point(guides: &Guides, guide: usize, u: f32) -> Vec3 {
    let last = guides.points_per_guide - 1;
    let i = (u as usize).min(last - 1);
    let t = u - i as f32;
    let p = |i: usize| guides.point(guide, i);
    let (b, c) = (p(i), p(i + 1));
    if t < 1e-4 {
        return b;
    }
    if t > 1.0 - 1e-4 {
        return c;
    }
    let a = if i == 0 { 2.0 * b - c } else { p(i - 1) };
    let d = if i + 1 == last { 2.0 * c - b } else { p(i + 2) };
    let (t2, t3) = (t * t, t * t * t);
    0.5 * (2.0 * b + (c - a) * t + (2.0 * a - 5.0 * b + 4.0 * c - d) * t2 + (3.0 * b - a - 3.0 * c + d) * t3)
}

/// The order of the guides of `b` in which their roots are nearest to those of `a`.
fn nearest_order(a: &[Vec<Vec3>; 3], b: &[Vec<Vec3>; 3]) -> [usize; 3] {
    let orders = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];
    let distance = |order: &[usize; 3]| (0..3).map(|k| a[k][0].distance_squared(b[order[k]][0])).sum::<f32>();
    orders.into_iter().min_by(|x, y| distance(x).total_cmp(&distance(y))).unwrap_or([0, 1, 2])
}

/// The guide between two: each link turns from one direction to the other and changes its length.
fn between(a: &[Vec3], b: &[Vec3], amount: f32, obstacle: &dyn Obstacle) -> Vec<Vec3> {
    let mut out = Vec::with_capacity(a.len());
    out.push(a[0].lerp(b[0], amount));
    for i in 1..a.len() {
        let [x, y] = [a[i] - a[i - 1], b[i] - b[i - 1]];
        let length = x.length() * (1.0 - amount) + y.length() * amount;
        let from = out[i - 1];
        let direction = match (x.try_normalize(), y.try_normalize()) {
            (Some(x), Some(y)) => turned(x, y, amount * x.angle_between(y), false),
            (Some(only), None) | (None, Some(only)) => only,
            (None, None) => {
                out.push(from);
                continue;
            }
        };
        let mut p = from + direction * length;
        let (distance, normal) = obstacle.distance(p);
        if distance < CLEAR {
            let clear = obstacle.distance(a[i]).0.min(obstacle.distance(b[i]).0).clamp(0.0, CLEAR);
            if distance < clear {
                p += normal * (clear - distance);
                p = from + (p - from).normalize_or(direction) * length;
            }
        }
        out.push(p);
    }
    out
}

#[cfg(test)]
mod tests;
