//! Ends an image early.

use std::fmt;
use std::sync::Arc;

use crate::RenderError;

/// A question whether an image is of no use any more, such as that of an older input. It is asked from any thread, between stages and
/// before each tile.
#[derive(Clone)]
pub struct Interrupt(Arc<dyn Fn() -> bool + Send + Sync>);

impl Interrupt {
    /// An interrupt that ends an image once `is_due` returns true, which must take microseconds at most.
    pub fn new(is_due: impl Fn() -> bool + Send + Sync + 'static) -> Self {
        Self(Arc::new(is_due))
    }

    /// Whether the image must end.
    pub fn is_due(&self) -> bool {
        (self.0)()
    }
}

impl fmt::Debug for Interrupt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Interrupt")
    }
}

/// An error if the image must end.
pub(super) fn check(interrupt: Option<&Interrupt>) -> Result<(), RenderError> {
    if interrupt.is_some_and(Interrupt::is_due) { Err(RenderError::Interrupted) } else { Ok(()) }
}
