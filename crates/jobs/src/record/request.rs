//! The request for a recording.

use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

use lovelock_panes::sheet::Sheet;
use lovelock_project::files::Access;
use lovelock_record::{FilmQuality, SequenceFormat};
use lovelock_render::{Backend, Gpu, HairDrawing, ShadowMethod, Transparency};

/// What to record. `None` uses the project's value.
#[derive(Clone, Debug, Default)]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of the command line by itself")]
pub struct RecordRequest {
    /// The output: a name ending in `.mp4` is a film, a folder is a sequence of PNG or EXR files.
    pub out: PathBuf,
    /// Frames, half open.
    pub frames: Option<Range<u64>>,
    /// Frames per second.
    pub fps: Option<f64>,
    /// Width and height, pixels.
    pub size: Option<(u32, u32)>,
    /// Shadow method.
    pub shadow: Option<ShadowMethod>,
    /// What hair is drawn as.
    pub draw: Option<HairDrawing>,
    /// Transparency mode.
    pub transparency: Option<Transparency>,
    /// Encoding quality of a film.
    pub quality: Option<FilmQuality>,
    /// Whether shadow method, transparency and frame number are written into each image.
    pub label: bool,
    /// Time in which the camera goes once round its target, seconds; without `frames` the film is one turn.
    pub turn_secs: Option<f32>,
    /// Whether the end of the film is blended into its start; the project can also enable this.
    pub seamless: bool,
    /// Format of the files in a folder.
    pub format: Option<SequenceFormat>,
    /// Whether the background is transparent even if the project has a background.
    pub transparent: bool,
    /// Samples per frame, 1 to [`lovelock_project::project::RecordingSection::MAX_SUBFRAMES`].
    pub motion_blur: Option<u32>,
    /// Shutter angle, degrees of 360 per frame.
    pub shutter_degrees: Option<f32>,
    /// Whether to resume the sequence in the folder.
    pub resume: bool,
    /// Whether frames of a take are counted from the start of the original motion instead of the start of the take.
    pub dance_time: bool,
    /// Which curves to export; `None` chooses by format.
    pub curves: Option<super::CurveSource>,
    /// Whether to export curves without the body.
    pub no_body: bool,
    /// Whether the camera follows the size of a body whose head has another size than that of the shipped dancer.
    pub frame_body: bool,
    /// The rendering backend.
    pub backend: Option<Backend>,
    /// The files that the project may read.
    pub access: Access,
    /// The device to render on; `None` opens one.
    pub gpu: Option<Arc<Gpu>>,
    /// Records the project's panes beside each other instead of its image.
    pub panes: Option<Sheet>,
}

impl RecordRequest {
    /// The first given option that only applies to images. Outputs without images reject it.
    pub(super) fn option_of_pictures(&self) -> Option<&'static str> {
        let given = [
            (self.size.is_some(), "--size"),
            (self.shadow.is_some(), "--shadow"),
            (self.draw.is_some(), "--draw"),
            (self.transparency.is_some(), "--transparency"),
            (self.backend.is_some(), "--backend"),
            (self.quality.is_some(), "--quality"),
            (self.label, "--label"),
            (self.turn_secs.is_some(), "--turntable"),
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
