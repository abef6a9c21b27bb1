//! What brushes did to hair: edits of single guides, stored by their places on the scalp.
//!
//! [`HandEdits`] has an edit for every guide that a brush touched. A guide whose root is at the place of an edit gets exactly that one.
//! Any other guide, such as one of another seed or another count of locks, gets the mean of the edits around it. Guides that are next to
//! a touched one have an edit too, which changes nothing, so that they are not taken for guides of another hairstyle.

mod edit;
mod guides;
mod place;
mod sample;
#[cfg(test)]
mod tests;
mod text;

use std::sync::Arc;

use glam::Vec3;
use lovelock_base::numbers::smoothstep;
use rayon::prelude::*;

pub use edit::{HandChannel, HandEdit};
pub use guides::{hand_input, relength, resampled, turned_toward};
use place::PlaceIndex;
pub use place::{HandPlace, HandRoots, link_frames, smallest_turn, turn_to, turned_by};
use sample::HandSample;

/// Edits reach hair of another hairstyle up to this many distances between roots.
const FADE: [f32; 2] = [1.0, 2.0];

/// Edits by the places of guides. Copies share memory, and a changed copy shares every edit that is the same.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct HandEdits(Arc<Vec<Arc<HandSample>>>);

impl HandEdits {
    /// The most places.
    pub const MAX: usize = 100_000;

    /// Whether there is no edit.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Number of places, those included whose edit changes nothing.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// Bytes of memory that this has and `other` does not share with it.
    pub fn bytes_beside(&self, other: &Self) -> usize {
        if Arc::ptr_eq(&self.0, &other.0) {
            return 0;
        }
        let own = |sample: &&Arc<HandSample>| {
            let at = other.0.binary_search_by_key(&sample.place, |other| other.place);
            !at.is_ok_and(|at| Arc::ptr_eq(&other.0[at], sample))
        };
        let bytes = |sample: &Arc<HandSample>| {
            let points: usize = sample.channels.iter().map(Vec::len).sum();
            size_of::<HandSample>() + 4 * sample.turns.len() + 2 * points
        };
        8 * self.0.len() + self.0.iter().filter(own).map(bytes).sum::<usize>()
    }

    /// The edit of each guide; `None` where nothing changes it.
    pub fn of_roots(&self, roots: &HandRoots) -> Vec<Option<HandEdit>> {
        let index = self.index();
        (0..roots.places.len())
            .into_par_iter()
            .map(|guide| self.at(&index, roots, guide).filter(|edit| !edit.is_none()))
            .collect()
    }

    /// Stores the edits of some guides of a hairstyle with these roots; that of no other of its guides changes. Edits of other hairstyles
    /// are replaced where they would reach the changed guides.
    pub fn change(&mut self, roots: &HandRoots, edits: impl IntoIterator<Item = (usize, HandEdit)>) {
        let mut changed = vec![None; roots.places.len()];
        for (guide, edit) in edits {
            if let Some(place) = changed.get_mut(guide) {
                *place = Some(edit);
            }
        }
        let touched: Vec<usize> = (0..changed.len()).filter(|guide| changed[*guide].is_some()).collect();
        if touched.is_empty() {
            return;
        }
        let index = self.index();
        let own: Vec<Option<usize>> = (0..changed.len())
            .map(|guide| self.own(&index, roots.directions[guide], roots.places[guide]))
            .collect();
        let mut foreign = vec![true; self.0.len()];
        own.iter().flatten().for_each(|sample| foreign[*sample] = false);

        // Edits of other hairstyles around the touched guides give way, once those that they reach have edits of their own.
        let furthest = FADE[1] * roots.spacing.max(self.furthest());
        let near = PlaceIndex::new(roots.directions.iter().copied(), furthest);
        let mut dropped = vec![false; self.0.len()];
        for &guide in &touched {
            for sample in index.around(roots.directions[guide]).filter(|sample| foreign[*sample]) {
                let reach = FADE[1] * self.0[sample].spacing();
                dropped[sample] |= self.0[sample].place.direction().distance(roots.directions[guide]) < reach;
            }
        }
        let mut pinned = vec![false; changed.len()];
        let mut pin = |centre: Vec3, reach: f32| {
            for guide in near.around(centre) {
                let free = changed[guide].is_none() && own[guide].is_none();
                pinned[guide] |= free && roots.directions[guide].distance(centre) < reach;
            }
        };
        for guide in &touched {
            pin(roots.directions[*guide], FADE[1] * roots.spacing);
        }
        if foreign.contains(&true) {
            // Any new edit would count among those of other hairstyles around it.
            for (guide, pinned) in pinned.iter_mut().enumerate() {
                *pinned = changed[guide].is_none() && own[guide].is_none();
            }
        }

        let mut samples: Vec<Arc<HandSample>> = Vec::with_capacity(self.0.len() + touched.len());
        let mut replaced = vec![false; self.0.len()];
        for sample in touched.iter().filter_map(|guide| own[*guide]) {
            replaced[sample] = true;
        }
        let kept = self.0.iter().enumerate().filter(|(i, _)| !dropped[*i] && !replaced[*i]);
        samples.extend(kept.map(|(_, sample)| Arc::clone(sample)));
        for (guide, edit) in changed.iter().enumerate() {
            let place = own[guide].map_or(roots.places[guide], |sample| self.0[sample].place);
            let edit = match edit {
                Some(edit) => edit.clone(),
                None if pinned[guide] => self.at(&index, roots, guide).unwrap_or_default(),
                None => continue,
            };
            samples.push(Arc::new(HandSample::of(place, roots.spacing, &edit)));
        }
        samples.truncate(Self::MAX);
        *self = Self::sorted(samples);
    }

    /// The edits on the other side of the head.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        Self::sorted(self.0.iter().map(|sample| Arc::new(sample.mirrored())).collect())
    }

    /// The mean of the edits around a place, in which exactly that of the place counts if there is one.
    fn at(&self, index: &PlaceIndex, roots: &HandRoots, guide: usize) -> Option<HandEdit> {
        let direction = roots.directions[guide];
        if let Some(own) = self.own(index, direction, roots.places[guide]) {
            return Some(self.0[own].edit());
        }
        let mut near: Vec<(f32, f32, usize)> = index
            .around(direction)
            .filter_map(|i| {
                let distance = self.0[i].place.direction().distance(direction);
                let reach = FADE[1] * self.0[i].spacing();
                (distance < reach).then_some((distance, reach, i))
            })
            .collect();
        near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.2.cmp(&b.2)));
        near.truncate(8);
        let (nearest, reach, _) = *near.first()?;
        let whole = 1.0 - smoothstep(FADE[0] / FADE[1] * reach, reach, nearest);
        let weight = |(distance, reach, _): &(f32, f32, usize)| {
            ((reach - distance) / (reach * distance.max(1e-4))).powi(2)
        };
        let sum: f32 = near.iter().map(weight).sum();
        let edits: Vec<(f32, HandEdit)> =
            near.iter().map(|near| (whole * weight(near) / sum, self.0[near.2].edit())).collect();
        let parts: Vec<(f32, &HandEdit)> = edits.iter().map(|(weight, edit)| (*weight, edit)).collect();
        Some(HandEdit::mean(&parts))
    }

    /// The sample at the place of a guide.
    fn own(&self, index: &PlaceIndex, direction: Vec3, place: HandPlace) -> Option<usize> {
        if let Ok(at) = self.0.binary_search_by_key(&place, |sample| sample.place) {
            return Some(at);
        }
        index.around(direction).find(|i| self.0[*i].place.is_at(place))
    }

    fn furthest(&self) -> f32 {
        self.0.iter().map(|sample| sample.spacing()).fold(0.0, f32::max)
    }

    fn index(&self) -> PlaceIndex {
        let directions = self.0.iter().map(|sample| sample.place.direction());
        PlaceIndex::new(directions, FADE[1] * self.furthest())
    }

    fn sorted(mut samples: Vec<Arc<HandSample>>) -> Self {
        samples.sort_by_key(|sample| sample.place);
        samples.dedup_by_key(|sample| sample.place);
        Self(Arc::new(samples))
    }
}
