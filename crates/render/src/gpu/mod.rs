//! The GPU backend: wgpu compute and raster passes.

mod hair;
mod pipelines;
mod renderer;
mod shadow_stage;
mod sort;
mod surface;
mod targets;
mod uniform;

pub use pipelines::all_shaders;
pub use renderer::Renderer;
