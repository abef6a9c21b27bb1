//! One picture: strands, shading, transparency, body, ground and tone mapping.
//!
//! A [`FrameInput`] is everything that a picture shows at one instant; a [`Renderer`] makes a [`Picture`] of it.
//! Shadow methods run here, between the strands and their shading.

mod camera;
mod error;
mod frame;
mod gpu;
mod light;
mod picture;
mod transparency;

pub use camera::Camera;
pub use error::RenderError;
pub use frame::{FrameInput, FrameStats};
pub use gpu::{Renderer, all_shaders};
pub use light::{Light, MAX_LIGHTS};
pub use lovelock_gpu::{Gpu, GpuError, Stopwatch, check_shader};
pub use lovelock_shadow::voxel_map::{MapExtent, VoxelDeposit, VoxelFilter, VoxelMapSettings};
pub use lovelock_shadow::{ShadowMethod, ShadowSettings};
pub use picture::{Picture, PictureSettings};
pub use transparency::Transparency;
