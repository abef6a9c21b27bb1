//! The rounds of variants.

use std::sync::Arc;

use lovelock_project::Project;
use lovelock_project::variants::{Locks, vary};
use lovelock_session::wall::Wall;

use super::{PRESENT, WallLayout};

/// The most rounds that can be returned to.
const MAX_ROUNDS: usize = 40;

/// The variants of each round, with the present hairstyle in the middle.
#[derive(Default)]
pub(super) struct Rounds {
    variants: Vec<Arc<Project>>,
    /// The hairstyle that the variants were made from, how far they are, and what was locked.
    of: Option<(Arc<Project>, f32, Locks)>,
    seed: u32,
    before: Vec<(Vec<Arc<Project>>, u32)>,
}

impl Rounds {
    /// The variants that are shown.
    pub(super) fn variants(&self) -> &[Arc<Project>] {
        &self.variants
    }

    /// Whether there is a round to return to.
    pub(super) fn has_before(&self) -> bool {
        !self.before.is_empty()
    }

    /// A number for chance that changes with every round.
    pub(super) fn next_seed(&self) -> u32 {
        self.seed.wrapping_add(1)
    }

    /// Makes variants again if the hairstyle has changed, from which they are made, or how they are made.
    pub(super) fn follow(&mut self, project: &Arc<Project>, layout: &WallLayout) {
        match &self.of {
            Some((of, amount, locks)) => {
                let same_hair =
                    Arc::ptr_eq(of, project) || (of.hair == project.hair && of.look == project.look);
                let same_chance = amount.to_bits() == layout.amount.to_bits() && *locks == layout.locks;
                if same_hair && same_chance {
                    return;
                }
                // Another amount or lock shows the same chance; other hair is another round.
                if !same_hair {
                    self.remember();
                }
            }
            None => self.seed = project.hair.groom.seed,
        }
        self.make(Arc::clone(project), layout);
    }

    /// Makes other variants of the same hairstyle.
    pub(super) fn again(&mut self, layout: &WallLayout) {
        if let Some((of, ..)) = self.of.clone() {
            self.remember();
            self.make(of, layout);
        }
    }

    /// Returns to the variants before. The present hairstyle stays.
    pub(super) fn back(&mut self) {
        if let Some((variants, seed)) = self.before.pop() {
            let present = self.variants.get(PRESENT).cloned();
            (self.variants, self.seed) = (variants, seed);
            if let (Some(slot), Some(present)) = (self.variants.get_mut(PRESENT), present) {
                *slot = present;
            }
        }
    }

    fn remember(&mut self) {
        self.before.push((std::mem::take(&mut self.variants), self.seed));
        if self.before.len() > MAX_ROUNDS {
            self.before.remove(0);
        }
        self.seed = self.seed.wrapping_add(1);
    }

    fn make(&mut self, of: Arc<Project>, layout: &WallLayout) {
        // Only hair and colours are used, and tracks may be large: earlier rounds would keep a copy for each variant.
        let mut bare = Project::clone(&of);
        (bare.timeline.tracks, bare.timeline.markers) = (Vec::new(), Vec::new());
        let variant = |index: usize| {
            if index == PRESENT {
                return Arc::clone(&of);
            }
            let seed = self.seed.wrapping_mul(Wall::CELLS as u32).wrapping_add(index as u32);
            Arc::new(vary(&bare, seed, layout.amount, &layout.locks))
        };
        self.variants = (0..Wall::CELLS).map(variant).collect();
        self.of = Some((of, layout.amount, layout.locks.clone()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_follow_the_hair_and_not_the_camera() {
        let mut rounds = Rounds::default();
        let layout = WallLayout::default();
        let mut project = Project::default();
        rounds.follow(&Arc::new(project.clone()), &layout);
        let first = rounds.variants().to_vec();
        assert_eq!(first.len(), Wall::CELLS);
        assert_eq!(*first[PRESENT], project);
        project.camera.azimuth += 0.3;
        rounds.follow(&Arc::new(project.clone()), &layout);
        assert!(first.iter().zip(rounds.variants()).all(|(a, b)| Arc::ptr_eq(a, b)));
        project.hair.groom.length = 0.4;
        rounds.follow(&Arc::new(project.clone()), &layout);
        assert_eq!(*rounds.variants()[PRESENT], project);
        assert_ne!(rounds.variants()[0].hair, first[0].hair);
        rounds.back();
        assert!(Arc::ptr_eq(&rounds.variants()[0], &first[0]));
        assert_eq!(*rounds.variants()[PRESENT], project, "the present style stays");
    }

    #[test]
    fn another_amount_shows_the_same_chance_nearer() {
        let mut rounds = Rounds::default();
        let project = Arc::new(Project::default());
        let mut layout = WallLayout { amount: 1.0, ..WallLayout::default() };
        rounds.follow(&project, &layout);
        let far: Vec<f32> = rounds.variants().iter().map(|variant| variant.hair.groom.length).collect();
        layout.amount = 0.1;
        rounds.follow(&project, &layout);
        assert!(!rounds.has_before());
        let own = project.hair.groom.length;
        for (far, near) in far.into_iter().zip(rounds.variants()) {
            assert!((near.hair.groom.length - own).abs() <= (far - own).abs() + 1e-6);
        }
        rounds.again(&layout);
        assert!(rounds.has_before());
    }
}
