//! The sound beside the dance.

use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings, Unit};
use serde::{Deserialize, Serialize};

use crate::files::FileRef;

/// The sound beside the dance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct SoundSection {
    /// A sound file: WAV, MP3, Ogg Vorbis or FLAC; silence where none.
    pub file: Option<FileRef>,
    /// Second of the timeline at which the sound begins; negative where its beginning is not heard.
    pub offset_secs: f64,
    /// Factor of its amplitude.
    pub gain: f32,
    /// Whether it is silent, in the window and in recordings.
    pub muted: bool,
}

impl Default for SoundSection {
    fn default() -> Self {
        Self { file: None, offset_secs: 0.0, gain: 1.0, muted: false }
    }
}

impl SoundSection {
    /// Farthest start of the sound before and after that of the timeline, seconds.
    pub const MAX_OFFSET_SECS: f64 = 3600.0;
    /// The largest gain: 12 dB.
    pub const MAX_GAIN: f64 = 4.0;

    /// Whether there is something to hear.
    pub fn is_heard(&self) -> bool {
        self.file.is_some() && !self.muted && self.gain > 0.0
    }
}

impl Settings for SoundSection {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(
            field!(Self, offset_secs),
            [-Self::MAX_OFFSET_SECS, Self::MAX_OFFSET_SECS],
            "Starts at",
            "Time of the timeline at which the sound begins. Negative values leave out its beginning.",
        )
        .unit(Unit::SECONDS)
        .soft([-60.0, 60.0])
        .decimals(3),
        Setting::number(
            field!(Self, gain),
            [0.0, Self::MAX_GAIN],
            "Volume",
            "Loudness of the sound in the window and in recordings, as a multiple of that in its file.",
        )
        .unit(Unit::FRACTION),
        Setting::switch(
            field!(Self, muted),
            "Mute",
            "Silences the sound in the window and leaves it out of recordings.",
        ),
    ];
}

#[cfg(test)]
mod tests {
    use super::super::{Project, load_project, parse_project, save_project};
    use super::*;
    use crate::error::Place;
    use crate::history::History;

    #[test]
    fn a_sound_is_saved_beside_the_project_and_a_missing_one_is_a_problem() {
        let dir = tempfile::tempdir().expect("a folder");
        let (path, file) = (dir.path().join("p.lovelock"), dir.path().join("süß.mp3"));
        std::fs::write(&file, b"ID3").expect("a file");
        let mut project = Project::default();
        assert!(!project.sound.is_heard(), "silence");
        project.set_sound_file(&file);
        (project.sound.offset_secs, project.sound.gain) = (-1.25, 0.5);
        save_project(&path, &project).expect("saved");
        let text = std::fs::read_to_string(&path).expect("text");
        assert!(text.contains("süß.mp3") && !text.contains(&dir.path().display().to_string()), "{text}");
        assert_eq!(load_project(&path).expect("opened"), (project.clone(), Vec::new()));
        assert!(project.sound.is_heard());
        std::fs::remove_file(&file).expect("removed");
        let (opened, problems) = load_project(&path).expect("opened");
        assert_eq!(opened, project, "the project keeps the name of the file");
        assert!(
            problems.len() == 1 && problems[0].place == Place::Sound && problems[0].is_failure(),
            "{problems:?}"
        );
        project.set_take(dir.path().join("a.take"));
        assert!(project.files().iter().any(|(place, _)| *place == Place::Sound), "a take records no sound");
    }

    #[test]
    fn values_out_of_range_are_brought_into_it_and_old_projects_are_silent() {
        let mut project = Project::default();
        (project.sound.offset_secs, project.sound.gain) = (f64::NAN, 100.0);
        let (clean, problems) = project.sanitised();
        assert_eq!((clean.sound.offset_secs, clean.sound.gain), (0.0, 4.0));
        assert_eq!(
            problems.iter().filter(|problem| problem.place == Place::Sound).count(),
            2,
            "{problems:?}"
        );
        let (old, problems) = parse_project("old.lovelock".as_ref(), "(version: 3)").expect("a project");
        assert_eq!((old.sound, problems.len()), (SoundSection::default(), 0));
    }

    #[test]
    fn a_sound_stays_with_the_motion_when_the_clip_is_trimmed_and_can_be_undone() {
        let mut project = Project::default();
        (project.recording.fps, project.recording.first_frame) = (30.0, 60);
        project.sound.offset_secs = 0.5;
        let mut history = History::new(project);
        history.change("Trim", None, Project::trim_to_points);
        assert_eq!(history.project().sound.offset_secs, -1.5, "the cut is 2 s after the start");
        history.change("Restore", None, Project::trim_nothing);
        assert_eq!(history.project().sound.offset_secs, 0.5);
        history.change("Mute", None, |project| project.sound.muted = true);
        assert!(!history.project().sound.is_heard());
        history.undo();
        assert!(!history.project().sound.muted);
    }
}
