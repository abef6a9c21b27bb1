//! The head of a figure without joints, found by its shape: what is above a neck over broad, flat shoulders.
//!
//! The figure is cut across an axis into sections, and the outermost ring around its middle is followed from the top down. A head is a part
//! that narrows to a neck, below which the ring becomes much wider than the head, and wider than it is deep. Nothing else that is common
//! has that shape: an animal has no shoulders, a bottle is round, a chair has no neck.

use glam::{Quat, Vec2, Vec3};

/// Sections along an axis.
const LEVELS: usize = 96;
/// Cells along the longer side of a section in which its rings are told apart.
const CELLS: usize = 48;
/// The most triangles that are cut; of larger surfaces only so many, evenly.
const MAX_TRIANGLES: usize = 400_000;
/// The widest neck as a fraction of the size of the head.
const NECK: f32 = 0.82;
/// The narrowest shoulders as a multiple of the width of the head, and of their own depth.
const SHOULDERS: [f32; 2] = [1.7, 1.3];
/// How far below the neck shoulders are at most, as a multiple of the way from the neck to the crown.
const SHOULDERS_BELOW: f32 = 0.9;
/// The least and the most height of crown over neck as a multiple of the width of the head.
const HEIGHT: [f32; 2] = [0.8, 2.2];
/// The most depth of a head as a multiple of its width.
const ROUND: f32 = 1.7;
/// The least and the most height of a figure in heads with necks, where it is no bust.
const HEADS: [f32; 2] = [1.3, 10.0];
/// How far head and neck are from the middle of the shoulders at most, in widths of their own.
const ASIDE: f32 = 0.25;
/// How far a head is from the middle of the figure at most, in its own widths: a leg is beside it.
const OFF: f32 = 0.35;
/// Where the joint of a head is between neck and crown.
const JOINT: f32 = 0.13;

/// A head that was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ShapedHead {
    /// Unit vector from the neck to the crown: one of the axes.
    pub up: Vec3,
    /// Unit vector toward the face: one of the axes.
    pub ahead: Vec3,
    /// The place of the joint of the head, at the upper end of the neck.
    pub joint: Vec3,
    /// Coordinate along `up` of the neck.
    neck: f32,
    /// The middle of the head, and the farthest that its skin is from the axis through it along `up`.
    middle: Vec3,
    reach: f32,
}

impl ShapedHead {
    /// Whether a place on the surface belongs to the head.
    pub fn has(&self, p: Vec3) -> bool {
        let away = p - self.middle;
        p.dot(self.up) > self.neck && (away - self.up * away.dot(self.up)).length() < self.reach
    }

    /// The rotation that stands the figure up with its face toward +Z; `None` where it does so.
    pub fn to_upright(self) -> Option<Quat> {
        if self.up == Vec3::Y {
            return None;
        }
        let left = self.up.cross(self.ahead);
        // Rows are where the axes of the figure go to.
        let world_from_figure = glam::Mat3::from_cols(left, self.up, self.ahead).transpose();
        Some(Quat::from_mat3(&world_from_figure))
    }
}

/// One ring across an axis: its bounds, seen along the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Ring {
    low: Vec2,
    high: Vec2,
}

impl Ring {
    fn size(self) -> Vec2 {
        self.high - self.low
    }

    fn middle(self) -> Vec2 {
        0.5 * (self.low + self.high)
    }

    /// The side of a square as large as its bounds.
    fn mean_size(self) -> f32 {
        self.size().element_product().max(0.0).sqrt()
    }

    fn touches(self, other: Self) -> bool {
        self.low.cmple(other.high).all() && other.low.cmple(self.high).all()
    }

    fn with(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }
}

/// Finds the head of a surface: an upright one if there is one, otherwise along any other axis.
pub(crate) fn find_head(positions: &[Vec3], triangles: &[[u32; 3]]) -> Option<ShapedHead> {
    let upright = of_axis(positions, triangles, Vec3::Y);
    upright.or_else(|| {
        let others = [Vec3::Z, Vec3::NEG_Z, Vec3::X, Vec3::NEG_X, Vec3::NEG_Y];
        others.into_iter().find_map(|up| of_axis(positions, triangles, up))
    })
}

/// The axes across one: both are axes of the space, and right-handed with it.
fn across(up: Vec3) -> [Vec3; 2] {
    let first = if up.x.abs() > 0.5 { Vec3::Y } else { Vec3::X };
    [first, up.cross(first)]
}

fn of_axis(positions: &[Vec3], triangles: &[[u32; 3]], up: Vec3) -> Option<ShapedHead> {
    let [a, b] = across(up);
    let (low, high) = positions
        .iter()
        .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), p| (low.min(p.dot(up)), high.max(p.dot(up))));
    let length = high - low;
    if !(length.is_finite() && length > 0.0) {
        return None;
    }
    let step = length / LEVELS as f32;
    let (rings, middle) = rings_along(positions, triangles, (up, [a, b]), (low, step))?;
    // From the top down. Level 0 is the lowest.
    let sizes: Vec<f32> = rings.iter().map(|(_, ring)| ring.mean_size()).collect();
    let (neck, widest) = neck_of(&sizes)?;
    let (crown_level, neck_level) = (rings[0].0, rings[neck].0);
    let height = (crown_level - neck_level) as f32 * step;
    let head = rings[widest].1;
    let width = head.size().min_element();
    let is_round = head.size().max_element() <= ROUND * width;
    if !is_round || !(HEIGHT[0]..=HEIGHT[1]).contains(&(height / width)) {
        return None;
    }
    let shoulders = rings[neck..]
        .iter()
        .take_while(|(level, _)| (neck_level - level) as f32 * step <= SHOULDERS_BELOW * height)
        .map(|(_, ring)| *ring)
        .find(|ring| {
            let (wide, deep) = (ring.size().max_element(), ring.size().min_element());
            wide >= SHOULDERS[0] * width && wide >= SHOULDERS[1] * deep
        })?;
    let figure = crown_level as f32 * step / height;
    if !(HEADS[0]..=HEADS[1]).contains(&figure) {
        return None;
    }
    // The head is over the middle of the shoulders, unlike a foot under the hips.
    let side = usize::from(shoulders.size().x < shoulders.size().y);
    let aside =
        |ring: Ring| (ring.middle()[side] - shoulders.middle()[side]).abs() / ring.size()[side].max(1e-9);
    let off = (head.middle()[side] - middle[side]).abs() / head.size()[side].max(1e-9);
    if aside(head) > ASIDE || aside(rings[neck].1) > ASIDE || off > OFF {
        return None;
    }
    let of_neck = rings[neck].1.middle();
    // The head is before the neck. It faces across the shoulders.
    let before = head.middle() - of_neck;
    let (axis, by) = if side == 1 { (a, before.x) } else { (b, before.y) };
    let ahead = if by < 0.0 { -axis } else { axis };
    let place = |at: Vec2, along: f32| a * at.x + b * at.y + up * along;
    let neck_at = low + (neck_level as f32 + 0.5) * step;
    Some(ShapedHead {
        up,
        ahead,
        joint: place(of_neck, neck_at + JOINT * height),
        neck: neck_at,
        middle: place(head.middle(), neck_at + 0.5 * height),
        reach: 0.75 * head.size().length().max(rings[neck].1.size().length()),
    })
}

/// The indices of the neck and of the widest part of the head among sizes from the top down.
fn neck_of(sizes: &[f32]) -> Option<(usize, usize)> {
    let mut widest = 0;
    let mut neck: Option<usize> = None;
    for (i, &size) in sizes.iter().enumerate() {
        match neck {
            None if size > sizes[widest] => widest = i,
            None if size <= NECK * sizes[widest] && i > widest => neck = Some(i),
            Some(at) if size <= sizes[at] => neck = Some(i),
            // Wider than the head again: shoulders.
            Some(at) if size > 1.1 * sizes[widest] => return (at >= 3).then_some((at, widest)),
            _ => {}
        }
    }
    None
}

/// The ring around the middle of each level from the top down, with its level, and that middle.
fn rings_along(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    (up, [a, b]): (Vec3, [Vec3; 2]),
    (low, step): (f32, f32),
) -> Option<(Vec<(usize, Ring)>, Vec2)> {
    let mut segments: Vec<Vec<[Vec2; 2]>> = vec![Vec::new(); LEVELS];
    let every = triangles.len().div_ceil(MAX_TRIANGLES).max(1);
    for triangle in triangles.iter().step_by(every) {
        let [Some(p), Some(q), Some(r)] = triangle.map(|i| positions.get(i as usize).copied()) else {
            continue;
        };
        let along = [p, q, r].map(|p| (p.dot(up) - low) / step - 0.5);
        let flat = [p, q, r].map(|p| Vec2::new(p.dot(a), p.dot(b)));
        let least = along.iter().copied().fold(f32::INFINITY, f32::min).ceil().max(0.0);
        let most = along.iter().copied().fold(f32::NEG_INFINITY, f32::max).floor();
        if !(least.is_finite() && most.is_finite()) {
            continue;
        }
        let (first, end) = (least as usize, ((most + 1.0).max(0.0) as usize).min(LEVELS));
        for (level, segments) in segments.iter_mut().enumerate().take(end).skip(first) {
            let at = level as f32;
            let mut ends = [Vec2::ZERO; 2];
            let mut count = 0;
            for [i, j] in [[0, 1], [1, 2], [2, 0]] {
                let (from, to) = (along[i] - at, along[j] - at);
                if (from < 0.0) != (to < 0.0) && count < 2 {
                    ends[count] = flat[i].lerp(flat[j], from / (from - to));
                    count += 1;
                }
            }
            if count == 2 {
                segments.push(ends);
            }
        }
    }
    let middle = median_of(&segments)?;
    let rings: Vec<(usize, Ring)> = segments
        .iter()
        .enumerate()
        .rev()
        .filter_map(|(level, segments)| Some((level, ring_of(segments, middle)?)))
        .collect();
    // Hands that are raised over the head are beside it.
    let first = rings.iter().position(|(_, ring)| {
        let margin = 0.5 * ring.size();
        middle.cmpge(ring.low - margin).all() && middle.cmple(ring.high + margin).all()
    })?;
    // Below that there is a crotch over raised feet.
    (rings[first].0 >= LEVELS - LEVELS / 5).then(|| (rings[first..].to_vec(), middle))
}

/// The median place of all sections, each of which counts alike.
fn median_of(sections: &[Vec<[Vec2; 2]>]) -> Option<Vec2> {
    let mut middles: Vec<Vec2> = Vec::new();
    for section in sections.iter().filter(|section| !section.is_empty()) {
        let (low, high) = section
            .iter()
            .flatten()
            .fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(low, high), p| (low.min(*p), high.max(*p)));
        middles.push(0.5 * (low + high));
    }
    if middles.is_empty() {
        return None;
    }
    let mut median = |axis: usize| {
        middles.sort_by(|p, q| p[axis].total_cmp(&q[axis]));
        middles[middles.len() / 2][axis]
    };
    Some(Vec2::new(median(0), median(1)))
}

/// The ring of a section that is nearest to a place, with what lies within it or overlaps it.
fn ring_of(segments: &[[Vec2; 2]], at: Vec2) -> Option<Ring> {
    let bounds =
        segments.iter().flatten().fold(Ring { low: Vec2::INFINITY, high: Vec2::NEG_INFINITY }, |ring, p| {
            ring.with(Ring { low: *p, high: *p })
        });
    let cell = bounds.size().max_element() / CELLS as f32;
    if !(cell.is_finite() && cell > 0.0) {
        return None;
    }
    let key = |p: Vec2| {
        let [x, y] = ((p - bounds.low) / cell).to_array().map(|v| (v.max(0.0) as usize).min(CELLS - 1));
        y * CELLS + x
    };
    let mut is_full = vec![false; CELLS * CELLS];
    for [p, q] in segments {
        let pieces = ((p.distance(*q) / cell).ceil() as usize).clamp(1, 2 * CELLS);
        for k in 0..=pieces {
            is_full[key(p.lerp(*q, k as f32 / pieces as f32))] = true;
        }
    }
    let mut rings = Vec::new();
    for start in 0..is_full.len() {
        if !std::mem::take(&mut is_full[start]) {
            continue;
        }
        let (mut open, mut ring) = (vec![start], Ring { low: Vec2::INFINITY, high: Vec2::NEG_INFINITY });
        while let Some(at) = open.pop() {
            let (x, y) = (at % CELLS, at / CELLS);
            let corner = bounds.low + cell * Vec2::new(x as f32, y as f32);
            ring = ring.with(Ring { low: corner, high: corner + cell });
            for ny in y.saturating_sub(1)..(y + 2).min(CELLS) {
                for nx in x.saturating_sub(1)..(x + 2).min(CELLS) {
                    if std::mem::take(&mut is_full[ny * CELLS + nx]) {
                        open.push(ny * CELLS + nx);
                    }
                }
            }
        }
        rings.push(ring);
    }
    let away = |ring: &Ring| at.clamp(ring.low, ring.high).distance_squared(at);
    let mut chosen = *rings.iter().min_by(|p, q| away(p).total_cmp(&away(q)))?;
    // A tongue lies within the head.
    while let Some(i) = rings.iter().position(|ring| chosen.touches(*ring) && chosen.with(*ring) != chosen) {
        chosen = chosen.with(rings[i]);
    }
    Some(chosen)
}
