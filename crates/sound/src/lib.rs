//! Sound beside a dance: reading files, the waveform, beats, and playing in step with a clock.
//!
//! Every sound is brought to [`RATE`] samples per second when it is read ([`read_sound`]), and has one or two channels of 16 bits.

mod beats;
mod error;
mod play;
mod read;
mod sound;
mod waveform;

pub use beats::{Beats, find_beats};
pub use error::SoundError;
pub use play::{Player, Target};
pub use read::{LONGEST_SECS, RATES, SOUND_EXTENSIONS, Source, is_sound, read_sound};
pub use sound::{RATE, Sound};
pub use waveform::Waveform;
