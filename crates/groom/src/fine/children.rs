//! The list of fine strands of a hairstyle.

use std::sync::Arc;

use glam::Affine3A;
use lovelock_base::random::SplitMix64;

use super::hairline::{Edge, edges_of, shorten};
use super::order::evenly;
use super::strand::{FineStrand, Shape};
use crate::{GuideFrame, Hairstyle, Strands, interpolate};

/// The most points of a fine strand.
pub(super) const MOST_POINTS: usize = 128;
/// Wisps of fewer strands take parents from neighbouring wisps.
const FEW_STRANDS: u32 = 4;
/// Neighbours are looked for among all strands only in hairstyles of at most so many.
const SPARSE: usize = 6000;
/// The nearest strands among which parents are chosen.
const NEIGHBOURS: usize = 7;
/// Share of children that leave their lock.
const STRAYS: f32 = 0.06;

/// The strands of a hairstyle in the order in which they are drawn; see the [module](crate::fine).
#[derive(Clone, Debug, Default)]
pub struct FineStrands {
    /// Points of every strand.
    pub points_per_strand: usize,
    /// The list: stored strands, then children.
    pub strands: Vec<FineStrand>,
    order: Vec<u32>,
    neighbours: Vec<[u32; NEIGHBOURS]>,
    edges: Vec<Edge>,
    of: Topology,
    rest: Option<Arc<Hairstyle>>,
}

/// What the list depends on: hair that is combed from one style into another keeps it.
#[derive(Clone, Debug, Default, PartialEq)]
struct Topology {
    wisp: Vec<u32>,
    weights: Vec<[f32; 3]>,
    first_point: Vec<u32>,
}

impl FineStrands {
    /// Makes this the list of `style`, with at least `count` strands. Returns whether anything has changed.
    ///
    /// The strands of a list do not depend on how many there are.
    pub fn follow(&mut self, style: &Arc<Hairstyle>, count: usize) -> bool {
        if !self.rest.as_ref().is_some_and(|old| Arc::ptr_eq(old, style)) {
            self.rest = Some(Arc::clone(style));
            let set = &style.strands;
            if (&self.of.wisp, &self.of.weights, &self.of.first_point)
                != (&set.wisp, &set.weights, &set.first_point)
            {
                self.of = Topology {
                    wisp: set.wisp.clone(),
                    weights: set.weights.clone(),
                    first_point: set.first_point.clone(),
                };
                self.start(style);
            }
        }
        let stored = self.order.len();
        if stored == 0 || count <= self.strands.len() {
            return false;
        }
        if self.strands.is_empty() {
            self.strands.extend(self.order.iter().map(|&strand| stored_strand(style, strand)));
        }
        if count > stored && self.neighbours.is_empty() {
            (self.neighbours, self.edges) = neighbours_of(style);
        }
        // In steps, so that an approaching camera does not extend the list in every frame.
        let target = if count > stored { count.max(self.strands.len() * 5 / 4) } else { count };
        for i in self.strands.len()..target {
            let parent = self.order[i % stored];
            let (near, edge) = (&self.neighbours[parent as usize], self.edges[parent as usize]);
            self.strands.push(child(style, parent, near, edge, i));
        }
        true
    }

    fn start(&mut self, style: &Hairstyle) {
        self.order = evenly(&style.strands);
        self.strands.clear();
        self.neighbours.clear();
        let longest = style.strands.first_point.windows(2).map(|ends| (ends[1] - ends[0]) as usize).max();
        self.points_per_strand = longest.unwrap_or(2).clamp(2, MOST_POINTS);
    }

    /// The number of stored strands, which are the first of the list.
    pub fn stored(&self) -> usize {
        self.order.len()
    }
}

fn stored_strand(style: &Hairstyle, strand: u32) -> FineStrand {
    FineStrand {
        parents: [strand; 3],
        length: u16::MAX,
        shade: byte(style.strands.shade.get(strand as usize).copied().unwrap_or(0.5)),
        ..FineStrand::default()
    }
}

fn byte(unit: f32) -> u8 {
    (unit.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// The child with number `i` in the list.
fn child(style: &Hairstyle, parent: u32, near: &[u32; NEIGHBOURS], edge: Edge, i: usize) -> FineStrand {
    let mut random = SplitMix64::of_stream(0xf17e, i as u64);
    let b = (random.bits() % NEIGHBOURS as u64) as usize;
    let c = (b + 1 + (random.bits() % (NEIGHBOURS as u64 - 1)) as usize) % NEIGHBOURS;
    let strays = random.unit() < STRAYS;
    let reach = if strays { 0.9 } else { 0.5 };
    let mut weights = [[0; 4]; 2];
    for of in &mut weights {
        // Roots fill the space between the parents. Toward the tip the child gathers to its first parent.
        let root = 0.5 * random.unit();
        let along = [root, 0.5 * root + 0.12 * random.signed(), 0.0, 0.0];
        for (k, (weight, mean)) in of.iter_mut().zip(along).enumerate() {
            let loose = if k > 1 { reach * random.signed() } else { 0.0 };
            *weight = ((mean + loose).clamp(-1.0, 1.0) * 127.0).round() as i8;
        }
    }
    let shorter = random.unit() * random.unit() * if strays { 0.2 } else { 0.05 };
    let own = style.strands.shade.get(parent as usize).copied().unwrap_or(0.5);
    let mut strand = FineStrand {
        parents: [parent, near[b], near[c]],
        weights,
        length: ((1.0 - shorter) * 65_535.0) as u16,
        shade: byte(0.55 * own + 0.45 * random.unit()),
        spare: 0,
    };
    shorten(&mut strand, edge, &mut random);
    strand
}

/// The nearest strands of each strand, of its wisp or of all with a similar shape where a wisp has few; and the edge of the hair.
fn neighbours_of(style: &Hairstyle) -> (Vec<[u32; NEIGHBOURS]>, Vec<Edge>) {
    if style.check().is_err() {
        // Only strands that are given can be drawn of such a style, without knowing where they are at rest.
        let count = style.strands.count();
        return (
            (0..count as u32).map(|strand| [strand; NEIGHBOURS]).collect(),
            vec![Edge::default(); count],
        );
    }
    let mut rest = Strands::default();
    interpolate(style, &GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0), &mut rest);
    let shapes: Vec<Shape> = rest
        .first_point
        .windows(2)
        .map(|ends| {
            let (first, last) = (ends[0] as usize, ends[1] as usize - 1);
            let middle =
                (rest.point(usize::midpoint(first, last)) + rest.point((first + last).div_ceil(2))) / 2.0;
            [rest.point(first), middle, rest.point(last)]
        })
        .collect();
    let all: Vec<u32> = (0..shapes.len() as u32).collect();
    let mut out = Vec::with_capacity(shapes.len());
    for wisp in &style.wisps {
        let members: Vec<u32> = (wisp.first_strand..wisp.first_strand + wisp.strand_count).collect();
        for &of in &members {
            let few = wisp.strand_count < FEW_STRANDS && shapes.len() <= SPARSE;
            out.push(nearest(&shapes, of, if few { &all } else { &members }, few));
        }
    }
    (out, edges_of(&shapes))
}

/// The strands of `among` whose roots are nearest to that of strand `of`; the strand itself where there are too few.
fn nearest(shapes: &[Shape], of: u32, among: &[u32], other_wisps: bool) -> [u32; NEIGHBOURS] {
    let own = &shapes[of as usize];
    let mut found: Vec<(f32, u32)> = among
        .iter()
        .filter(|&&other| other != of)
        .filter_map(|&other| {
            let [root, middle, tip] = [0, 1, 2].map(|k| own[k].distance(shapes[other as usize][k]));
            // Hair on the other side of a parting is no neighbour.
            let parted = other_wisps && middle.max(0.5 * tip) > 2.0 * root + 0.02;
            (root.is_finite() && !parted).then_some((root, other))
        })
        .collect();
    if found.len() > NEIGHBOURS {
        found.select_nth_unstable_by(NEIGHBOURS, |a, b| a.0.total_cmp(&b.0));
        found.truncate(NEIGHBOURS);
    }
    found.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    std::array::from_fn(|k| if found.is_empty() { of } else { found[k % found.len()].1 })
}
