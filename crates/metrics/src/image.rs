//! Images to compare.

/// An image to compare: sRGB, four bytes per pixel, rows from the top. Alpha is ignored.
#[derive(Clone, Copy, Debug)]
pub struct Image<'a> {
    width: usize,
    height: usize,
    rgba: &'a [u8],
}

/// Why images cannot be compared.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ImageError {
    /// There are not four bytes per pixel, or no pixels.
    #[error("{bytes} bytes are not an image of {width} x {height} pixels")]
    Bytes {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
        /// Number of bytes.
        bytes: usize,
    },
    /// The images differ in size.
    #[error("an image of {0} x {1} pixels cannot be compared with one of {2} x {3}")]
    Sizes(usize, usize, usize, usize),
    /// An image is smaller than the window of the metric.
    #[error("an image of {0} x {1} pixels is smaller than the window of {2} x {2} pixels")]
    TooSmall(usize, usize, usize),
}

impl<'a> Image<'a> {
    /// An image of `width` by `height` pixels, sRGB, four bytes per pixel.
    ///
    /// # Errors
    /// If there are no pixels, or not four bytes for each.
    pub fn new(width: u32, height: u32, rgba: &'a [u8]) -> Result<Self, ImageError> {
        let wanted = (width as usize).checked_mul(height as usize).and_then(|pixels| pixels.checked_mul(4));
        if wanted != Some(rgba.len()) || rgba.is_empty() {
            return Err(ImageError::Bytes { width, height, bytes: rgba.len() });
        }
        Ok(Self { width: width as usize, height: height as usize, rgba })
    }

    /// Width in pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The bytes, four per pixel.
    pub fn rgba(&self) -> &'a [u8] {
        self.rgba
    }

    /// Red, green and blue of each pixel.
    pub(crate) fn rgb(&self) -> impl Iterator<Item = [u8; 3]> + use<'a> {
        self.rgba.chunks_exact(4).map(|pixel| [pixel[0], pixel[1], pixel[2]])
    }

    /// Checks that both have the same size.
    pub(crate) fn same_size(&self, other: &Self) -> Result<(), ImageError> {
        if (self.width, self.height) == (other.width, other.height) {
            return Ok(());
        }
        Err(ImageError::Sizes(other.width, other.height, self.width, self.height))
    }
}

#[cfg(test)]
mod tests {
    use super::{Image, ImageError};

    #[test]
    fn there_must_be_four_bytes_per_pixel() {
        assert!(Image::new(2, 3, &[0; 24]).is_ok());
        for (width, height, bytes) in [(2, 3, 23), (0, 0, 0), (0, 9, 0), (u32::MAX, u32::MAX, 8)] {
            let error = Image::new(width, height, &vec![0; bytes]).unwrap_err();
            assert_eq!(error, ImageError::Bytes { width, height, bytes });
        }
    }
}
