//! One variant in motion.

use std::sync::Arc;

use lovelock_project::Project;
use lovelock_project::variants::adopt;
use lovelock_render::{Backend, DeviceImages, FrameInput, Gpu, Image, RenderError, Renderer, StrandCount};
use lovelock_session::engine::Engine;
use lovelock_session::scene::Scene;
use lovelock_session::window_device::WindowDevice;

use super::{WallCell, WallRequest};

/// The length of a simulated step, seconds: images of the wall are rarer than those of the window.
const STEP_SECS: f64 = 1.0 / 30.0;
/// Hair that is further behind than this many steps moves with the head instead of being simulated.
const MOST_STEPS: i64 = 12;

/// A variant, its simulation and its renderer.
pub(super) struct Cell {
    variant: Arc<Project>,
    /// The project with the variant's hair, and the project and variant that it was made from.
    shown: Option<(Arc<Project>, Arc<Project>)>,
    engine: Engine,
    /// Whether the hair has its rest shape and should be settled while time stands still.
    is_new: bool,
    renderer: Option<(Backend, Renderer)>,
    textures: Option<DeviceImages>,
}

impl Cell {
    /// A variant whose hair starts at rest.
    pub(super) fn new(variant: Arc<Project>, scene: Arc<Scene>) -> Self {
        let engine = Engine::at_rest(scene, variant.simulation, STEP_SECS);
        Self { variant, shown: None, engine, is_new: true, renderer: None, textures: None }
    }

    /// The variant that is shown.
    pub(super) fn variant(&self) -> &Arc<Project> {
        &self.variant
    }

    /// Shows another variant. Hair of the same layout goes on moving.
    pub(super) fn set(&mut self, variant: Arc<Project>, scene: Arc<Scene>) {
        self.is_new |= self.engine.set_scene(scene);
        self.variant = variant;
        self.shown = None;
    }

    /// Simulates up to the instant of the request.
    pub(super) fn advance(&mut self, request: &WallRequest) {
        self.engine.follow(&request.project);
        let wanted = (request.time_secs / STEP_SECS).round() as i64;
        let behind = wanted - (self.engine.time_secs() / STEP_SECS).round() as i64;
        if (0..=MOST_STEPS).contains(&behind) {
            self.engine.advance_to_step(wanted.max(0) as u64);
        } else {
            self.engine.seek(request.time_secs);
            self.is_new |= behind.abs() > MOST_STEPS;
        }
        if self.is_new && !request.playing {
            self.engine.settle();
        }
        self.is_new = false;
    }

    /// Renders the instant.
    pub(super) fn draw(&mut self, request: &WallRequest, window: &WindowDevice) -> WallCell {
        let (image, problem) = match self.image(request, window) {
            Ok(image) => (image, None),
            Err(error) => {
                // Opened again for the next round.
                self.renderer = None;
                (Image::default(), Some(error.to_string()))
            }
        };
        WallCell { variant: Arc::clone(&self.variant), image, time_secs: request.time_secs, problem }
    }

    fn image(&mut self, request: &WallRequest, window: &WindowDevice) -> Result<Image, RenderError> {
        let project = self.project(&request.project);
        let backend = project.picture.backend;
        let device = window.get().filter(|gpu| !gpu.is_lost());
        self.renderer.take_if(|(of, renderer)| *of != backend || is_elsewhere(renderer, device.as_ref()));
        let renderer = match &mut self.renderer {
            Some((_, renderer)) => renderer,
            none => &mut none.insert((backend, Renderer::open_for(backend, device.as_ref())?)).1,
        };
        let snapshot = self.engine.snapshot();
        let camera = snapshot.camera(&project.camera);
        let input = FrameInput { is_draft: request.playing, ..snapshot.frame_input(&project, &camera) };
        let textures = window.images(&mut self.textures);
        Ok(renderer.image(&input, request.size, false, textures)?.0)
    }

    /// The project with the hair of the variant.
    fn project(&mut self, base: &Arc<Project>) -> Arc<Project> {
        if let Some((of, project)) = &self.shown
            && Arc::ptr_eq(of, base)
        {
            return Arc::clone(project);
        }
        let mut project = (**base).clone();
        adopt(&mut project, &self.variant);
        // Images are small: a part of the strands fills them.
        project.picture.strands = StrandCount::default();
        let project = Arc::new(project);
        self.shown = Some((Arc::clone(base), Arc::clone(&project)));
        project
    }
}

/// Whether a renderer on a device is not on that of the window.
fn is_elsewhere(renderer: &Renderer, window: Option<&Arc<Gpu>>) -> bool {
    match (renderer.gpu(), window) {
        (Some(own), Some(window)) => own.is_lost() || own.device != window.device,
        (Some(own), None) => own.is_lost(),
        (None, _) => false,
    }
}
