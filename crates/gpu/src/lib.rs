//! The wgpu device, shader composition, typed buffers, readback and timers.

mod buffer;
mod device;
mod readback;
mod shader;
mod timer;

pub use buffer::GrowBuffer;
pub use device::{Gpu, GpuError};
pub use readback::read_texture_rgba8;
pub use shader::{ShaderPart, ShaderSource, check_shader};
pub use timer::Stopwatch;
pub use wgpu;
