//! The stage of a `.usdz` package: a ZIP archive whose first file is the stage, stored as it is.

use crate::io::HairFileError;

/// The header of a file in an archive.
const HEADER: usize = 30;

/// The name of the first file of an archive that begins with `start`.
fn first_name(start: &[u8]) -> Option<&[u8]> {
    let header = start.get(..HEADER).filter(|header| header.starts_with(b"PK\x03\x04"))?;
    start.get(HEADER..HEADER + usize::from(u16::from_le_bytes([header[26], header[27]])))
}

/// Whether a file that begins with `start` is a package of USD.
pub(super) fn is_package(start: &[u8]) -> bool {
    first_name(start).is_some_and(|name| {
        let name = name.to_ascii_lowercase();
        [&b".usd"[..], b".usda", b".usdc"].iter().any(|ending| name.ends_with(ending))
    })
}

/// The bytes of the stage of a package.
pub(super) fn stage<'a>(name: &str, data: &'a [u8]) -> Result<&'a [u8], HairFileError> {
    let malformed = |found: &str| HairFileError::Malformed {
        name: name.to_owned(),
        offset: 0,
        found: found.to_owned(),
        wanted: "a package that begins with its stage, stored as it is".to_owned(),
    };
    let header = data.get(..HEADER).ok_or_else(|| malformed("a package without a file"))?;
    let two = |at: usize| usize::from(u16::from_le_bytes([header[at], header[at + 1]]));
    if two(8) != 0 {
        return Err(malformed("a compressed stage"));
    }
    let size = u32::from_le_bytes([header[18], header[19], header[20], header[21]]) as usize;
    let rest = data.get(HEADER + two(26) + two(28)..).unwrap_or_default();
    rest.get(..size).filter(|stage| !stage.is_empty()).ok_or_else(|| malformed("a stage that is cut"))
}
