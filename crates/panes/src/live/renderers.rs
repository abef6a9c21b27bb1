//! What draws the panes: a renderer each, on one device for all that use it.

use std::sync::Arc;

use lovelock_project::project::Contender;
use lovelock_render::{Backend, Gpu, GpuError, RenderError, Renderer};

/// How often in a row a pane may break the graphics device before it is no more drawn there.
const MOST_FAILURES: u32 = 3;

/// Opens what draws on the backend that was chosen.
pub(super) type Open = Box<dyn FnMut(Backend) -> Result<Renderer, RenderError> + Send>;

/// What becomes of the panes when what draws one broke.
pub(super) struct Broken {
    /// Whether to draw again by itself.
    pub(super) try_again: bool,
    /// What the user should know: what is not drawn on the graphics card from now on.
    pub(super) notice: Option<String>,
}

/// A renderer a pane, so that none forgets its maps while another draws.
pub(super) struct Renderers {
    open: Open,
    panes: Vec<Option<Renderer>>,
    /// The device that all panes on the graphics card draw on.
    gpu: Option<Arc<Gpu>>,
    /// What [`Backend::Auto`] turned out to be.
    auto: Option<Backend>,
    /// What each pane is, with its own failures of the device in a row: a pane that works says nothing of another.
    failed: Vec<(Contender, u32)>,
}

impl Renderers {
    /// Renderers that `open` opens.
    pub(super) fn new(open: Open) -> Self {
        Self { open, panes: Vec::new(), gpu: None, auto: None, failed: Vec::new() }
    }

    /// The renderer of a pane, opened where there is none for that choice.
    ///
    /// # Errors
    /// No adapter for [`Backend::Gpu`], one that cannot be used, or one that failed again and again with this pane.
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
        if choice == Backend::Gpu && self.failed[pane].1 >= MOST_FAILURES {
            let sentence =
                "this pane broke the graphics device again and again: change its settings to try again";
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
        if !self.panes[pane].as_ref().is_some_and(fits) {
            // The old one first: two do not fit where one does.
            self.panes[pane] = None;
            let opened = match (&self.gpu, wanted) {
                (Some(gpu), Backend::Gpu) => Renderer::on_device(Arc::clone(gpu))?,
                _ => (self.open)(wanted)?,
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
            None => unreachable!("a renderer that was just put there"),
        }
    }

    /// The renderer of a pane as it was left by its last picture.
    pub(super) fn last(&mut self, pane: usize) -> Option<&mut Renderer> {
        self.panes.get_mut(pane)?.as_mut()
    }

    /// A pane was drawn.
    pub(super) fn worked(&mut self, pane: usize) {
        if self.last(pane).is_some_and(|renderer| renderer.backend() == Backend::Gpu)
            && let Some(failed) = self.failed.get_mut(pane)
        {
            failed.1 = 0;
        }
    }

    /// What drew a pane broke: everything on its device is closed.
    pub(super) fn broke(&mut self, pane: usize) -> Broken {
        let by_card = self.last(pane).is_none_or(|renderer| renderer.backend() == Backend::Gpu);
        if let Some(slot) = self.panes.get_mut(pane) {
            *slot = None;
        }
        if !by_card {
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
        let notice = (*failed == MOST_FAILURES).then(|| {
            let what = if contender.backend == Backend::Gpu {
                format!("pane {} is not drawn there any more", pane + 1)
            } else {
                self.auto = Some(Backend::Cpu);
                "the processor draws what it may from now on".to_owned()
            };
            format!("The graphics card failed {MOST_FAILURES} times in a row: {what}.")
        });
        // After the last failure once more, for the panes that lost their device with this one.
        Broken { try_again: *failed <= MOST_FAILURES, notice }
    }

    /// Forgets the renderers of panes that are no more.
    pub(super) fn keep(&mut self, panes: usize) {
        self.panes.truncate(panes);
        self.failed.truncate(panes);
    }
}

/// Whether what draws must be opened again: see the drawing thread of the window's single picture.
pub(super) fn device_is_gone(error: &RenderError) -> bool {
    match error {
        RenderError::Gpu(error) => {
            !matches!(error, GpuError::Shader(_) | GpuError::NoAdapter(_) | GpuError::Input(_))
        }
        _ => false,
    }
}
