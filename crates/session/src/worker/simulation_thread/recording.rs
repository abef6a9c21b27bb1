//! Recording a take on the simulation thread.

use std::sync::{Arc, PoisonError};

use lovelock_project::Project;
use lovelock_project::error::ProjectError;

use super::super::Event;
use super::SimulationThread;
use crate::take::TakeRecording;

impl SimulationThread {
    pub(super) fn start_take(&mut self, path: &std::path::Path) {
        if self.take.is_some() {
            let message = format!("{}: a take is being played; leave it to record another", path.display());
            return self.outbox.send(Event::TakeFailed { message });
        }
        self.end_take(None);
        self.finish_preroll();
        let (Some(engine), Some(project)) = (&self.engine, self.recorded_project()) else {
            let message = format!("{}: there is nothing to record yet", path.display());
            return self.outbox.send(Event::TakeFailed { message });
        };
        match TakeRecording::start(path, &project, engine) {
            Ok(recording) => self.recording = Some(recording),
            Err(error) => self.outbox.send(Event::TakeFailed { message: error.to_string() }),
        }
        self.publish_progress();
    }

    /// Completes the take that is being recorded, if any.
    pub(super) fn end_take(&mut self, because: Option<&str>) {
        let Some(recording) = self.recording.take() else { return };
        match recording.finish() {
            Ok(report) => self.outbox.send(Event::TakeSaved { report, because: because.map(str::to_owned) }),
            Err(error) => self.outbox.send(Event::TakeFailed { message: error.to_string() }),
        }
        self.publish_progress();
    }

    pub(super) fn record_step(&mut self) {
        let (Some(recording), Some(engine)) = (&mut self.recording, &self.engine) else { return };
        if let Err(error) = recording.push(engine) {
            self.fail_take(&error);
        }
        self.publish_progress();
    }

    /// Ends a take whose recording failed.
    pub(super) fn fail_take(&mut self, error: &ProjectError) {
        self.outbox.send(Event::TakeFailed { message: error.to_string() });
        // Keep what was written; if writing failed, the message said which part is kept.
        let ended = self.recording.take().map(TakeRecording::finish);
        if let Some(Ok(report)) = ended {
            self.outbox.send(Event::TakeSaved { report, because: Some(error.to_string()) });
        }
        self.publish_progress();
    }

    pub(super) fn record_change(&mut self) {
        let project = self.recorded_project();
        let (Some(recording), Some(project)) = (&mut self.recording, project) else { return };
        if let Err(error) = recording.change(&project) {
            self.outbox.send(Event::TakeFailed { message: error.to_string() });
        }
    }

    /// The project of the recorded frames: the current one, but with the scene of the last load.
    pub(super) fn recorded_project(&self) -> Option<Arc<Project>> {
        let project = self.project.as_ref()?;
        let Some(of) = &self.scene_of else { return Some(Arc::clone(project)) };
        if (&of.body, &of.motion, &of.hair) == (&project.body, &project.motion, &project.hair) {
            return Some(Arc::clone(project));
        }
        let Project { body, motion, hair, .. } = Project::clone(of);
        Some(Arc::new(Project { body, motion, hair, ..Project::clone(project) }))
    }

    pub(super) fn publish_progress(&self) {
        let progress = self.recording.as_ref().map(TakeRecording::progress);
        *self.shared.recorded.lock().unwrap_or_else(PoisonError::into_inner) = progress;
    }
}
