//! Reads sound files: WAV, MP3, Ogg Vorbis and FLAC.

mod counted;
mod end;
mod mix;
mod other;
mod resample;
mod wav;

use std::fs::File;
use std::io::{Read, Seek};
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use lovelock_base::words;
use symphonia::core::codecs::audio::{AudioDecoder, AudioDecoderOptions};
use symphonia::core::common::Limit;
use symphonia::core::errors::Error;
use symphonia::core::formats::probe::Hint;
use symphonia::core::formats::{FormatOptions, FormatReader, TrackType};
use symphonia::core::io::{MediaSourceStream, MediaSourceStreamOptions};
use symphonia::core::meta::MetadataOptions;

use crate::error::SoundError;
use crate::sound::{RATE, Sound};
use counted::Counted;
use end::{End, Next};
use mix::Mix;
use resample::Resampler;

/// The longest sound that is read, seconds. It takes 346 MB in memory.
pub const LONGEST_SECS: f64 = 1800.0;

/// The rates that a file may have, samples per second.
pub const RATES: std::ops::RangeInclusive<u32> = 4_000..=384_000;

/// The most channels that a file may have.
const MAX_CHANNELS: usize = 32;

/// The most samples per channel of one packet. The longest that a format allows are 65,535 of FLAC.
const LONGEST_PACKET: usize = 1 << 20;

/// The most damaged packets in a row after which the rest of a file is given up.
const MAX_DAMAGED: u32 = 2000;

/// Names of sound files end in one of these.
pub const SOUND_EXTENSIONS: [&str; 6] = ["wav", "wave", "mp3", "ogg", "oga", "flac"];

/// What a file contained before it was brought to [`RATE`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// Format for people, such as `MP3` or `Ogg Vorbis`.
    pub format: String,
    /// Samples per second.
    pub rate: u32,
    /// Number of channels.
    pub channels: usize,
    /// What was left out or guessed, as sentences.
    pub notes: Vec<String>,
}

/// Whether the first bytes of a file are those of a sound that [`read_sound`] may read. 12 bytes suffice.
pub fn is_sound(start: &[u8]) -> bool {
    match start {
        _ if wav::is_wav(start) => true,
        [b'O', b'g', b'g', b'S', ..] | [b'f', b'L', b'a', b'C', ..] | [b'I', b'D', b'3', ..] => true,
        // The sync word of MPEG, with layer 3 and a valid rate.
        [0xFF, second, third, ..] => second & 0xE6 == 0xE2 && third & 0xF0 != 0xF0 && third & 0x0C != 0x0C,
        _ => false,
    }
}

/// Reads a sound and brings it to [`RATE`] and at most two channels. `progress` gets the part of the file that was read, 0 to 1, and may
/// cancel. More than two channels are mixed to one.
///
/// # Errors
/// [`SoundError::Refused`] for what is no sound, has no channel or no sample, a rate outside [`RATES`], or lasts longer than
/// [`LONGEST_SECS`]; [`SoundError::Io`] if the file cannot be read; [`SoundError::Cancelled`]. A file that ends early, or whose header
/// states a wrong length, is read up to its end, and a note says so.
pub fn read_sound(
    path: &Path,
    progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
) -> Result<(Sound, Source), SoundError> {
    // The library multiplies numbers of damaged headers without a check, which panics where overflow is checked.
    catch_unwind(AssertUnwindSafe(|| read(path, progress))).unwrap_or_else(|_| {
        Err(SoundError::Refused {
            path: path.to_owned(),
            found: "found a damaged sound".to_owned(),
            wanted: WANTED.to_owned(),
        })
    })
}

/// What is read, for errors.
const WANTED: &str = "a sound: WAV, MP3, Ogg Vorbis or FLAC";

/// As [`read_sound`], but may panic.
fn read(
    path: &Path,
    progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
) -> Result<(Sound, Source), SoundError> {
    let io = |source| SoundError::Io { path: path.to_owned(), source };
    let mut file = File::open(path).map_err(io)?;
    let data = file.metadata().map_err(io)?;
    if !data.is_file() {
        return Err(io(std::io::Error::other("it is not a file")));
    }
    let refused = |found: &str, wanted: &str| SoundError::Refused {
        path: path.to_owned(),
        found: found.to_owned(),
        wanted: wanted.to_owned(),
    };
    if data.len() == 0 {
        return Err(refused("found an empty file", WANTED));
    }
    let mut start = Vec::new();
    Read::take(&mut file, other::START as u64).read_to_end(&mut start).map_err(io)?;
    file.rewind().map_err(io)?;
    if let Some(name) = other::name(&start) {
        return Err(refused(&format!("found a sound of the format {name}"), WANTED));
    }
    let (head, part, notes) = match wav::parts(&mut file, data.len()).map_err(io)? {
        Some(Ok(parts)) => (parts.head, parts.samples, parts.notes),
        Some(Err([found, wanted])) => return Err(refused(found, wanted)),
        None => (Vec::new(), 0..data.len(), Vec::new()),
    };
    let (counted, read) = Counted::new(file, head, part).map_err(io)?;
    let stream = MediaSourceStream::new(Box::new(counted), MediaSourceStreamOptions::default());
    // Pictures of the cover are not used.
    let meta = MetadataOptions::default().limit_visual_bytes(Limit::Maximum(0));
    let mut reader = symphonia::default::get_probe()
        .probe(&Hint::new(), stream, FormatOptions::default(), meta)
        .map_err(|error| match error {
            Error::Unsupported(_) => refused("found no sound of a known format", WANTED),
            error => refused(&format!("found no sound ({error})"), WANTED),
        })?;
    let (track, mut decoder) = open(reader.as_ref()).map_err(|found| refused(&found, WANTED))?;

    let mut source =
        Source { format: format_name(reader.as_ref(), decoder.as_ref()), rate: 0, channels: 0, notes };
    let mut end = End::of(reader.as_ref());
    let mut chain: Option<(Mix, Resampler)> = None;
    let (mut packet_samples, mut damaged, mut in_a_row) = (Vec::<f32>::new(), 0_u64, 0);
    loop {
        if progress(read.fraction()).is_break() {
            return Err(SoundError::Cancelled);
        }
        let packet = match end.next(reader.as_mut(), track) {
            Ok(Next::Packet(packet)) => packet,
            Ok(Next::Waiting) => continue,
            Ok(Next::End) => break,
            Err(Error::ResetRequired) => {
                source.notes.push("another sound follows in the file and was left out".to_owned());
                break;
            }
            Err(error) => {
                source.notes.push(format!(
                    "the file ends early or is damaged ({error}); the sound is read up to there"
                ));
                break;
            }
        };
        let decoded = match decoder.decode(&packet) {
            Ok(decoded) => decoded,
            Err(Error::DecodeError(_) | Error::IoError(_)) if in_a_row < MAX_DAMAGED => {
                (damaged, in_a_row) = (damaged + 1, in_a_row + 1);
                continue;
            }
            Err(error) => {
                source.notes.push(format!("the sound cannot be decoded further ({error})"));
                break;
            }
        };
        let (rate, channels, frames) =
            (decoded.spec().rate(), decoded.spec().channels().count(), decoded.frames());
        if frames == 0 {
            continue;
        }
        in_a_row = 0;
        if frames > LONGEST_PACKET {
            return Err(refused(&format!("found a packet of {frames} samples"), "at most 1048576"));
        }
        if chain.is_none() {
            let mix = chain_head(rate, channels).map_err(|(found, wanted)| refused(&found, &wanted))?;
            (source.rate, source.channels) = (rate, channels);
            let resampler = Resampler::new(rate, mix.channels()).map_err(|error| {
                refused(&format!("found {rate} samples per second ({error})"), "another rate")
            })?;
            chain = Some((mix, resampler));
        }
        let Some((mix, resampler)) = &mut chain else { break };
        if (rate, channels) != (source.rate, source.channels) {
            source.notes.push(
                "the rate or the number of channels changes in the file; the rest was left out".to_owned(),
            );
            break;
        }
        packet_samples.resize(frames * channels, 0.0);
        decoded.copy_to_slice_interleaved(&mut packet_samples[..]);
        mix.mix(&mut packet_samples);
        resampler.push(&packet_samples);
        if resampler.frames() as f64 > LONGEST_SECS * f64::from(RATE) {
            let wanted = format!("at most {} minutes", LONGEST_SECS / 60.0);
            return Err(refused(
                &format!("found a sound of more than {} minutes", LONGEST_SECS / 60.0),
                &wanted,
            ));
        }
    }
    let Some((mix, resampler)) = chain else {
        return Err(refused("found no samples", "a sound of at least one sample"));
    };
    if source.channels > 2 {
        source.notes.push(format!("its {} channels are mixed to one", source.channels));
    }
    if damaged > 0 {
        source.notes.push(words::counted(
            damaged,
            "damaged packet was left out",
            "damaged packets were left out",
        ));
    }
    if end.is_wrong() {
        source
            .notes
            .push("its header states a shorter length; it is played to the end of the file".to_owned());
    }
    let sound = Sound::new(resampler.finish(), mix.channels());
    if sound.frames() == 0 {
        return Err(refused("found no samples", "a sound of at least one sample"));
    }
    Ok((sound, source))
}

/// What mixes the channels of a sound; otherwise what was found and what is wanted.
fn chain_head(rate: u32, channels: usize) -> Result<Mix, (String, String)> {
    if !RATES.contains(&rate) {
        let wanted = format!("{} to {}", RATES.start(), RATES.end());
        return Err((format!("found {rate} samples per second"), wanted));
    }
    if channels == 0 || channels > MAX_CHANNELS {
        return Err((format!("found {channels} channels"), format!("1 to {MAX_CHANNELS}")));
    }
    Ok(Mix::new(channels))
}

/// The track that is played, and its decoder; otherwise what was found.
fn open(reader: &dyn FormatReader) -> Result<(u32, Box<dyn AudioDecoder>), String> {
    let track = reader.default_track(TrackType::Audio).ok_or("found a file without sound")?;
    let parameters = track.codec_params.as_ref().and_then(|parameters| parameters.audio());
    let parameters = parameters.ok_or("found a sound of an unknown codec")?;
    if let Some(rate) = parameters.sample_rate
        && !RATES.contains(&rate)
    {
        return Err(format!(
            "found {rate} samples per second (must be {} to {})",
            RATES.start(),
            RATES.end()
        ));
    }
    // Other headers may state any length; these sounds are measured as they are read.
    let is_measured = reader.format_info().short_name == "wave";
    let longest = parameters.sample_rate.filter(|_| is_measured).map(|rate| LONGEST_SECS * f64::from(rate));
    if let (Some(frames), Some(longest)) = (track.num_frames, longest)
        && frames as f64 > longest
    {
        let minutes = frames as f64 / longest * LONGEST_SECS / 60.0;
        return Err(format!(
            "found a sound of {minutes:.0} minutes (must be at most {})",
            LONGEST_SECS / 60.0
        ));
    }
    let decoder = symphonia::default::get_codecs()
        .make_audio_decoder(parameters, &AudioDecoderOptions::default())
        .map_err(|error| format!("found a sound that cannot be decoded ({error})"))?;
    Ok((track.id, decoder))
}

/// Format and codec for people.
fn format_name(reader: &dyn FormatReader, decoder: &dyn AudioDecoder) -> String {
    match (reader.format_info().short_name, decoder.codec_info().short_name) {
        ("ogg", "vorbis") => "Ogg Vorbis".to_owned(),
        ("ogg", codec) => format!("Ogg {}", codec.to_uppercase()),
        ("wave", codec) => format!("WAV ({codec})"),
        (format, _) => format.to_uppercase(),
    }
}

#[cfg(test)]
mod tests;
