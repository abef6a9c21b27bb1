//! Reading a picture of the surroundings, averaged to a small size while it is read.

mod exr;
mod radiance;
mod reduce;

use std::fs::{self, File};
use std::io::{BufRead, BufReader, Seek};
use std::path::Path;

pub use self::reduce::Notes;
pub(super) use self::reduce::{Reduced, Reducer, luminance};
use super::error::{MAX_FILE_BYTES, Problem};

/// The largest radiance that is read; what exceeds it is taken as this. Six times the luminance of the sun in candela
/// per square metre, and far from where sums of floats overflow.
pub const LARGEST_RADIANCE: f32 = 1e10;

/// Opens the file of a picture.
///
/// Asks what it is before it opens it: to open a pipe waits for its writer.
pub(super) fn open(path: &Path) -> Result<BufReader<File>, Problem> {
    let found = fs::metadata(path)?;
    if found.is_dir() {
        return Err(Problem::NotAFile("a folder"));
    }
    if !found.is_file() {
        return Err(Problem::NotAFile("a pipe or a device"));
    }
    if found.len() > MAX_FILE_BYTES {
        return Err(Problem::TooManyBytes(found.len()));
    }
    Ok(BufReader::with_capacity(1 << 16, File::open(path)?))
}

/// Reads a picture of the surroundings. The first bytes decide on the format.
pub(super) fn read(content: impl BufRead + Seek) -> Result<Reducer, Problem> {
    read_by(content, &Reducer::new)
}

/// Reads a picture with at most `side` pixels along its longest side; a larger one is averaged.
pub(super) fn read_onto(content: impl BufRead + Seek, side: u32) -> Result<Reducer, Problem> {
    read_by(content, &|width, height| Reducer::within(width, height, side))
}

/// What makes the reducer of a picture of some width and height.
type NewReducer<'a> = &'a dyn Fn(u64, u64) -> Result<Reducer, Problem>;

fn read_by(mut content: impl BufRead + Seek, reducer: NewReducer<'_>) -> Result<Reducer, Problem> {
    let start = content.fill_buf()?;
    if start.starts_with(&::exr::meta::magic_number::BYTES) {
        exr::read(content, reducer)
    } else if start.starts_with(b"#?") {
        radiance::read(content, reducer)
    } else {
        Err(Problem::Format(describe(start)))
    }
}

/// What the first bytes of a file look like, for an error.
pub(super) fn describe(start: &[u8]) -> String {
    let known: [(&[u8], &str); 6] = [
        (b"\x89PNG", "a PNG picture"),
        (b"\xff\xd8\xff", "a JPEG picture"),
        (b"II*\0", "a TIFF picture"),
        (b"MM\0*", "a TIFF picture"),
        (b"DDS ", "a DDS picture"),
        (b"PF", "a PFM picture"),
    ];
    let start = &start[..start.len().min(16)];
    if start.is_empty() {
        return "nothing".to_owned();
    }
    if let Some((_, name)) = known.iter().find(|(magic, _)| start.starts_with(magic)) {
        return (*name).to_owned();
    }
    match std::str::from_utf8(start) {
        Ok(text) if !text.contains('\0') => format!("the text {text:?}"),
        _ => format!("the bytes {start:02x?}"),
    }
}
