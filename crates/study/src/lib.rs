//! Shadow methods compared without a window, and the report about them.
//!
//! - [`batch`]: renders every method that is to be compared, and measures it.
//! - [`report`] and [`changes`]: the results, in the layout of `report.json`.
//!
//! - [`page`]: what pages for local use are made of, for other reports.
//!
//! The module `html` writes the report as one page.

pub mod batch;
mod budget;
pub mod changes;
mod html;
pub mod report;

/// What pages for local use are made of: their frame, text and numbers, and plots.
pub mod page {
    pub use crate::html::document;
    pub use crate::html::plot::{Axis, Dot, Label, Plot, Stroke};
    pub use crate::html::words::{NOTHING, address, bytes, escaped, fixed, grouped, ms, signed, small};
}
