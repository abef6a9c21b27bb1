//! Describes a sound.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::Path;

use lovelock_project::error::ProjectError;
use lovelock_sound::{find_beats, read_sound};
use serde::Serialize;

/// Description of a sound.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SoundInfo {
    /// Format and codec.
    pub format: String,
    /// Duration, seconds.
    pub duration_secs: f64,
    /// Samples per second in the file.
    pub rate: u32,
    /// Number of channels in the file.
    pub channels: usize,
    /// Beats per minute, or `null` if there is no regular beat.
    pub tempo: Option<f64>,
    /// Number of beats.
    pub beats: usize,
    /// Always empty: what is damaged is a note.
    pub dropped: BTreeMap<String, u64>,
    /// What was left out or mixed.
    pub notes: Vec<String>,
}

impl SoundInfo {
    /// Reads the sound at `path` and looks for beats.
    ///
    /// # Errors
    /// If the file is no sound, or is too long.
    pub(super) fn of(path: &Path) -> Result<Self, ProjectError> {
        let (sound, source) = read_sound(path, &mut |_| ControlFlow::Continue(()))
            .map_err(|error| ProjectError::input(path, error))?;
        let beats = find_beats(&sound);
        Ok(Self {
            format: source.format,
            duration_secs: sound.secs(),
            rate: source.rate,
            channels: source.channels,
            tempo: beats.tempo,
            beats: beats.secs.len(),
            dropped: BTreeMap::new(),
            notes: source.notes,
        })
    }
}
