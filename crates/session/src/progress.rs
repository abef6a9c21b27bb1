//! Progress of a recording or a comparison.

use std::ops::ControlFlow;

use lovelock_project::error::{Problem, ProjectError};

/// Progress of a recording or a comparison.
#[derive(Clone, Debug, PartialEq)]
pub enum Progress {
    /// Files are read and hair is grown.
    Loading {
        /// What is being done.
        what: String,
    },
    /// The scene is loaded.
    Loaded {
        /// Parts that could not be loaded, and notes about the files.
        problems: Vec<Problem>,
    },
    /// The pre-roll before the first rendered frame is simulated.
    Simulating {
        /// Steps done.
        done: u64,
        /// Total number of steps.
        total: u64,
    },
    /// A frame is done.
    Frame {
        /// Simulation steps per frame; 0 for a take.
        steps_per_frame: u32,
        /// Frames done.
        done: u64,
        /// Total number of frames.
        total: u64,
    },
    /// A frame exists already, from an earlier recording.
    Kept {
        /// Frames done.
        done: u64,
        /// Total number of frames.
        total: u64,
    },
    /// Methods are compared.
    Comparing {
        /// What is being done.
        what: String,
        /// Parts done.
        done: u64,
        /// Total number of parts.
        total: u64,
        /// Estimated seconds until all parts are done, if they are estimated.
        left_secs: Option<f64>,
    },
    /// The file is completed.
    Finishing,
}

/// Reports progress to the caller's callback.
///
/// # Errors
/// [`ProjectError::Cancelled`] if the callback cancels the work.
pub fn report_progress(
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    what: Progress,
) -> Result<(), ProjectError> {
    match progress(what) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(ProjectError::Cancelled),
    }
}
