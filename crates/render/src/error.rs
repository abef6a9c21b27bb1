//! Errors of rendering.

/// Why rendering failed.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The graphics device rejected a command or was lost.
    #[error(transparent)]
    Gpu(#[from] lovelock_gpu::GpuError),
    /// The shadow map would be too large.
    #[error(transparent)]
    Shadow(#[from] lovelock_shadow::ShadowError),
    /// The size is out of range.
    #[error(transparent)]
    Size(#[from] lovelock_picture::SizeError),
    /// An [`Interrupt`](crate::Interrupt) ended the picture.
    #[error("the image was ended early")]
    Interrupted,
    /// A picture was queried before one was rendered.
    #[error("no image has been rendered yet")]
    NoPicture,
    /// The last picture has no such light.
    #[error("there is no light {light}: the image has {lights} lights that are switched on, counted from 0")]
    NoLight {
        /// The index that was given.
        light: usize,
        /// The number of lights that are switched on.
        lights: usize,
    },
    /// The number of given values does not match the picture.
    #[error("the values given for the image have {found} {of}; {needed} are needed")]
    Known {
        /// What the values belong to.
        of: &'static str,
        /// The number that was given.
        found: usize,
        /// The number that is needed.
        needed: usize,
    },
}

impl From<lovelock_shadow::GpuShadowError> for RenderError {
    fn from(error: lovelock_shadow::GpuShadowError) -> Self {
        match error {
            lovelock_shadow::GpuShadowError::Shadow(error) => error.into(),
            lovelock_shadow::GpuShadowError::Gpu(error) => error.into(),
        }
    }
}

impl lovelock_base::Failure for RenderError {
    fn is_request(&self) -> bool {
        matches!(self, Self::Size(_))
    }
}
