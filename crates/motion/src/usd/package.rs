//! The first layer of a `.usdz` package: a ZIP archive of files that are stored as they are.

use crate::MotionError;

/// Whether a file is a ZIP archive, by its first bytes.
pub(super) fn is_package(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PK\x03\x04")
}

/// A file of a package by its name, or by the end of its path. Files are stored one after the other, each with its size before it.
pub(super) fn entry<'a>(bytes: &'a [u8], name: &str) -> Option<&'a [u8]> {
    let wanted = name.trim_start_matches("./").to_ascii_lowercase();
    let ending = format!("/{wanted}");
    let mut at = 0_usize;
    loop {
        let head = bytes.get(at..)?.get(..30).filter(|head| is_package(head))?;
        let number = |at: usize, size: usize| {
            head[at..at + size].iter().rev().fold(0, |n, &b| n << 8 | usize::from(b))
        };
        let (method, size, name_length) = (number(8, 2), number(22, 4), number(26, 2));
        let start = at + 30 + name_length + number(28, 2);
        let own = String::from_utf8_lossy(bytes.get(at + 30..)?.get(..name_length)?).to_ascii_lowercase();
        let data = bytes.get(start..)?.get(..size)?;
        if method == 0 && (own == wanted || own.ends_with(&ending)) {
            return Some(data);
        }
        at = start + size;
    }
}

/// The first file of a package, which is its stage.
pub(super) fn first_layer<'a>(file: &str, bytes: &'a [u8]) -> Result<&'a [u8], MotionError> {
    let refuse = |problem: &str| MotionError::malformed(file, "byte 0", problem);
    let short = || refuse("the package ends within its first file");
    let number = |at: usize, size: usize| -> Option<u64> {
        let bytes = bytes.get(at..at + size)?;
        Some(bytes.iter().rev().fold(0, |number, &byte| number << 8 | u64::from(byte)))
    };
    // APPNOTE.TXT, section 4.3.7: method at 8, sizes at 18 and 22, lengths of name and extra field at 26 and 28.
    let method = number(8, 2).ok_or_else(short)?;
    let size = number(22, 4).ok_or_else(short)?;
    let name_length = number(26, 2).ok_or_else(short)? as usize;
    let start = 30 + name_length + number(28, 2).ok_or_else(short)? as usize;
    let name =
        String::from_utf8_lossy(bytes.get(30..30 + name_length).ok_or_else(short)?).to_ascii_lowercase();
    if ![".usd", ".usda", ".usdc"].iter().any(|ending| name.ends_with(ending)) {
        return Err(refuse(
            "the package does not begin with a .usd, .usda or .usdc file; must be a .usdz file",
        ));
    }
    if method != 0 {
        return Err(refuse("the first file of the package is compressed; must be stored, as .usdz requires"));
    }
    bytes.get(start..start.saturating_add(size as usize)).ok_or_else(short)
}
