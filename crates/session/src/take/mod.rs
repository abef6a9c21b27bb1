//! Takes: recorded simulations.
//!
//! [`TakeRecording`] writes what an [`Engine`](crate::engine::Engine) does; [`TakePlayer`] makes [`FrameSnapshot`](crate::snapshot::FrameSnapshot)s
//! of a take without simulating, so that everything that renders a simulation can render a take. It plays curves over time of
//! other programs ([`lovelock_groom::CurveCache`]) as well.

mod cache;
mod player;
mod playing;
mod recording;
mod transport;

pub use cache::{CurveInputs, CurvesToPlay, holds_curves, project_of_cache};
pub use player::TakePlayer;
pub use recording::{TakeProgress, TakeRecording};
pub(crate) use transport::TakeTransport;

use std::path::Path;

use lovelock_project::Project;
use lovelock_project::error::{Problem, ProjectError};
use lovelock_project::project::project_of_text;
use lovelock_record::{TakeHeader, TakeReader};

/// The project that a take was recorded from, set to play the take. Also returns problems of the project's text.
///
/// For curves over time it is the default project, set to play them.
///
/// # Errors
/// If the file is not a take, is of a newer version, or has no frames.
pub fn project_of_take(path: &Path) -> Result<(Project, Vec<Problem>), ProjectError> {
    if holds_curves(path) {
        return Ok((project_of_cache(&Project::default(), path)?, Vec::new()));
    }
    let mut reader = TakeReader::open(path)?;
    let start = reader.nearest(0).unwrap_or(0);
    let text = match reader.project_at(start) {
        Ok(text) => text,
        Err(_) => reader.header().project.as_str().into(),
    };
    let (mut project, problems) = project_of_text(path, &text)?;
    project.set_take(path);
    // Markers, tracks and the sound move to the timeline of the take, where the in and out points have no meaning.
    (project.recording.first_frame, project.recording.end_frame) = (0, None);
    let start = start_on_timeline(reader.header(), &project);
    project.timeline.shift(-start, f64::INFINITY);
    project.sound.offset_secs -= start;
    Ok((project, problems))
}

/// Start of a take on the timeline of the original motion, seconds.
fn start_on_timeline(header: &TakeHeader, project: &Project) -> f64 {
    let length = header.clip_secs / f64::from(project.motion.speed.max(0.1));
    let start = header.start_secs.max(0.0);
    if project.motion.looping && length > 0.0 { start.rem_euclid(length) } else { start }
}

#[cfg(test)]
mod cache_tests;
#[cfg(test)]
mod regrown_tests;
#[cfg(test)]
mod tests;
