//! The GPU backend: wgpu compute and raster passes.

mod carried;
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
mod surface_textures;
mod targets;

use lovelock_gpu::ShaderSource;

pub use renderer::{Finished, GpuRenderer, MAX_IN_FLIGHT, PendingPicture};
pub use shrink::Shrinker;

/// Every composed shader with its label, so that a test can validate them without a device.
pub fn all_shaders() -> Vec<(String, ShaderSource)> {
    let own = pipelines::own_shaders().into_iter().map(|(label, source)| (label.to_owned(), source));
    let single = [
        ("shrink".to_owned(), pipelines::shrink_source()),
        ("skin shadow".to_owned(), pipelines::skin_shadow_source()),
    ];
    let hair = interpolate::shaders().into_iter().chain(fine::shaders()).chain(clusters::shaders());
    own.chain(single).chain(surface_textures::shaders()).chain(eye::shaders()).chain(hair).collect()
}
