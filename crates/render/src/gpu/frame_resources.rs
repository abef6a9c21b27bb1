//! The bindings that all kernels of the picture share: twin of frame.wgsl.

use lovelock_gpu::wgpu;

/// The uniform of the frame, the depth maps of the body, the transmittance behind the hair, and its sampler.
#[derive(Clone, Copy, Debug)]
pub(super) struct FrameResources<'a> {
    pub uniform: &'a wgpu::Buffer,
    pub body_depth: &'a wgpu::TextureView,
    pub columns: &'a wgpu::TextureView,
    pub linear: &'a wgpu::Sampler,
    pub compare: &'a wgpu::Sampler,
    /// The grid of light from all directions.
    pub ambient: &'a wgpu::TextureView,
}

impl<'a> FrameResources<'a> {
    /// These bindings and those of a kernel, which are 4 to 14.
    pub fn with<const N: usize>(
        &self,
        own: [(u32, wgpu::BindingResource<'a>); N],
    ) -> Vec<(u32, wgpu::BindingResource<'a>)> {
        let frame = [
            (0, self.uniform.as_entire_binding()),
            (1, wgpu::BindingResource::TextureView(self.body_depth)),
            (2, wgpu::BindingResource::TextureView(self.columns)),
            (3, wgpu::BindingResource::Sampler(self.linear)),
            (15, wgpu::BindingResource::Sampler(self.compare)),
            (22, wgpu::BindingResource::TextureView(self.ambient)),
        ];
        frame.into_iter().chain(own).collect()
    }
}
