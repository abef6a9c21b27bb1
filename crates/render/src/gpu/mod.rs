//! The GPU backend: wgpu compute and raster passes.

mod eye;
mod frame_resources;
mod ground;
mod hair;
mod interpolate;
mod layers;
mod light_kernels;
mod pipelines;
mod renderer;
mod screen;
mod shadow;
mod surface;
mod targets;

pub use pipelines::all_shaders;
pub use renderer::GpuRenderer;
