//! Recording without a window.

mod burn_in;
mod dance;
mod drawer;
mod fingerprint;
mod job;
mod new_folders;
mod options;
mod prepare;
mod record;
mod record_curves;
mod record_take;
mod report;
mod request;
mod seam;

pub(crate) use dance::Dance;
pub(crate) use new_folders::NewFolders;
pub(crate) use prepare::{check_frames, open_renderer, tell};

pub use job::{RecordJob, Recorded};
pub use record::record;
pub use record_curves::{CurveRecordReport, CurveSource, is_curves, record_curves};
pub use record_take::{TakeRecordReport, is_take, record_take};
pub use report::{RecordReport, StageMedians};
pub use request::{Progress, RecordRequest};

#[cfg(test)]
mod layered_tests;
#[cfg(test)]
mod tests;
