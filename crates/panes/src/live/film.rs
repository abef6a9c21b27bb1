//! Frames of a film of panes.

use std::sync::Arc;

use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_project::files::Access;
use lovelock_render::{Picture, Renderer};
use lovelock_session::snapshot::FrameSnapshot;
use lovelock_session::window_device::WindowDevice;

use super::renderers::Renderers;
use super::round::Rounds;
use crate::request::LiveRequest;
use crate::sheet::Sheet;

/// Renders all panes of a frame and composes them.
pub struct FilmOfPanes {
    rounds: Rounds,
    sheet: Sheet,
    project: Arc<Project>,
    access: Access,
}

impl FilmOfPanes {
    /// For the panes of `project`, composed by `sheet`, with takes that `access` allows.
    pub fn new(project: &Project, sheet: Sheet, access: Access) -> Self {
        let rounds = Rounds::new(Renderers::new(Box::new(Renderer::open_for), WindowDevice::default()));
        Self { rounds, sheet, project: Arc::new(project.clone()), access }
    }

    /// Renders one frame of `project`, in which tracks are already applied. Returns the names of the devices.
    ///
    /// # Errors
    /// If no pane can be rendered. A single pane that fails shows the reason in its rectangle.
    pub fn frame(
        &mut self,
        project: &Project,
        snapshot: &Arc<FrameSnapshot>,
        whole: [u32; 2],
        picture: &mut Picture,
    ) -> Result<Vec<String>, ProjectError> {
        if *self.project != *project {
            self.project = Arc::new(project.clone());
        }
        let panes = self.sheet.panes(self.project.compare.panes.len());
        let [width, height] = self.sheet.pane_size(panes.len(), whole);
        let request = LiveRequest {
            project: Arc::clone(&self.project),
            access: self.access.clone(),
            snapshot: Arc::clone(snapshot),
            panes,
            width,
            height,
            together: true,
            view: self.sheet.view,
            probe: None,
        };
        self.rounds.begin(&request);
        let mut drawn = Vec::new();
        for &index in &request.panes {
            // Reopen a lost device, as often as the thread for the window does.
            let mut pane = self.rounds.pane(&request, index);
            while pane.1.as_ref().is_some_and(|broken| broken.try_again) {
                pane = self.rounds.pane(&request, index);
            }
            drawn.push((index, pane.0));
        }
        if let Some((_, first)) = drawn.first()
            && drawn.iter().all(|(_, pane)| pane.problem.is_some())
        {
            return Err(ProjectError::work(first.problem.clone().unwrap_or_default()));
        }
        let shown: Vec<_> = drawn.iter().map(|(index, pane)| (*index, pane, pane.times.whole)).collect();
        *picture = self.sheet.compose(&shown, whole);
        let mut adapters: Vec<String> = drawn.into_iter().map(|(_, pane)| pane.adapter.name).collect();
        adapters.dedup();
        Ok(adapters)
    }
}
