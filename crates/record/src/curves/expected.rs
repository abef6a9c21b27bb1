//! Checks that frames match their scene and are as many as it says.

use std::path::{Path, PathBuf};

use super::{CurveFrame, CurveScene};
use crate::RecordError;

/// What the frames of a file must have.
#[derive(Debug)]
pub(super) struct Expected {
    pub(super) target: PathBuf,
    /// Number of points of the curves.
    pub(super) points: usize,
    /// Number of vertices of the body; 0 if the body is not stored.
    pub(super) vertices: usize,
    frames: u64,
}

impl Expected {
    /// The frames of a scene. Without `with_body` the body's surface is not looked at.
    pub(super) fn of(target: &Path, scene: &CurveScene, with_body: bool) -> Self {
        let body = scene.body.as_ref().filter(|_| with_body);
        Self {
            target: target.to_owned(),
            points: scene.points(),
            vertices: body.map_or(0, |body| body.bind_positions.len()),
            frames: scene.frames,
        }
    }

    /// Checks the frame that follows `done` others.
    pub(super) fn check(&self, done: u64, frame: &CurveFrame<'_>) -> Result<(), RecordError> {
        let refuse = |what: String| Err(RecordError::request(format!("{}: {what}", self.target.display())));
        if done == self.frames {
            return refuse(format!("more frames than the {} of its settings", self.frames));
        }
        if frame.points.iter().any(|axis| axis.len() != self.points) {
            return refuse(format!("a frame of {} points; must have {}", frame.points[0].len(), self.points));
        }
        let body = frame.body.map_or([&[][..], &[][..]], |body| [body.positions, body.normals]);
        if self.vertices > 0 && body.iter().any(|array| array.len() != self.vertices) {
            return refuse(format!("a body of {} vertices; must have {}", body[0].len(), self.vertices));
        }
        Ok(())
    }

    /// Checks at the end that all frames have arrived.
    pub(super) fn complete(&self, done: u64) -> Result<(), RecordError> {
        if done == self.frames {
            return Ok(());
        }
        Err(RecordError::request(format!(
            "{}: {done} frames; must be the {} of its settings",
            self.target.display(),
            self.frames
        )))
    }
}
