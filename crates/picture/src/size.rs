//! The sizes that an image may have.

use lovelock_base::Failure;

/// The longest side of an image, pixels.
pub const MAX_SIDE: u32 = 8192;

/// The most pixels of an image: 8192 by 4320, a little more than 8K video.
pub const MAX_PIXELS: u64 = 8192 * 4320;

/// A size that is out of range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "an image of {width}x{height} pixels is out of range: each side must be 1 to {limit}, and both together at \
     most {} million pixels",
    MAX_PIXELS / 1_000_000
)]
pub struct SizeError {
    /// The width that was given, pixels.
    pub width: u32,
    /// The height that was given, pixels.
    pub height: u32,
    /// The longest side that the backend supports.
    pub limit: u32,
}

impl Failure for SizeError {
    fn is_request(&self) -> bool {
        true
    }
}

/// Returns an error for sizes that no backend supports.
///
/// # Errors
/// The size with the limit.
pub fn check_size(width: u32, height: u32) -> Result<(), SizeError> {
    check_size_for(width, height, MAX_SIDE)
}

/// Returns an error for sizes out of range. `limit` is the longest side that the backend supports.
///
/// # Errors
/// The size with the limit.
pub fn check_size_for(width: u32, height: u32, limit: u32) -> Result<(), SizeError> {
    let limit = limit.min(MAX_SIDE);
    let fits = (1..=limit).contains(&width) && (1..=limit).contains(&height);
    if fits && u64::from(width) * u64::from(height) <= MAX_PIXELS {
        Ok(())
    } else {
        Err(SizeError { width, height, limit })
    }
}
