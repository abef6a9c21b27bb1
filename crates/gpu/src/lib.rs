//! The wgpu device, shader composition, typed buffers, readback and timers.

mod buffer;
mod commands;
mod compiled;
mod constants;
mod device;
mod kernel;
mod layout;
mod pool;
mod readback;
mod shader;
mod traffic;
mod translate;

pub use buffer::GrowBuffer;
pub use commands::{Commands, PassTime, PassTimer};
pub use device::{Gpu, GpuError};
pub use kernel::{Constant, Kernel, THREADS};
pub use layout::layout_in_shader;
pub use pool::{BufferPool, PooledBuffer};
pub use readback::{Readback, read_buffer, read_texture_rgba8};
pub use shader::{ShaderPart, ShaderSource, check_shader};
pub use traffic::Traffic;
pub use translate::check_translations;
pub use wgpu;
