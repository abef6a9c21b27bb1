//! Finds the samples of a WAV file whose header does not state their length, or states it wrongly.
//!
//! Recorders that were cut off, and programs that write to a pipe, leave 0 or ffffffff where the length belongs. Like other players, this
//! plays such a file up to its end. The decoder then gets a header of its own with the true length.
//!
//! Sources: *Multimedia Programming Interface and Data Specifications 1.0* (RIFF, WAVE), EBU Tech 3306 (RF64), ITU-R BS.2088 (BW64).

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::ops::Range;

/// Chunks before the samples that are looked at; real files have a few dozen at most.
const MOST_CHUNKS: usize = 4096;
/// Bytes of a `fmt ` chunk that have a meaning.
const LONGEST_FORMAT: u64 = 40;
/// Layer III of MPEG in a WAV file.
const MP3: u16 = 0x55;
const EXTENSIBLE: u16 = 0xfffe;
const PCM: u16 = 1;

/// The parts of a file that the decoder reads.
pub(super) struct Parts {
    /// Bytes to read before those of the file.
    pub(super) head: Vec<u8>,
    /// The bytes of the file with the samples.
    pub(super) samples: Range<u64>,
    /// What the header states wrongly, as sentences.
    pub(super) notes: Vec<String>,
}

/// The parts of a WAV file; otherwise what was found and what must be there.
type Found = Result<Parts, [&'static str; 2]>;

/// The parts of a WAV file; `None` for files of other formats.
pub(super) fn parts(file: &mut File, length: u64) -> io::Result<Option<Found>> {
    let start = read_at::<12>(file, 0)?;
    file.rewind()?;
    match start {
        Some([b'R', b'I', b'F', b'X', _, _, _, _, b'W', b'A', b'V', b'E']) => Ok(Some(Err([
            "found a WAV file with the highest byte first (RIFX)",
            "one with the lowest byte first (RIFF, RF64 or BW64)",
        ]))),
        Some(start) if is_wav(&start) => find(file, length).map(Some),
        _ => Ok(None),
    }
}

/// Whether a file that begins with these bytes is a WAV file of either byte order.
pub(super) fn is_wav(start: &[u8]) -> bool {
    let is_riff = [&b"RIFF"[..], b"RIFX", b"RF64", b"BW64"].iter().any(|name| start.starts_with(name));
    is_riff && start.get(8..12) == Some(b"WAVE")
}

fn find(file: &mut File, length: u64) -> io::Result<Found> {
    let (mut format, mut samples, mut large, mut notes) = (None, None, None, Vec::new());
    let mut at = 12;
    for _ in 0..MOST_CHUNKS {
        // The length of the whole (`RIFF`) is not used: what counts is the file.
        let Some((id, size)) = chunk(file, at)? else { break };
        let (body, mut bytes) = (at + 8, u64::from(size));
        match &id {
            b"ds64" => large = read_at::<16>(file, body)?.map(|bytes| u64_at(&bytes, 8)),
            b"fmt " if format.is_none() => {
                let mut fields = Vec::new();
                file.seek(SeekFrom::Start(body))?;
                Read::take(&mut *file, bytes.min(LONGEST_FORMAT)).read_to_end(&mut fields)?;
                format = Some(fields);
            }
            b"data" if samples.is_none() => {
                let stated = match large {
                    Some(large) if size == u32::MAX => large,
                    _ => u64::from(size),
                };
                let there = length.saturating_sub(body);
                let unknown =
                    stated > there || (stated == 0 && there > 0 && !chunks_end_the_file(file, body, length)?);
                if unknown {
                    let states = match stated {
                        0 | 0xffff_ffff | u64::MAX => "no length".to_owned(),
                        stated => format!("{stated} bytes of sound, of which {there} are there"),
                    };
                    notes.push(format!("its header states {states}; it is played to the end of the file"));
                }
                let used = if unknown { there } else { stated };
                samples = Some(body..body + used);
                bytes = used;
                let end = aligned(file, body, used)?;
                if end < length && !chunks_end_the_file(file, end, length)? {
                    let after = length - end;
                    notes.push(format!(
                        "{after} bytes after the sound that its header states are no chunk and were left out"
                    ));
                }
                if unknown || format.is_some() {
                    break;
                }
            }
            _ => {}
        }
        at = aligned(file, body, bytes)?;
    }
    let Some(format) = format.filter(|format| format.len() >= 16) else {
        return Ok(Err(["found a WAV file without a `fmt ` chunk", "a WAV file that states its format"]));
    };
    let Some(samples) = samples else {
        return Ok(Err(["found a WAV file without a `data` chunk", "a WAV file with samples"]));
    };
    if samples.is_empty() {
        return Ok(Err(["found no samples: the `data` chunk is empty", "a sound of at least one sample"]));
    }
    let head = match u16_at(&format, 0) {
        MP3 => Vec::new(),
        _ => header(&format, samples.end - samples.start),
    };
    Ok(Ok(Parts { head, samples, notes }))
}

/// Name and size of the chunk at a byte; `None` where none begins.
fn chunk(file: &mut File, at: u64) -> io::Result<Option<([u8; 4], u32)>> {
    let Some([a, b, c, d, size @ ..]) = read_at::<8>(file, at)? else { return Ok(None) };
    let id = [a, b, c, d];
    let is_name = id.iter().all(|byte| (0x20..=0x7e).contains(byte)) && id != *b"    ";
    Ok(is_name.then(|| (id, u32::from_le_bytes(size))))
}

/// Where the next chunk begins: an odd number of bytes is followed by one more, unless the file was written without it.
fn aligned(file: &mut File, body: u64, size: u64) -> io::Result<u64> {
    let end = body + size;
    let padded = end + size % 2;
    let is_unpadded = padded != end && chunk(file, padded)?.is_none() && chunk(file, end)?.is_some();
    Ok(if is_unpadded { end } else { padded })
}

/// Whether chunks follow from a byte up to the end of the file.
fn chunks_end_the_file(file: &mut File, from: u64, length: u64) -> io::Result<bool> {
    let mut at = from;
    for _ in 0..MOST_CHUNKS {
        let Some((_, size)) = chunk(file, at)? else { return Ok(false) };
        let end = at + 8 + u64::from(size);
        if end == length || end + u64::from(size % 2) == length {
            return Ok(true);
        }
        if end > length {
            return Ok(false);
        }
        at = aligned(file, at + 8, u64::from(size))?;
    }
    Ok(false)
}

/// A header of the usual form for samples of this format.
fn header(format: &[u8], samples: u64) -> Vec<u8> {
    let (tag, channels) = (u16_at(format, 0), u16_at(format, 2));
    let mut format = format.to_vec();
    // Samples of 12, 20 or 0 bits fill the bytes that the size of a block leaves for each.
    let (block, bits) = (u16_at(&format, 12), u16_at(&format, 14));
    let bytes = if channels > 0 && block.is_multiple_of(channels) { block / channels } else { 0 };
    if [PCM, EXTENSIBLE].contains(&tag)
        && (bits == 0 || !bits.is_multiple_of(8))
        && (1..=4).contains(&bytes)
        && bits <= 8 * bytes
    {
        format[14..16].copy_from_slice(&(8 * bytes).to_le_bytes());
    }
    match tag {
        EXTENSIBLE if format.len() >= 40 => {
            format.truncate(40);
            format[16..18].copy_from_slice(&22_u16.to_le_bytes());
            let (bits, valid) = (u16_at(&format, 14), u16_at(&format, 18));
            let is_float = format[24] == 3;
            if is_float || valid == 0 || valid > bits {
                format[18..20].copy_from_slice(&bits.to_le_bytes());
            }
        }
        EXTENSIBLE => {
            format.truncate(16);
            format[..2].copy_from_slice(&PCM.to_le_bytes());
        }
        1 | 3 => format.truncate(16),
        // A-law and µ-law.
        6 | 7 => {
            format.truncate(16);
            format.extend([0, 0]);
        }
        _ => {}
    }
    // Longer sounds are refused by their duration.
    let samples = u32::try_from(samples).unwrap_or(u32::MAX).min(u32::MAX - 256);
    let mut head = b"RIFF".to_vec();
    head.extend((20 + format.len() as u32 + samples).to_le_bytes());
    head.extend(b"WAVEfmt ");
    head.extend((format.len() as u32).to_le_bytes());
    head.extend(&format);
    if format.len() % 2 == 1 {
        head.push(0);
    }
    head.extend(b"data");
    head.extend(samples.to_le_bytes());
    head
}

/// Bytes at a place; `None` beyond the end of the file.
fn read_at<const N: usize>(file: &mut File, at: u64) -> io::Result<Option<[u8; N]>> {
    let mut bytes = [0; N];
    file.seek(SeekFrom::Start(at))?;
    match file.read_exact(&mut bytes) {
        Ok(()) => Ok(Some(bytes)),
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => Ok(None),
        Err(error) => Err(error),
    }
}

fn u16_at(bytes: &[u8], at: usize) -> u16 {
    u16::from_le_bytes([bytes[at], bytes[at + 1]])
}

fn u64_at(bytes: &[u8; 16], at: usize) -> u64 {
    bytes[at..].first_chunk::<8>().map_or(0, |&eight| u64::from_le_bytes(eight))
}
