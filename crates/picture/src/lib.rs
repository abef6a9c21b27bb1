//! What an image is made with, beside what it shows: lights, and the settings of the image as a whole.
//!
//! Projects store these settings and the renderer reads them, so that a project needs no renderer.

mod backend;
mod background;
mod body_look;
mod hair_drawing;
mod light;
mod map_view;
mod rig;
mod settings;
mod size;
mod strand_count;
mod transparency;

pub use backend::{Backend, UnknownBackend};
pub use background::{BackgroundForm, PictureFit};
pub use body_look::BodyLook;
pub use hair_drawing::HairDrawing;
pub use light::{Light, LightKind, MAX_LIGHTS};
pub use map_view::{MapForm, MapValue, MapView};
pub use rig::LightRig;
pub use settings::PictureSettings;
pub use size::{MAX_PIXELS, MAX_SIDE, SizeError, check_size, check_size_for};
pub use strand_count::StrandCount;
pub use transparency::Transparency;
