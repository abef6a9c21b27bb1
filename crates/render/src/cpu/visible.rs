//! Light of the strand points that show: order first, light after.
//!
//! Most points of dense hair show in no pixel, because other hair or the body is in front of them, and light is what a point costs most. So
//! points are placed without light. Each tile weighs its segments from near to far (`hair::weigh`), and the light of their points is computed
//! for those of which a pixel takes something, once for all tiles. Weights are exact, and what is left out is a fraction of a step of 8 bits of the brightest light.
//!
//! Where light is computed at every second point of fine strands, a point between two others that shows takes the light of the points
//! that decide its own, also of those that do not show. Otherwise its light would depend on which points other tiles have needed before.

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use lovelock_base::memory::list_bytes;
use lovelock_base::simd::Width;
use rayon::prelude::*;

use super::hair::weigh::Weighed;
use super::strand_points::{
    PointsIn, ShadedPoint, ShadedPoints, curve_through, decided_by, halfway, is_sparse, light_chosen_simd,
    place_all,
};
use super::view::View;

/// Points per task at least.
const PIECE: usize = 1 << 16;

/// What the light of the points of a picture is computed from.
pub(super) struct LateInput<'a> {
    view: &'a View<'a>,
    points: PointsIn<'a>,
    shaded: ShadedPoints,
}

impl<'a> LateInput<'a> {
    /// Combines points with the `view` of their picture.
    pub fn new(view: &'a View<'a>, points: PointsIn<'a>, shaded: ShadedPoints) -> Self {
        Self { view, points, shaded }
    }

    /// Opacity of a strand where it covers a pixel completely.
    pub fn opacity(&self) -> f32 {
        self.view.uniform.opacity
    }

    fn is_draft(&self) -> bool {
        self.shaded == ShadedPoints::Second
    }

    /// Points of each strand, if light is computed at every second one of them; 1 otherwise.
    fn points_per_strand(&self) -> usize {
        if is_sparse(self.view, self.shaded) { self.view.points_per_strand() } else { 1 }
    }
}

/// The light of points, as far as tiles have needed it. Kept from picture to picture for its memory.
#[derive(Debug, Default)]
pub(super) struct LateLight {
    /// Whether the light of each point is known.
    known: Vec<AtomicBool>,
    /// The bits of red, green and blue. Two tiles that need a point at the same time compute and store the same.
    colors: Vec<[AtomicU32; 3]>,
}

/// The points whose light a tile needs; scratch memory.
#[derive(Clone, Debug, Default)]
pub(super) struct Wanted {
    /// Those whose own light is computed.
    own: Vec<u32>,
    /// Those whose light may lie between that of others.
    between: Vec<u32>,
    colors: Vec<[f32; 3]>,
}

impl Wanted {
    /// Its memory, bytes.
    pub fn bytes(&self) -> u64 {
        list_bytes(&self.own) + list_bytes(&self.between) + list_bytes(&self.colors)
    }
}

impl LateLight {
    /// Its memory, bytes.
    pub fn bytes(&self) -> u64 {
        list_bytes(&self.known) + list_bytes(&self.colors)
    }

    /// Places the points of a picture, whose light is not known.
    pub fn place(&mut self, width: Width, input: &LateInput, placed: &mut Vec<ShadedPoint>) {
        place_all(width, input.view, &input.points, input.shaded, placed);
        self.known.resize_with(placed.len(), AtomicBool::default);
        self.colors.resize_with(placed.len(), Default::default);
        self.known.par_iter_mut().with_min_len(PIECE).for_each(|known| *known.get_mut() = false);
    }

    /// Takes no part in a picture: all its points have their light.
    pub fn leave(&mut self) {
        self.known.clear();
    }

    /// The number of points whose light was not needed.
    pub fn unlit(&self) -> usize {
        self.known.iter().filter(|known| !known.load(Ordering::Relaxed)).count()
    }

    /// Writes the light of the points of weighed segments, and computes it where it is not known. `placed` are all points; those beyond
    /// the ones of this picture's late light have their own.
    pub fn light(
        &self,
        width: Width,
        input: &LateInput,
        placed: &[ShadedPoint],
        weighed: &mut Weighed,
        wanted: &mut Wanted,
    ) {
        let Weighed { segments, lights, .. } = weighed;
        self.want(input, segments, wanted);
        let Wanted { own, between, colors } = wanted;
        self.compute(width, input, own, colors);
        own.clear();
        for &point in &*between {
            match self.between(input, placed, point as usize) {
                Some(color) => self.put(point as usize, color),
                None => own.push(point),
            }
        }
        self.compute(width, input, own, colors);
        let color = |at: usize| if at < self.colors.len() { self.color(at) } else { placed[at].color };
        lights.clear();
        lights.extend(segments.iter().map(|&first| [color(first as usize), color(first as usize + 1)]));
    }

    /// Lists the points of segments whose light is not known, and the points that decide it.
    fn want(&self, input: &LateInput, segments: &[u32], wanted: &mut Wanted) {
        let Wanted { own, between, .. } = wanted;
        own.clear();
        between.clear();
        let (points, count) = (input.points_per_strand(), self.known.len());
        let is_missing = |point: usize| point < count && !self.known[point].load(Ordering::Acquire);
        for &first in segments {
            for point in [first, first + 1] {
                if !is_missing(point as usize) {
                    continue;
                }
                match decided_by(point as usize, (points, count), input.is_draft()) {
                    None => own.push(point),
                    Some(range) => {
                        between.push(point);
                        own.extend(range.step_by(2).filter(|&other| is_missing(other)).map(|i| i as u32));
                    }
                }
            }
        }
        for list in [own, between] {
            list.sort_unstable();
            list.dedup();
        }
    }

    /// Computes the light of `chosen` points, with `colors` as scratch memory.
    fn compute(&self, width: Width, input: &LateInput, chosen: &[u32], colors: &mut Vec<[f32; 3]>) {
        colors.resize(chosen.len(), [0.0; 3]);
        light_chosen_simd(width, input.view, &input.points, chosen, colors);
        for (&point, &color) in chosen.iter().zip(&*colors) {
            self.put(point as usize, color);
        }
    }

    /// The light of a point between others, whose light is known; `None` if its own must be computed.
    fn between(&self, input: &LateInput, placed: &[ShadedPoint], i: usize) -> Option<[f32; 3]> {
        if input.is_draft() {
            return Some(halfway(self.color(i - 1), self.color(i + 1)));
        }
        let around = [i - 3, i - 1, i + 1, i + 3];
        // A point that is not drawn has no light.
        if around.iter().any(|&at| placed[at].half_width < 0.0) {
            return None;
        }
        let lit = [i - 1, i, i + 1].map(|at| input.points.transmittance[at]);
        curve_through(around.map(|at| self.color(at)), lit)
    }

    /// The light of a point that is known.
    fn color(&self, point: usize) -> [f32; 3] {
        self.colors[point].each_ref().map(|bits| f32::from_bits(bits.load(Ordering::Relaxed)))
    }

    fn put(&self, point: usize, color: [f32; 3]) {
        for (bits, light) in self.colors[point].iter().zip(color) {
            bits.store(light.to_bits(), Ordering::Relaxed);
        }
        // After the colour, so that whoever finds the point known reads it.
        self.known[point].store(true, Ordering::Release);
    }
}
