//! Takes: the simulation recorded once, and played as often as wanted.
//!
//! [`TakeRecording`] writes what an [`Engine`](crate::Engine) does; [`TakePlayer`] makes [`FrameSnapshot`](crate::FrameSnapshot)s
//! of a take without simulating, so that whatever draws a simulation draws a take.

mod playing;
mod recording;
mod transport;

pub use playing::TakePlayer;
pub use recording::{TakeProgress, TakeRecording};
pub(crate) use transport::TakeTransport;

use std::path::Path;

use lovelock_record::{TakeError, TakeHeader, TakeReader};

use crate::project::project_of_text;
use crate::{Problem, Project, StudioError};

/// The project that a take was recorded from, set to play it. Problems are those of the project's text.
///
/// # Errors
/// No take, one of a newer version or without frames.
pub fn project_of_take(path: &Path) -> Result<(Project, Vec<Problem>), StudioError> {
    let mut reader = TakeReader::open(path)?;
    let start = reader.nearest(0).unwrap_or(0);
    let text = match reader.project_at(start) {
        Ok(text) => text,
        Err(_) => reader.header().project.as_str().into(),
    };
    let (mut project, problems) = project_of_text(path, &text)?;
    project.set_take(path);
    // What stands on the dance's timeline goes to the take's own, on which points of a recording mean nothing.
    (project.recording.first_frame, project.recording.end_frame) = (0, None);
    let start = start_on_timeline(reader.header(), &project);
    project.timeline.shift(-start, f64::INFINITY);
    Ok((project, problems))
}

/// Where on the dance's timeline a take begins, seconds.
fn start_on_timeline(header: &TakeHeader, project: &Project) -> f64 {
    let length = header.clip_secs / f64::from(project.motion.speed.max(0.1));
    let start = header.start_secs.max(0.0);
    if project.motion.looping && length > 0.0 { start.rem_euclid(length) } else { start }
}

impl From<TakeError> for StudioError {
    fn from(error: TakeError) -> Self {
        let file = Some(error.path().to_owned());
        let message = error.to_string();
        match error {
            TakeError::Io { .. } | TakeError::Write { .. } | TakeError::Stopped { .. } => {
                Self::Work { file, message }
            }
            TakeError::Request { .. }
            | TakeError::Busy { .. }
            | TakeError::NotATake { .. }
            | TakeError::Newer { .. }
            | TakeError::Empty { .. }
            | TakeError::Malformed { .. }
            | TakeError::Lost { .. }
            | TakeError::NoSuchFrame { .. } => Self::Request { file, message },
        }
    }
}

#[cfg(test)]
mod curve_tests;
#[cfg(test)]
mod regrown_tests;
#[cfg(test)]
mod tests;
