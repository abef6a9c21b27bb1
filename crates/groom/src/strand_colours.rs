//! Colours of single strands, beside those of the look.
// Inlined into the loops of a renderer; a call would prevent vectorisation.
#![allow(clippy::inline_always)]

use glam::Vec3;

/// Places along a strand at which its colour is stored: evenly from the root to the tip. Between them it is linear.
pub const COLOUR_SAMPLES: usize = 8;

/// The colour of hair at one place, as a change of the absorption that the look has there.
///
/// The absorption is `kept * below + added`. Absorption is proportional to the concentration of pigment (Beer-Lambert), so a mixture of two
/// colours by a share is that of their pigments, and any sequence of changes is again of this form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrandColour {
    /// What is left of the pigment below, as a fraction.
    pub kept: f32,
    /// Absorption of the pigment that was added, per unit of path through a fibre, linear sRGB.
    pub added: [f32; 3],
}

impl Default for StrandColour {
    fn default() -> Self {
        Self::BELOW
    }
}

impl StrandColour {
    /// The colour below, unchanged.
    pub const BELOW: Self = Self { kept: 1.0, added: [0.0; 3] };

    /// The colour in which the fraction `share` of all pigment is replaced by one of that absorption.
    #[must_use]
    pub fn toward(self, absorption: Vec3, share: f32) -> Self {
        self.faded(1.0 - share).with(absorption * share)
    }

    /// The colour with its pigment multiplied by a factor.
    #[must_use]
    pub fn faded(self, factor: f32) -> Self {
        Self { kept: self.kept * factor, added: self.added.map(|sigma| sigma * factor) }
    }

    /// The colour with more pigment.
    #[must_use]
    pub fn with(self, absorption: Vec3) -> Self {
        Self { added: (Vec3::from(self.added) + absorption).to_array(), ..self }
    }

    /// A mixture with the fraction `share` of the pigment of another colour; exactly one of both at 0 and 1.
    #[must_use]
    pub fn mixed(self, other: Self, share: f32) -> Self {
        let mix = |a: f32, b: f32| if a == b { a } else { a * (1.0 - share) + b * share };
        Self {
            kept: mix(self.kept, other.kept),
            added: [0, 1, 2].map(|c| mix(self.added[c], other.added[c])),
        }
    }

    /// The absorption over hair of the absorption `below`.
    pub fn absorption(self, below: Vec3) -> Vec3 {
        self.kept * below + Vec3::from(self.added)
    }

    /// Whether every number is finite and not negative.
    pub fn is_sound(self) -> bool {
        [self.kept, self.added[0], self.added[1], self.added[2]].iter().all(|v| v.is_finite() && *v >= 0.0)
    }

    /// `kept`, then red, green and blue of `added`.
    pub fn to_array(self) -> [f32; 4] {
        let [red, green, blue] = self.added;
        [self.kept, red, green, blue]
    }

    fn mean(of: impl Iterator<Item = Self>) -> Self {
        let (mut sum, mut count) = ([0.0_f64; 4], 0_usize);
        for colour in of {
            for (sum, value) in sum.iter_mut().zip(colour.to_array()) {
                *sum += f64::from(value);
            }
            count += 1;
        }
        if count == 0 {
            return Self::BELOW;
        }
        let [kept, red, green, blue] = sum.map(|sum| (sum / count as f64) as f32);
        Self { kept, added: [red, green, blue] }
    }
}

/// The colours of one strand from root to tip.
pub type ColourSamples = [StrandColour; COLOUR_SAMPLES];

/// The colours of the strands of a [`StrandSet`](crate::StrandSet), or nothing where every strand has the colour of the look.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StrandColours {
    strands: Vec<ColourSamples>,
    mean: StrandColour,
    roots: StrandColour,
}

impl StrandColours {
    /// The colours of strands, one entry for each.
    pub fn new(strands: Vec<ColourSamples>) -> Self {
        let mean = StrandColour::mean(strands.iter().flatten().copied());
        let roots = StrandColour::mean(strands.iter().map(|samples| samples[0]));
        Self { strands, mean, roots }
    }

    /// Whether every strand has the colour of the look.
    pub fn is_empty(&self) -> bool {
        self.strands.is_empty()
    }

    /// The colours of each strand; empty where every strand has the colour of the look.
    pub fn strands(&self) -> &[ColourSamples] {
        &self.strands
    }

    /// The mean over all strands and places.
    pub fn mean(&self) -> StrandColour {
        self.mean
    }

    /// The mean at the roots.
    pub fn roots(&self) -> StrandColour {
        self.roots
    }

    /// The colours of a selection of these strands, by their indices.
    #[must_use]
    pub fn selected(&self, strands: impl Iterator<Item = usize>) -> Self {
        if self.is_empty() {
            return Self::default();
        }
        Self::new(strands.map(|strand| self.strands[strand]).collect())
    }

    /// The colours of strands that are cut to a fraction of their length. `left` returns that fraction.
    #[must_use]
    pub fn shortened(&self, left: impl Fn(usize) -> f32) -> Self {
        let cut = |(strand, samples): (usize, &ColourSamples)| {
            let left = left(strand);
            if left >= 1.0 {
                return *samples;
            }
            std::array::from_fn(|k| {
                let [kept, red, green, blue] = colour_along(samples, Self::place(k) * left.max(0.0));
                StrandColour { kept, added: [red, green, blue] }
            })
        };
        if self.is_empty() {
            return Self::default();
        }
        Self::new(self.strands.iter().enumerate().map(cut).collect())
    }

    /// The place along a strand of a sample: 0 is the root, 1 the tip.
    pub fn place(sample: usize) -> f32 {
        sample as f32 / (COLOUR_SAMPLES - 1) as f32
    }
}

/// The colour at the fraction `along` of a strand.
///
/// Twin of `color_at` in `strand_points.wgsl`.
#[inline(always)]
pub fn colour_along(samples: &ColourSamples, along: f32) -> [f32; 4] {
    let at = along * (COLOUR_SAMPLES - 1) as f32;
    let first = (at as usize).min(COLOUR_SAMPLES - 2);
    let t = at - first as f32;
    let (a, b) = (samples[first], samples[first + 1]);
    let mix = |a: f32, b: f32| a + (b - a) * t;
    [
        mix(a.kept, b.kept),
        mix(a.added[0], b.added[0]),
        mix(a.added[1], b.added[1]),
        mix(a.added[2], b.added[2]),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_of_a_colour_are_those_of_its_pigment() {
        let below = Vec3::new(0.6, 1.0, 2.0);
        let dye = Vec3::new(0.1, 0.8, 0.4);
        let half = StrandColour::BELOW.toward(dye, 0.5);
        assert!(half.absorption(below).abs_diff_eq(0.5 * below + 0.5 * dye, 1e-6));
        assert_eq!(StrandColour::BELOW.toward(dye, 1.0).absorption(below), dye);
        assert_eq!(StrandColour::BELOW.toward(dye, 0.0), StrandColour::BELOW);
        assert_eq!(StrandColour::BELOW.absorption(below), below);
        let light = half.faded(0.25);
        assert!(light.absorption(below).abs_diff_eq(0.25 * half.absorption(below), 1e-6));
        // A full change does not depend on those before it.
        assert_eq!(light.toward(below, 1.0).absorption(dye), below);
    }

    #[test]
    fn colours_are_linear_between_samples() {
        let of = |k: usize| StrandColour { kept: 1.0, added: [(k * k) as f32, 0.0, 2.0] };
        let samples: ColourSamples = std::array::from_fn(of);
        for k in 0..COLOUR_SAMPLES {
            assert_eq!(colour_along(&samples, StrandColours::place(k)), of(k).to_array());
        }
        let between = colour_along(&samples, 2.5 / (COLOUR_SAMPLES - 1) as f32);
        assert!((between[1] - 6.5).abs() < 1e-4 && between[3] == 2.0, "{between:?}");
    }

    #[test]
    fn a_cut_takes_the_colours_of_the_tips_away() {
        let samples: ColourSamples =
            std::array::from_fn(|k| StrandColour { kept: StrandColours::place(k), added: [0.0; 3] });
        let colours = StrandColours::new(vec![samples; 2]);
        let cut = colours.shortened(|strand| [0.5, 1.0][strand]);
        for k in 0..COLOUR_SAMPLES {
            assert!((cut.strands()[0][k].kept - 0.5 * StrandColours::place(k)).abs() < 1e-6);
        }
        assert_eq!(cut.strands()[1], samples);
    }

    #[test]
    fn means_are_over_strands_and_at_their_roots() {
        let dark = [StrandColour { kept: 0.0, added: [4.0; 3] }; COLOUR_SAMPLES];
        let mut light_tip = [StrandColour::BELOW; COLOUR_SAMPLES];
        light_tip[COLOUR_SAMPLES - 1] = StrandColour::BELOW.faded(0.0);
        let colours = StrandColours::new(vec![dark, light_tip]);
        assert_eq!(colours.roots(), StrandColour { kept: 0.5, added: [2.0; 3] });
        assert_eq!(colours.mean().kept, 7.0 / 16.0);
        assert_eq!(colours.selected([0, 0].into_iter()).mean(), dark[0]);
        assert_eq!(StrandColours::default().mean(), StrandColour::BELOW);
        assert!(StrandColours::default().selected([7].into_iter()).is_empty());
    }
}
