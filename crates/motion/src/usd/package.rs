//! The first layer of a `.usdz` package: a ZIP archive of files that are stored as they are.

use crate::MotionError;

/// Whether a file is a ZIP archive, by its first bytes.
pub(super) fn is_package(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PK\x03\x04")
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
