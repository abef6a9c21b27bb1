//! Metrics of images and transmittances: FLIP, PSNR and SSIM of images, errors of transmittance, stability over time,
//! banding, spreads of times, and false colour with a legend.
//!
//! Every result is a pure function of its arguments. No function panics for any input: values that cannot be compared
//! give an error or `None`, or are counted as left out.

mod banding;
mod blur;
mod color_map;
mod errors;
mod figure;
mod flip;
mod image;
mod pareto;
mod psnr;
mod spread;
mod ssim;
mod stability;
mod ticks;

pub use banding::{Banding, banding};
pub use color_map::{ColorMap, paint};
pub use errors::{Errors, errors, errors_of};
pub use figure::{Canvas, Legend};
pub use flip::{FlipMap, flip};
pub use image::{Image, ImageError};
pub use pareto::pareto;
pub use psnr::psnr_db;
pub use spread::Spread;
pub use ssim::ssim;
pub use stability::{Stability, excess, flicker, pop, swim};
pub use ticks::{Ticks, ticks};
