//! Hairstyles: scalp, wisps, guides, strands; growing, styling, interpolation and hair files.
//!
//! A [`Hairstyle`] is immutable and shared by `Arc`. Its coordinates are in *head space*: metres, the axes of the
//! world in the body's rest pose (right-handed, Y up, the face toward +Z), the origin at the head joint.
//! The simulator moves its [`Guides`] to a [`GuideFrame`] in world space, from which [`interpolate()`] makes the
//! [`Strands`] that are shadowed and drawn.

pub mod carried;
mod colours;
pub mod fine;
mod frame;
mod grow;
mod guides;
mod haircut;
mod hairstyle;
mod import;
mod interpolate;
mod io;
mod look;
mod motion_factors;
mod obstacle;
mod pigment;
mod plain_head;
pub mod polyline;
mod presets;
mod scaled;
mod scalp;
mod scalp_index;
mod settings;
mod strand_bounds;
mod strand_colours;
mod strand_marks;
mod strands;
mod ties;

pub use colours::{HAIR_COLOURS, HairColour};
pub use frame::{WispCurve, reference_normal, transport, widest_radii};
pub use grow::{GUIDE_POINTS, GrowError, grow};
pub use guides::{GuideFrame, Guides};
pub use haircut::{Blade, Haircut, trimmed};
pub use hairstyle::{Hairstyle, HairstyleError, Rope, StrandSet, Wisp};
pub use import::{
    HairInfo, ImportError, ImportSettings, ImportedInPlace, PlacedGroom, Placement, hair_info, hair_look,
    import, import_around, import_in_place, import_noted, place,
};
pub use interpolate::{FollowingStrands, interpolate};
pub use io::{
    Bounds, CurveCache, CurveMotion, Facing, GltfContent, HAIR_FORMATS, HairFile, HairFileError, HairFormat,
    METRES_Y_UP, SURE, Unit, UnitGuess, UpAxis, gltf_content, guess_units, load_hair, load_hair_bytes,
    load_hair_watched,
};
pub use look::{HairLook, HairShading};
pub use motion_factors::MotionFactors;
pub use obstacle::{Bounded, NoObstacle, Obstacle};
pub use pigment::{PAINTED_FROM, PigmentVariation, UNPIGMENTED, WHITENING};
pub use plain_head::PlainHead;
pub use presets::Preset;
pub use scalp::{Scalp, ScalpError, ScalpPoint};
pub use scalp_index::ScalpIndex;
pub use settings::{GroomSettings, MAX_POINTS};
pub use strand_bounds::StrandBounds;
pub use strand_colours::{COLOUR_SAMPLES, ColourSamples, StrandColour, StrandColours, colour_along};
pub use strand_marks::StrandMarks;
pub use strands::Strands;
pub use ties::{HairTie, TieKind, TieReach, tied, tied_where};
