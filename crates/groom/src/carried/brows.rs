//! Brows and lashes.

use glam::Vec3;

use super::{Course, RootPlace, SkinGroom};
use crate::StrandColour;

/// Brows. A brow has about 250 hairs of 6 to 9 mm.
pub const BROWS: SkinGroom = SkinGroom {
    name: "brows",
    mask: "_BROW",
    roots: RootPlace::Triangles,
    strands: 500.0,
    length: [0.0055, 0.009],
    // Wider than a hair: fine down between them is left out.
    width: 140e-6,
    tip: 0.25,
    course: Course::Temple { lift: 0.3 },
    // The look of brows says all of their colour.
    colour: StrandColour::BELOW,
};

/// Lashes of the upper lids: about 90 a lid, of 8 to 10 mm, which curve up.
pub const UPPER_LASHES: SkinGroom = SkinGroom {
    name: "upper lashes",
    mask: "_LASH_UPPER",
    roots: RootPlace::Rim(Vec3::new(0.0, -1.0, 1.0)),
    strands: 180.0,
    length: [0.0055, 0.010],
    width: 230e-6,
    tip: 0.15,
    course: Course::Forward { elevation: [-0.15, 1.0], spread: 0.7 },
    colour: NEARLY_BLACK,
};

/// Lashes of the lower lids: fewer, shorter and thinner.
pub const LOWER_LASHES: SkinGroom = SkinGroom {
    name: "lower lashes",
    mask: "_LASH_LOWER",
    roots: RootPlace::Rim(Vec3::new(0.0, 1.0, 1.0)),
    strands: 100.0,
    length: [0.004, 0.006],
    width: 130e-6,
    tip: 0.15,
    course: Course::Forward { elevation: [-0.7, -0.2], spread: 0.7 },
    colour: NEARLY_BLACK,
};

/// The pigment of nearly black hair, whatever the look is: eumelanin of the concentration 6.
const NEARLY_BLACK: StrandColour = StrandColour { kept: 0.0, added: [2.5, 4.2, 8.2] };
