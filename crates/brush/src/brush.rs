//! One stroke of a brush.

use std::sync::Arc;

use glam::Vec3;
use lovelock_base::settings::Settings as _;
use lovelock_groom::{GuideFrame, Guides, Hairstyle, Obstacle};
use lovelock_style::hand::{HandEdit, HandEdits, HandRoots, hand_input};
use rayon::prelude::*;

use crate::carry::CarriedGuide;
use crate::chain::{evened, lay, lengths};
use crate::fall::{fallen, lifts};
use crate::settings::{BrushMirror, BrushSettings};
use crate::stroke::{Dab, Resampler, StrokeSample, mirror};
use crate::tool::Tool;
use crate::tools::{Change, Grab, Stamp, neighbours};
use crate::touch::{TouchedGuide, Wisps, touched};

/// How far a link may be stretched or compressed at a dab, as factors.
const STRETCH: [f32; 2] = [0.8, 1.25];
/// The most points of the way of a brush that tools use.
const MAX_WAY: usize = 512;

/// What is around the hair at one instant.
#[derive(Clone, Copy)]
pub struct BrushSurroundings<'a> {
    /// The body without hair, in the space of the head.
    pub obstacle: &'a dyn Obstacle,
}

/// One stroke of a brush.
#[derive(Clone, Debug)]
pub struct Brush {
    tool: Tool,
    inverted: bool,
    settings: BrushSettings,
    /// The hair that the layer gets.
    below: Arc<Hairstyle>,
    /// The guides at rest after all layers, as the stroke has changed them.
    rest: Guides,
    roots: HandRoots,
    locks: Wisps,
    /// The edit of each guide in the layer.
    edits: Vec<Option<HandEdit>>,
    touched: Vec<bool>,
    frozen: Vec<bool>,
    resampler: Resampler,
    way: Vec<Vec3>,
    grab: Vec<Grab>,
    neighbours: Vec<Vec<u32>>,
    /// How far a comb has lifted the points of each guide off the body so far, metres; empty for the others.
    lifted: Vec<Vec<f32>>,
}

impl Brush {
    /// A stroke that is about to begin.
    ///
    /// `below` is the hairstyle that the layer with the edits gets, and `rest` the one after all layers. `frozen` says which guides are
    /// protected; guides that it lacks are not. `None` if the two hairstyles differ in their guides.
    pub fn new(
        tool: Tool,
        inverted: bool,
        settings: &BrushSettings,
        [below, rest]: [&Arc<Hairstyle>; 2],
        edits: &HandEdits,
        frozen: &[bool],
    ) -> Option<Self> {
        let count = below.guides.count();
        let alike =
            rest.guides.count() == count && rest.guides.points_per_guide == below.guides.points_per_guide;
        if !alike {
            return None;
        }
        let roots = HandRoots::of(below);
        let (tool, inverted) = tool.resolved(inverted);
        let mut frozen = frozen.to_vec();
        frozen.resize(count, false);
        Some(Self {
            tool,
            inverted,
            settings: settings.clamped(),
            below: Arc::clone(below),
            rest: rest.guides.clone(),
            locks: Wisps::of(rest),
            edits: edits.of_roots(&roots),
            touched: vec![false; count],
            lifted: vec![Vec::new(); count],
            frozen,
            resampler: Resampler::default(),
            way: Vec::new(),
            grab: Vec::new(),
            neighbours: if tool == Tool::Smooth { neighbours(&roots.directions) } else { Vec::new() },
            roots,
        })
    }

    /// Moves the brush to a sample. The touched guides of `frame` take their new places. Returns the guides that were changed.
    ///
    /// A frame of another hairstyle stays as it is.
    pub fn stroke_to(
        &mut self,
        frame: &mut GuideFrame,
        around: &BrushSurroundings<'_>,
        sample: &StrokeSample,
    ) -> Vec<usize> {
        let alike = frame.guides.count() == self.touched.len()
            && frame.guides.points_per_guide == self.rest.points_per_guide;
        let head_from_world = frame.world_from_head.inverse();
        if !alike || !head_from_world.is_finite() {
            return Vec::new();
        }
        let dabs = self.resampler.dabs(sample, self.settings.radius, &head_from_world);
        if dabs.is_empty() {
            return Vec::new();
        }
        let mut seen = GuideFrame::at_rest(&frame.guides, head_from_world, 0.0).guides;
        let mut changed = vec![false; self.touched.len()];
        for dab in dabs {
            if self.way.len() < MAX_WAY {
                self.way.push(dab.centre);
            }
            self.dab(&dab, &mut seen, around, &mut changed);
            if self.settings.mirror == BrushMirror::Own {
                self.dab(&dab.mirrored(), &mut seen, around, &mut changed);
            }
        }
        if self.settings.mirror == BrushMirror::Same {
            self.mirror(&mut seen, &mut changed);
        }
        let changed: Vec<usize> = (0..changed.len()).filter(|guide| changed[*guide]).collect();
        self.put_back(frame, &seen, changed.iter());
        changed
    }

    /// Brings guides of a frame to where they are seen, head space.
    fn put_back<'a>(
        &mut self,
        frame: &mut GuideFrame,
        seen: &Guides,
        guides: impl Iterator<Item = &'a usize>,
    ) {
        let count = frame.guides.points_per_guide;
        for &guide in guides {
            self.touched[guide] = true;
            for i in 1..count {
                put(
                    &mut frame.guides,
                    guide * count + i,
                    frame.world_from_head.transform_point3(seen.point(guide, i)),
                );
            }
        }
    }

    /// Ends the stroke: what a comb has left in the air falls at rest, and so does the hair of `frame` if `at_once`. Otherwise that stays where
    /// it is, for its simulation to let it fall. `falls` is 1 for hair that nothing holds, and 0 for hair that stays in the air. Returns the
    /// guides that were changed.
    pub fn let_go(
        &mut self,
        frame: &mut GuideFrame,
        around: &BrushSurroundings<'_>,
        (falls, at_once): (f32, bool),
    ) -> Vec<usize> {
        let alike = frame.guides.count() == self.touched.len()
            && frame.guides.points_per_guide == self.rest.points_per_guide;
        let head_from_world = frame.world_from_head.inverse();
        let down = head_from_world.transform_vector3(Vec3::NEG_Y).try_normalize();
        let Some(down) = down.filter(|_| alike && head_from_world.is_finite() && falls > 0.0) else {
            return Vec::new();
        };
        let mut seen = GuideFrame::at_rest(&frame.guides, head_from_world, 0.0).guides;
        let combed: Vec<usize> =
            (0..self.lifted.len()).filter(|guide| !self.lifted[*guide].is_empty()).collect();
        let fall = |guide: &usize| {
            let points = hand_input(&seen, *guide, 1.0)?;
            let fallen = fallen(&points, &self.lifted[*guide], down, falls, around.obstacle)?;
            let mut carried = self.carried(*guide, points)?;
            carried.move_to(&fallen, 1.0)?;
            changed_guide(carried)
        };
        let fallen: Vec<ChangedGuide> = combed.par_iter().filter_map(fall).collect();
        let mut changed = vec![false; self.touched.len()];
        for guide in fallen {
            self.keep(&mut seen, guide, &mut changed);
        }
        if self.settings.mirror == BrushMirror::Same {
            self.mirror(&mut seen, &mut changed);
        }
        self.lifted.iter_mut().for_each(Vec::clear);
        let changed: Vec<usize> = (0..changed.len()).filter(|guide| changed[*guide]).collect();
        for guide in &changed {
            self.touched[*guide] = true;
        }
        self.put_back(frame, &seen, changed.iter().filter(|_| at_once));
        changed
    }

    /// Adds what the stroke did to a layer.
    pub fn write(&self, edits: &mut HandEdits) {
        let touched = self.touched.iter().enumerate().filter(|(_, touched)| **touched);
        let edit = |guide: usize| self.edits[guide].clone().unwrap_or_default();
        edits.change(&self.roots, touched.map(|(guide, _)| (guide, edit(guide))));
    }

    /// Which guides the stroke has changed.
    pub fn touched(&self) -> &[bool] {
        &self.touched
    }

    /// Which guides are protected after the stroke.
    pub fn frozen(&self) -> &[bool] {
        &self.frozen
    }

    /// The guides at rest after all layers, as the stroke has changed them, head space.
    pub fn rest(&self) -> &Guides {
        &self.rest
    }

    fn dab(&mut self, dab: &Dab, seen: &mut Guides, around: &BrushSurroundings<'_>, changed: &mut [bool]) {
        let is_free = |guide: usize| self.tool == Tool::Freeze || !self.frozen[guide];
        let mut touched = touched(seen, dab, &self.settings, &self.locks, is_free, around.obstacle);
        if self.tool == Tool::Place {
            if dab.first {
                self.grab.extend(touched.iter().filter_map(|touched| Grab::of(touched, dab.mirrored)));
            }
            let again = |grab: &Grab| {
                let points = hand_input(seen, grab.guide, 1.0)?;
                Some(TouchedGuide { guide: grab.guide, weights: vec![grab.weight; points.len()], points })
            };
            touched =
                self.grab.iter().filter(|grab| grab.mirrored == dab.mirrored).filter_map(again).collect();
        }
        let way: Vec<Vec3> =
            if dab.mirrored { self.way.iter().copied().map(mirror).collect() } else { self.way.clone() };
        let stamp = Stamp {
            tool: self.tool,
            inverted: self.inverted,
            settings: &self.settings,
            dab: *dab,
            path: &way,
            seen,
            neighbours: &self.neighbours,
            locks: &self.locks,
            grab: &self.grab,
            obstacle: around.obstacle,
        };
        let changes: Vec<(usize, Outcome, Vec<f32>)> = touched
            .par_iter()
            .filter_map(|touched| {
                let change = stamp.change(touched)?;
                let outcome = self.outcome(touched, change, around.obstacle)?;
                let lifts = match &outcome {
                    Outcome::Guide(now) if self.tool == Tool::Comb => {
                        lifts([&touched.points, &now.seen], around.obstacle)
                    }
                    _ => Vec::new(),
                };
                Some((touched.guide, outcome, lifts))
            })
            .collect();
        for (guide, outcome, lifts) in changes {
            let lifted = &mut self.lifted[guide];
            lifted.resize(lifted.len().max(lifts.len()), 0.0);
            for (sum, lift) in lifted.iter_mut().zip(lifts) {
                *sum += lift;
            }
            match outcome {
                Outcome::Guide(carried) => self.keep(seen, *carried, changed),
                Outcome::Removed(removed) => self.each_of_wisp(guide, |brush, guide| {
                    let edit = brush.edits[guide].get_or_insert_default();
                    changed[guide] |= edit.removed != removed;
                    edit.removed = removed;
                }),
                Outcome::Frozen(frozen) => {
                    self.each_of_wisp(guide, |brush, guide| brush.frozen[guide] = frozen);
                }
            }
        }
    }

    fn each_of_wisp(&mut self, guide: usize, mut act: impl FnMut(&mut Self, usize)) {
        for guide in self.locks.of_guide(guide) {
            act(self, guide);
        }
    }

    fn carried(&self, guide: usize, seen: Vec<Vec3>) -> Option<CarriedGuide<'_>> {
        Some(CarriedGuide {
            guide,
            outward: self.roots.directions[guide],
            below: &self.below.guides,
            rest: hand_input(&self.rest, guide, 1.0)?,
            seen,
            edit: self.edits[guide].clone().unwrap_or_default(),
        })
    }

    fn outcome(&self, touched: &TouchedGuide, change: Change, obstacle: &dyn Obstacle) -> Option<Outcome> {
        let mut carried = self.carried(touched.guide, touched.points.clone())?;
        match change {
            Change::Points(targets) => {
                let links = lengths(&touched.points);
                let (links, factor) = if self.settings.keep_lengths {
                    (links, 1.0)
                } else {
                    stretched(&links, &targets, carried.edit.length)
                };
                let mut laid = lay(&touched.points, &targets, &links, obstacle);
                if self.tool.pushes() {
                    laid = lay(&touched.points, &evened(&touched.points, &laid), &links, obstacle);
                }
                carried.move_to(&laid, factor)?;
            }
            Change::Length(factor) => carried.relength(factor)?,
            Change::Cut(at) => carried.cut(at)?,
            Change::Channel(kind, step, weights) => {
                let links = hand_input(&self.below.guides, touched.guide, 1.0)?.len() - 1;
                let last = weights.len() - 1;
                if kind == lovelock_style::hand::HandChannel::Curl {
                    carried.edit.pitch = self.settings.curl_pitch;
                }
                let [low, high] = kind.range();
                for (i, value) in carried.edit.channel_mut(kind, links).iter_mut().enumerate() {
                    let weight = weights[i.min(last)];
                    // What is beyond a cut stays.
                    if i <= last {
                        *value = step.of(*value, weight).clamp(low, high);
                    }
                }
                carried.edit.tidy();
            }
            Change::Removed(removed) => return Some(Outcome::Removed(removed)),
            Change::Frozen(frozen) => return Some(Outcome::Frozen(frozen)),
        }
        Some(Outcome::Guide(Box::new(changed_guide(carried)?)))
    }

    fn keep(&mut self, seen: &mut Guides, guide: ChangedGuide, changed: &mut [bool]) {
        let ChangedGuide { guide, rest, seen: points, edit } = guide;
        let own = &mut self.edits[guide];
        let same = own.as_ref().map_or(edit.is_none(), |own| *own == edit);
        *own = (!edit.is_none()).then_some(edit);
        changed[guide] |= !same;
        write_guide(&mut self.rest, guide, &rest);
        write_guide(seen, guide, &points);
    }

    /// Gives the other side of the head the mirrored shape of the guides that the stroke touched.
    fn mirror(&mut self, seen: &mut Guides, changed: &mut [bool]) {
        let touched: Vec<usize> =
            (0..changed.len()).filter(|guide| changed[*guide] || self.touched[*guide]).collect();
        let Some(side) = self.way.first().map(|p| p.x.signum()) else { return };
        let mut edits = HandEdits::default();
        let all = self.edits.iter().enumerate();
        edits.change(&self.roots, all.map(|(guide, edit)| (guide, edit.clone().unwrap_or_default())));
        let mirrored = edits.mirrored().of_roots(&self.roots);
        let reach = self.roots.spacing;
        let near = |guide: &usize| {
            let own = self.roots.directions[*guide];
            let other = mirror(own);
            let on_other_side = own.x * side < 0.0 && !self.frozen[*guide];
            on_other_side
                && touched.iter().any(|from| {
                    let from = self.roots.directions[*from];
                    from.x * side >= 0.0 && from.distance(other) < reach
                })
        };
        let guides: Vec<usize> = (0..changed.len()).filter(near).collect();
        for guide in guides {
            let edit = mirrored[guide].clone().unwrap_or_default();
            let Some(points) = hand_input(seen, guide, 1.0) else { continue };
            let Some(mut carried) = self.carried(guide, points) else { continue };
            if carried.take(edit).is_none() {
                continue;
            }
            let CarriedGuide { guide, rest, seen: points, edit, .. } = carried;
            if points.iter().chain(&rest).all(|p| p.is_finite()) {
                self.keep(seen, ChangedGuide { guide, rest, seen: points, edit }, changed);
            }
        }
    }
}

/// What a dab did to one guide.
enum Outcome {
    Guide(Box<ChangedGuide>),
    Removed(bool),
    Frozen(bool),
}

struct ChangedGuide {
    guide: usize,
    rest: Vec<Vec3>,
    seen: Vec<Vec3>,
    edit: HandEdit,
}

/// What was changed of a guide; `None` if that is not finite.
fn changed_guide(carried: CarriedGuide<'_>) -> Option<ChangedGuide> {
    let CarriedGuide { guide, rest, seen, edit, .. } = carried;
    let finite = seen.iter().chain(&rest).all(|p| p.is_finite());
    finite.then_some(ChangedGuide { guide, rest, seen, edit })
}

/// The lengths of links that are stretched, and the factor on the whole length.
fn stretched(links: &[f32], targets: &[Vec3], length: f32) -> (Vec<f32>, f32) {
    let [low, high] = STRETCH;
    let wanted = lengths(targets);
    let new: Vec<f32> =
        links.iter().zip(&wanted).map(|(link, wanted)| wanted.clamp(low * link, high * link)).collect();
    let (before, after) = (links.iter().sum::<f32>(), new.iter().sum::<f32>());
    let factor = after / before;
    let [least, most] = HandEdit::LENGTHS;
    if factor.is_finite() && (least..=most).contains(&(length * factor)) {
        // Links stay equal.
        (links.iter().map(|link| link * factor).collect(), factor)
    } else {
        (links.to_vec(), 1.0)
    }
}

/// Writes the points of a guide; the rest of its points lie on the last of them.
fn write_guide(guides: &mut Guides, guide: usize, points: &[Vec3]) {
    let count = guides.points_per_guide;
    for i in 0..count {
        put(guides, guide * count + i, points[i.min(points.len() - 1)]);
    }
}

fn put(guides: &mut Guides, at: usize, p: Vec3) {
    (guides.x[at], guides.y[at], guides.z[at]) = (p.x, p.y, p.z);
}
