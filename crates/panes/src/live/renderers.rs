//! The renderers of panes: one per pane, sharing one GPU device.

use std::sync::Arc;

use lovelock_project::project::Contender;
use lovelock_render::{Backend, Gpu, GpuError, RenderError, Renderer};
use lovelock_session::window_device::WindowDevice;

/// Number of consecutive device failures by a pane after which it is no longer rendered on the GPU.
const MAX_FAILURES: u32 = 3;

/// Opens a renderer on the chosen backend, on the window's device if that is one.
pub(super) type Open = Box<dyn FnMut(Backend, Option<&Arc<Gpu>>) -> Result<Renderer, RenderError> + Send>;

/// The consequences of a renderer's failure.
pub(super) struct Broken {
    /// Whether to render again without a new request.
    pub(super) try_again: bool,
    /// A notice for the user about panes that are no longer rendered on the GPU.
    pub(super) notice: Option<String>,
}

/// One renderer per pane, so that each keeps its maps while another one renders.
pub(super) struct Renderers {
    open: Open,
    pub(super) window: WindowDevice,
    panes: Vec<Option<Renderer>>,
    /// The device that all panes on the GPU share.
    gpu: Option<Arc<Gpu>>,
    /// The backend that [`Backend::Auto`] selected.
    auto: Option<Backend>,
    /// The settings of each pane with its number of consecutive device failures, which is counted per pane.
    failed: Vec<(Contender, u32)>,
}

impl Renderers {
    /// Renderers from `open`, on the device of `window` where possible.
    pub(super) fn new(open: Open, window: WindowDevice) -> Self {
        Self { open, window, panes: Vec::new(), gpu: None, auto: None, failed: Vec::new() }
    }

    /// The renderer of a pane; opened if there is none for its backend.
    ///
    /// # Errors
    /// If there is no adapter for [`Backend::Gpu`], it cannot be used, or it failed repeatedly with this pane.
    pub(super) fn of_pane(
        &mut self,
        pane: usize,
        contender: &Contender,
    ) -> Result<&mut Renderer, RenderError> {
        let choice = contender.backend;
        if self.failed.len() <= pane {
            self.failed.resize_with(pane + 1, || (contender.clone(), 0));
        }
        if self.failed[pane].0 != *contender {
            self.failed[pane] = (contender.clone(), 0);
        }
        if choice == Backend::Gpu && self.failed[pane].1 >= MAX_FAILURES {
            let sentence =
                "this pane made the graphics device fail repeatedly: change its settings to try again";
            return Err(GpuError::Input(sentence.to_owned()).into());
        }
        let wanted = match choice {
            Backend::Auto => self.auto.unwrap_or(Backend::Auto),
            chosen => chosen,
        };
        if self.panes.len() <= pane {
            self.panes.resize_with(pane + 1, || None);
        }
        let fits = |renderer: &Renderer| match wanted {
            Backend::Auto => false,
            wanted => renderer.backend() == wanted,
        };
        let window = self.window.get();
        self.close_lost();
        if !self.panes[pane].as_ref().is_some_and(fits) {
            // Drop the old one first, because two may not fit into memory.
            self.panes[pane] = None;
            let opened = match (&self.gpu, wanted) {
                (Some(gpu), Backend::Gpu) => Renderer::on_device(gpu)?,
                _ => (self.open)(wanted, window.as_ref())?,
            };
            if choice == Backend::Auto {
                self.auto = Some(opened.backend());
            }
            if let Some(gpu) = opened.gpu() {
                self.gpu = Some(Arc::clone(gpu));
            }
            self.panes[pane] = Some(opened);
        }
        match &mut self.panes[pane] {
            Some(renderer) => Ok(renderer),
            None => unreachable!("the renderer was just stored"),
        }
    }

    /// Closes all renderers, and forgets their device and its failures.
    pub(super) fn close(&mut self) {
        (self.panes, self.failed, self.gpu) = (Vec::new(), Vec::new(), None);
    }

    /// The memory that the renderers keep, bytes.
    pub(super) fn bytes(&self) -> u64 {
        self.panes.iter().flatten().map(Renderer::bytes).sum()
    }

    /// Closes the renderers whose device is lost.
    fn close_lost(&mut self) {
        self.gpu.take_if(|gpu| gpu.is_lost());
        for pane in &mut self.panes {
            pane.take_if(|renderer| renderer.gpu().is_some_and(|gpu| gpu.is_lost()));
        }
    }

    /// The renderer of a pane in the state after its last image.
    pub(super) fn last(&mut self, pane: usize) -> Option<&mut Renderer> {
        self.panes.get_mut(pane)?.as_mut()
    }

    /// Records that a pane was rendered.
    pub(super) fn worked(&mut self, pane: usize) {
        if self.last(pane).is_some_and(|renderer| renderer.backend() == Backend::Gpu)
            && let Some(failed) = self.failed.get_mut(pane)
        {
            failed.1 = 0;
        }
    }

    /// Handles a failure of a pane's renderer: closes all renderers on its device.
    pub(super) fn broke(&mut self, pane: usize) -> Broken {
        let by_card = self.last(pane).is_none_or(|renderer| renderer.backend() == Backend::Gpu);
        if let Some(slot) = self.panes.get_mut(pane) {
            *slot = None;
        }
        if !by_card {
            return Broken { try_again: false, notice: None };
        }
        if self.window.get().is_some_and(|gpu| gpu.is_lost()) {
            // The window opens another device and repeats the request: the pane has not failed.
            self.close_lost();
            return Broken { try_again: false, notice: None };
        }
        for slot in &mut self.panes {
            if slot.as_ref().is_some_and(|renderer| renderer.backend() == Backend::Gpu) {
                *slot = None;
            }
        }
        self.gpu = None;
        if self.auto == Some(Backend::Gpu) {
            self.auto = None;
        }
        let Some((contender, failed)) = self.failed.get_mut(pane) else {
            return Broken { try_again: false, notice: None };
        };
        *failed = failed.saturating_add(1);
        let notice = (*failed == MAX_FAILURES).then(|| {
            let what = if contender.backend == Backend::Gpu {
                format!("pane {} is no longer rendered there", pane + 1)
            } else {
                self.auto = Some(Backend::Cpu);
                "the processor renders these panes from now on if their settings allow it".to_owned()
            };
            format!("The graphics card failed {MAX_FAILURES} times in a row: {what}.")
        });
        // Once more after the last failure, for the panes that lost the device because of this one.
        Broken { try_again: *failed <= MAX_FAILURES, notice }
    }

    /// Drops the renderers of removed panes.
    pub(super) fn keep(&mut self, panes: usize) {
        self.panes.truncate(panes);
        self.failed.truncate(panes);
    }
}

/// Whether the renderer must be opened again; see the render thread of the session crate.
pub(super) fn device_is_gone(error: &RenderError) -> bool {
    match error {
        RenderError::Gpu(error) => {
            !matches!(error, GpuError::Shader(_) | GpuError::NoAdapter(_) | GpuError::Input(_))
        }
        _ => false,
    }
}
