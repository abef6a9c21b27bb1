//! The project's sections, and reading and writing project files.
//!
//! One plain struct per section. A section keeps the values of all its alternatives, so that switching between them loses
//! nothing. File paths are absolute in memory; on disk they are relative to the project's folder if they lie in it (see
//! [`load_project`] and [`save_project`]).

mod brows;
mod contender;
mod file;
mod generic;
mod lens;
mod loop_blend;
mod memory;
mod reference;
mod sanitise;
mod sections;
mod settings;
mod sound;
mod tables;
mod trim;
mod version_1;
mod version_2;

pub use brows::{BrowColour, BrowSection};
pub use contender::{Contender, backend_label};
pub(crate) use file::{LARGEST_BYTES, parse_text, project_in_memory, text_in_memory, text_options};
pub use file::{
    PROJECT_EXTENSION, load_project, load_project_with, parse_project, project_of_text, read_text,
    refuse_foreign, save_project, text_of_project,
};
pub use lens::{FocusOn, LensSettings};
pub use sections::{
    BodySection, BodySource, CameraMode, CameraSection, CompareSection, HairMorph, HairSection, HairSource,
    KeptScalp, Marker, MorphStyle, MotionSection, MotionSource, RecordingSection, StyleGrowth,
    SurroundingsSection, TakeSection, TimelineSection,
};

pub use reference::ReferenceSection;
pub use sound::SoundSection;

pub use settings::{
    Assignment, all_settings, changed_settings, settings_json, settings_of, settings_page, settings_table,
    settings_text,
};

use lovelock_groom::{Facing, GroomSettings, HairLook, Preset, UpAxis};
use lovelock_motion::LoopBlend;
use lovelock_picture::{BackgroundForm, Light, PictureSettings, StrandCount};
use lovelock_shadow::{ShadowMethod, ShadowSettings, UserMethod};
use lovelock_simulation::SimulationSettings;
use serde::{Deserialize, Serialize};

use crate::files::FileRef;

/// Version of the project file that this program writes, and the newest version that it reads.
pub const PROJECT_VERSION: u32 = 3;

/// Everything that is saved and undone.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Project {
    /// Version of the file, [`PROJECT_VERSION`].
    pub version: u32,
    /// The body.
    pub body: BodySection,
    /// The motion of the body.
    pub motion: MotionSection,
    /// The hairstyle.
    pub hair: HairSection,
    /// Colour and width of the hair.
    pub look: HairLook,
    /// How the hair moves.
    pub simulation: SimulationSettings,
    /// How the hair shadows itself.
    pub shadow: ShadowSettings,
    /// The lights, at most [`lovelock_picture::MAX_LIGHTS`].
    pub lights: Vec<Light>,
    /// The light from all directions.
    pub surroundings: SurroundingsSection,
    /// The picture that is compared with the image in the window.
    pub reference: ReferenceSection,
    /// The sound of the dance.
    pub sound: SoundSection,
    /// The camera.
    pub camera: CameraSection,
    /// Settings of the whole image.
    pub picture: PictureSettings,
    /// Settings of recordings.
    pub recording: RecordingSection,
    /// The panes of a comparison.
    pub compare: CompareSection,
    /// The take that is played, if any.
    pub take: TakeSection,
    /// Markers, tracks and pre-roll.
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
            surroundings: SurroundingsSection::default(),
            reference: ReferenceSection::default(),
            sound: SoundSection::default(),
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
    /// The project as comparisons of shadow methods draw it: with the strands that the hairstyle stores, at which transmittance is
    /// measured, and with the shading of [`CompareSection::shading`].
    #[must_use]
    pub fn compared(&self) -> Self {
        let mut project = self.clone();
        project.picture.strands = StrandCount::Stored;
        project.look.shading = self.compare.shading;
        project
    }

    /// Switches to a hair file that the user picked. The axes that were set for another file do not apply to it.
    pub fn set_hair_file(&mut self, path: impl Into<std::path::PathBuf>) {
        let file = FileRef::new(path);
        if self.hair.file.as_ref().is_some_and(|before| before.path != file.path) {
            (self.hair.import.up, self.hair.import.facing) = (UpAxis::Auto, Facing::Auto);
        }
        self.set_hair_source(HairSource::File);
        self.hair.file = Some(file);
    }

    /// Switches to a character file that the user picked, with its first clip. Hair and style stay, on the scalp of the new head.
    pub fn set_body_file(&mut self, path: impl Into<std::path::PathBuf>) {
        self.body.switch(BodySource::File, Some(FileRef::new(path)));
        if self.motion.source == MotionSource::Clip {
            self.motion.clip.clear();
            self.motion.loop_blend = LoopBlend::End;
        }
    }

    /// Switches to a shipped body. Those of fur and grass have no clips and rest.
    pub fn show_shipped_body(&mut self, source: BodySource) {
        let rests = |source| matches!(source, BodySource::Animal | BodySource::Lawn);
        if rests(source) {
            self.motion.source = MotionSource::Rest;
        } else if rests(self.body.source) {
            self.motion.source = MotionSource::Clip;
        }
        self.body.switch(source, None);
    }

    /// Switches to a motion file that the user picked.
    pub fn set_motion_file(&mut self, path: impl Into<std::path::PathBuf>) {
        self.motion.source = MotionSource::File;
        self.motion.file = Some(FileRef::new(path));
        self.motion.loop_blend = LoopBlend::End;
    }

    /// Takes the light from all directions from a picture that the user picked.
    pub fn set_surroundings_file(&mut self, path: impl Into<std::path::PathBuf>) {
        self.surroundings.file = Some(FileRef::new(path));
    }

    /// Shows a picture that the user picked behind the figure.
    pub fn set_backdrop_file(&mut self, path: impl Into<std::path::PathBuf>) {
        self.surroundings.backdrop = Some(FileRef::new(path));
        self.picture.background = BackgroundForm::Picture;
    }

    /// Lays a picture that the user picked over the image in the window.
    pub fn set_reference_file(&mut self, path: impl Into<std::path::PathBuf>) {
        self.reference.file = Some(FileRef::new(path));
        self.reference.shown = true;
    }

    /// Adds a sound file that the user picked to the dance.
    pub fn set_sound_file(&mut self, path: impl Into<std::path::PathBuf>) {
        self.sound.file = Some(FileRef::new(path));
    }

    /// Plays a take that the user picked.
    pub fn set_take(&mut self, path: impl Into<std::path::PathBuf>) {
        self.take.file = Some(FileRef::new(path));
    }

    /// Makes the file at `place` the one that it is in `other`.
    pub fn restore_part(&mut self, place: crate::error::Place, other: &Self) {
        use crate::error::Place;
        match place {
            Place::Hair => {
                self.set_hair_source(other.hair.source);
                self.hair.file.clone_from(&other.hair.file);
            }
            Place::Body => {
                self.body.clone_from(&other.body);
                self.motion.clip.clone_from(&other.motion.clip);
            }
            Place::Motion => {
                self.motion.source = other.motion.source;
                self.motion.file.clone_from(&other.motion.file);
                self.motion.loop_blend = other.motion.loop_blend;
            }
            Place::Surroundings => self.surroundings.file.clone_from(&other.surroundings.file),
            Place::Backdrop => {
                self.surroundings.backdrop.clone_from(&other.surroundings.backdrop);
                self.picture.background = other.picture.background;
            }
            Place::Reference => self.reference.clone_from(&other.reference),
            Place::Sound => self.sound.file.clone_from(&other.sound.file),
            Place::Take => self.take.file.clone_from(&other.take.file),
            _ => {}
        }
    }

    /// The shadow methods of the user's own that it uses, each once.
    pub fn user_methods(&self) -> Vec<UserMethod> {
        let panes = self.compare.panes.iter().map(|pane| pane.shadow.method);
        let mut found = Vec::new();
        for method in std::iter::once(self.shadow.method).chain(panes) {
            if let ShadowMethod::User(user) = method
                && !found.contains(&user)
            {
                found.push(user);
            }
        }
        found
    }

    /// Every file that the project refers to and uses, with the part that uses it.
    pub fn files(&self) -> Vec<(crate::error::Place, &FileRef)> {
        let body = (self.body.source == BodySource::File).then_some(self.body.file.as_ref()).flatten();
        let motion =
            (self.motion.source == MotionSource::File).then_some(self.motion.file.as_ref()).flatten();
        let hair = (self.hair.source == HairSource::File).then_some(self.hair.file.as_ref()).flatten();
        let morph = self.hair.morph.to.as_ref().map(|to| &to.hair);
        let other = morph.filter(|hair| hair.source == HairSource::File).and_then(|hair| hair.file.as_ref());
        let surroundings = (crate::error::Place::Surroundings, self.surroundings.file.as_ref());
        let backdrop = (crate::error::Place::Backdrop, self.surroundings.backdrop.as_ref());
        let sound = (crate::error::Place::Sound, self.sound.file.as_ref());
        let take = self.take.file.as_ref();
        if take.is_some() {
            // A take itself names the files of body, motion and hair; curves play on the body of the project.
            let curves = self.plays_curves();
            let around = |file| if curves { file } else { None };
            let used = [
                (crate::error::Place::Take, take),
                (crate::error::Place::Body, around(body)),
                (crate::error::Place::Motion, around(motion)),
                surroundings,
                backdrop,
                sound,
            ];
            return used.into_iter().filter_map(|(place, file)| Some((place, file?))).collect();
        }
        [
            (crate::error::Place::Body, body),
            (crate::error::Place::Motion, motion),
            (crate::error::Place::Hair, hair),
            (crate::error::Place::Hair, other),
            surroundings,
            backdrop,
            sound,
        ]
        .into_iter()
        .filter_map(|(place, file)| Some((place, file?)))
        .collect()
    }

    /// Whether the file that plays is one of curves over time, by its name. Body and motion are then those of the project, whereas a take has
    /// recorded them.
    pub fn plays_curves(&self) -> bool {
        self.take
            .file
            .as_ref()
            .and_then(|file| file.path.extension())
            .is_some_and(|end| ["abc", "usd", "usda", "usdc"].iter().any(|own| end.eq_ignore_ascii_case(own)))
    }

    /// Every file that the project refers to, used or not.
    pub fn file_refs_mut(&mut self) -> impl Iterator<Item = &mut FileRef> {
        let Self { body, motion, hair, surroundings, reference, sound, recording, take, compare, .. } = self;
        let pictures = [&mut surroundings.file, &mut surroundings.backdrop, &mut reference.file];
        let own = [&mut body.file, &mut motion.file, &mut sound.file];
        let scalps = body.other_scalps.iter_mut().map(|kept| &mut kept.file);
        own.into_iter()
            .chain(pictures)
            .chain(scalps)
            .chain([&mut recording.output, &mut take.file])
            .chain(compare.panes.iter_mut().map(|pane| &mut pane.take))
            .flatten()
            .chain(hair.files_mut())
    }
}

#[cfg(test)]
mod tests;
