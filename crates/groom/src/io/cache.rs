//! Curves over time: a simulation that was made elsewhere.

use std::path::Path;

use glam::Vec3;
use lovelock_alembic::OGAWA_MAGIC;

use super::clean::clean_keeping;
use super::file::{Bounds, HairFile};
use super::format::HairFormat;
use super::frames::{CurveFrames, OpenedFrames, Stated};
use super::source::Source;
use super::units::{Facing, Unit, UpAxis, rotation_to_head_axes};
use super::{HairFileError, UnitGuess, alembic, guess_units, usd};

/// Whether the curves of a file move.
#[derive(Debug)]
pub enum CurveMotion {
    /// They do not, or the file is of a format without curves over time, or it cannot be read at all.
    Still,
    /// At this number of times, two or more.
    Moving(usize),
    /// They move but cannot be played, for example because their number changes. As a still hairstyle they can be read.
    Refused(HairFileError),
}

impl CurveMotion {
    /// Looks into a file.
    pub fn of(path: &Path) -> Self {
        let name = path.display().to_string();
        match open(&name, path) {
            Ok(Some(((Ok(frames), _), _))) if frames.times().len() > 1 => Self::Moving(frames.times().len()),
            Ok(Some(((Err(reason), _), _))) => Self::Refused(reason),
            // Whoever reads the hair reports a file that cannot be read.
            Ok(_) | Err(_) => Self::Still,
        }
    }

    /// Why curves that move cannot be played, as a sentence that names the file.
    pub fn problem(&self) -> Option<String> {
        match self {
            Self::Refused(reason) => Some(format!(
                "{reason}; the motion of these curves cannot be played, only a still hairstyle is read"
            )),
            Self::Still | Self::Moving(_) => None,
        }
    }
}

/// The curves of an Alembic archive or of a USD stage over time, in metres with Y up.
///
/// The file stays open, and two of its times are in memory. Between them points move in straight lines, unless a transform turns them.
pub struct CurveCache {
    name: String,
    frames: Box<dyn CurveFrames>,
    hair: HairFile,
    /// Metres per unit, and the axis of the file that points up.
    metres_per_unit: f32,
    up: UpAxis,
    /// Which points of the file those of `hair` are; empty for all of them.
    kept: Vec<u32>,
    notes: Vec<String>,
    /// The points of the last two times that were asked for, with the index of each.
    held: [(usize, Vec<Vec3>); 2],
    read: Vec<Vec3>,
}

impl std::fmt::Debug for CurveCache {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("CurveCache").field("name", &self.name).finish_non_exhaustive()
    }
}

/// No time is in memory.
const NONE: usize = usize::MAX;

impl CurveCache {
    /// Opens a file. A unit or an up axis that is `Auto` is that of the file, or guessed. Strands that are hidden at the first time are
    /// left out, unless `include_hidden` is set.
    ///
    /// # Errors
    /// As [`load_hair`](super::load_hair), for files of other formats, and for curves whose number or points change over time.
    pub fn open(path: &Path, unit: Unit, up: UpAxis, include_hidden: bool) -> Result<Self, HairFileError> {
        let name = path.display().to_string();
        let Some(((frames, raw), format)) = open(&name, path)? else {
            return Err(HairFileError::Malformed {
                name,
                offset: 0,
                found: "a file of another format".to_owned(),
                wanted: "curves over time, in Alembic or USD".to_owned(),
            });
        };
        let frames = frames?;
        let whole = raw.points.len();
        let raw = raw.settled(&name, include_hidden)?;
        let guides = raw.left_out.clone();
        let mut kept = Vec::new();
        let mut hair = clean_keeping(&name, format, raw, Some(&mut kept))?;
        if let Some(of_points) = guides {
            let places: Vec<u32> = (0..).zip(&of_points).filter(|(_, kept)| **kept).map(|(i, _)| i).collect();
            for point in &mut kept {
                *point = places[*point as usize];
            }
        } else if kept.len() == whole {
            kept.clear();
        }
        let guess = guess_units(&hair);
        let from_file = hair.is_in_metres;
        let metres_per_unit = unit.metres().unwrap_or(guess.metres_per_unit);
        let mut notes = notes_on_units(unit, up, from_file.then(|| frames.stated()), &guess);
        notes.extend(hair.notes.iter().cloned());
        let up = up_or_guess(up, from_file, &guess);
        let mut cache = Self {
            name,
            frames,
            hair: hair.clone(),
            metres_per_unit,
            up,
            kept,
            notes,
            held: [(NONE, Vec::new()), (NONE, Vec::new())],
            read: Vec::new(),
        };
        let mut points = std::mem::take(&mut hair.points);
        for point in &mut points {
            *point = cache.in_metres(*point);
        }
        hair.bounds = Bounds::EMPTY;
        for &point in &points {
            hair.bounds.include(point);
        }
        hair.points = points;
        hair.thickness.iter_mut().flatten().for_each(|width| *width *= metres_per_unit);
        hair.default_thickness = hair.default_thickness.map(|width| width * metres_per_unit);
        hair.is_in_metres = true;
        cache.hair = hair;
        Ok(cache)
    }

    /// The times of the file, seconds, ascending; at least one.
    pub fn times(&self) -> &[f64] {
        self.frames.times()
    }

    /// The curves at the first time, in metres with Y up.
    pub fn hair(&self) -> &HairFile {
        &self.hair
    }

    /// Where the unit and the up axis come from, and what the reader left out, as sentences.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Replaces `out` by the points of [`Self::hair`] at a time, which is clamped to the times of the file; metres, Y up.
    ///
    /// # Errors
    /// For a file that cannot be read or contradicts itself at that time.
    pub fn points_at(&mut self, secs: f64, out: &mut Vec<Vec3>) -> Result<(), HairFileError> {
        let times = self.frames.times();
        if self.frames.bends() {
            let at = secs.clamp(times[0], times[times.len() - 1]);
            self.read_into(0, at)?;
            out.clear();
            out.extend_from_slice(&self.held[0].1);
            return Ok(());
        }
        let after = times.partition_point(|&time| time <= secs);
        let (from, to) = (after.saturating_sub(1), after.min(times.len() - 1));
        let (start, end) = (times[from], times[to]);
        let t = if end > start { ((secs - start) / (end - start)).clamp(0.0, 1.0) as f32 } else { 0.0 };
        let near = self.hold(from, to)?;
        let far = if t > 0.0 { self.hold(to, from)? } else { near };
        let (near, far) = (&self.held[near].1, &self.held[far].1);
        out.clear();
        out.extend(near.iter().zip(far).map(|(a, b)| a.lerp(*b, t)));
        Ok(())
    }

    /// Brings a time into memory, in place of any but `other`. Returns where it is.
    fn hold(&mut self, index: usize, other: usize) -> Result<usize, HairFileError> {
        if let Some(held) = self.held.iter().position(|(held, _)| *held == index) {
            return Ok(held);
        }
        let place = self.held.iter().position(|(held, _)| *held != other).unwrap_or(0);
        let secs = self.frames.times()[index];
        self.read_into(place, secs)?;
        self.held[place].0 = index;
        Ok(place)
    }

    /// Reads the points at a time into a place in memory, which is then that of no time of the file.
    fn read_into(&mut self, place: usize, secs: f64) -> Result<(), HairFileError> {
        self.held[place].0 = NONE;
        self.frames.points(secs, &mut self.read)?;
        let (metres, up) = (self.metres_per_unit, self.up);
        let (read, points) = (&self.read, &mut self.held[place].1);
        points.clear();
        if self.kept.is_empty() {
            points.extend(read.iter().map(|&point| in_metres(point, metres, up)));
        } else {
            points.extend(self.kept.iter().map(|&i| in_metres(read[i as usize], metres, up)));
        }
        if let Some(point) = points.iter().find(|point| !point.is_finite()) {
            return Err(HairFileError::Malformed {
                name: self.name.clone(),
                offset: 0,
                found: format!("a point at {point} at {secs} s"),
                wanted: "finite coordinates".to_owned(),
            });
        }
        Ok(())
    }

    fn in_metres(&self, point: Vec3) -> Vec3 {
        in_metres(point, self.metres_per_unit, self.up)
    }
}

/// Where the unit and the up axis of a file come from. `of_file` is what a file states that is read in metres.
fn notes_on_units(unit: Unit, up: UpAxis, of_file: Option<Stated>, guess: &UnitGuess) -> Vec<String> {
    let metres = |metres: f32| match Unit::NAMED.into_iter().find(|unit| unit.metres() == Some(metres)) {
        Some(unit) => format!("one {}", unit.word()),
        None => format!("{metres} m"),
    };
    let unit = match unit.metres() {
        Some(chosen) => format!("Unit: {}, as set.", metres(chosen)),
        None if of_file.is_some_and(|stated| stated.unit) => {
            "Unit: read from the file; its points are in metres.".to_owned()
        }
        None if of_file.is_some() => {
            "Unit: one centimetre, the default of USD; the file states none.".to_owned()
        }
        None => format!("Unit: {}, guessed. {}", metres(guess.metres_per_unit), guess.reason),
    };
    let up = match up {
        UpAxis::Auto if of_file.is_some_and(|stated| stated.up) => {
            "Up axis: read from the file; its points have Y up.".to_owned()
        }
        UpAxis::Auto if of_file.is_none() && !guess.is_up_in_doubt() => {
            format!("Up axis: {}, guessed from the strands.", guess.up.label())
        }
        UpAxis::Auto => {
            "Up axis: Y, the usual one; the file states none. `--up` or the setting *Up axis* changes it."
                .to_owned()
        }
        up => format!("Up axis: {}, as set.", up.label()),
    };
    vec![unit, up]
}

/// The axis that points up. Hair that flies says nothing about it: then it is Y, as is usual in both formats.
fn up_or_guess(up: UpAxis, is_stated: bool, guess: &UnitGuess) -> UpAxis {
    match up {
        UpAxis::Auto if is_stated || guess.is_up_in_doubt() => UpAxis::Y,
        UpAxis::Auto => guess.up,
        up => up,
    }
}

/// A point in metres with Y up, by the smallest rotation. Where Z points up, the face therefore looks along -Y, as in modellers.
fn in_metres(point: Vec3, metres_per_unit: f32, up: UpAxis) -> Vec3 {
    let facing = match up {
        UpAxis::Z => Facing::MinusY,
        UpAxis::MinusZ => Facing::PlusY,
        _ => Facing::PlusZ,
    };
    let point = point * metres_per_unit;
    if up == UpAxis::Y { point } else { rotation_to_head_axes(up, facing) * point }
}

/// The content of a file and its format; `None` for formats without curves over time.
fn open(name: &str, path: &Path) -> Result<Option<(OpenedFrames, &'static HairFormat)>, HairFileError> {
    let source = Source::open(name, path)?;
    let start = source.start();
    if start.starts_with(OGAWA_MAGIC) {
        return Ok(Some((alembic::frames(name, source)?, &alembic::FORMAT)));
    }
    if usd::FORMAT.magics.iter().any(|magic| start.starts_with(magic)) {
        return Ok(Some((usd::frames(name, source)?, &usd::FORMAT)));
    }
    Ok(None)
}

#[cfg(test)]
#[path = "cache_tests.rs"]
mod tests;
