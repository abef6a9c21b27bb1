//! A recording on a background thread, for the window.

use std::path::PathBuf;
use std::sync::Arc;

use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_session::job::BackgroundJob;
use lovelock_session::worker::Wake;

use super::curves::{is_curves, record_curves};
use super::pictures::record;
use super::request::RecordRequest;

/// The result of [`record_in_background`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recorded {
    /// The film, the folder or the file of curves.
    pub out: PathBuf,
    /// Number of frames.
    pub frames: u64,
    /// Number of frames kept from an earlier recording.
    pub frames_kept: u64,
}

/// Starts recording images, or curves if the output name has such an extension. `wake` is called for every progress report and at the
/// end. The job ends as [`record`] and [`record_curves`].
///
/// # Errors
/// If the system cannot create a thread.
pub fn record_in_background(
    project: Arc<Project>,
    request: RecordRequest,
    wake: Wake,
) -> Result<BackgroundJob<Recorded>, ProjectError> {
    BackgroundJob::start("recording", wake, move |progress| {
        let (frames, frames_kept) = if is_curves(&request.out) {
            (record_curves(&project, &request, progress)?.frames, 0)
        } else {
            let report = record(&project, &request, progress)?;
            (report.frames, report.frames_kept)
        };
        Ok(Recorded { out: request.out.clone(), frames, frames_kept })
    })
}
