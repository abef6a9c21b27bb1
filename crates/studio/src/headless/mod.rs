//! Recording without a window.

mod job;
mod new_folders;
mod record;
mod report;
mod request;

pub use job::RecordJob;
pub use record::record;
pub use report::{RecordReport, StageMedians};
pub use request::{Progress, RecordRequest};

#[cfg(test)]
mod tests;
