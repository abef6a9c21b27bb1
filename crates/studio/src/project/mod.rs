//! The project: everything that is saved and undone.
//!
//! Plain structs, one a section. Every section keeps the values of all its alternatives, so that switching
//! loses nothing. In memory file paths are absolute; on disk they are relative to the project's folder where
//! they lie in it (see [`load_project`] and [`save_project`]).

mod file;
mod generic;
mod path;
mod sanitise;
mod sections;
mod trim;

use lovelock_render::{Light, PictureSettings, ShadowSettings};
use lovelock_simulation::SimulationSettings;
use serde::{Deserialize, Serialize};

pub use file::{
    PROJECT_EXTENSION, load_project, load_project_with, parse_project, save_project, write_whole,
};
pub(crate) use file::{project_of_text, text_of_project};
pub use path::{Access, FileRef};
pub use sections::{
    BodySection, BodySource, CameraMode, CameraSection, CompareSection, HairSection, HairSource, Marker,
    MotionSection, MotionSource, RecordingSection, TakeSection, TimelineSection,
};

use lovelock_groom::{GroomSettings, HairLook, Haircut, Preset};

/// Version of the project file that this program writes, and the newest that it reads.
pub const PROJECT_VERSION: u32 = 1;

/// Everything that is saved and undone.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Project {
    /// Version of the file, [`PROJECT_VERSION`].
    pub version: u32,
    /// The body that dances.
    pub body: BodySection,
    /// How it dances.
    pub motion: MotionSection,
    /// The hairstyle.
    pub hair: HairSection,
    /// Colour and width of the hair.
    pub look: HairLook,
    /// How the hair moves.
    pub simulation: SimulationSettings,
    /// How the hair shadows itself.
    pub shadow: ShadowSettings,
    /// The lights, at most [`lovelock_render::MAX_LIGHTS`].
    pub lights: Vec<Light>,
    /// Where the picture is taken from.
    pub camera: CameraSection,
    /// Settings of the picture as a whole.
    pub picture: PictureSettings,
    /// What a recording is.
    pub recording: RecordingSection,
    /// What is compared beside each other.
    pub compare: CompareSection,
    /// A recorded simulation that plays.
    pub take: TakeSection,
    /// What stands on the timeline.
    pub timeline: TimelineSection,
}

impl Default for Project {
    fn default() -> Self {
        Self {
            version: PROJECT_VERSION,
            body: BodySection::default(),
            motion: MotionSection::default(),
            hair: HairSection::default(),
            look: GroomSettings::preset(Preset::Smooth).look,
            simulation: SimulationSettings::default(),
            shadow: ShadowSettings::default(),
            lights: Light::default_rig(),
            camera: CameraSection::default(),
            picture: PictureSettings::default(),
            recording: RecordingSection::default(),
            compare: CompareSection::default(),
            take: TakeSection::default(),
            timeline: TimelineSection::default(),
        }
    }
}

impl Project {
    /// Takes a shipped hairstyle with its colours, its ties and, where nobody has chosen others, its stiffness.
    pub fn set_preset(&mut self, preset: Preset) {
        self.change_hair(HairSource::Grown, preset);
        self.hair.groom = GroomSettings::preset(preset);
        self.look = self.hair.groom.look;
        self.hair.ties = preset.ties().to_vec();
        // Other hair is not cut.
        self.hair.cut = Haircut::default();
    }

    /// Takes the hair file again that was picked before, or the style that is grown.
    pub fn set_hair_source(&mut self, source: HairSource) {
        self.change_hair(source, self.hair.preset);
    }

    /// Other hair, and how it moves where it moved as that before.
    fn change_hair(&mut self, source: HairSource, preset: Preset) {
        let before = self.hair.simulation();
        (self.hair.source, self.hair.preset) = (source, preset);
        self.simulation = self.simulation.restyled(&before, &self.hair.simulation());
    }

    /// Takes a hair file, which the user picked.
    pub fn set_hair_file(&mut self, path: impl Into<std::path::PathBuf>) {
        self.set_hair_source(HairSource::File);
        self.hair.file = Some(FileRef::new(path));
    }

    /// Takes a character file, which the user picked, with its first clip.
    pub fn set_body_file(&mut self, path: impl Into<std::path::PathBuf>) {
        self.body.source = BodySource::File;
        self.body.file = Some(FileRef::new(path));
        self.body.head_joint = None;
        if self.motion.source == MotionSource::Clip {
            self.motion.clip.clear();
        }
    }

    /// Takes a motion file, which the user picked.
    pub fn set_motion_file(&mut self, path: impl Into<std::path::PathBuf>) {
        self.motion.source = MotionSource::File;
        self.motion.file = Some(FileRef::new(path));
    }

    /// Plays a take, which the user picked.
    pub fn set_take(&mut self, path: impl Into<std::path::PathBuf>) {
        self.take.file = Some(FileRef::new(path));
    }

    /// Every file that the project names and uses, with the part that uses it.
    pub fn files(&self) -> Vec<(crate::Place, &FileRef)> {
        let body = (self.body.source == BodySource::File).then_some(self.body.file.as_ref()).flatten();
        let motion =
            (self.motion.source == MotionSource::File).then_some(self.motion.file.as_ref()).flatten();
        let hair = (self.hair.source == HairSource::File).then_some(self.hair.file.as_ref()).flatten();
        let take = self.take.file.as_ref();
        if take.is_some() {
            // It says by itself which files it was made from.
            return take.into_iter().map(|file| (crate::Place::Take, file)).collect();
        }
        [(crate::Place::Body, body), (crate::Place::Motion, motion), (crate::Place::Hair, hair)]
            .into_iter()
            .filter_map(|(place, file)| Some((place, file?)))
            .collect()
    }

    /// Every file that the project names, used or not.
    pub(crate) fn file_refs_mut(&mut self) -> impl Iterator<Item = &mut FileRef> {
        let Self { body, motion, hair, recording, take, compare, .. } = self;
        [&mut body.file, &mut motion.file, &mut hair.file, &mut recording.output, &mut take.file]
            .into_iter()
            .chain(compare.panes.iter_mut().map(|pane| &mut pane.take))
            .flatten()
    }
}

#[cfg(test)]
mod tests;
