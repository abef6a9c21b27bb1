//! The CPU backend: the whole picture on the processor, without a graphics driver.
//!
//! What the shaders of the GPU backend say is said here once more, in loops over fixed-size arrays that the
//! compiler turns into vector instructions. The picture is cut into tiles, and each tile is drawn whole by one
//! thread: the body's visible samples, then the hair before them from near to far, then the light of what is
//! still seen behind it, then tone mapping. No tile's result depends on another's, and every sum is taken in a
//! fixed order: the same bytes for any number of threads and any width of vectors.
#![allow(
    clippy::needless_range_loop,
    clippy::needless_bitwise_bool,
    reason = "loops over lanes by index and tests without branches are what becomes vectors"
)]
#![allow(
    clippy::approx_constant,
    clippy::excessive_precision,
    reason = "constants are those of the shaders and of fitted polynomials, digit for digit"
)]

mod backdrop;
mod bins;
mod body_depth;
mod finish;
mod hair;
mod layers;
mod math;
mod placed;
mod points;
mod pool;
mod renderer;
mod surface;
mod tile;
mod tone;
mod transparency;
mod values;
mod view;

pub(crate) use layers::show_row;
pub use renderer::CpuRenderer;
pub use values::{HairHit, ValuePicture, ValueRenderer};
