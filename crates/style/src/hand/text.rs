//! Edits as text of files: packed bytes, LZ4, base 64.

use std::sync::Arc;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use super::HandEdits;
use super::place::HandPlace;
use super::sample::HandSample;

/// The version of the bytes.
const VERSION: u8 = 1;
/// The most bytes of all edits.
const MAX_BYTES: usize = 64 << 20;

impl HandEdits {
    /// The edits as one line of text; empty without edits. Equal edits have equal text.
    pub fn to_text(&self) -> String {
        if self.is_empty() {
            return String::new();
        }
        let mut out = vec![VERSION];
        out.extend((self.count() as u32).to_le_bytes());
        for sample in self.0.iter() {
            write(sample, &mut out);
        }
        STANDARD.encode(lz4_flex::compress_prepend_size(&out))
    }

    /// Reads what [`HandEdits::to_text`] wrote.
    ///
    /// # Errors
    /// What is wrong with the text, in one sentence.
    pub fn from_text(text: &str) -> Result<Self, String> {
        if text.is_empty() {
            return Ok(Self::default());
        }
        let packed = STANDARD.decode(text).map_err(|error| format!("edits by hand: {error}"))?;
        let size = packed.first_chunk().map_or(0, |size| u32::from_le_bytes(*size) as usize);
        if size > MAX_BYTES {
            return Err(format!("edits by hand: found {size} bytes; must be at most {MAX_BYTES}"));
        }
        let bytes = lz4_flex::decompress_size_prepended(&packed)
            .map_err(|error| format!("edits by hand: {error}"))?;
        let mut reader = Reader(&bytes);
        let samples = reader.samples().ok_or("edits by hand: the data ends too early or is damaged")?;
        if !reader.0.is_empty() {
            return Err(format!("edits by hand: {} bytes too many", reader.0.len()));
        }
        Ok(Self::sorted(samples))
    }
}

fn write(sample: &HandSample, out: &mut Vec<u8>) {
    let mut short = |value: u16| out.extend(value.to_le_bytes());
    sample.place.steps.iter().for_each(|step| short(*step as u16));
    short(sample.reach);
    sample.numbers.iter().for_each(|number| short(*number));
    short(u16::from(sample.place.twin) | u16::from(sample.removed) << 8);
    short(sample.turns.len() as u16);
    sample.channels.iter().for_each(|values| short(values.len() as u16));
    // Neighbouring links are turned alike: differences pack better.
    let mut rise = |values: &mut dyn Iterator<Item = i16>| {
        let mut before = 0_i16;
        for value in values {
            out.extend(value.wrapping_sub(before).to_le_bytes());
            before = value;
        }
    };
    for axis in 0..2 {
        rise(&mut sample.turns.iter().map(|turn| turn[axis]));
    }
    for values in &sample.channels {
        rise(&mut values.iter().copied());
    }
}

struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn bytes<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (bytes, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*bytes)
    }

    fn short(&mut self) -> Option<u16> {
        self.bytes().map(u16::from_le_bytes)
    }

    fn row(&mut self, count: usize) -> Option<Vec<i16>> {
        let mut value = 0_i16;
        let mut next = || {
            value = value.wrapping_add(self.short()? as i16);
            // The lowest number has no opposite on the other side of the head.
            Some(value.max(-i16::MAX))
        };
        (0..count).map(|_| next()).collect()
    }

    fn samples(&mut self) -> Option<Vec<Arc<HandSample>>> {
        if self.bytes()? != [VERSION] {
            return None;
        }
        let count = u32::from_le_bytes(self.bytes()?) as usize;
        if count > HandEdits::MAX {
            return None;
        }
        (0..count).map(|_| self.sample().map(Arc::new)).collect()
    }

    fn sample(&mut self) -> Option<HandSample> {
        let steps = [self.short()?, self.short()?, self.short()?].map(|v| (v as i16).max(-i16::MAX));
        let reach = self.short()?;
        let numbers = [self.short()?, self.short()?, self.short()?];
        let flags = self.short()?;
        let links = self.short()? as usize;
        let counts = [self.short()?, self.short()?, self.short()?, self.short()?].map(usize::from);
        if links > HandSample::MAX_LINKS || counts.iter().any(|count| *count > HandSample::MAX_LINKS + 1) {
            return None;
        }
        let [x, y] = [self.row(links)?, self.row(links)?];
        let mut channels: [Vec<i16>; 4] = Default::default();
        for (channel, count) in channels.iter_mut().zip(counts) {
            *channel = self.row(count)?;
        }
        let read = HandSample {
            place: HandPlace { steps, twin: flags as u8 },
            reach,
            turns: x.into_iter().zip(y).map(|(x, y)| [x, y]).collect(),
            channels,
            numbers,
            removed: flags & 0x100 != 0,
        };
        // Numbers out of their ranges are brought into them.
        Some(HandSample { reach: read.reach, ..HandSample::of(read.place, read.spacing(), &read.edit()) })
    }
}
