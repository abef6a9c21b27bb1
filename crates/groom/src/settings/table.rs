//! The table of [`GroomSettings`].

use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings, Unit};

use super::{GroomSettings, MAX_POINTS};

impl Settings for GroomSettings {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::count(
            field!(Self, wisps),
            [8, 1000],
            "Wisps",
            "Number of wisps, groups of strands that move together. Each is simulated as three guide \
             strands.",
        )
        .logarithmic(),
        Setting::count(
            field!(Self, strands_per_wisp),
            [1, 1000],
            "Strands per wisp",
            "Number of strands drawn per wisp. Higher values look finer and take longer.",
        )
        .soft([1.0, 400.0])
        .logarithmic(),
        Setting::count(
            field!(Self, segments_per_strand),
            [2, 200],
            "Segments per strand",
            "Number of segments per strand. Curls need more than straight hair.",
        )
        .logarithmic(),
        Setting::count(
            field!(Self, seed),
            [0, u32::MAX as u64],
            "Seed",
            "Seed of the random numbers of the hairstyle.",
        )
        .soft([0.0, 999.0]),
        Setting::number(field!(Self, length), [0.02, 1.0], "Length", "Length of the longest hair.")
            .unit(Unit::METRES_AS_CM)
            .soft([0.02, 0.7]),
        Setting::number(
            field!(Self, layering),
            [0.0, 1.0],
            "Layers",
            "How much shorter the top layers are than the lowest. 0 % cuts all tips at one height.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, length_variation),
            [0.0, 0.5],
            "Length variation",
            "How much shorter than its wisp a strand may end.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, face_framing),
            [0.0, 1.0],
            "Face framing",
            "How much shorter the hair beside the face is.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, fringe),
            [0.0, 1.0],
            "Fringe",
            "How much of the front hair falls over the forehead.",
        )
        .unit(Unit::FRACTION),
        Setting::number(field!(Self, fringe_length), [0.02, 0.3], "Fringe length", "Length of the fringe.")
            .unit(Unit::METRES_AS_CM),
        Setting::number(
            field!(Self, hairline),
            [0.05, 0.95],
            "Hairline",
            "How far back on the forehead hair begins.",
        ),
        Setting::number(
            field!(Self, part_position),
            [-0.06, 0.06],
            "Parting position",
            "Where the parting meets the forehead: 0 is the middle, positive values are on the \
             wearer's left.",
        )
        .unit(Unit::METRES_AS_CM),
        Setting::number(
            field!(Self, part_strength),
            [0.0, 1.0],
            "Parting strength",
            "How cleanly the hair is parted. 0 % combs it back without a parting.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, sweep),
            [-1.0, 1.0],
            "Sweep",
            "How far the front hair is combed back (positive) or toward the face (negative).",
        ),
        Setting::number(field!(Self, volume), [0.0, 0.06], "Volume", "Thickness of the hair over the skull.")
            .unit(Unit::METRES_AS_CM),
        Setting::number(
            field!(Self, crown_volume),
            [0.0, 0.05],
            "Crown volume",
            "Additional height of the hair at the crown.",
        )
        .unit(Unit::METRES_AS_CM),
        Setting::number(
            field!(Self, root_lift),
            [0.1, 1.4],
            "Root lift",
            "Angle at which hair leaves the scalp.",
        )
        .unit(Unit::RADIANS),
        Setting::number(
            field!(Self, hold),
            [0.01, 0.5],
            "Root stand",
            "Distance from the root over which hair bends down under its weight. Low values suit \
             heavy hair.",
        )
        .unit(Unit::METRES_AS_CM),
        Setting::number(
            field!(Self, ends),
            [-1.0, 1.0],
            "Ends",
            "Bends the ends under (positive) or out (negative).",
        ),
        Setting::number(
            field!(Self, clump),
            [0.0, 0.95],
            "Clumping",
            "How much a wisp narrows toward its tip. High values look wet or styled, low values \
             brushed.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, locks),
            [0.0, 1.0],
            "Locks",
            "How strongly strands gather in smaller locks within a wisp.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, frizz),
            [0.0, 0.02],
            "Frizz",
            "Size of the small irregular bends of each strand.",
        )
        .unit(Unit::METRES_AS_MM),
        Setting::number(
            field!(Self, frizz_scale),
            [0.005, 0.2],
            "Frizz length",
            "Length of the small irregular bends.",
        )
        .unit(Unit::METRES_AS_MM)
        .logarithmic(),
        Setting::number(
            field!(Self, strays),
            [0.0, 0.5],
            "Strays",
            "Fraction of strands that leave their wisp.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, stray_reach),
            [0.0, 0.06],
            "Stray distance",
            "How far a stray strand is from its wisp at the tip.",
        )
        .unit(Unit::METRES_AS_MM),
        Setting::number(
            field!(Self, curl_radius),
            [0.0, 0.02],
            "Curl radius",
            "Radius of the curls. 0 is straight hair.",
        )
        .unit(Unit::METRES_AS_MM),
        Setting::number(
            field!(Self, curl_pitch),
            [0.006, 0.3],
            "Curl pitch",
            "Length of one turn of a curl: coils are below 10 mm, curls 10 to 25 mm, waves 20 to 60 \
             mm.",
        )
        .unit(Unit::METRES_AS_MM)
        .logarithmic(),
        Setting::number(
            field!(Self, curl_onset),
            [0.0, 0.4],
            "Curl onset",
            "Distance from the root over which curls grow to their full radius.",
        )
        .unit(Unit::METRES_AS_CM),
        Setting::number(
            field!(Self, curl_wander),
            [0.0, 1.0],
            "Curl variation",
            "How much curls and waves vary along a strand and between strands.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, wave),
            [0.0, 0.03],
            "Wave height",
            "Height of the waves that swing whole wisps sideways.",
        )
        .unit(Unit::METRES_AS_MM),
        Setting::number(field!(Self, wave_length), [0.02, 0.4], "Wave length", "Length of one wave.")
            .unit(Unit::METRES_AS_CM),
        Setting::number(
            field!(Self, taper),
            [0.0, 1.0],
            "Taper",
            "Fraction of each strand over which it thins to its tip.",
        )
        .unit(Unit::FRACTION),
    ];

    /// Limits the strands to [`MAX_POINTS`] points in all.
    fn reconcile(&mut self) {
        let most = MAX_POINTS / (self.wisps * (self.segments_per_strand + 1));
        self.strands_per_wisp = self.strands_per_wisp.min(most);
        self.look = self.look.clamped();
    }
}
