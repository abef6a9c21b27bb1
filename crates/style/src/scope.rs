//! Where and how strongly a layer acts.

use glam::Vec3;
use lovelock_base::random::SplitMix64;
use lovelock_groom::{Hairstyle, Obstacle};

use crate::{HeadBox, Mask, Ramp};

/// Where and how strongly a layer acts on a hairstyle.
pub struct Scope<'a> {
    /// The body without hair, head space.
    pub obstacle: &'a dyn Obstacle,
    /// The box of the hair on the head.
    pub head: HeadBox,
    /// The layer's weight, with that of its group.
    pub weight: f32,
    /// The layer's mask.
    pub mask: &'a Mask,
    /// The layer's ramp.
    pub ramp: &'a Ramp,
    /// The layer's seed.
    pub seed: u32,
}

impl Scope<'_> {
    /// The layer's weight times its mask at a place of the scalp, head space: 0 where it does nothing.
    pub fn at(&self, root: Vec3) -> f32 {
        self.weight * self.mask.at(&self.head, root)
    }

    /// The layer's ramp at a place along a strand: 0 is the root, 1 the tip.
    pub fn along(&self, place: f32) -> f32 {
        self.ramp.at(place)
    }

    /// Whether the layer's ramp is 1 everywhere.
    pub fn is_even(&self) -> bool {
        self.ramp.is_one()
    }

    /// [`Scope::at`] the root of each guide.
    pub fn guides(&self, style: &Hairstyle) -> Vec<f32> {
        (0..style.guides.count()).map(|guide| self.at(style.guides.point(guide, 0))).collect()
    }

    /// [`Scope::at`] the middle of the roots of each wisp.
    pub fn wisps(&self, style: &Hairstyle) -> Vec<f32> {
        wisp_roots(style).into_iter().map(|root| self.at(root)).collect()
    }

    /// [`Scope::at`] the root of each strand.
    pub fn strands(&self, style: &Hairstyle) -> Vec<f32> {
        strand_roots(style).into_iter().map(|root| self.at(root)).collect()
    }

    /// Random numbers of one thing that the layer acts on, such as a wisp; `purpose` keeps two uses apart.
    pub fn random(&self, purpose: u32, thing: usize) -> SplitMix64 {
        SplitMix64::of_stream(self.seed, (u64::from(purpose) << 32) | thing as u64)
    }
}

/// The root of each stored strand between those of its guides, head space: where masks are read for it.
pub fn strand_roots(style: &Hairstyle) -> Vec<Vec3> {
    let set = &style.strands;
    let root = |strand: usize| -> Vec3 {
        let guides = style.wisps[set.wisp[strand] as usize].guides;
        guides.iter().zip(set.weights[strand]).map(|(&g, w)| style.guides.point(g as usize, 0) * w).sum()
    };
    (0..set.count()).map(root).collect()
}

/// The middle of the roots of each wisp, head space.
pub(crate) fn wisp_roots(style: &Hairstyle) -> Vec<Vec3> {
    let root =
        |guides: [u32; 3]| guides.map(|g| style.guides.point(g as usize, 0)).iter().sum::<Vec3>() / 3.0;
    style.wisps.iter().map(|wisp| root(wisp.guides)).collect()
}
