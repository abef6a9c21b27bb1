//! What the render thread does about failures of a renderer and of its device.

use std::sync::Arc;

use lovelock_render::{Backend, GpuError, RenderError};

use super::{Failure, RenderRequest, Worker};

/// Number of consecutive failures after which a graphics device is no longer reopened automatically.
pub(super) const MAX_FAILURES: u32 = 3;

impl Worker {
    /// Reports an error. Returns whether to render the request again.
    pub(super) fn take_error(&mut self, error: &RenderError, request: &RenderRequest) -> bool {
        let opened_on_window = self.opened.as_ref().and_then(|opened| opened.window.clone());
        if let Some(gpu) = opened_on_window.or_else(|| self.window.get()).filter(|gpu| gpu.is_lost()) {
            // The window opens another device and asks again. A loss that two images notice is one loss.
            self.opened = None;
            let known = self.lost.as_ref().is_some_and(|lost| lost.is_same_device(&gpu));
            if known && self.failures.latest().is_some_and(|last| last.pictures == self.images.number()) {
                return false;
            }
            // What failed first may not name the loss.
            self.fail(gpu.check().map_or_else(|loss| loss.to_string(), |()| error.to_string()));
            self.lost = Some(gpu);
            self.failed = self.failed.saturating_add(1);
            if self.failed >= MAX_FAILURES {
                self.give_up(request);
            }
            return false;
        }
        self.fail(error.to_string());
        device_is_gone(error) && self.try_again(request.project.picture.backend)
    }

    pub(super) fn fail(&self, message: String) {
        self.failures.put(Arc::new(Failure { message, pictures: self.images.number() }));
    }

    /// Closes the renderer after a failure. Returns whether to render the same request again.
    pub(super) fn try_again(&mut self, choice: Backend) -> bool {
        let by_processor = self.opened.take().is_some_and(|opened| opened.renderer.backend() == Backend::Cpu);
        self.failed = self.failed.saturating_add(1);
        if self.failed < MAX_FAILURES {
            return true;
        }
        if choice != Backend::Auto || self.card_given_up || by_processor {
            return false;
        }
        self.give_up_card();
        true
    }

    /// Stops using a card that is lost again and again with this request.
    fn give_up(&mut self, request: &RenderRequest) {
        match request.project.picture.backend {
            Backend::Auto => self.give_up_card(),
            _ => self.refused = Some(Arc::clone(&request.project)),
        }
        self.failed = 0;
    }

    fn give_up_card(&mut self) {
        self.card_given_up = true;
        self.notices.put(Arc::new(format!(
            "The graphics card failed {MAX_FAILURES} times in a row: the processor renders from now on. Choose \
             \"{}\" in Picture to try the card again.",
            Backend::Gpu.label()
        )));
    }
}

/// Whether the renderer must be opened again. Opening it again does not help if a shader does not compile, something does not
/// fit into memory, or there is no adapter.
fn device_is_gone(error: &RenderError) -> bool {
    match error {
        RenderError::Gpu(error) => {
            !matches!(error, GpuError::Shader(_) | GpuError::NoAdapter(_) | GpuError::Input(_))
        }
        _ => false,
    }
}
