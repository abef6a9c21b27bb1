//! Operations of colour: they change the absorption of drawn strands at a few places from root to tip.
//!
//! A change is one of pigment (see [`StrandColour`]), so that half of a dye is half of its pigment. It acts on what the look and the layers
//! before it give, and the variation between strands stays on top of all.

mod dye;
mod gradient;
mod grey;
mod highlights;
mod melanin;
mod streak;
#[cfg(test)]
mod tests;

pub use dye::Dye;
pub use gradient::{Gradient, GradientPigment};
pub use grey::Grey;
pub use highlights::Highlights;
pub use melanin::Melanin;
pub use streak::Streak;

use glam::Vec3;
use lovelock_groom::{COLOUR_SAMPLES, ColourSamples, HairLook, Hairstyle, StrandColour, StrandColours};
use rayon::prelude::*;

use crate::Scope;

/// One place of a strand whose colour an operation changes.
#[derive(Clone, Copy, Debug)]
struct ColourPlace {
    /// Index of the strand.
    strand: usize,
    /// [`Scope::at`] the root of the strand.
    strength: f32,
    /// [`Scope::along`] the strand.
    along: f32,
    /// The place along the strand: 0 is the root, 1 the tip.
    place: f32,
}

impl ColourPlace {
    /// The share of pigment that the layer may replace, 0 to 1.
    fn share(&self) -> f32 {
        (self.strength * self.along).clamp(0.0, 1.0)
    }
}

/// Changes the colours of the strands on which the layer acts. `change` returns the new colour of a place.
fn recolour(
    style: &mut Hairstyle,
    scope: &Scope<'_>,
    change: impl Fn(&ColourPlace, StrandColour) -> StrandColour + Sync,
) {
    let strengths = scope.strands(style);
    let places: [(f32, f32); COLOUR_SAMPLES] = std::array::from_fn(|sample| {
        let place = StrandColours::place(sample);
        (place, scope.along(place))
    });
    let old = style.strands.colours.strands();
    let of_strand = |(strand, &strength): (usize, &f32)| -> ColourSamples {
        let before = old.get(strand).copied().unwrap_or_default();
        if strength == 0.0 {
            return before;
        }
        std::array::from_fn(|sample| {
            let (place, along) = places[sample];
            if along == 0.0 {
                return before[sample];
            }
            let new = change(&ColourPlace { strand, strength, along, place }, before[sample]);
            if new.is_sound() { new } else { before[sample] }
        })
    };
    let colours = strengths.par_iter().enumerate().map(of_strand).collect();
    style.strands.colours = StrandColours::new(colours);
}

/// Absorption of natural hair of these concentrations.
fn natural(eumelanin: f32, pheomelanin: f32) -> Vec3 {
    HairLook { eumelanin, pheomelanin, dye_amount: 0.0, ..HairLook::default() }.absorption()
}

/// Absorption of a dye. The roughness is that of hair by default: the look may change after the dye.
fn dyed(color: Vec3) -> Vec3 {
    HairLook::absorption_of_dye(color, HairLook::default().roughness_around)
}

/// A random number of each lock, 0 to 1, by the lock of each strand.
fn by_lock(scope: &Scope<'_>, purpose: u32, locks: &[u32]) -> Vec<f32> {
    locks.iter().map(|&lock| scope.random(purpose, lock as usize).unit()).collect()
}
