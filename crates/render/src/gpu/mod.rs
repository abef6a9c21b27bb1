//! The GPU backend: wgpu compute and raster passes.

mod clusters;
mod eye;
mod false_colors;
mod fine;
mod frame_resources;
mod ground;
mod hair;
mod interpolate;
mod layers;
mod light_buffers;
mod light_kernels;
mod pipelines;
mod present;
mod renderer;
mod screen;
mod shadow;
mod shrink;
mod skin_shadow;
mod surface;
mod targets;

pub use pipelines::all_shaders;
pub use renderer::{Finished, GpuRenderer, MAX_IN_FLIGHT, PendingPicture};
pub use shrink::Shrinker;
