//! Hair files: Cem Yuksel's `.hair` and that of `MonoHair`, AMD's TressFX `.tfx`, curves of USD and Alembic, lines of glTF and OBJ, curves of
//! pbrt, strands in PLY and in arrays of `NumPy`, USC-HairSalon's `.data` and `CT2Hair`'s `.bin`.
//!
//! A [`HairFile`] contains the strands of a file, in the file's own unit and axes, without those that cannot be drawn
//! (see [`HairFile::dropped`]). [`guess_units`] estimates its size and orientation, and [`crate::import`] makes a
//! hairstyle of it. Each format is a [`HairFormat`] in the table [`HAIR_FORMATS`].

mod alembic;
mod basis;
mod bytes;
mod cache;
mod chain;
mod clean;
mod error;
mod file;
mod format;
mod frames;
mod gltf;
mod guess;
mod headless;
mod hidden;
mod marks;
mod numpy;
mod obj;
mod partial;
mod pbrt;
mod ply;
mod registry;
mod root_shape;
mod source;
mod strand_axes;
mod tressfx;
mod units;
mod usc;
mod usd;
mod words;
mod yuksel;

pub use alembic::METRES_Y_UP;
pub use cache::{CurveCache, CurveMotion};
pub use error::HairFileError;
pub use file::{Bounds, HairFile};
pub use format::HairFormat;
pub use gltf::{GltfContent, gltf_content};
pub(crate) use guess::guess_facing;
pub use guess::{SURE, UnitGuess, guess_units};
pub use registry::{HAIR_FORMATS, load_hair, load_hair_bytes, load_hair_watched};
pub(crate) use root_shape::{RootShape, fit_sphere};
pub(crate) use units::rotation_to_head_axes;
pub use units::{Facing, Unit, UpAxis};
