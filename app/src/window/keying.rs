//! What the window does with keys that are set at controls.

use lovelock_project::Project;
use lovelock_project::tracks::Track;

use super::control::KeyRequest;
use super::{Window, notices};

impl Window {
    /// Sets or removes a key of `project`, the one that the panels edit, at the current time, or records a control.
    pub(super) fn key(&mut self, request: KeyRequest, project: &mut Project) {
        let secs = self.now_secs();
        match request {
            KeyRequest::Add { target, value } => {
                if !project.set_key(&target, secs, value) {
                    let (tracks, keys) = (Track::MAX, Track::MAX_KEYS);
                    self.warn([format!(
                        "The key limit is reached: a project can have {tracks} tracks of {keys} keys. Remove a key first."
                    )]);
                }
            }
            KeyRequest::Remove { target } => {
                project.remove_key(&target, secs);
            }
            KeyRequest::Record { target, label } => {
                self.document.overdub_mut().arm_only(target);
                let what = if self.session.playing {
                    "Hold and move the control to write its track"
                } else {
                    "Play the dance and move the control to write its track, or move it now to set a key"
                };
                self.notices
                    .push(notices::Kind::Done, format!("Recording {label}. {what}. Press W to stop."));
            }
        }
    }
}
