//! Single keys of a project's tracks.

use super::leaf::is_held;
use crate::project::Project;
use crate::tracks::{Key, Track};

impl Project {
    /// Sets the key of `target` at a time of the timeline, in seconds, to these numbers ([`key_numbers`](super::key_numbers)), and makes
    /// the track if there is none. Returns whether there was room for it; there is none at a time that is not finite.
    pub fn set_key(&mut self, target: &str, secs: f64, value: Vec<f64>) -> bool {
        if !secs.is_finite() {
            return false;
        }
        let held = is_held(self, target);
        let tracks = &mut self.timeline.tracks;
        if let Some(track) = tracks.iter_mut().find(|track| track.target == target) {
            track.keys.retain(|key| (key.secs - secs).abs() > Track::AT_SECS);
            track.put(secs, value);
            return track.key_at(secs).is_some();
        }
        let track = Track { keys: vec![Key { secs: secs.max(0.0), value }], held, ..Track::new(target) };
        match track.in_range().filter(|_| tracks.len() < Track::MAX) {
            Some(track) => {
                tracks.push(track);
                true
            }
            None => false,
        }
    }

    /// Removes the key of `target` at a time, and the track with its last key. Returns whether there was one.
    pub fn remove_key(&mut self, target: &str, secs: f64) -> bool {
        let tracks = &mut self.timeline.tracks;
        let Some(track) = tracks.iter_mut().find(|track| track.target == target) else { return false };
        let Some(at) = track.key_at(secs).map(|key| key.secs) else { return false };
        track.keys.retain(|key| key.secs.to_bits() != at.to_bits());
        tracks.retain(|track| track.target != target || !track.keys.is_empty());
        true
    }
}
