//! What can go wrong with a picture.

/// Why a picture could not be made.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The graphics device refused or is gone.
    #[error(transparent)]
    Gpu(#[from] lovelock_gpu::GpuError),
    /// The shadow's map would be too large.
    #[error(transparent)]
    Shadow(#[from] lovelock_shadow::ShadowError),
    /// The asked size is out of range.
    #[error(
        "a picture of {width}x{height} pixels is out of range: each side must be 1 to {limit}, and both together at \
         most {} million pixels",
        crate::MOST_PIXELS / 1_000_000
    )]
    Size {
        /// The width asked for, pixels.
        width: u32,
        /// The height asked for, pixels.
        height: u32,
        /// The longest side that the backend can draw.
        limit: u32,
    },
}
