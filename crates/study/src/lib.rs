//! Shadow methods compared without a window, and the report about them.
//!
//! - [`batch`]: renders every method that is to be compared, and measures it.
//! - [`report`] and [`changes`]: the results, in the layout of `report.json`.
//!
//! The module `html` writes the report as one page.

pub mod batch;
pub mod changes;
mod html;
pub mod report;
