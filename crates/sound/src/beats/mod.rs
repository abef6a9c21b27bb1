//! Finds beats: onset strength by spectral flux, tempo by autocorrelation, beats by dynamic programming.
//!
//! D. P. W. Ellis, *Beat Tracking by Dynamic Programming*, Journal of New Music Research 36 (2007), 51–60. Names of sections and
//! constants are those of the paper. The frames are finer here, so that beats are exact to about 10 ms, and the period is halved where the
//! onsets between the beats are as strong as the beats.

mod onset;
mod tempo;
mod track;

use crate::sound::Sound;

/// Shorter sounds have no beats, seconds: a tempo needs several of them.
const SHORTEST_SECS: f64 = 3.0;

/// The beats of a sound.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Beats {
    /// Their times from the start of the sound, seconds, ascending. None for a sound without a regular beat, such as noise.
    pub secs: Vec<f64>,
    /// Beats per minute: the mean from the first to the last one. `None` without beats.
    pub tempo: Option<f64>,
}

/// Finds the beats of a sound.
pub fn find_beats(sound: &Sound) -> Beats {
    if sound.secs() < SHORTEST_SECS {
        return Beats::default();
    }
    let onsets = onset::strength(sound);
    let Some(period) = tempo::period(&onsets) else { return Beats::default() };
    let mut frames = track::beats(&onsets, period);
    if let Some(half) = tempo::halved(&onsets, &frames, period) {
        frames = track::beats(&onsets, half);
    }
    let secs: Vec<f64> = frames.into_iter().map(onset::secs_of).collect();
    let tempo = match secs.as_slice() {
        [first, .., last] => Some(60.0 * (secs.len() - 1) as f64 / (last - first)),
        _ => return Beats::default(),
    };
    Beats { secs, tempo }
}

#[cfg(test)]
mod tests;
