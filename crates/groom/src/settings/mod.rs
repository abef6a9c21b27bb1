//! The settings from which a hairstyle grows.

mod table;

use serde::{Deserialize, Serialize};

use crate::HairLook;

/// The most points that clamped settings let a hairstyle have: about 300 MB with everything that draws it.
pub const MAX_POINTS: u32 = 6_000_000;

/// How a hairstyle grows. Ranges are in its table of settings.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct GroomSettings {
    /// Seed of the random numbers of the hairstyle.
    pub seed: u32,
    /// Number of wisps: groups of strands that move together.
    pub wisps: u32,
    /// Strands per wisp.
    pub strands_per_wisp: u32,
    /// Segments per strand.
    pub segments_per_strand: u32,

    /// Length of the longest hair, which grows along the parting and at the crown, metres.
    pub length: f32,
    /// 0 cuts every tip at one height; 1 cuts the top layers much shorter than the lowest.
    pub layering: f32,
    /// The largest fraction by which a strand may be shorter than its wisp.
    pub length_variation: f32,
    /// How much shorter the hair beside the face is.
    pub face_framing: f32,
    /// How much of the front hair is cut and combed over the forehead.
    pub fringe: f32,
    /// Length of the fringe, metres.
    pub fringe_length: f32,
    /// Threshold on the scalp's mask above which hair grows.
    pub hairline: f32,

    /// Where the parting meets the forehead: 0 in the middle, positive on the wearer's left, metres.
    pub part_position: f32,
    /// 0 combs the hair back without a parting; 1 parts it cleanly.
    pub part_strength: f32,
    /// How far the front hair is combed back (positive) or toward the face (negative).
    pub sweep: f32,

    /// Thickness of the hair over the skull, metres.
    pub volume: f32,
    /// Additional height at the crown, metres.
    pub crown_volume: f32,
    /// Angle between the scalp and the first segment of a strand, radians.
    pub root_lift: f32,
    /// Distance from the root over which hair bends down into the direction of gravity, metres.
    pub hold: f32,
    /// Bends the ends under (positive) or out (negative).
    pub ends: f32,

    /// How much a wisp narrows toward its tip.
    pub clump: f32,
    /// How strongly the strands of a wisp gather in smaller locks.
    pub locks: f32,
    /// Amplitude of the small irregular bends of each strand, metres.
    pub frizz: f32,
    /// Wavelength of those bends, metres.
    pub frizz_scale: f32,
    /// Fraction of strands that leave their wisp.
    pub strays: f32,
    /// Distance of a stray from its wisp at the tip, metres.
    pub stray_reach: f32,

    /// Radius of the helix of curls; 0 for hair without curls, metres.
    pub curl_radius: f32,
    /// Length of one turn of a curl along the wisp, metres.
    pub curl_pitch: f32,
    /// Distance from the root over which curls grow to their full radius, metres.
    pub curl_onset: f32,
    /// How much radius, pitch and phase of curls and waves vary.
    pub curl_wander: f32,
    /// Amplitude of the waves that swing whole wisps sideways; 0 for none, metres.
    pub wave: f32,
    /// Wavelength of those waves, metres.
    pub wave_length: f32,

    /// Fraction of each strand over which it thins to its tip.
    pub taper: f32,

    /// Colour and width that the style suggests.
    pub look: HairLook,
}

impl GroomSettings {
    /// Number of strands that these settings grow.
    pub fn strand_count(&self) -> usize {
        self.wisps as usize * self.strands_per_wisp as usize
    }

    /// Number of segments that these settings grow.
    pub fn segment_count(&self) -> usize {
        self.strand_count() * self.segments_per_strand as usize
    }
}
