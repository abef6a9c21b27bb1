//! The tables of the project's sections, and which parts a project has.

use std::f64::consts::PI;

use lovelock_base::field;
use lovelock_base::settings::{Choices, Part, PartMut, Setting, Settings, Unit};
use lovelock_groom::{HairShading, HairTie, Preset};
use lovelock_motion::LoopBlend;
use lovelock_picture::{Backend, HairDrawing, MAX_LIGHTS, MAX_PIXELS, MAX_SIDE, Transparency};
use lovelock_record::{FilmQuality, SequenceFormat};

use super::super::Project;
use super::PROJECT_VERSION;
use super::contender::Contender;
use super::sections::{
    BodySection, BodySource, CameraMode, CameraSection, CompareSection, HairMorph, HairSection, HairSource,
    Marker, MotionSection, MotionSource, RecordingSection, TimelineSection,
};
use crate::tracks::Track;

/// The parts of a list, named `PREFIX.0`, `PREFIX.1` and so on.
fn list<'a, T: Settings>(prefix: &'static str, items: &'a [T]) -> impl Iterator<Item = Part<'a>> {
    items.iter().enumerate().map(move |(i, item)| -> Part<'a> { (format!("{prefix}.{i}").into(), item) })
}

/// The same, to be changed.
fn list_mut<'a, T: Settings>(prefix: &'static str, items: &'a mut [T]) -> impl Iterator<Item = PartMut<'a>> {
    items
        .iter_mut()
        .enumerate()
        .map(move |(i, item)| -> PartMut<'a> { (format!("{prefix}.{i}").into(), item) })
}

impl Settings for Project {
    const TABLE: &'static [Setting<Self>] = &[];

    fn parts(&self) -> Vec<Part<'_>> {
        let mut parts: Vec<Part<'_>> = vec![
            ("body".into(), &self.body),
            ("motion".into(), &self.motion),
            ("hair".into(), &self.hair),
            ("look".into(), &self.look),
            ("simulation".into(), &self.simulation),
            ("shadow".into(), &self.shadow),
        ];
        parts.extend(list("lights", &self.lights));
        let rest: [Part<'_>; 7] = [
            ("reference".into(), &self.reference),
            ("sound".into(), &self.sound),
            ("camera".into(), &self.camera),
            ("picture".into(), &self.picture),
            ("recording".into(), &self.recording),
            ("compare".into(), &self.compare),
            ("timeline".into(), &self.timeline),
        ];
        parts.extend(rest);
        parts
    }

    fn parts_mut(&mut self) -> Vec<PartMut<'_>> {
        let mut parts: Vec<PartMut<'_>> = vec![
            ("body".into(), &mut self.body),
            ("motion".into(), &mut self.motion),
            ("hair".into(), &mut self.hair),
            ("look".into(), &mut self.look),
            ("simulation".into(), &mut self.simulation),
            ("shadow".into(), &mut self.shadow),
        ];
        parts.extend(list_mut("lights", &mut self.lights));
        let rest: [PartMut<'_>; 7] = [
            ("reference".into(), &mut self.reference),
            ("sound".into(), &mut self.sound),
            ("camera".into(), &mut self.camera),
            ("picture".into(), &mut self.picture),
            ("recording".into(), &mut self.recording),
            ("compare".into(), &mut self.compare),
            ("timeline".into(), &mut self.timeline),
        ];
        parts.extend(rest);
        parts
    }

    fn reconcile(&mut self) {
        self.version = PROJECT_VERSION;
        self.lights.truncate(MAX_LIGHTS);
    }
}

impl Choices for BodySource {
    const ALL: &'static [Self] =
        &[Self::Dancer, Self::Man, Self::Woman, Self::Elder, Self::Animal, Self::Lawn, Self::File];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Dancer => ("Dancer", "Dancer"),
            Self::Man => ("Man", "Man"),
            Self::Woman => ("Woman", "Woman"),
            Self::Elder => ("Elder", "Elder"),
            Self::Animal => ("Animal", "Animal"),
            Self::Lawn => ("Lawn", "Lawn"),
            Self::File => ("File", "Character file"),
        }
    }
}

/// The most shapes that a body can have.
const MAX_COLLIDERS: usize = 1000;
/// The longest name of a joint, characters.
const LONGEST_COLLIDER: usize = 400;

impl Settings for BodySection {
    const TABLE: &'static [Setting<Self>] = &[Setting::choice::<BodySource>(
        field!(Self, source),
        "Body",
        "The body that carries the hair: one of the shipped figures, an animal for fur, ground for grass, or a character file.",
    )];

    fn parts(&self) -> Vec<Part<'_>> {
        vec![
            ("settings".into(), &self.settings),
            ("colliders".into(), &self.colliders),
            ("scalp".into(), &self.scalp),
            ("face".into(), &self.face),
            ("brows".into(), &self.brows),
        ]
    }

    fn parts_mut(&mut self) -> Vec<PartMut<'_>> {
        vec![
            ("settings".into(), &mut self.settings),
            ("colliders".into(), &mut self.colliders),
            ("scalp".into(), &mut self.scalp),
            ("face".into(), &mut self.face),
            ("brows".into(), &mut self.brows),
        ]
    }

    fn reconcile(&mut self) {
        let shapes = std::mem::take(&mut self.colliders.shapes);
        let named = shapes.into_iter().filter(|(name, _)| name.chars().count() <= LONGEST_COLLIDER);
        self.colliders.shapes = named.take(MAX_COLLIDERS).collect();
        self.other_scalps.truncate(Self::MAX_SCALPS);
        self.other_scalps.iter_mut().for_each(|kept| kept.scalp = kept.scalp.clamped());
    }
}

impl Choices for MotionSource {
    const ALL: &'static [Self] = &[Self::Clip, Self::File, Self::Rest];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Clip => ("Clip", "Clip of the character"),
            Self::File => ("File", "Motion file"),
            Self::Rest => ("Rest", "Rest pose"),
        }
    }
}

/// The farthest second of a clip that can be named: a day.
const MAX_CLIP_SECS: f64 = 86_400.0;

impl Settings for MotionSection {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::choice::<MotionSource>(field!(Self, source), "Motion", "Where the motion comes from."),
        Setting::number(
            field!(Self, speed),
            [0.1, 4.0],
            "Tempo",
            "Speed of the motion: seconds of the clip per second. The hair reacts to it.",
        )
        .unit(Unit::TIMES)
        .logarithmic(),
        Setting::number(
            field!(Self, start_secs),
            [0.0, MAX_CLIP_SECS],
            "Clip start",
            "Time of the clip at which the motion begins.",
        )
        .unit(Unit::SECONDS),
        Setting::number(
            field!(Self, end_secs),
            [0.0, MAX_CLIP_SECS],
            "Clip end",
            "Time of the clip at which the motion ends.",
        )
        .unit(Unit::SECONDS)
        .or_none("the last key of the clip"),
        Setting::switch(
            field!(Self, looping),
            "Loop",
            "Repeats the clip. Off, the body holds the last pose.",
        ),
        Setting::number(
            field!(Self, loop_blend_secs),
            [0.0, 2.0],
            "Loop blend",
            "Duration of the blend between the ends of a clip that does not loop by itself.",
        )
        .unit(Unit::SECONDS)
        .decimals(2),
        Setting::choice::<LoopBlend>(
            field!(Self, loop_blend),
            "Loop blend at",
            "Where the ends of a clip that does not loop by itself are blended. At its end, every pose before the blend is that of the \
             file; at its start, the clip is shorter by the blend, and counts from the zero of its file.",
        ),
    ];

    fn parts(&self) -> Vec<Part<'_>> {
        vec![("settings".into(), &self.settings)]
    }

    fn parts_mut(&mut self) -> Vec<PartMut<'_>> {
        vec![("settings".into(), &mut self.settings)]
    }
}

impl Choices for HairSource {
    const ALL: &'static [Self] = &[Self::Grown, Self::File];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Grown => ("Grown", "Grown from settings"),
            Self::File => ("File", "Hair file"),
        }
    }
}

impl Settings for HairSection {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::choice::<HairSource>(field!(Self, source), "Hair", "Where the hairstyle comes from."),
        Setting::choice::<Preset>(
            field!(Self, preset),
            "Hairstyle",
            "The shipped hairstyle, with its colours and ties, that the other settings start from.",
        ),
    ];

    fn parts(&self) -> Vec<Part<'_>> {
        let mut parts: Vec<Part<'_>> = vec![("groom".into(), &self.groom), ("import".into(), &self.import)];
        parts.extend(list("ties", &self.ties));
        parts.push(("stack".into(), &self.stack));
        parts.push(("morph".into(), &self.morph));
        parts
    }

    fn parts_mut(&mut self) -> Vec<PartMut<'_>> {
        let mut parts: Vec<PartMut<'_>> =
            vec![("groom".into(), &mut self.groom), ("import".into(), &mut self.import)];
        parts.extend(list_mut("ties", &mut self.ties));
        parts.push(("stack".into(), &mut self.stack));
        parts.push(("morph".into(), &mut self.morph));
        parts
    }

    fn reconcile(&mut self) {
        self.ties.truncate(HairTie::MAX);
        self.cut = self.cut.clamped();
        self.style = self.style.chars().filter(|c| !c.is_control()).take(Self::LONGEST_STYLE).collect();
        self.moves = self.moves.map(|moves| moves.clamped());
        if let Some(grows) = &mut self.grows {
            grows.groom = grows.groom.clamped();
            grows.ties.truncate(HairTie::MAX);
            grows.ties.iter_mut().for_each(|tie| *tie = tie.clamped());
        }
        let layers = &self.stack.layers;
        self.style_layers.retain(|id| layers.iter().any(|layer| layer.id == *id));
    }
}

impl Settings for HairMorph {
    const TABLE: &'static [Setting<Self>] = &[Setting::number(
        field!(Self, amount),
        [0.0, 1.0],
        "Morph",
        "How far the hair is morphed: 0 is the project's own style, 1 the second one.",
    )
    .unit(Unit::FRACTION)];

    fn reconcile(&mut self) {
        let Some(to) = &mut self.to else { return };
        to.name = to.name.chars().filter(|c| !c.is_control()).take(Self::LONGEST_NAME).collect();
        to.hair.morph = Self::default();
        to.hair = to.hair.clamped();
        to.look = to.look.clamped();
        to.simulation = to.simulation.clamped();
    }
}

impl Choices for CameraMode {
    const ALL: &'static [Self] = &[Self::Follow, Self::Fixed];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Follow => ("Follow", "Follow the head"),
            Self::Fixed => ("Fixed", "Fixed"),
        }
    }
}

impl Settings for CameraSection {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::choice::<CameraMode>(
            field!(Self, mode),
            "Camera target",
            "What the camera looks at: the head, followed smoothly, or a fixed place in the world.",
        ),
        Setting::vector(
            field!(Self, follow_offset),
            [-3.0, 3.0],
            "Follow offset",
            ["Sideways", "Upward", "Forward"],
            "Offset of the target from the smoothed head joint, along the axes of the world.",
        )
        .unit(Unit::METRES),
        Setting::number(
            field!(Self, follow_secs),
            [0.0, 4.0],
            "Follow smoothing",
            "Width of the window over which the path of the head is smoothed. Higher values follow \
             more slowly.",
        )
        .unit(Unit::SECONDS),
        Setting::vector(
            field!(Self, fixed_target),
            [-20.0, 20.0],
            "Fixed target",
            ["Target x", "Target y", "Target z"],
            "The fixed target in the world.",
        )
        .unit(Unit::METRES),
        Setting::number(
            field!(Self, azimuth),
            [-PI, PI],
            "Azimuth",
            "Angle about the vertical from the front toward the dancer's left.",
        )
        .unit(Unit::RADIANS)
        .wraps(),
        Setting::number(field!(Self, elevation), [-1.5, 1.5], "Elevation", "Angle above the horizon.")
            .unit(Unit::RADIANS),
        Setting::number(field!(Self, distance), [0.1, 30.0], "Distance", "Distance from the target.")
            .unit(Unit::METRES)
            .logarithmic(),
        Setting::number(
            field!(Self, fov_y),
            [0.05, 2.0],
            "Field of view",
            "Vertical field of view. Small angles look like a long lens.",
        )
        .unit(Unit::RADIANS),
        Setting::switch(
            field!(Self, turntable),
            "Turntable",
            "Moves the camera round its target as time passes, in the window and in films.",
        ),
        Setting::number(
            field!(Self, turn_secs),
            [0.5, 600.0],
            "Turn time",
            "Time of one turn of the turntable.",
        )
        .unit(Unit::SECONDS)
        .logarithmic()
        .soft([2.0, 60.0]),
    ];

    fn parts(&self) -> Vec<Part<'_>> {
        vec![("lens".into(), &self.lens)]
    }

    fn parts_mut(&mut self) -> Vec<PartMut<'_>> {
        vec![("lens".into(), &mut self.lens)]
    }
}

impl Settings for RecordingSection {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::count(field!(Self, width), [16, MAX_SIDE as u64], "Width", "Width of the recorded images.")
            .unit(Unit::PIXELS),
        Setting::count(
            field!(Self, height),
            [16, MAX_SIDE as u64],
            "Height",
            "Height of the recorded images.",
        )
        .unit(Unit::PIXELS),
        Setting::number(field!(Self, fps), [1.0, 240.0], "Frame rate", "Frames per second of the recording.")
            .unit(Unit::FRAMES_PER_SECOND),
        Setting::choice::<FilmQuality>(
            field!(Self, quality),
            "Quality",
            "Quality of the encoded film. Higher settings keep single hairs distinct and make larger files.",
        ),
        Setting::count(
            field!(Self, first_frame),
            [0, 10_000_000],
            "First frame",
            "Number of the first recorded frame.",
        )
        .soft([0.0, 1e6]),
        Setting::count(
            field!(Self, end_frame),
            [1, 20_000_000],
            "End frame",
            "One past the number of the last recorded frame.",
        )
        .soft([1.0, 1e6])
        .or_none("the end of the clip"),
        Setting::choice::<SequenceFormat>(
            field!(Self, format),
            "File format",
            "Format of the files in a folder: PNG as the screen shows it, or EXR for compositing, \
             with linear light, depth and the light that reaches the hair.",
        ),
        Setting::switch(
            field!(Self, transparent),
            "Transparent",
            "Leaves out background and ground, so that the images can be composited over others. Not for films, which have \
             no alpha.",
        ),
        Setting::count(
            field!(Self, subframes),
            [1, Self::MAX_SUBFRAMES as u64],
            "Samples per frame",
            "Images averaged per frame for motion blur while the shutter is open: 1 is no blur, 8 to 16 are smooth. \
             Rendering time grows in proportion.",
        )
        .logarithmic(),
        Setting::number(
            field!(Self, shutter_degrees),
            [0.0, 360.0],
            "Shutter angle",
            "How long the shutter is open for motion blur. 360° is the whole frame.",
        )
        .unit(Unit::DEGREES),
        Setting::switch(
            field!(Self, label),
            "Label",
            "Writes the shadow method, the transparency and the frame number into each image.",
        ),
        Setting::switch(
            field!(Self, seamless),
            "Seamless loop",
            "Blends the end of the loop into its start, so that the film of a looping dance repeats \
             without a jump.",
        ),
    ];

    fn reconcile(&mut self) {
        if u64::from(self.width) * u64::from(self.height) > MAX_PIXELS {
            // Even, as films need it.
            self.height = (MAX_PIXELS / u64::from(self.width)) as u32 & !1;
        }
        self.end_frame = self.end_frame.map(|end| end.max(self.first_frame + 1));
    }
}

impl Settings for TimelineSection {
    const TABLE: &'static [Setting<Self>] = &[Setting::number(
        field!(Self, preroll_secs),
        [0.0, 30.0],
        "Pre-roll",
        "Time simulated before a recording or a jump, so that the hair has settled. 0 starts with the style at rest.",
    )
    .unit(Unit::SECONDS)];

    fn reconcile(&mut self) {
        let good = self.markers.iter().filter(|marker| marker.secs.is_finite() && marker.secs >= 0.0);
        let markers = good.take(Self::MAX_MARKERS).map(|marker| Marker {
            secs: marker.secs,
            name: marker.name.chars().take(Self::LONGEST_NAME).collect(),
        });
        self.markers = markers.collect();
        self.tracks = self.tracks.iter().filter_map(Track::in_range).take(Track::MAX).collect();
    }
}

impl Settings for CompareSection {
    const TABLE: &'static [Setting<Self>] = &[Setting::choice::<HairShading>(
        field!(Self, shading),
        "Shading of panes",
        "How hair in panes is shaded: by two highlights, by Kajiya-Kay as the papers on shadows do it, or by scattering in \
         the fibres. Panes draw the strands that the hairstyle stores.",
    )];

    fn parts(&self) -> Vec<Part<'_>> {
        list("panes", &self.panes).collect()
    }

    fn parts_mut(&mut self) -> Vec<PartMut<'_>> {
        list_mut("panes", &mut self.panes).collect()
    }

    fn reconcile(&mut self) {
        if self.panes.is_empty() {
            self.panes = Self::default().panes;
        }
        self.panes.truncate(Self::MAX_PANES);
    }
}

impl Settings for Contender {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::choice::<HairDrawing>(
            field!(Self, draw),
            "Draw hair as",
            "How hair is drawn: as strands, as locks from a database of rendered sectors, or as strands where it is large in the image and locks where it is small. Errors of transmittance are measured at \
             strands, so panes that draw locks have none.",
        ),
        Setting::choice::<Transparency>(
            field!(Self, transparency),
            "Transparency",
            "How strands that overlap in a pixel are blended.",
        ),
        Setting::choice::<Backend>(field!(Self, backend), "Backend", "What renders the pane."),
        Setting::number(
            field!(Self, scale),
            [0.1, 1.0],
            "Resolution",
            "Rendered pixels per pixel of the pane along each edge.",
        )
        .unit(Unit::FRACTION),
    ];

    fn parts(&self) -> Vec<Part<'_>> {
        vec![("shadow".into(), &self.shadow)]
    }

    fn parts_mut(&mut self) -> Vec<PartMut<'_>> {
        vec![("shadow".into(), &mut self.shadow)]
    }
}
