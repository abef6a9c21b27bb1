//! The sections of a project that belong to no other crate.

use glam::Vec3;
use lovelock_groom::{GroomSettings, HairLook, HairShading, HairTie, Haircut, ImportSettings, Preset};
use lovelock_motion::{
    BodySettings, ColliderEdits, FaceWeights, LoopBlend, MotionSettings, ScalpArea, ScalpFit,
};
use lovelock_picture::{Backend, HairDrawing, Transparency};
use lovelock_record::{FilmQuality, SequenceFormat};
use lovelock_shadow::{ShadowMethod, ShadowSettings};
use lovelock_simulation::SimulationSettings;
use lovelock_style::operations::Scissors;
use lovelock_style::{Layer, StyleStack};
use serde::{Deserialize, Serialize};

use super::brows::BrowSection;
use super::contender::Contender;
use super::lens::LensSettings;
use crate::files::FileRef;
use crate::tracks::Track;

/// Where the body comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum BodySource {
    /// The dancer that is part of the program.
    #[default]
    Dancer,
    /// The man that is part of the program.
    Man,
    /// The woman of African ancestry that is part of the program, for coils.
    Woman,
    /// The old woman that is part of the program.
    Elder,
    /// The four-legged animal that is part of the program, for fur.
    Animal,
    /// The piece of ground that is part of the program, for grass.
    Lawn,
    /// [`BodySection::file`].
    File,
}

impl BodySource {
    /// The bodies that are part of the program: their names on the command line, and what they are.
    pub const SHIPPED: [(Self, &str, &str); 6] = [
        (Self::Dancer, "dancer", "Loads the shipped dancer."),
        (Self::Man, "man", "Loads the shipped man, with the same dance."),
        (Self::Woman, "woman", "Loads the shipped woman with a head for coils, with the same dance."),
        (Self::Elder, "elder", "Loads the shipped old woman, with the same dance."),
        (Self::Animal, "animal", "Loads the shipped animal at rest, with hair on its whole skin, as fur."),
        (Self::Lawn, "lawn", "Loads the shipped piece of ground, with hair on it, as grass."),
    ];

    /// The shipped body with this name.
    pub fn shipped(name: &str) -> Option<Self> {
        Self::SHIPPED.iter().find(|(_, known, _)| *known == name).map(|(source, ..)| *source)
    }

    /// The name of a shipped body; `None` for one from a file.
    pub fn name(self) -> Option<&'static str> {
        Self::SHIPPED.iter().find(|(source, ..)| *source == self).map(|(_, name, _)| *name)
    }

    /// The fitted scalp of a body with which a project begins: fur and grass grow on the whole skin.
    pub fn scalp(self) -> ScalpFit {
        let area = if matches!(self, Self::Animal | Self::Lawn) { ScalpArea::Skin } else { ScalpArea::Head };
        ScalpFit { area, ..ScalpFit::default() }
    }
}

/// The body that dances.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct BodySection {
    /// Where it comes from.
    pub source: BodySource,
    /// A character file: glTF, VRM, FBX or USD.
    pub file: Option<FileRef>,
    /// Unit and up axis of that file.
    pub settings: BodySettings,
    /// The joint that carries the hair, by its name or its path (`hips/spine/neck/head`); the guess where none.
    pub head_joint: Option<String>,
    /// What is changed about the shapes that hair collides with.
    pub colliders: ColliderEdits,
    /// What is changed about the scalp that was fitted to this body.
    pub scalp: ScalpFit,
    /// Weights of expressions and morph targets, in addition to those of the clip.
    pub face: FaceWeights,
    /// Brows and lashes, on bodies whose file has them.
    pub brows: BrowSection,
    /// The corrected scalps of other bodies of this project: each returns with its body.
    pub other_scalps: Vec<KeptScalp>,
}

/// The corrected scalp of a body that is not shown.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct KeptScalp {
    /// That body, if it is a shipped one.
    pub source: BodySource,
    /// The file of that body; none for a shipped one.
    pub file: Option<FileRef>,
    /// What was changed.
    pub scalp: ScalpFit,
}

impl BodySection {
    /// The most bodies whose scalps are kept.
    pub const MAX_SCALPS: usize = 16;

    /// Switches to another body: to a file, or to a shipped one. The head joint is guessed again. The corrections of the scalp are
    /// kept for the body that they were made for, and those that the new body had before return.
    pub fn switch(&mut self, source: BodySource, file: Option<FileRef>) {
        let of = (self.source == BodySource::File).then(|| self.file.clone()).flatten();
        let key = |source: BodySource, file: &Option<FileRef>| match file {
            Some(file) => (BodySource::File, Some(file.path.clone())),
            None => (source, None),
        };
        let of_kept = |kept: &KeptScalp| key(kept.source, &kept.file);
        if key(self.source, &of) != key(source, &file) {
            let is_plain = self.scalp == self.source.scalp();
            let left = KeptScalp { source: self.source, file: of, scalp: std::mem::take(&mut self.scalp) };
            self.other_scalps.retain(|kept| of_kept(kept) != of_kept(&left));
            let known = self.other_scalps.iter().position(|kept| of_kept(kept) == key(source, &file));
            self.scalp = known.map_or_else(|| source.scalp(), |i| self.other_scalps.remove(i).scalp);
            if !is_plain {
                self.other_scalps.push(left);
                let surplus = self.other_scalps.len().saturating_sub(Self::MAX_SCALPS);
                self.other_scalps.drain(..surplus);
            }
        }
        self.head_joint = None;
        self.source = if file.is_some() { BodySource::File } else { source };
        if file.is_some() {
            self.file = file;
        }
    }
}

/// Where the motion comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum MotionSource {
    /// The body's own clip named [`MotionSection::clip`].
    #[default]
    Clip,
    /// [`MotionSection::file`].
    File,
    /// None: the body stays in its rest pose.
    Rest,
}

/// How the body dances.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct MotionSection {
    /// Where the motion comes from.
    pub source: MotionSource,
    /// Name of one of the body's clips; its first one where empty. With a motion file that has several clips, the name of one of
    /// those; the first of the file where it has none of that name.
    pub clip: String,
    /// A motion file (BVH, glTF, VRM animation, FBX or USD), retargeted to the body.
    pub file: Option<FileRef>,
    /// Unit, axis and root position of that file.
    pub settings: MotionSettings,
    /// Tempo: seconds of the clip that pass per second.
    pub speed: f32,
    /// Second of the clip at which it begins.
    pub start_secs: f32,
    /// Second of the clip at which it ends; that of its last key where none.
    pub end_secs: Option<f32>,
    /// Whether the clip starts again at its end; it holds its last pose otherwise.
    pub looping: bool,
    /// Where the ends of a clip that does not loop by itself are blended while it loops.
    pub loop_blend: LoopBlend,
    /// Duration of that blend, seconds.
    pub loop_blend_secs: f32,
}

impl Default for MotionSection {
    fn default() -> Self {
        Self {
            source: MotionSource::Clip,
            clip: "dance".to_owned(),
            file: None,
            settings: MotionSettings::default(),
            speed: 1.0,
            start_secs: 0.0,
            end_secs: None,
            looping: true,
            loop_blend: LoopBlend::End,
            loop_blend_secs: 0.5,
        }
    }
}

/// Where the hairstyle comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum HairSource {
    /// Grown on the body's scalp from [`HairSection::groom`].
    #[default]
    Grown,
    /// [`HairSection::file`].
    File,
}

/// The hairstyle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct HairSection {
    /// Where it comes from.
    pub source: HairSource,
    /// The shipped style that `groom` began as, where `style` names none: where its controls return to.
    pub preset: Preset,
    /// The style that was applied last: the id of a shipped one, or `own/NAME` of one of the user's; empty where only `preset` was.
    /// Controls return to the style's values if it is shipped.
    pub style: String,
    /// How the style that was applied moves, where it is none of the shipped ones: where the controls of the simulation return to.
    pub moves: Option<SimulationSettings>,
    /// How the style that was applied grows and is tied, where it is none of the shipped ones: where those controls return to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub grows: Option<Box<StyleGrowth>>,
    /// The layers that came with the style that was applied last, by their ids. All others are the user's.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub style_layers: Vec<u32>,
    /// How hair grows. Its `look` is not used: [`super::Project::look`] is.
    pub groom: GroomSettings,
    /// A hair file, in one of [`lovelock_groom::HAIR_FORMATS`].
    pub file: Option<FileRef>,
    /// How that file becomes a hairstyle.
    pub import: ImportSettings,
    /// What gathers the hair, at most [`HairTie::MAX`].
    pub ties: Vec<HairTie>,
    /// What is done to the hair after cutting and tying, layer by layer.
    pub stack: StyleStack,
    /// What was cut off while it moved; made by [`Haircut::of`] from an instant, and added up by [`Haircut::and`].
    pub cut: Haircut,
    /// A second style that the hair turns into.
    pub morph: HairMorph,
}

/// How a style grows and is tied.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct StyleGrowth {
    /// How hair grows.
    pub groom: GroomSettings,
    /// What gathers it.
    pub ties: Vec<HairTie>,
}

impl Default for HairSection {
    fn default() -> Self {
        Self {
            source: HairSource::Grown,
            preset: Preset::Smooth,
            style: String::new(),
            moves: None,
            grows: None,
            style_layers: Vec::new(),
            groom: GroomSettings::preset(Preset::Smooth),
            file: None,
            import: ImportSettings::default(),
            ties: Vec::new(),
            stack: StyleStack::default(),
            cut: Haircut::default(),
            morph: HairMorph::default(),
        }
    }
}

impl HairSection {
    /// The longest name of a style, characters.
    pub const LONGEST_STYLE: usize = 100;

    /// The hair files that it refers to, used or not: its own and that of its morph.
    pub fn files_mut(&mut self) -> impl Iterator<Item = &mut FileRef> {
        let other = self.morph.to.as_mut().and_then(|to| to.hair.file.as_mut());
        self.file.as_mut().into_iter().chain(other)
    }

    /// The cut and the ties as layers, which act before those of [`HairSection::stack`].
    pub fn cut_and_ties(&self) -> StyleStack {
        let mut layers = Vec::new();
        if !self.cut.is_empty() {
            layers.push(Layer::of(Scissors { cut: self.cut.clone() }));
        }
        layers.extend(self.ties.iter().map(|tie| Layer::of(*tie)));
        StyleStack { layers, ..StyleStack::default() }
    }
}

/// How far the hair has turned into a second style.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct HairMorph {
    /// 0 is the project's own style and 1 the second one.
    pub amount: f32,
    /// The second style; without one the amount has no effect.
    pub to: Option<Box<MorphStyle>>,
}

/// A style to which hair is morphed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct MorphStyle {
    /// What it is called.
    pub name: String,
    /// How it grows and is styled. Its own morph is not used.
    pub hair: HairSection,
    /// Its colours.
    pub look: HairLook,
    /// How it moves.
    pub simulation: SimulationSettings,
}

impl Default for MorphStyle {
    fn default() -> Self {
        Self {
            name: String::new(),
            hair: HairSection::default(),
            look: GroomSettings::preset(Preset::Smooth).look,
            simulation: SimulationSettings::default(),
        }
    }
}

impl HairMorph {
    /// The longest name of a style, characters.
    pub const LONGEST_NAME: usize = 80;

    /// The second style and the amount, unless the hair is that of the project's own style alone.
    pub fn mix(&self) -> Option<(&MorphStyle, f32)> {
        self.to.as_deref().filter(|_| self.amount > 0.0).map(|to| (to, self.amount))
    }
}

/// What the camera looks at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum CameraMode {
    /// The head, followed smoothly.
    #[default]
    Follow,
    /// A place in the world.
    Fixed,
}

/// A camera on a sphere around its target.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct CameraSection {
    /// What it looks at.
    pub mode: CameraMode,
    /// The target if it follows the head: offset from the smoothed head joint, world axes, metres.
    pub follow_offset: Vec3,
    /// Width of the window over which the path of the head is smoothed, seconds.
    pub follow_secs: f32,
    /// The target if it is fixed, world space, metres.
    pub fixed_target: Vec3,
    /// Angle about the vertical from the front (+Z) toward the dancer's left (+X), radians.
    pub azimuth: f32,
    /// Angle above the horizon, radians.
    pub elevation: f32,
    /// Distance from the target, metres.
    pub distance: f32,
    /// Vertical field of view, radians.
    pub fov_y: f32,
    /// Whether it goes round its target as time passes.
    pub turntable: bool,
    /// The time of one turn, seconds.
    pub turn_secs: f32,
    /// Its lens.
    pub lens: LensSettings,
}

impl CameraSection {
    /// The camera at a time of the scene: a turntable adds to its azimuth.
    ///
    /// A turn goes toward the figure's left; whole turns return exactly to the start.
    #[must_use]
    pub fn turned(&self, time_secs: f64) -> Self {
        if !self.turntable {
            return *self;
        }
        let turns = (time_secs / f64::from(self.turn_secs.max(0.1))).rem_euclid(1.0);
        Self { azimuth: self.azimuth + (turns * std::f64::consts::TAU) as f32, ..*self }
    }
}

impl Default for CameraSection {
    /// Head height, the look of a 65 mm lens on a frame 24 mm high, head and shoulders in the picture.
    fn default() -> Self {
        Self {
            mode: CameraMode::Follow,
            follow_offset: Vec3::new(0.0, 0.02, 0.0),
            follow_secs: 1.2,
            fixed_target: Vec3::new(0.0, 1.45, 0.0),
            azimuth: 0.45,
            elevation: 0.03,
            distance: 2.0,
            fov_y: 2.0 * (12.0_f32 / 65.0).atan(),
            turntable: false,
            turn_secs: 8.0,
            lens: LensSettings::default(),
        }
    }
}

/// What a recording is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct RecordingSection {
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// Frames per second.
    pub fps: f64,
    /// Number of the first frame.
    pub first_frame: u64,
    /// One past the number of the last frame; all of the clip's where none.
    pub end_frame: Option<u64>,
    /// Whether the hair at the end of a film of one cycle of a looping dance is blended into the hair at its start.
    pub seamless: bool,
    /// How finely a film is encoded.
    pub quality: FilmQuality,
    /// The format of the files in a folder.
    pub format: SequenceFormat,
    /// Whether background and ground are left out.
    pub transparent: bool,
    /// Samples per frame for motion blur; 1 is no blur.
    pub subframes: u32,
    /// Shutter angle, degrees; 360 is the whole frame.
    pub shutter_degrees: f32,
    /// Whether the shadow method, the transparency and the frame number are written into each image.
    pub label: bool,
    /// The output: a name that ends in `.mp4`, or a folder.
    pub output: Option<FileRef>,
}

impl Default for RecordingSection {
    fn default() -> Self {
        Self {
            width: 1280,
            height: 720,
            fps: 30.0,
            first_frame: 0,
            end_frame: None,
            seamless: false,
            quality: FilmQuality::default(),
            format: SequenceFormat::default(),
            transparent: false,
            subframes: 1,
            shutter_degrees: 180.0,
            label: false,
            output: None,
        }
    }
}

impl RecordingSection {
    /// The frames to record of a dance of `clip_frames`: those between the in and the out point, at least one.
    pub fn frame_range(&self, clip_frames: u64) -> std::ops::Range<u64> {
        let first = self.first_frame;
        first..self.end_frame.unwrap_or(clip_frames.max(first + 1))
    }

    /// Removes the in and the out point.
    pub fn record_all(&mut self) {
        (self.first_frame, self.end_frame) = (0, None);
    }

    /// The most samples per frame.
    pub const MAX_SUBFRAMES: u32 = 64;
}

/// What surrounds the figure and gives it light from all directions.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct SurroundingsSection {
    /// A picture of the surroundings, Radiance (`.hdr`) or `OpenEXR` (`.exr`); a sky above a ground where none.
    pub file: Option<FileRef>,
    /// A picture behind the figure, PNG, JPEG, Radiance or `OpenEXR`; [`lovelock_picture::BackgroundForm::Picture`] shows it.
    pub backdrop: Option<FileRef>,
}

/// A recorded simulation that plays in place of one that runs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct TakeSection {
    /// The take; where there is one, body, motion, hairstyle and their movement are as they were recorded.
    pub file: Option<FileRef>,
}

/// A named time of the dance.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Marker {
    /// Seconds from the start of the timeline.
    pub secs: f64,
    /// What it is called.
    pub name: String,
}

/// What stands on the timeline.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct TimelineSection {
    /// Named times, at most [`TimelineSection::MAX_MARKERS`].
    pub markers: Vec<Marker>,
    /// Numbers of the project that follow the timeline, at most [`Track::MAX`].
    pub tracks: Vec<Track>,
    /// Simulated time, at least, from rest to an instant that is jumped to or recorded from, seconds, so that the hair has settled. 0
    /// shows the style at rest.
    pub preroll_secs: f32,
}

impl Default for TimelineSection {
    fn default() -> Self {
        Self { markers: Vec::new(), tracks: Vec::new(), preroll_secs: 2.0 }
    }
}

impl TimelineSection {
    /// The most markers.
    pub const MAX_MARKERS: usize = 200;
    /// The longest name of a marker, characters.
    pub const LONGEST_NAME: usize = 80;
}

/// What is compared beside each other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct CompareSection {
    /// The panes, from the left and the top: 1 to [`CompareSection::MAX_PANES`].
    pub panes: Vec<Contender>,
    /// How hair in panes is shaded.
    pub shading: HairShading,
}

impl CompareSection {
    /// The most panes.
    pub const MAX_PANES: usize = 9;
}

impl Default for CompareSection {
    /// A method of each kind: a grid, layers, bits, and the truth.
    fn default() -> Self {
        let pane = |method| Contender {
            shadow: ShadowSettings { method, ..ShadowSettings::default() },
            draw: HairDrawing::default(),
            transparency: Transparency::default(),
            backend: Backend::default(),
            scale: 1.0,
            take: None,
        };
        let methods = [
            ShadowMethod::VoxelMap,
            ShadowMethod::DeepOpacityMaps,
            ShadowMethod::OccupancyMaps,
            ShadowMethod::Exact,
        ];
        Self { panes: methods.map(pane).to_vec(), shading: HairShading::TwoHighlights }
    }
}
