//! One variant in motion.

use std::sync::Arc;

use lovelock_project::Project;
use lovelock_project::variants::adopt;
use lovelock_render::{Backend, DeviceImages, FrameInput, Gpu, Image, RenderError, Renderer, StrandCount};

use super::{WallCell, WallRequest};
use crate::engine::Engine;
use crate::scene::Scene;
use crate::window_device::WindowDevice;

/// The length of a simulated step, seconds: images of the wall are rarer than those of the window.
const STEP_SECS: f64 = 1.0 / 30.0;
/// Hair that is further behind than this many steps moves with the head instead of being simulated.
const LONGEST_WAY: i64 = 30;
/// The most wisps of a variant: nine of them are simulated at once.
const MAX_WISPS: u32 = 80;
/// The most strands that a variant stores; they cast its shadows.
const MAX_STRANDS: u32 = 4_000;
/// The most segments of a strand.
const MAX_SEGMENTS: u32 = 20;
/// The strands that are drawn.
const DRAWN_STRANDS: f32 = 1_500.0;
/// The most cells along each edge of the voxel map, whose shadow hardly depends on it.
const MAX_VOXELS: u32 = 64;

/// Gives a variant as much hair and as fine a shadow as its small image needs.
pub(super) fn lighten(project: &mut Project) {
    project.picture.strands = StrandCount::Fixed;
    project.picture.strand_number = DRAWN_STRANDS;
    let map = &mut project.shadow.voxel_map;
    map.resolution = map.resolution.min(MAX_VOXELS);
    let groom = &mut project.hair.groom;
    groom.wisps = groom.wisps.min(MAX_WISPS);
    groom.segments_per_strand = groom.segments_per_strand.min(MAX_SEGMENTS);
    groom.strands_per_wisp = groom.strands_per_wisp.min(MAX_STRANDS / groom.wisps.max(1));
    let import = &mut project.hair.import;
    import.wisps = if import.wisps == 0 { MAX_WISPS } else { import.wisps.min(MAX_WISPS) };
}

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

    /// The memory of its hair, its renderer and its images, bytes.
    pub(super) fn bytes(&self) -> u64 {
        self.engine.bytes()
            + self.renderer.as_ref().map_or(0, |(_, renderer)| renderer.bytes())
            + self.textures.as_ref().map_or(0, DeviceImages::bytes)
    }

    /// Shows another variant. Hair of the same layout keeps moving.
    pub(super) fn set(&mut self, variant: Arc<Project>, scene: Arc<Scene>) {
        self.is_new |= self.engine.set_scene(scene);
        self.variant = variant;
        self.shown = None;
    }

    /// Simulates up to an instant of the scene, or moves there with the head if that is before or far behind.
    pub(super) fn advance(&mut self, request: &WallRequest, time_secs: f64) {
        self.engine.follow(&request.project);
        let wanted = (time_secs / STEP_SECS).round() as i64;
        let behind = wanted - (self.engine.time_secs() / STEP_SECS).round() as i64;
        if (0..=LONGEST_WAY).contains(&behind) {
            self.engine.advance_to_step(wanted.max(0) as u64);
        } else {
            self.engine.seek(time_secs);
            self.is_new = true;
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
        WallCell { variant: Arc::clone(&self.variant), image, time_secs: self.engine.time_secs(), problem }
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
        lighten(&mut project);
        let project = Arc::new(project);
        self.shown = Some((Arc::clone(base), Arc::clone(&project)));
        project
    }
}

/// Whether a renderer on a device is not on that of the window.
fn is_elsewhere(renderer: &Renderer, window: Option<&Arc<Gpu>>) -> bool {
    match (renderer.gpu(), window) {
        (Some(own), Some(window)) => own.is_lost() || !own.is_same_device(window),
        (Some(own), None) => own.is_lost(),
        (None, _) => false,
    }
}
