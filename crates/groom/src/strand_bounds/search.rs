//! Finds the farthest strand point along one direction.

use std::collections::BinaryHeap;

use glam::Vec3;

use super::polygon::CORNERS;
use super::{LinkReach, StrandBounds, WispReach, strands_of};
use crate::{GuideFrame, Guides, WispCurve};

/// Hair farther than this from the anchor along the direction is ignored, metres.
const FARTHEST: f32 = 1e4;
/// Rounding of interpolation and bounds, as a fraction of the largest intermediate value: about thirty roundings of
/// 2^-24.
const ROUNDING: f32 = 2e-6;
/// The largest sum of the absolute Catmull-Rom basis functions, reached halfway along a link.
const OVERSHOOT: f32 = 1.25;
/// How much too large the result may be, as a fraction of the guides' extent.
const TOLERANCE: f32 = 0.03;
/// The most links whose points are evaluated, so that hair that ends in one plane is not searched completely.
const MAX_LINKS: usize = 256;
/// Above this fraction, the whole link is bounded, which is faster.
const NEARLY_WHOLE: f32 = 0.75;
/// Values that are compared side by side.
const LANES: usize = 8;

/// A wisp or one of its links, with an upper bound of its reach.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    at_most: f32,
    wisp: u32,
    /// `None` for the whole wisp.
    link: Option<u32>,
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let key = |c: &Self| (c.wisp, c.link);
        self.at_most.total_cmp(&other.at_most).then_with(|| key(self).cmp(&key(other)))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Candidate {}

/// Properties of a guide that do not depend on the direction.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Size {
    /// The largest sum of absolute coordinates of its finite points.
    most: f32,
    /// Whether all of its points are finite.
    finite: bool,
}

/// The sizes of all guides.
pub(super) fn sizes_of_guides(guides: &Guides) -> Vec<Size> {
    let size = |((x, y), z): ((&f32, &f32), &f32)| x.abs() + y.abs() + z.abs();
    let sizes: Vec<f32> = guides.x.iter().zip(&guides.y).zip(&guides.z).map(size).collect();
    let of_guide = |sizes: &[f32]| Size {
        most: most(sizes.iter().copied().filter(|size| size.is_finite()), 0.0),
        finite: sizes.iter().all(|size| size.is_finite()),
    };
    sizes.chunks_exact(guides.points_per_guide).map(of_guide).collect()
}

fn most(values: impl Iterator<Item = f32>, at_least: f32) -> f32 {
    values.fold(at_least, |most, value| if value > most { value } else { most })
}

/// The smallest and largest coordinate of the strands along `way` from the anchor, or slightly beyond; `None` if no
/// strands are left.
pub(super) fn span(
    bounds: &StrandBounds,
    frame: &GuideFrame,
    sizes: &[Size],
    narrowed: &[Option<[Vec<Vec3>; 3]>],
    way: Vec3,
    anchor: Vec3,
) -> Option<(f32, f32)> {
    let guides = &frame.guides;
    let along = |((&x, &y), &z): ((&f32, &f32), &f32)| {
        (x - anchor.x) * way.x + (y - anchor.y) * way.y + (z - anchor.z) * way.z
    };
    let along: Vec<f32> = guides.x.iter().zip(&guides.y).zip(&guides.z).map(along).collect();
    let extents: Vec<_> = along.chunks_exact(guides.points_per_guide).map(Extent::of_guide).collect();
    let back: Vec<f32> = along.iter().map(|along| -along).collect();
    let extents_back: Vec<_> = extents.iter().map(|extent| extent.turned()).collect();
    let (high, low) = rayon::join(
        || Search { bounds, frame, sizes, narrowed, way, anchor, along: &along }.farthest(&extents),
        || Search { bounds, frame, sizes, narrowed, way: -way, anchor, along: &back }.farthest(&extents_back),
    );
    Some((-low?, high?))
}

/// The range of some values, and the largest step between them.
#[derive(Clone, Copy, Debug)]
struct Extent {
    min: f32,
    max: f32,
    /// The largest step from one value to the next.
    step: f32,
}

impl Extent {
    const NONE: Self = Self { min: f32::INFINITY, max: f32::NEG_INFINITY, step: 0.0 };

    /// The extent of the points of one guide, without NaN.
    fn of_guide(along: &[f32]) -> Self {
        let mut min = [f32::INFINITY; LANES];
        let mut max = [f32::NEG_INFINITY; LANES];
        let mut most = [0.0_f32; LANES];
        let mut add = |values: &[f32; LANES], nexts: &[f32; LANES]| {
            for lane in 0..LANES {
                let (value, step) = (values[lane], (nexts[lane] - values[lane]).abs());
                min[lane] = if value < min[lane] { value } else { min[lane] };
                max[lane] = if value > max[lane] { value } else { max[lane] };
                most[lane] = if step > most[lane] { step } else { most[lane] };
            }
        };
        let (last, values) = (along[along.len() - 1], &along[..along.len() - 1]);
        let ((values, values_rest), (nexts, nexts_rest)) =
            (values.as_chunks::<LANES>(), along[1..].as_chunks::<LANES>());
        for (values, nexts) in values.iter().zip(nexts) {
            add(values, nexts);
        }
        // The rest, padded with the last point.
        let fill = |rest: &[f32]| {
            let mut lanes = [last; LANES];
            lanes[..rest.len()].copy_from_slice(rest);
            lanes
        };
        add(&fill(values_rest), &fill(nexts_rest));
        add(&[last; LANES], &[last; LANES]);
        let over = |lanes: [f32; LANES], of: fn(f32, f32) -> f32| lanes.into_iter().reduce(of).unwrap_or(0.0);
        Self { min: over(min, f32::min), max: over(max, f32::max), step: over(most, f32::max) }
    }

    /// The extent along the opposite direction.
    fn turned(self) -> Self {
        Self { min: -self.max, max: -self.min, step: self.step }
    }

    fn join(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max), step: self.step.max(other.step) }
    }
}

/// One instant seen along one direction.
#[derive(Clone, Copy)]
struct Search<'a> {
    bounds: &'a StrandBounds,
    frame: &'a GuideFrame,
    sizes: &'a [Size],
    /// For each wisp the guides that its strands follow where these are not its own.
    narrowed: &'a [Option<[Vec<Vec3>; 3]>],
    way: Vec3,
    anchor: Vec3,
    /// Coordinate of every guide point along the direction.
    along: &'a [f32],
}

impl Search<'_> {
    /// The largest coordinate of the strands.
    fn farthest(self, guides: &[Extent]) -> Option<f32> {
        let Self { bounds, frame, .. } = self;
        // A guide with an infinite point would make any bound close enough.
        let finite = guides.iter().filter(|guide| (guide.max - guide.min).is_finite());
        let whole = finite.fold(Extent::NONE, |whole, guide| whole.join(*guide));
        let tolerance = (TOLERANCE * (whole.max - whole.min)).max(0.0);
        let wisps = (0..).zip(&bounds.wisps).map(|(number, wisp)| Candidate {
            at_most: match self.narrowed_along(number) {
                Some(along) => self.reach_of_wisp(wisp, along.map(|along| Extent::of_guide(&along))),
                None => self.reach_of_wisp(wisp, wisp.wisp.guides.map(|g| guides[g as usize])),
            },
            wisp: number,
            link: None,
        });
        let mut candidates: BinaryHeap<Candidate> = wisps.collect();
        let mut found = f32::NEG_INFINITY;
        let mut curves: Vec<(u32, WispCurve)> = Vec::new();
        let mut looked_at = 0;
        while let Some(next) = candidates.pop() {
            if next.at_most <= found + tolerance || looked_at >= MAX_LINKS {
                found = found.max(next.at_most);
                break;
            }
            let wisp = &bounds.wisps[next.wisp as usize];
            let links = self.links_of(next.wisp);
            if let Some(link) = next.link {
                looked_at += 1;
                let known = curves.iter().position(|(number, _)| *number == next.wisp).unwrap_or_else(|| {
                    let mut curve = WispCurve::default();
                    let style = &bounds.style;
                    curve.place(
                        &style.guides,
                        &wisp.wisp,
                        &style.widest,
                        &frame.guides,
                        frame.world_from_head,
                    );
                    curves.push((next.wisp, curve));
                    curves.len() - 1
                });
                found = found.max(self.reach_of_points(wisp, links[link as usize], &curves[known].1));
            } else {
                self.reach_of_links(next.wisp, wisp, links, |link, at_most| {
                    if at_most > found {
                        candidates.push(Candidate { at_most, wisp: next.wisp, link: Some(link) });
                    }
                });
            }
        }
        (found > f32::NEG_INFINITY).then_some(found)
    }

    /// Coordinates along the direction of the guides that the strands of wisp `number` follow, if these are not its own.
    fn narrowed_along(&self, number: u32) -> Option<[Vec<f32>; 3]> {
        let guides = self.narrowed[number as usize].as_ref()?;
        let along = |guide: &Vec<Vec3>| guide.iter().map(|p| (*p - self.anchor).dot(self.way)).collect();
        Some(guides.each_ref().map(along))
    }

    fn points_per_guide(&self) -> usize {
        self.frame.guides.points_per_guide
    }

    fn links_of(&self, wisp: u32) -> &[LinkReach] {
        let links = self.points_per_guide() - 1;
        &self.bounds.links[wisp as usize * links..][..links]
    }

    /// The rounding error of any coordinate of a wisp.
    fn rounding(&self, wisp: &WispReach) -> f32 {
        let size = self.size(wisp) * (1.0 + wisp.weights.sum) + self.anchor.abs().element_sum() + wisp.offset;
        ROUNDING * self.way.length() * size
    }

    fn size(&self, wisp: &WispReach) -> f32 {
        wisp.wisp.guides.iter().map(|&g| self.sizes[g as usize].most).fold(0.0, f32::max)
    }

    /// The margin around the blended guides: the longest offset, the shift caused by weights whose sum is not exactly 1
    /// (proportional to the distance from the origin), and rounding.
    fn around(&self, wisp: &WispReach, offset: f32) -> f32 {
        (offset + OVERSHOOT * wisp.weights.off * self.size(wisp)) * self.way.length() + self.rounding(wisp)
    }

    /// Upper bound of a wisp's reach, from its three guides.
    fn reach_of_wisp(&self, wisp: &WispReach, guides: [Extent; 3]) -> f32 {
        let blend = |w: &[f32; 3]| -> f32 {
            w.iter().zip(guides).map(|(&w, guide)| w * if w < 0.0 { guide.min } else { guide.max }).sum()
        };
        let blends = most(wisp.weights.corners.iter().map(blend), f32::NEG_INFINITY);
        // The inner Bézier points of a link lie within a third of a step of its ends.
        let step = guides.iter().map(|guide| guide.step).fold(0.0, f32::max) / 3.0;
        limited(blends + wisp.weights.sum * step + self.around(wisp, wisp.offset))
    }

    /// Upper bound of the reach of each link that has points, from the hull of its curves.
    fn reach_of_links(
        &self,
        number: u32,
        wisp: &WispReach,
        links: &[LinkReach],
        mut tell: impl FnMut(u32, f32),
    ) {
        let n = self.points_per_guide();
        let narrowed = self.narrowed_along(number);
        let [a, b, c] = match &narrowed {
            Some(along) => along.each_ref().map(Vec::as_slice),
            None => wisp.wisp.guides.map(|g| &self.along[g as usize * n..][..n]),
        };
        let finite = wisp.wisp.guides.iter().all(|&g| self.sizes[g as usize].finite);
        let weights: [[f32; CORNERS]; 3] =
            std::array::from_fn(|g| std::array::from_fn(|corner| wisp.weights.corners[corner][g]));
        let at = |p: usize| -> [f32; CORNERS] {
            std::array::from_fn(|k| a[p] * weights[0][k] + b[p] * weights[1][k] + c[p] * weights[2][k])
        };
        let phantom = |end: [f32; CORNERS], inner: [f32; CORNERS]| -> [f32; CORNERS] {
            std::array::from_fn(|k| 2.0 * end[k] - inner[k])
        };
        let around = self.around(wisp, 0.0);
        let length = self.way.length();
        let mut four = [phantom(at(0), at(1)), at(0), at(1), at(1)];
        for (p, link) in links.iter().enumerate() {
            four[3] = if p + 2 < n { at(p + 2) } else { phantom(four[2], four[1]) };
            // Controls that are not finite give no finite points.
            if link.count > 0 && (finite || four.iter().flatten().sum::<f32>().is_finite()) {
                tell(p as u32, limited(hull(&four, link.end) + (around + length * link.offset)));
            }
            four = [four[1], four[2], four[3], four[3]];
        }
    }

    /// The actual reach of the points of a link, plus rounding.
    fn reach_of_points(&self, wisp: &WispReach, link: LinkReach, curve: &WispCurve) -> f32 {
        let set = &self.bounds.style.strands;
        let strands = strands_of(&wisp.wisp);
        let points = &self.bounds.points[link.first as usize..][..link.count as usize];
        let along = points.iter().map(|&i| {
            let before = set.first_point[strands.clone()].partition_point(|&first| first <= i);
            let weights = set.weights[strands.start + before - 1];
            let i = i as usize;
            let offset = Vec3::new(set.offset_normal[i], set.offset_binormal[i], set.offset_tangent[i]);
            (curve.point(weights, set.guide_param[i], offset) - self.anchor).dot(self.way)
        });
        most(along.filter(|along| along.abs() <= FARTHEST), f32::NEG_INFINITY) + self.rounding(wisp)
    }
}

/// Clamps a bound to [`FARTHEST`]; NaN counts as unbounded.
fn limited(at_most: f32) -> f32 {
    if at_most < FARTHEST { at_most } else { FARTHEST }
}

/// The largest of the Bézier points of a link's curves, one curve per corner, up to the fraction `end`.
#[inline]
fn hull(four: &[[f32; CORNERS]; 4], end: f32) -> f32 {
    let [before, a, b, after] = four;
    let larger = |a: f32, b: f32| if a > b { a } else { b };
    let mut most = [0.0; CORNERS];
    if end > NEARLY_WHOLE {
        for k in 0..CORNERS {
            let second = a[k] + (b[k] - before[k]) * (1.0 / 6.0);
            let third = b[k] - (after[k] - a[k]) * (1.0 / 6.0);
            most[k] = larger(larger(a[k], b[k]), larger(second, third));
        }
    } else {
        let lerp = |a: f32, b: f32| a + (b - a) * end;
        for k in 0..CORNERS {
            let second = a[k] + (b[k] - before[k]) * (1.0 / 6.0);
            let third = b[k] - (after[k] - a[k]) * (1.0 / 6.0);
            // De Casteljau: the curve up to `end`.
            let (ab, bc, cd) = (lerp(a[k], second), lerp(second, third), lerp(third, b[k]));
            let (abc, bcd) = (lerp(ab, bc), lerp(bc, cd));
            most[k] = larger(larger(a[k], ab), larger(abc, lerp(abc, bcd)));
        }
    }
    most.into_iter().fold(f32::NEG_INFINITY, larger)
}
