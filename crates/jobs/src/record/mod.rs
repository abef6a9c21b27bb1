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

/// The folder in which the user keeps videos, otherwise the home folder. `None` for a user without a home.
pub fn videos_folder() -> Option<std::path::PathBuf> {
    dirs::video_dir().filter(|folder| folder.is_dir()).or_else(dirs::home_dir)
}

#[cfg(test)]
mod curve_tests;
#[cfg(test)]
mod layered_tests;
#[cfg(test)]
mod take_tests;
#[cfg(test)]
mod tests;
