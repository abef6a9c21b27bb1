//! What an engine does, written down.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use lovelock_record::{
    FrameRate, TakeAsset, TakeFrame, TakeHeader, TakeReport, TakeWriter, hairstyle_fingerprint,
};

use crate::project::text_of_project;
use crate::{Engine, Project, Scene, StudioError};

/// How far the recording of a take is.
#[derive(Clone, Debug, PartialEq)]
pub struct TakeProgress {
    /// The take's name when it is finished.
    pub path: PathBuf,
    /// Frames recorded.
    pub frames: u64,
    /// Frames that are on the disk, whatever happens now.
    pub kept: u64,
    /// Seconds recorded.
    pub secs: f64,
}

/// A take in the making: every step of an engine, and the project as it changes.
pub struct TakeRecording {
    writer: TakeWriter,
    frame: TakeFrame,
    step_secs: f64,
    project: Arc<Project>,
}

impl TakeRecording {
    /// Starts a take at `path` with the instant that `engine` is at.
    ///
    /// # Errors
    /// Where another recording writes it, the file cannot be made, or the scene has no hair.
    pub fn start(path: &Path, project: &Arc<Project>, engine: &Engine) -> Result<Self, StudioError> {
        let scene = engine.scene();
        let guides = &scene.style.guides;
        if guides.count() == 0 {
            return Err(StudioError::work(format!("{}: there is no hair to record", path.display())));
        }
        // Files that cannot be read are not in the scene either: the loader has said so.
        let assets = project
            .files()
            .into_iter()
            .filter_map(|(place, file)| TakeAsset::of_file(place.label(), &file.path).ok());
        let rate = 1.0 / engine.step_secs();
        let header = TakeHeader {
            program: concat!("lovelock ", env!("CARGO_PKG_VERSION")).to_owned(),
            frames_per_second: FrameRate::from_fps(rate).map_err(StudioError::option)?,
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
            project: Arc::clone(project),
        };
        recording.push(engine)?;
        Ok(recording)
    }

    /// The next instants are of `scene`, whose hair may have other guides. Returns whether it has any.
    ///
    /// # Errors
    /// More guides than a take can hold; the disk refused an earlier frame.
    pub fn set_scene(&mut self, scene: &Scene) -> Result<bool, StudioError> {
        let guides = &scene.style.guides;
        if guides.count() > 0 {
            self.writer.set_layout(guides.count(), guides.points_per_guide)?;
        }
        Ok(guides.count() > 0)
    }

    /// Adds the instant that `engine` is at.
    ///
    /// # Errors
    /// The disk refused an earlier frame; what is kept stays.
    pub fn push(&mut self, engine: &Engine) -> Result<(), StudioError> {
        engine.take_frame(&mut self.frame);
        Ok(self.writer.push(&self.frame)?)
    }

    /// The project is another one from the next frame on.
    ///
    /// # Errors
    /// A project that no take can hold.
    pub fn change(&mut self, project: &Arc<Project>) -> Result<(), StudioError> {
        if !same_but_tracks(project, &self.project) {
            self.project = Arc::clone(project);
            self.writer.change(&text_of(self.writer.path(), project)?)?;
        }
        Ok(())
    }

    /// How far it is.
    pub fn progress(&self) -> TakeProgress {
        let frames = self.writer.frames();
        TakeProgress {
            path: self.writer.path().to_owned(),
            frames,
            kept: self.writer.kept_frames(),
            secs: frames as f64 * self.step_secs,
        }
    }

    /// Makes the take whole and gives it its name.
    ///
    /// # Errors
    /// The disk refused; what is kept stays in the unfinished file, which plays too.
    pub fn finish(self) -> Result<TakeReport, StudioError> {
        Ok(self.writer.finish()?)
    }

    /// Stops and removes what was written.
    ///
    /// # Errors
    /// Where it cannot be removed.
    pub fn discard(self) -> Result<(), StudioError> {
        Ok(self.writer.discard()?)
    }
}

/// Whether two projects are the same but for their tracks, which grow with every frame while they are written and are not
/// of the simulation.
fn same_but_tracks(a: &Project, b: &Project) -> bool {
    if a.timeline.tracks == b.timeline.tracks {
        return a == b;
    }
    let without = |project: &Project| {
        let mut project = project.clone();
        project.timeline.tracks.clear();
        project
    };
    without(a) == without(b)
}

/// A project as a take at `path` holds it: one that plays no take itself.
fn text_of(path: &Path, project: &Project) -> Result<String, StudioError> {
    let mut project = project.clone();
    project.take.file = None;
    text_of_project(path, &project).map_err(|error| {
        StudioError::output(
            path,
            format!("{}: the project cannot be written as text: {error}", path.display()),
        )
    })
}
