//! Recording a simulation as a take.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use lovelock_project::Project;
use lovelock_project::error::{Place, ProjectError};
use lovelock_project::project::text_of_project;
use lovelock_project::tracks::{MORPH_TARGET, STACK_TARGET};
use lovelock_record::{
    FrameRate, TakeAsset, TakeFrame, TakeHeader, TakeReport, TakeWriter, hairstyle_fingerprint,
};

use crate::engine::Engine;
use crate::scene::Scene;

/// Progress of the recording of a take.
#[derive(Clone, Debug, PartialEq)]
pub struct TakeProgress {
    /// The final path of the take.
    pub path: PathBuf,
    /// Number of recorded frames.
    pub frames: u64,
    /// Number of frames that are safely on disk.
    pub kept: u64,
    /// Recorded time, seconds.
    pub secs: f64,
    /// Time of the timeline at which the recording began, seconds.
    pub from_secs: f64,
}

/// A take that is being recorded: every step of an engine, and the changes of the project.
pub struct TakeRecording {
    writer: TakeWriter,
    frame: TakeFrame,
    step_secs: f64,
    from_secs: f64,
    project: Arc<Project>,
}

impl TakeRecording {
    /// Starts a take at `path` with the current instant of `engine`.
    ///
    /// # Errors
    /// If another recording writes the file, it cannot be created, or the scene has no hair.
    pub fn start(path: &Path, project: &Arc<Project>, engine: &Engine) -> Result<Self, ProjectError> {
        let scene = engine.scene();
        let guides = &scene.style.guides;
        if guides.count() == 0 {
            return Err(ProjectError::work(format!("{}: there is no hair to record", path.display())));
        }
        // Files that cannot be read are not part of the scene; the loader has reported them.
        let assets = project
            .files()
            .into_iter()
            // A take records no light.
            .filter(|(place, _)| !matches!(place, Place::Surroundings | Place::Backdrop))
            .filter_map(|(place, file)| TakeAsset::of_file(place.label(), &file.path).ok());
        let rate = 1.0 / engine.step_secs();
        let header = TakeHeader {
            program: concat!("lovelock ", env!("CARGO_PKG_VERSION")).to_owned(),
            frames_per_second: FrameRate::from_fps(rate).map_err(ProjectError::option)?,
            guides: guides.count() as u32,
            points_per_guide: guides.points_per_guide as u32,
            strands: scene.style.strands.count() as u32,
            hairstyle: hairstyle_fingerprint(&scene.style),
            project: text_of(path, project)?,
            assets: assets.collect(),
            seed: u64::from(project.hair.groom.seed),
            clip: scene.clip.as_ref().map_or_else(String::new, |clip| clip.name.clone()),
            clip_secs: scene.clip.as_ref().map_or(0.0, |clip| clip.duration_secs),
            start_secs: engine.time_secs(),
            ..TakeHeader::default()
        };
        let mut recording = Self {
            writer: TakeWriter::create(path, header)?,
            frame: TakeFrame::default(),
            step_secs: engine.step_secs(),
            from_secs: engine.position_secs(),
            project: Arc::clone(project),
        };
        recording.push(engine)?;
        Ok(recording)
    }

    /// Sets the scene of the next frames, whose hair may have other guides. Returns whether it has any hair.
    ///
    /// # Errors
    /// If there are more guides than a take can hold, or an earlier frame could not be written.
    pub fn set_scene(&mut self, scene: &Scene) -> Result<bool, ProjectError> {
        let guides = &scene.style.guides;
        if guides.count() > 0 {
            self.writer.set_layout(guides.count(), guides.points_per_guide)?;
        }
        Ok(guides.count() > 0)
    }

    /// Adds the current instant of `engine`.
    ///
    /// # Errors
    /// If an earlier frame could not be written; the written frames stay.
    pub fn push(&mut self, engine: &Engine) -> Result<(), ProjectError> {
        engine.take_frame(&mut self.frame);
        Ok(self.writer.push(&self.frame)?)
    }

    /// Records a change of the project from the next frame on.
    ///
    /// # Errors
    /// If a take cannot hold the project.
    pub fn change(&mut self, project: &Arc<Project>) -> Result<(), ProjectError> {
        if !same_but_tracks(project, &self.project) {
            self.project = Arc::clone(project);
            self.writer.change(&text_of(self.writer.path(), project)?)?;
        }
        Ok(())
    }

    /// Current progress.
    pub fn progress(&self) -> TakeProgress {
        let frames = self.writer.frames();
        TakeProgress {
            path: self.writer.path().to_owned(),
            frames,
            kept: self.writer.kept_frames(),
            secs: frames as f64 * self.step_secs,
            from_secs: self.from_secs,
        }
    }

    /// Completes the take and renames it to its final name.
    ///
    /// # Errors
    /// If writing fails; the written frames stay in the unfinished file, which can be played as well.
    pub fn finish(self) -> Result<TakeReport, ProjectError> {
        Ok(self.writer.finish()?)
    }

    /// Stops and removes the file.
    ///
    /// # Errors
    /// If it cannot be removed.
    pub fn discard(self) -> Result<(), ProjectError> {
        Ok(self.writer.discard()?)
    }
}

/// Whether two projects are equal except for their tracks, which change at every frame while they are written and do not affect
/// a recorded simulation; those of layers change the strands that follow its guides.
fn same_but_tracks(a: &Project, b: &Project) -> bool {
    if a.timeline.tracks == b.timeline.tracks {
        return a == b;
    }
    let without = |project: &Project| {
        let mut project = project.clone();
        project
            .timeline
            .tracks
            .retain(|track| track.target.starts_with(STACK_TARGET) || track.target == MORPH_TARGET);
        project
    };
    without(a) == without(b)
}

/// The text of a project in a take at `path`. The project itself plays no take.
fn text_of(path: &Path, project: &Project) -> Result<String, ProjectError> {
    let mut project = project.clone();
    project.take.file = None;
    text_of_project(path, &project).map_err(|error| {
        ProjectError::output(
            path,
            format!("{}: the project cannot be written as text: {error}", path.display()),
        )
    })
}
