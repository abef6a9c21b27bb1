//! The finished picture.

/// A finished picture in memory.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Picture {
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// Rows from the top, four bytes per pixel: red, green, blue (sRGB-encoded) and alpha.
    pub rgba: Vec<u8>,
}

impl Picture {
    /// The memory of its pixels, bytes.
    pub fn bytes(&self) -> u64 {
        self.rgba.capacity() as u64
    }
}
