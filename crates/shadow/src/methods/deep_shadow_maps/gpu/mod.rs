//! Deep shadow maps on the GPU: see [`GpuCurveMethod`].

use lovelock_gpu::ShaderPart;

use super::cpu::DeepNodes;
use crate::gpu::wgsl;
use crate::methods::curves::GpuCurveMethod;

impl GpuCurveMethod for DeepNodes {
    const COMPRESS: ShaderPart = wgsl!("methods/deep_shadow_maps/gpu/", "compress.wgsl");

    fn tolerance(&self) -> f32 {
        self.0.tolerance
    }
}
