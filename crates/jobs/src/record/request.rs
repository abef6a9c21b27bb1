//! What to record, and how far it is.

use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

use lovelock_panes::sheet::Sheet;
use lovelock_project::files::Access;
use lovelock_record::{FilmQuality, SequenceFormat};
use lovelock_render::{Backend, Gpu, ShadowMethod, Transparency};

/// What to record; where a field is none, the project says.
#[derive(Clone, Debug, Default)]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of the command line by itself")]
pub struct RecordRequest {
    /// Where it goes: a name ending in `.mp4` is a film, a folder a sequence of PNG or EXR files.
    pub out: PathBuf,
    /// Frames, half open.
    pub frames: Option<Range<u64>>,
    /// Frames a second.
    pub fps: Option<f64>,
    /// Width and height, pixels.
    pub size: Option<(u32, u32)>,
    /// Shadow method.
    pub shadow: Option<ShadowMethod>,
    /// Transparency mode.
    pub transparency: Option<Transparency>,
    /// How finely a film is coded.
    pub quality: Option<FilmQuality>,
    /// Whether the shadow method, the transparency and the frame's number are written into each picture.
    pub label: bool,
    /// Whether the end of the film goes over into its start, hair and all; the project may say so too.
    pub seamless: bool,
    /// What the files of a folder are.
    pub format: Option<SequenceFormat>,
    /// Whether there is nothing behind hair and body, also where the project draws a background.
    pub transparent: bool,
    /// Pictures that a frame is the mean of, 1 to [`lovelock_project::project::RecordingSection::MOST_SUBFRAMES`].
    pub motion_blur: Option<u32>,
    /// How long the shutter is open, degrees of 360 a frame.
    pub shutter_degrees: Option<f32>,
    /// Whether to go on with the sequence that is in the folder.
    pub resume: bool,
    /// Whether frames of a take are counted on the dance that it was recorded from, and not from its own start.
    pub dance_time: bool,
    /// Which curves an output of curves holds; by its format where none.
    pub curves: Option<super::CurveSource>,
    /// Whether an output of curves leaves the body out.
    pub no_body: bool,
    /// What draws; the project says where none.
    pub backend: Option<Backend>,
    /// What the project may read.
    pub access: Access,
    /// The device to draw on; one is opened where none.
    pub gpu: Option<Arc<Gpu>>,
    /// The project's panes beside each other in place of its picture.
    pub panes: Option<Sheet>,
}

impl RecordRequest {
    /// The first option given that is of pictures alone: what holds none refuses it.
    pub(super) fn option_of_pictures(&self) -> Option<&'static str> {
        let given = [
            (self.size.is_some(), "--size"),
            (self.shadow.is_some(), "--shadow"),
            (self.transparency.is_some(), "--transparency"),
            (self.backend.is_some(), "--backend"),
            (self.quality.is_some(), "--quality"),
            (self.label, "--label"),
            (self.panes.is_some(), "--beside"),
            (self.format.is_some(), "--format"),
            (self.transparent, "--transparent"),
            (self.motion_blur.is_some(), "--motion-blur"),
            (self.shutter_degrees.is_some(), "--shutter"),
            (self.resume, "--resume"),
            (self.dance_time, "--dance-time"),
        ];
        given.into_iter().find(|(given, _)| *given).map(|(_, option)| option)
    }
}
