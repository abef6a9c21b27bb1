//! What the window does with keys that are set at controls.

use lovelock_project::tracks::Track;

use super::{Window, notices};

impl Window {
    /// Sets the key of a target at the current time.
    pub(super) fn set_key(&mut self, target: &str, value: Vec<f64>) {
        let secs = self.now_secs();
        let mut is_set = true;
        self.change("track", |project| is_set = project.set_key(target, secs, value));
        if !is_set {
            let (tracks, keys) = (Track::MAX, Track::MAX_KEYS);
            self.warn([format!(
                "The key limit is reached: a project can have {tracks} tracks of {keys} keys. Remove a key first."
            )]);
        }
    }

    /// Removes the key of a target at the current time.
    pub(super) fn remove_key(&mut self, target: &str) {
        let secs = self.now_secs();
        self.change("track", |project| {
            project.remove_key(target, secs);
        });
    }

    /// From now on a control is recorded alone.
    pub(super) fn record_control(&mut self, target: String, label: &str) {
        self.document.overdub_mut().arm_only(target);
        let what = if self.session.playing {
            "Hold and move the control to write its track"
        } else {
            "Play the dance and move the control to write its track, or move it now to set a key"
        };
        self.notices.push(notices::Kind::Done, format!("Recording {label}. {what}. Press W to stop."));
    }
}
