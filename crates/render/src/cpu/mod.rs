//! The CPU backend: renders the whole picture without a graphics driver.
//!
//! It computes what the shaders of the GPU backend compute, in loops over fixed-size arrays that the compiler vectorises. The picture
//! is divided into tiles, and one thread renders each tile: the visible samples of the body, then the hair in front of them from near
//! to far, then the shading of what is still visible behind it, then tone mapping. Tiles are independent and every sum has a fixed
//! order, so the bytes are the same for any number of threads and any vector width.
#![allow(
    clippy::needless_range_loop,
    clippy::needless_bitwise_bool,
    reason = "loops over lanes by index and tests without branches vectorise"
)]
#![allow(
    clippy::approx_constant,
    clippy::excessive_precision,
    reason = "constants equal those of the shaders and of fitted polynomials, digit for digit"
)]

mod backdrop;
mod bins;
mod body_depth;
mod carried;
mod clusters;
mod drawn;
mod false_colors;
mod finish;
mod hair;
mod interrupt;
mod kept;
mod layers;
mod math;
mod placed;
mod pool;
mod renderer;
mod shadow;
mod standing;
mod strand_points;
mod surface;
mod tile;
mod tone_map;
mod transparency;
mod values;
mod view;
mod visible;

pub use drawn::DrawnHair;
pub use interrupt::Interrupt;
pub(crate) use layers::{show_row, show_row_over};
pub use renderer::CpuRenderer;
pub(crate) use tone_map::encode;
pub use values::{HairHit, ValuePicture, ValueRenderer};
