//! Everything that a stylist sets: the controls of growing.

use lovelock_base::numbers::within;
use serde::{Deserialize, Serialize};

use crate::HairLook;

/// The most points that [`GroomSettings::clamped`] lets a hairstyle have: about 300 MB with all that draws it.
pub const MOST_POINTS: u32 = 6_000_000;

/// How a hairstyle grows. Each field's comment ends in its unit and safe range; [`GroomSettings::clamped`] brings any
/// value into it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct GroomSettings {
    /// Chooses among hairstyles that differ only by chance. Any.
    pub seed: u32,
    /// Number of wisps, the locks that move together. 8 to 1000.
    pub wisps: u32,
    /// Strands that each wisp carries. 1 to 1000.
    pub strands_per_wisp: u32,
    /// Segments of each strand; curls need more than straight hair. 2 to 200.
    pub segments_per_strand: u32,

    /// Length of the longest hair, which grows along the parting and at the crown. Metres, 0.02 to 1.
    pub length: f32,
    /// 0 cuts every tip at one height; 1 cuts the top layers much shorter than the lowest. 0 to 1.
    pub layering: f32,
    /// How much shorter than its wisp a strand may end. Fraction, 0 to 0.5.
    pub length_variation: f32,
    /// How much shorter the hair beside the face is, so that it frames it. 0 to 1.
    pub face_framing: f32,
    /// How much of the front hair is cut and combed as a fringe over the forehead. 0 to 1.
    pub fringe: f32,
    /// Length of the fringe. Metres, 0.02 to 0.3.
    pub fringe_length: f32,
    /// Where hair begins on the scalp's mask: lower values widen the hair, higher ones uncover the forehead.
    /// 0.05 to 0.95.
    pub hairline: f32,

    /// Where the parting meets the forehead: 0 in the middle, positive on the wearer's left. Metres, -0.06 to 0.06.
    pub part_position: f32,
    /// 0 combs the hair back with no parting; 1 parts it cleanly. 0 to 1.
    pub part_strength: f32,
    /// How far the front hair is combed back (positive) or toward the face (negative). -1 to 1.
    pub sweep: f32,

    /// Thickness of the body of hair over the skull. Metres, 0 to 0.06.
    pub volume: f32,
    /// Height that the hair gains at the crown. Metres, 0 to 0.05.
    pub crown_volume: f32,
    /// Angle between the scalp and a hair that leaves it. Radians, 0.1 to 1.4.
    pub root_lift: f32,
    /// Distance after which hair gives in to gravity: small for heavy hair, large for hair that stands.
    /// Metres, 0.01 to 0.5.
    pub hold: f32,
    /// Bends the ends under (positive) or out (negative). -1 to 1.
    pub ends: f32,

    /// How much a wisp narrows toward its tip. 0 to 0.95.
    pub clump: f32,
    /// How much the strands of a wisp gather in smaller locks. 0 to 1.
    pub locks: f32,
    /// Size of the small irregular bends of each strand. Metres, 0 to 0.02.
    pub frizz: f32,
    /// Length of those bends. Metres, 0.005 to 0.2.
    pub frizz_scale: f32,
    /// Share of strands that leave their wisp. Fraction, 0 to 0.5.
    pub strays: f32,
    /// How far strays leave their wisp at the tip. Metres, 0 to 0.06.
    pub stray_reach: f32,

    /// Radius of the curls' helix; 0 for hair without curls. Metres, 0 to 0.02.
    pub curl_radius: f32,
    /// Length of one turn of a curl along the wisp. Metres, 0.006 to 0.3.
    pub curl_pitch: f32,
    /// Distance from the root over which curls reach their full radius. Metres, 0 to 0.4.
    pub curl_onset: f32,
    /// How much radius, pitch and phase of curls and waves wander. 0 to 1.
    pub curl_wander: f32,
    /// Height of the waves that swing whole wisps to the sides; 0 for none. Metres, 0 to 0.03.
    pub wave: f32,
    /// Length of one wave. Metres, 0.02 to 0.4.
    pub wave_length: f32,

    /// Share of each strand over which it thins to its tip. Fraction, 0 to 1.
    pub taper: f32,

    /// Colour and width that the style suggests.
    pub look: HairLook,
}

impl GroomSettings {
    /// The settings with every number inside its safe range; what is not a number takes the value of
    /// [`GroomSettings::default`].
    ///
    /// Strands are limited to [`MOST_POINTS`] points in all.
    pub fn clamped(&self) -> Self {
        let d = Self::default();
        let wisps = self.wisps.clamp(8, 1000);
        let segments_per_strand = self.segments_per_strand.clamp(2, 200);
        let most = MOST_POINTS / (wisps * (segments_per_strand + 1));
        Self {
            seed: self.seed,
            wisps,
            strands_per_wisp: self.strands_per_wisp.clamp(1, most.min(1000)),
            segments_per_strand,
            length: within(self.length, 0.02, 1.0, d.length),
            layering: within(self.layering, 0.0, 1.0, d.layering),
            length_variation: within(self.length_variation, 0.0, 0.5, d.length_variation),
            face_framing: within(self.face_framing, 0.0, 1.0, d.face_framing),
            fringe: within(self.fringe, 0.0, 1.0, d.fringe),
            fringe_length: within(self.fringe_length, 0.02, 0.3, d.fringe_length),
            hairline: within(self.hairline, 0.05, 0.95, d.hairline),
            part_position: within(self.part_position, -0.06, 0.06, d.part_position),
            part_strength: within(self.part_strength, 0.0, 1.0, d.part_strength),
            sweep: within(self.sweep, -1.0, 1.0, d.sweep),
            volume: within(self.volume, 0.0, 0.06, d.volume),
            crown_volume: within(self.crown_volume, 0.0, 0.05, d.crown_volume),
            root_lift: within(self.root_lift, 0.1, 1.4, d.root_lift),
            hold: within(self.hold, 0.01, 0.5, d.hold),
            ends: within(self.ends, -1.0, 1.0, d.ends),
            clump: within(self.clump, 0.0, 0.95, d.clump),
            locks: within(self.locks, 0.0, 1.0, d.locks),
            frizz: within(self.frizz, 0.0, 0.02, d.frizz),
            frizz_scale: within(self.frizz_scale, 0.005, 0.2, d.frizz_scale),
            strays: within(self.strays, 0.0, 0.5, d.strays),
            stray_reach: within(self.stray_reach, 0.0, 0.06, d.stray_reach),
            curl_radius: within(self.curl_radius, 0.0, 0.02, d.curl_radius),
            curl_pitch: within(self.curl_pitch, 0.006, 0.3, d.curl_pitch),
            curl_onset: within(self.curl_onset, 0.0, 0.4, d.curl_onset),
            curl_wander: within(self.curl_wander, 0.0, 1.0, d.curl_wander),
            wave: within(self.wave, 0.0, 0.03, d.wave),
            wave_length: within(self.wave_length, 0.02, 0.4, d.wave_length),
            taper: within(self.taper, 0.0, 1.0, d.taper),
            look: self.look.clamped(),
        }
    }

    /// Number of strands that these settings grow.
    pub fn strand_count(&self) -> usize {
        self.wisps as usize * self.strands_per_wisp as usize
    }

    /// Number of segments that these settings grow.
    pub fn segment_count(&self) -> usize {
        self.strand_count() * self.segments_per_strand as usize
    }
}
