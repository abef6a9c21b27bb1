//! The list of fine strands of a hairstyle.

use std::sync::Arc;

use glam::Vec3;
use lovelock_base::memory::list_bytes;
use lovelock_base::random::SplitMix64;
use rayon::prelude::*;

use super::hairline::{edges_of, shorten};
use super::nearest::Nearest;
use super::order::evenly;
use super::strand::FineStrand;
use crate::{Guides, Hairstyle};

/// The most points of a fine strand.
pub(super) const MAX_POINTS: usize = 128;
/// Wisps of fewer strands take parents from neighbouring wisps.
const FEW_STRANDS: u32 = 4;
/// Neighbours are looked for among all strands only in hairstyles of at most so many.
const SPARSE: usize = 6000;
/// The nearest strands among which parents are chosen.
const NEIGHBOURS: usize = 7;
/// Share of children that leave their lock.
const STRAYS: f32 = 0.06;
/// A child follows a parent wholly that is at least this fraction as long as its first one, and less the shorter that is. Otherwise it would
/// leave the hair: beside a stub, it would go on the way that a long strand comes.
const AS_LONG: f32 = 0.5;
/// Children of shorter strands lean less to their other parents, in proportion, metres. Otherwise those of stubs would lie on the scalp.
const LEANING: f32 = 0.02;
/// The least length of strands of hair without stubs, metres.
const STUB: f32 = 0.004;
/// Steps per octave in which lengths are told apart.
const LENGTH_STEPS: f32 = 16.0;

/// The strands of a hairstyle in the order in which they are drawn; see the [module](crate::fine).
#[derive(Clone, Debug, Default)]
pub struct FineStrands {
    /// Points of every strand: those of the longest stored one, or fewer.
    pub points_per_strand: usize,
    /// Points of the longest stored strand.
    stored_points: usize,
    /// The length of the longest guide, metres.
    pub longest_m: f32,
    /// The list: stored strands, then children.
    pub strands: Vec<FineStrand>,
    order: Vec<u32>,
    neighbours: Vec<[u32; NEIGHBOURS]>,
    /// How near each stored strand is to the edge of the hair.
    edges: Vec<f32>,
    of: Source,
    /// See [`lengths_of`].
    lengths: Vec<i16>,
    rest: Option<Arc<Hairstyle>>,
}

/// Everything that the list depends on.
///
/// Ties and combing change none of it, so that hair that is combed from one style into another keeps its strands. Only where wisps have few
/// strands, whose neighbours are on the same side of a parting at rest, a tie may change them.
#[derive(Clone, Debug, Default, PartialEq)]
struct Source {
    wisp: Vec<u32>,
    first_point: Vec<u32>,
    shade: Vec<f32>,
    roots: Vec<Vec3>,
    /// Middles and tips, if neighbours may be of other wisps.
    ends: Vec<[Vec3; 2]>,
    /// Whether the neighbours of each strand may be of other wisps; empty if those of none may.
    few: Vec<bool>,
}

impl FineStrands {
    /// The memory of the list and of what it is made from, bytes.
    pub fn bytes(&self) -> u64 {
        let of = &self.of;
        list_bytes(&self.strands)
            + list_bytes(&self.order)
            + list_bytes(&self.neighbours)
            + list_bytes(&self.edges)
            + list_bytes(&self.lengths)
            + [&of.wisp, &of.first_point].into_iter().map(list_bytes).sum::<u64>()
            + list_bytes(&of.shade)
            + list_bytes(&of.roots)
            + list_bytes(&of.ends)
            + list_bytes(&of.few)
    }
}

impl Source {
    /// That of a style.
    ///
    /// Roots are those of the guides between which a strand lies. Its own root is beside them by an offset, which every tie computes anew.
    fn of(style: &Hairstyle) -> Self {
        let set = &style.strands;
        let count = set.count();
        let mut source = Self {
            wisp: set.wisp.clone(),
            first_point: set.first_point.clone(),
            shade: set.shade.clone(),
            ..Self::default()
        };
        if style.check().is_err() {
            // Only strands that are given can be drawn of such a style, without knowing where they are at rest.
            return source;
        }
        let has_few = |strands: u32| strands < FEW_STRANDS && count <= SPARSE;
        let guides = &style.guides;
        let at = |strand: usize, u: f32| {
            blended(guides, style.wisps[set.wisp[strand] as usize].guides, set.weights[strand], u)
        };
        source.roots = (0..count).map(|strand| at(strand, 0.0)).collect();
        if style.wisps.iter().any(|wisp| wisp.strand_count > 0 && has_few(wisp.strand_count)) {
            let last = |strand: usize| set.guide_param[set.first_point[strand + 1] as usize - 1];
            source.ends =
                (0..count).map(|strand| [0.5, 1.0].map(|part| at(strand, part * last(strand)))).collect();
            source.few =
                (0..count).map(|i| has_few(style.wisps[set.wisp[i] as usize].strand_count)).collect();
        }
        source
    }
}

/// The point at `u` links along the straight guides, blended by `weights`.
fn blended(guides: &Guides, of: [u32; 3], weights: [f32; 3], u: f32) -> Vec3 {
    let links = guides.points_per_guide - 1;
    let u = u.max(0.0).min(links as f32);
    let p = (u as usize).min(links - 1);
    let point = |guide: u32| {
        let (a, b) = (guides.point(guide as usize, p), guides.point(guide as usize, p + 1));
        a + (b - a) * (u - p as f32)
    };
    (0..3).map(|k| point(of[k]) * weights[k]).sum()
}

/// How long the strands of a style are, as binary logarithms of millimetres in [`LENGTH_STEPS`]; empty if none is a stub or much shorter than
/// others of its wisp.
fn lengths_of(style: &Hairstyle) -> Vec<i16> {
    let (set, guides) = (&style.strands, &style.guides);
    if style.check().is_err() {
        return Vec::new();
    }
    // Links beyond a cut have no length, so lengths are added up to where a strand ends.
    let points = guides.points_per_guide;
    let ways: Vec<f32> = (0..guides.count())
        .into_par_iter()
        .flat_map_iter(|guide| {
            let mut way = 0.0;
            (0..points).map(move |p| {
                if p > 0 {
                    way += guides.point(guide, p - 1).distance(guides.point(guide, p));
                }
                way
            })
        })
        .collect();
    let length = |strand: usize| {
        let u = set.guide_param[set.first_point[strand + 1] as usize - 1].clamp(0.0, (points - 1) as f32);
        let p = (u as usize).min(points - 2);
        let along = |guide: u32| {
            let way = &ways[guide as usize * points..][p..p + 2];
            way[0] + (way[1] - way[0]) * (u - p as f32)
        };
        let of = style.wisps[set.wisp[strand] as usize].guides;
        (0..3).map(|k| along(of[k]) * set.weights[strand][k]).sum::<f32>()
    };
    let all: Vec<i16> = (0..set.count()).map(|strand| steps_of(length(strand))).collect();
    let much = (-LENGTH_STEPS * AS_LONG.log2()) as i16;
    let uneven = style.wisps.iter().filter(|wisp| wisp.strand_count > 0).any(|wisp| {
        let of = &all[wisp.first_strand as usize..(wisp.first_strand + wisp.strand_count) as usize];
        of.iter().max() > of.iter().min().map(|least| least + much).as_ref()
    });
    let stub = steps_of(STUB);
    if uneven || all.iter().any(|length| *length < stub) { all } else { Vec::new() }
}

impl FineStrands {
    /// Makes this the list of `style`, with at least `count` strands. Returns whether anything has changed.
    ///
    /// The strands of a list do not depend on how many there are, nor on the styles of before.
    pub fn follow(&mut self, style: &Arc<Hairstyle>, count: usize) -> bool {
        if !self.rest.as_ref().is_some_and(|old| Arc::ptr_eq(old, style)) {
            self.rest = Some(Arc::clone(style));
            let source = Source::of(style);
            let lengths = lengths_of(style);
            self.longest_m = longest(&style.guides);
            if self.of != source {
                self.start(source);
                self.lengths = lengths;
            } else if self.lengths != lengths {
                // The same children, which follow their parents less or more.
                self.lengths = lengths;
                self.strands.clear();
            }
        }
        let stored = self.order.len();
        if stored == 0 || count <= self.strands.len() {
            return false;
        }
        if self.strands.is_empty() {
            self.strands.extend(self.order.iter().map(|&strand| stored_strand(&self.of, strand)));
        }
        if count > stored && self.neighbours.is_empty() {
            self.neighbours = neighbours_of(&self.of);
            self.edges = edges_of(&self.of.roots);
        }
        // In steps, so that an approaching camera does not extend the list in every frame.
        let target = if count > stored { count.max(self.strands.len() * 5 / 4) } else { count };
        for i in self.strands.len()..target {
            let parent = self.order[i % stored];
            let near = &self.neighbours[parent as usize];
            let edge = self.edges.get(parent as usize).copied().unwrap_or(0.0);
            let mut child = child(&self.of, parent, near, edge, i);
            follow_by_length(&mut child, &self.lengths);
            self.strands.push(child);
        }
        true
    }

    fn start(&mut self, source: Source) {
        self.order = evenly(&source.wisp);
        self.strands.clear();
        self.neighbours.clear();
        let longest =
            source.first_point.windows(2).map(|ends| ends[1].saturating_sub(ends[0]) as usize).max();
        self.stored_points = longest.unwrap_or(2).clamp(2, MAX_POINTS);
        self.points_per_strand = self.stored_points;
        self.of = source;
    }

    /// Gives each strand as many points as the longest stored one has, but no more than `most`.
    pub fn limit_points(&mut self, most: usize) {
        self.points_per_strand = self.stored_points.min(most).max(2);
    }
}

/// The length of the longest guide, metres.
fn longest(guides: &Guides) -> f32 {
    let length = |guide: usize| {
        let links = 1..guides.points_per_guide;
        links.map(|i| guides.point(guide, i - 1).distance(guides.point(guide, i))).sum::<f32>()
    };
    // False for NaN.
    (0..guides.count()).map(length).fold(0.0, |most, length| if length > most { length } else { most })
}

fn stored_strand(source: &Source, strand: u32) -> FineStrand {
    FineStrand {
        parents: [strand; 3],
        length: u16::MAX,
        shade: byte(source.shade.get(strand as usize).copied().unwrap_or(0.5)),
        ..FineStrand::default()
    }
}

fn byte(unit: f32) -> u8 {
    (unit.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// The child with number `i` in the list.
fn child(source: &Source, parent: u32, near: &[u32; NEIGHBOURS], edge: f32, i: usize) -> FineStrand {
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
    let own = source.shade.get(parent as usize).copied().unwrap_or(0.5);
    let mut strand = FineStrand {
        parents: [parent, near[b], near[c]],
        weights,
        length: ((1.0 - shorter) * 65_535.0) as u16,
        shade: byte(0.55 * own + 0.45 * random.unit()),
        is_short: 0,
    };
    shorten(&mut strand, edge, &mut random);
    strand
}

/// A length in metres as a number of [`lengths_of`].
fn steps_of(length: f32) -> i16 {
    ((length.max(1e-6) * 1e3).log2() * LENGTH_STEPS).round() as i16
}

/// Reduces the weights of parents that are much longer or much shorter than the first one, and those of a stub toward its tip.
fn follow_by_length(strand: &mut FineStrand, lengths: &[i16]) {
    let length = |parent: u32| lengths.get(parent as usize).copied();
    let Some(own) = length(strand.parents[0]) else { return };
    let leans = ((f32::from(own) / LENGTH_STEPS).exp2() * 1e-3 / LEANING).min(1.0);
    for (k, of) in strand.weights.iter_mut().enumerate() {
        let octaves = f32::from(own.abs_diff(length(strand.parents[k + 1]).unwrap_or(own))) / LENGTH_STEPS;
        let follows = ((-octaves).exp2() / AS_LONG).min(1.0);
        if follows < 1.0 || leans < 1.0 {
            let root = f32::from(of[0]) * follows;
            *of = of.map(|weight| (root + (f32::from(weight) * follows - root) * leans) as i8);
        }
    }
}

/// The nearest strands of each strand, of its wisp or of all with a similar shape where a wisp has few.
fn neighbours_of(source: &Source) -> Vec<[u32; NEIGHBOURS]> {
    if source.roots.is_empty() {
        return (0..source.wisp.len() as u32).map(|strand| [strand; NEIGHBOURS]).collect();
    }
    let mut out = vec![[0; NEIGHBOURS]; source.roots.len()];
    let mut first = 0;
    for members in source.wisp.chunk_by(|a, b| a == b) {
        let of = first..first + members.len();
        first = of.end;
        if source.few.get(of.start).copied().unwrap_or(false) {
            continue;
        }
        let tree = Nearest::new(&source.roots[of.clone()]);
        let start = of.start as u32;
        let row = |i: u32| {
            let found = tree.of::<NEIGHBOURS>(source.roots[(start + i) as usize], |other| other != i);
            repeated(found.points().map(|other| start + other), start + i)
        };
        out[of].par_iter_mut().enumerate().with_min_len(64).for_each(|(i, out)| *out = row(i as u32));
    }
    if !source.ends.is_empty() {
        let tree = Nearest::new(&source.roots);
        out.par_iter_mut().enumerate().filter(|(i, _)| source.few[*i]).for_each(|(i, out)| {
            let accept = |other: u32| other as usize != i && !is_parted(source, i, other as usize);
            let found = tree.of::<NEIGHBOURS>(source.roots[i], accept);
            *out = repeated(found.points(), i as u32);
        });
    }
    out
}

/// Whether a parting lies between two strands: their roots are much nearer to each other than the rest of them.
fn is_parted(source: &Source, a: usize, b: usize) -> bool {
    let root = source.roots[a].distance(source.roots[b]);
    let [middle, tip] = [0, 1].map(|k| source.ends[a][k].distance(source.ends[b][k]));
    middle.max(0.5 * tip) > 2.0 * root + 0.02
}

/// The neighbours that were found, again from the first where there are too few, and `own` where there are none.
fn repeated(found: impl ExactSizeIterator<Item = u32>, own: u32) -> [u32; NEIGHBOURS] {
    let mut out = [own; NEIGHBOURS];
    let count = found.len();
    for (out, found) in out.iter_mut().zip(found) {
        *out = found;
    }
    for k in count.max(1)..NEIGHBOURS {
        out[k] = out[k % count.max(1)];
    }
    out
}
