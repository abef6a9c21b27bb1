//! Adaptive volumetric shadow maps on the GPU: see [`GpuCurveMethod`].

use lovelock_gpu::ShaderPart;

use super::cpu::AdaptiveNodes;
use crate::gpu::wgsl;
use crate::methods::curves::GpuCurveMethod;

impl GpuCurveMethod for AdaptiveNodes {
    const COMPRESS: ShaderPart = wgsl!("methods/adaptive/gpu/", "compress.wgsl");
}
