//! Renders the frames of a recording: the project's image, or panes beside each other.

use std::sync::Arc;

use lovelock_base::clock::Stopwatch;
use lovelock_panes::live::FilmOfPanes;
use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_render::{FrameStats, Layers, PendingPicture, Picture, Renderer};
use lovelock_session::prepare::open_renderer;
use lovelock_session::snapshot::FrameSnapshot;

use super::request::RecordRequest;

/// The error for unsupported settings of panes.
pub(super) const PANES_ALONE: &str = "panes side by side can only be recorded as a film or PNG files, without a transparent \
                                      background, motion blur or depth of field: switch those off, or record the single image";

/// Renders the frames of a recording.
pub(super) enum Drawer {
    /// The project's image.
    One(Box<Renderer>),
    /// Panes, and the names of the devices that rendered them last.
    Panes(Box<FilmOfPanes>, String),
}

impl Drawer {
    /// Opens the renderer for `project`.
    ///
    /// # Errors
    /// If there is no adapter for the requested backend, or it cannot be used.
    pub(super) fn open(project: &Project, request: &RecordRequest) -> Result<Self, ProjectError> {
        if let Some(sheet) = &request.panes {
            let panes = Box::new(FilmOfPanes::new(project, sheet.clone(), request.access.clone()));
            return Ok(Self::Panes(panes, String::new()));
        }
        let choice = request.backend.unwrap_or(project.picture.backend);
        Ok(Self::One(Box::new(open_renderer(choice, request.gpu.as_ref())?)))
    }

    /// Renders a frame.
    ///
    /// # Errors
    /// If the size is out of range, the shadow needs too much memory, or the device is lost.
    pub(super) fn picture(
        &mut self,
        project: &Project,
        snapshot: &Arc<FrameSnapshot>,
        [width, height]: [u32; 2],
        picture: &mut Picture,
    ) -> Result<FrameStats, ProjectError> {
        match self {
            Self::One(renderer) => {
                let camera = snapshot.camera(&project.camera);
                let input = snapshot.frame_input(project, &camera);
                Ok(renderer.picture(&input, width, height, picture)?)
            }
            Self::Panes(panes, adapters) => {
                let watch = Stopwatch::start();
                *adapters = panes.frame(project, snapshot, [width, height], picture)?.join(", ");
                Ok(FrameStats { draw_ms: watch.ms(), ..FrameStats::default() })
            }
        }
    }

    /// Whether frames can be begun before the one before is finished.
    pub(super) fn begins(&self) -> bool {
        matches!(self, Self::One(renderer) if renderer.gpu().is_some())
    }

    /// Starts to render a frame without waiting for it; `None` where frames are rendered at once.
    ///
    /// # Errors
    /// As [`Drawer::picture`].
    pub(super) fn begin(
        &mut self,
        project: &Project,
        snapshot: &Arc<FrameSnapshot>,
        [width, height]: [u32; 2],
    ) -> Result<Option<PendingPicture>, ProjectError> {
        let Self::One(renderer) = self else { return Ok(None) };
        let camera = snapshot.camera(&project.camera);
        Ok(renderer.begin_picture(&snapshot.frame_input(project, &camera), width, height)?)
    }

    /// Finishes a frame that was begun with the same project, snapshot and size.
    ///
    /// # Errors
    /// As [`Drawer::picture`].
    pub(super) fn finish(
        &mut self,
        pending: PendingPicture,
        (project, snapshot): (&Project, &Arc<FrameSnapshot>),
        size: [u32; 2],
        picture: &mut Picture,
    ) -> Result<FrameStats, ProjectError> {
        if let Self::One(renderer) = self {
            let camera = snapshot.camera(&project.camera);
            let input = snapshot.frame_input(project, &camera);
            if let Some(stats) = renderer.finish_picture(pending, &input, picture)? {
                return Ok(stats);
            }
        }
        self.picture(project, snapshot, size, picture)
    }

    /// Renders the layers of a frame, with or without background.
    ///
    /// # Errors
    /// As [`Drawer::picture`]; panes have no layers.
    pub(super) fn layers(
        &mut self,
        project: &Project,
        snapshot: &Arc<FrameSnapshot>,
        [width, height]: [u32; 2],
        over_background: bool,
        layers: &mut Layers,
    ) -> Result<FrameStats, ProjectError> {
        match self {
            Self::One(renderer) => {
                let camera = snapshot.camera(&project.camera);
                let input = snapshot.frame_input(project, &camera);
                Ok(renderer.layers(&input, width, height, over_background, layers)?)
            }
            Self::Panes(..) => Err(ProjectError::option(PANES_ALONE)),
        }
    }

    /// Renders a sample of a lens: the layers of its first sample, and the light of the others.
    ///
    /// # Errors
    /// As [`Drawer::layers`].
    pub(super) fn lens_sample(
        &mut self,
        project: &Project,
        snapshot: &Arc<FrameSnapshot>,
        [width, height]: [u32; 2],
        (over_background, index, with_values): (bool, u32, bool),
        layers: &mut Layers,
    ) -> Result<FrameStats, ProjectError> {
        match self {
            Self::One(renderer) => {
                let camera = snapshot.camera(&project.camera);
                let lens = snapshot.lens(&project.camera, &camera);
                let camera = lens.map_or(camera, |lens| lens.camera(&camera, index));
                let input = snapshot.frame_input(project, &camera);
                Ok(if with_values {
                    renderer.layers(&input, width, height, over_background, layers)?
                } else {
                    renderer.light(&input, width, height, over_background, layers)?
                })
            }
            Self::Panes(..) => Err(ProjectError::option(PANES_ALONE)),
        }
    }

    /// The renderer, as far as pixels depend on it: the CPU gives the same result on any machine.
    pub(super) fn kind(&self) -> String {
        match self {
            Self::One(renderer) if renderer.gpu().is_none() => "cpu".to_owned(),
            Self::One(renderer) => renderer.adapter().to_owned(),
            Self::Panes(..) => "panes".to_owned(),
        }
    }

    /// `gpu` or `cpu`; `panes` if each pane has its own.
    pub(super) fn backend(&self) -> String {
        match self {
            Self::One(renderer) => renderer.backend().to_string(),
            Self::Panes(..) => "panes".to_owned(),
        }
    }

    /// The names of the rendering devices.
    pub(super) fn adapter(&self) -> &str {
        match self {
            Self::One(renderer) => renderer.adapter(),
            Self::Panes(_, adapters) => adapters,
        }
    }
}
