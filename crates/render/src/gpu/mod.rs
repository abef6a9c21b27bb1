//! The GPU backend: wgpu compute and raster passes.

mod hair;
mod pipelines;
mod renderer;
mod surface;
mod targets;

pub use pipelines::all_shaders;
pub use renderer::GpuRenderer;
