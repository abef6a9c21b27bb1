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
    /// Something was asked about a picture, and none has been drawn.
    #[error("no picture has been drawn that could be asked about")]
    NoPicture,
    /// A light was asked for that the last picture has not.
    #[error(
        "there is no light {light}: the picture has {lights} lights that are switched on, counted from 0"
    )]
    NoLight {
        /// The light asked for.
        light: usize,
        /// How many there are.
        lights: usize,
    },
    /// Transmittance or other values that are given do not fit the picture.
    #[error("what is given for the picture has {found} {of}, not {needed}")]
    Known {
        /// What is counted.
        of: &'static str,
        /// How many are given.
        found: usize,
        /// How many are needed.
        needed: usize,
    },
    /// Transmittance is given to the graphics card.
    #[error("transmittance that is given is drawn by the processor alone: choose the backend `cpu`")]
    KnownOnGpu,
}

impl From<lovelock_shadow::GpuShadowError> for RenderError {
    fn from(error: lovelock_shadow::GpuShadowError) -> Self {
        match error {
            lovelock_shadow::GpuShadowError::Shadow(error) => error.into(),
            lovelock_shadow::GpuShadowError::Gpu(error) => error.into(),
        }
    }
}
