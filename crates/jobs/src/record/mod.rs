//! Recording without a window.

mod burn_in;
mod curves;
mod drawer;
mod fingerprint;
mod job;
mod options;
mod pictures;
mod report;
mod request;
mod sound;
mod take;

pub use curves::{CurveRecordReport, CurveSource, is_curves, record_curves};
pub use job::{Recorded, record_in_background};
pub use pictures::record;
pub use report::{RecordReport, StageMedians};
pub use request::RecordRequest;
pub use take::{TakeRecordReport, is_take, record_take};

#[cfg(test)]
mod curve_tests;
#[cfg(test)]
mod layered_tests;
#[cfg(test)]
mod take_tests;
#[cfg(test)]
mod tests;
