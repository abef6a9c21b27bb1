//! The shaders of curves of transmittance.

use lovelock_gpu::ShaderPart;

use super::list::LIST_BODY;
use crate::gpu::wgsl;

const CURVE: ShaderPart = wgsl!("methods/texels/gpu/", "curve.wgsl");
const STEPS: ShaderPart = wgsl!("methods/texels/gpu/", "curve_steps.wgsl");
const LOOK_UP: ShaderPart = wgsl!("methods/texels/gpu/", "curve_query.wgsl");

/// The parts of a pass that makes curves, before its own.
pub(crate) const MAKE: [ShaderPart; 3] = [LIST_BODY, CURVE, STEPS];
/// The query of the methods with curves.
pub(crate) const QUERY: [ShaderPart; 2] = [CURVE, LOOK_UP];
