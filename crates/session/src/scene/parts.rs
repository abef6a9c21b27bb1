//! The parts of a scene, each loaded on its own.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, OnceLock};
use std::time::SystemTime;

use lovelock_base::words::counted;
use lovelock_motion::{
    Body, BodyField, BodySettings, Character, Clip, Collider, FaceWeights, LoopBlend, MotionError,
    MotionFile, MotionSettings, RestDistance, Skeleton, fit_colliders, joint_paths, load_character_watched,
    load_motion_watched, retarget, unknown_faces, unplaced_faces,
};
use lovelock_project::error::{Place, Problem, ProblemKind, ProjectError};
use lovelock_project::files::Access;
use lovelock_project::project::{BodySection, BodySource, MotionSection, MotionSource};

use super::control::LoadControl;
use super::shipped::shipped;

/// Identity of a file's contents when it was read. The file is read again if this changes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Stamp {
    pub(super) path: PathBuf,
    bytes: u64,
    modified: Option<SystemTime>,
}

impl Stamp {
    pub(super) fn of(path: &Path) -> Self {
        let data = std::fs::metadata(path).ok();
        Self {
            path: path.to_owned(),
            bytes: data.as_ref().map_or(0, std::fs::Metadata::len),
            modified: data.and_then(|data| data.modified().ok()),
        }
    }
}

/// The sources of a body.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct BodyKey {
    source: BodySource,
    file: Option<(Stamp, BodySettings)>,
    head_joint: Option<String>,
}

/// A body, and everything that is derived only from it.
#[derive(Clone, Debug)]
pub(super) struct BodyPart {
    pub(super) body: Arc<Body>,
    pub(super) clips: Arc<[Arc<Clip>]>,
    pub(super) colliders: Arc<[Collider]>,
    pub(super) rest: Arc<RestDistance>,
    /// The distance field of head and shoulders, if the body has them.
    pub(super) field: Option<Arc<BodyField>>,
    pub(super) notes: Vec<Problem>,
}

impl BodyKey {
    /// The sources in `section`, or a problem if they may not be read.
    pub(super) fn of(section: &BodySection, access: &Access) -> Result<Self, Problem> {
        let file = match (section.source, &section.file) {
            (BodySource::File, Some(file)) => {
                Some((Stamp::of(&access.read(Place::Body, file)?), section.settings))
            }
            (BodySource::File, None) => {
                return Err(Problem::not_loaded(Place::Body, "no character file is set; pick one"));
            }
            _ => None,
        };
        Ok(Self { source: section.source, file, head_joint: section.head_joint.clone() })
    }

    /// The dancer, whatever the project says.
    pub(super) fn dancer() -> Self {
        Self { source: BodySource::Dancer, file: None, head_joint: None }
    }

    /// As [`BodyKey::load_in_steps`], in one go.
    pub(super) fn load(&self) -> Result<BodyPart, Problem> {
        let (cancelled, mut silent) = (AtomicBool::new(false), |_: &str, _| {});
        let loaded = self.load_in_steps(&mut LoadControl { cancelled: &cancelled, progress: &mut silent });
        loaded.unwrap_or_else(|error| Err(Problem::not_loaded(Place::Body, error)))
    }

    /// Loads the body. `control` is told each part of the work and ends the load when it is cancelled.
    pub(super) fn load_in_steps(
        &self,
        control: &mut LoadControl<'_>,
    ) -> Result<Result<BodyPart, Problem>, ProjectError> {
        // Measured once: every window, wall and command has the shipped dancer.
        static DANCER: OnceLock<BodyPart> = OnceLock::new();
        let is_dancer = *self == Self::dancer();
        if let Some(part) = DANCER.get().filter(|_| is_dancer) {
            return Ok(Ok(part.clone()));
        }
        let character = match &self.file {
            None => shipped(self.source),
            Some((stamp, settings)) => {
                let (path, settings) = (stamp.path.clone(), *settings);
                control.read("loading the body", [0.0, 0.08], move |watch| {
                    load_character_watched(&path, settings, watch)
                })?
            }
        };
        let character = match character {
            Ok(character) => character,
            Err(error) => return Ok(Err(Problem::not_loaded(Place::Body, error))),
        };
        let mut notes = file_notes(Place::Body, &character.dropped, &character.notes);
        let Character { mut body, clips, .. } = character;
        if let Some(name) = &self.head_joint {
            match find_joint(&body.skeleton, name) {
                Some(joint) if joint == body.head_joint => {}
                Some(joint) => body = Arc::new(Body { head_joint: joint, ..(*body).clone() }),
                None => notes.push(Problem::new(
                    Place::Body,
                    ProblemKind::Ignored,
                    format!("{} has no joint called `{name}`; the hair is on a guessed joint", body.name),
                )),
            }
        }
        control.at("measuring the body", 0.08)?;
        let rest = RestDistance::new(&body);
        control.at("fitting shapes to the body", 0.18)?;
        let colliders = fit_colliders(&body).into();
        control.at("measuring head and shoulders", 0.22)?;
        let field = BodyField::new(&body, &rest).map(Arc::new);
        let part = BodyPart { colliders, field, rest: Arc::new(rest), clips: clips.into(), body, notes };
        if is_dancer {
            let _ = DANCER.set(part.clone());
        }
        Ok(Ok(part))
    }
}

/// The weights of a face that a body has no names for.
pub(super) fn face_notes(body: &Body, weights: &FaceWeights) -> Vec<Problem> {
    let of_name = |(name, nearest): (&str, Option<&str>)| {
        let nearest = nearest.map_or_else(String::new, |nearest| format!("; the nearest is `{nearest}`"));
        let text = format!("{} has no weight of the face called `{name}`{nearest}", body.name);
        Problem::new(Place::Body, ProblemKind::Ignored, text)
    };
    unknown_faces(weights, body).into_iter().map(of_name).collect()
}

/// What a motion's face does that a body cannot.
fn face_note(motion: &MotionFile, body: &Body) -> Option<Problem> {
    let unplaced = unplaced_faces(motion, body);
    let names: Vec<String> = unplaced.iter().take(8).map(|name| format!("`{name}`")).collect();
    let more = if unplaced.len() > names.len() { " and others" } else { "" };
    let what =
        counted(unplaced.len(), "weight of the motion's face has", "weights of the motion's face have");
    let text = format!("{what} no place on this body: {}{more}", names.join(", "));
    (!unplaced.is_empty()).then(|| Problem::new(Place::Motion, ProblemKind::Note, text))
}

/// A joint by its path (`hips/spine/head`) or its name; the first of several with the same name.
fn find_joint(skeleton: &Skeleton, name: &str) -> Option<usize> {
    joint_paths(skeleton)
        .iter()
        .position(|path| path == name)
        .or_else(|| skeleton.joints.iter().position(|joint| joint.name == name))
}

/// Problems for ignored contents of a file and for its notes.
pub(super) fn file_notes(place: Place, dropped: &BTreeMap<String, u64>, notes: &[String]) -> Vec<Problem> {
    let dropped = dropped.iter().map(|(what, count)| {
        Problem::new(
            place,
            ProblemKind::Note,
            format!("ignored in the file: {count} {}", what.replace('_', " ")),
        )
    });
    let notes = notes.iter().map(|note| Problem::new(place, ProblemKind::Note, note));
    dropped.chain(notes).collect()
}

/// The sources of a motion, besides the body.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum MotionKey {
    Rest,
    Clip {
        name: String,
        shape: Shape,
    },
    /// A motion file, and the clip of it that is wanted if it has several.
    File {
        stamp: Stamp,
        settings: MotionSettings,
        clip: String,
        shape: Shape,
    },
}

/// The part of a clip that is played, and how it repeats.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Shape {
    /// Start, and end if it is not the clip's own, seconds.
    part: (f32, Option<f32>),
    looping: bool,
    blend: LoopBlend,
    blend_secs: f32,
}

impl Shape {
    fn of(section: &MotionSection) -> Self {
        Self {
            part: (section.start_secs, section.end_secs),
            looping: section.looping,
            blend: section.loop_blend,
            blend_secs: section.loop_blend_secs,
        }
    }

    /// The trimmed clip, with its ends blended if it loops but does not do so by itself, and a note if its ends differ.
    fn applied(self, clip: &Arc<Clip>, body: &Body) -> (Arc<Clip>, Option<Problem>) {
        let mut clip = Arc::clone(clip);
        if self.blend == LoopBlend::Start && clip.lead_secs != 0.0 {
            clip = Arc::new((*clip).clone().on_file_clock());
        }
        let (start, mut end) = self.part;
        if !self.looping && clip.added_secs > 0.0 && end.is_none() {
            // The step back to the first pose is none of the file.
            end = Some((clip.duration_secs - clip.added_secs) as f32);
        }
        if start > 0.0 || end.is_some() {
            let mut part = (*clip).clone().trimmed(f64::from(start), end.map(f64::from));
            part.detect_loop(body);
            clip = Arc::new(part);
        }
        if !self.looping || clip.loops || clip.duration_secs <= 0.0 {
            return (clip, None);
        }
        let blended = (*clip).clone().with_loop_blend(f64::from(self.blend_secs), self.blend);
        let note = loop_note(&blended);
        (Arc::new(blended), Some(note))
    }
}

/// What a clip whose last pose is not its first does while it loops.
pub(super) fn loop_note(clip: &Clip) -> Problem {
    let secs = clip.loop_blend_secs;
    let how = match clip.loop_blend {
        _ if secs <= 0.0 => "the body jumps when the motion starts again".to_owned(),
        LoopBlend::End => {
            format!("while the motion loops, its last {secs:.2} s are blended into the first pose")
        }
        LoopBlend::Start => format!(
            "the motion is {secs:.2} s shorter, and its first {secs:.2} s are blended with its end, by the setting Loop blend at"
        ),
    };
    Problem::new(Place::Motion, ProblemKind::Note, format!("the last pose is not the first: {how}"))
}

/// A motion of one body.
#[derive(Debug)]
pub(super) struct MotionPart {
    pub(super) clip: Option<Arc<Clip>>,
    pub(super) notes: Vec<Problem>,
}

impl MotionKey {
    pub(super) fn of(section: &MotionSection, access: &Access) -> Result<Self, Problem> {
        let shape = Shape::of(section);
        match (section.source, &section.file) {
            (MotionSource::Rest, _) => Ok(Self::Rest),
            (MotionSource::Clip, _) => Ok(Self::Clip { name: section.clip.clone(), shape }),
            (MotionSource::File, Some(file)) => {
                let stamp = Stamp::of(&access.read(Place::Motion, file)?);
                Ok(Self::File { stamp, settings: section.settings, clip: section.clip.clone(), shape })
            }
            (MotionSource::File, None) => {
                Err(Problem::not_loaded(Place::Motion, "no motion file is set; pick one"))
            }
        }
    }

    /// The body's first clip, or the rest pose if it has none.
    pub(super) fn first_clip() -> Self {
        Self::Clip { name: String::new(), shape: Shape::default() }
    }

    /// Loads the motion.
    ///
    /// # Errors
    /// If the load is cancelled. A motion that cannot be loaded is a problem.
    pub(super) fn load(
        &self,
        part: &BodyPart,
        control: &mut LoadControl<'_>,
    ) -> Result<Result<MotionPart, Problem>, ProjectError> {
        let file = match self {
            Self::File { stamp, settings, clip, .. } => {
                let (path, settings, clip) = (stamp.path.clone(), *settings, clip.clone());
                let read = control.read("loading the motion", [0.3, 0.5], move |watch| {
                    load_motion_watched(&path, settings, &clip, watch)
                })?;
                Some(read)
            }
            Self::Rest | Self::Clip { .. } => None,
        };
        Ok(self.of_file(part, file))
    }

    fn of_file(
        &self,
        part: &BodyPart,
        file: Option<Result<MotionFile, MotionError>>,
    ) -> Result<MotionPart, Problem> {
        match self {
            Self::Rest => Ok(MotionPart { clip: None, notes: Vec::new() }),
            Self::Clip { name, shape } => {
                let clip = if name.is_empty() {
                    part.clips.first()
                } else {
                    part.clips.iter().find(|clip| clip.name == *name)
                };
                match clip {
                    None if !name.is_empty() => {
                        let names: Vec<_> =
                            part.clips.iter().map(|clip| format!("`{}`", clip.name)).collect();
                        let has = if names.is_empty() { "no clips".to_owned() } else { names.join(", ") };
                        Err(Problem::not_loaded(
                            Place::Motion,
                            format!("{} has no clip called `{name}`; it has {has}", part.body.name),
                        ))
                    }
                    clip => {
                        let (clip, note) = clip.map(|clip| shape.applied(clip, &part.body)).unzip();
                        Ok(MotionPart { clip, notes: note.flatten().into_iter().collect() })
                    }
                }
            }
            Self::File { shape, .. } => {
                let refuse = |error| Problem::not_loaded(Place::Motion, error);
                let Some(file) = file else { return Ok(MotionPart { clip: None, notes: Vec::new() }) };
                let file = file.map_err(refuse)?;
                let clip = retarget(&file, &part.body).map_err(refuse)?;
                let (clip, note) = shape.applied(&Arc::new(clip), &part.body);
                let mut notes = file_notes(Place::Motion, &file.dropped, &file.notes);
                notes.extend(face_note(&file, &part.body));
                notes.extend(note);
                Ok(MotionPart { clip: Some(clip), notes })
            }
        }
    }
}
