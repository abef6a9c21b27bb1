//! How values of options are read.

use std::ops::Range;
use std::path::Path;
use std::str::FromStr;

use lovelock_groom::{Unit, UpAxis};
use lovelock_jobs::bench::{BenchScene, LockScene};
use lovelock_jobs::reference::ReferenceScene;
use lovelock_project::project::Assignment;
use lovelock_record::{FilmQuality, SequenceFormat};
use lovelock_render::{Backend, ShadowMethod, UserMethod};

/// Shadow methods; all of them if empty.
#[derive(Clone, Debug)]
pub(crate) struct Methods(pub(crate) Vec<ShadowMethod>);

/// Backends, one after the other.
#[derive(Clone, Debug)]
pub(crate) struct Backends(pub(crate) Vec<Backend>);

/// What `bench` measures by one of its arguments.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum BenchTarget {
    Scene(BenchScene),
    Locks(Vec<LockScene>),
    VoxelMap,
    OccupancyOrder,
    Reference(Vec<ReferenceScene>),
}

impl FromStr for BenchTarget {
    type Err = String;

    fn from_str(id: &str) -> Result<Self, String> {
        match id {
            "locks" => Ok(Self::Locks(LockScene::ALL.to_vec())),
            "voxel-map" => Ok(Self::VoxelMap),
            "occupancy-order" => Ok(Self::OccupancyOrder),
            _ if id.starts_with("reference") => ReferenceScene::named(id).map(Self::Reference),
            _ if id.starts_with("locks-") => Ok(Self::Locks(vec![id.parse()?])),
            _ => id
                .parse()
                .map(Self::Scene)
                .map_err(|error: String| format!("{error}, locks, voxel-map, occupancy-order or reference")),
        }
    }
}

/// `A..B`, half open and not empty.
pub(super) fn frames(text: &str) -> Result<Range<u64>, String> {
    let wanted = || format!("found `{text}`; must be A..B with A below B, such as 0..240");
    let (start, end) = text.split_once("..").ok_or_else(wanted)?;
    let number = |text: &str| u64::from_str(text.trim()).map_err(|_| wanted());
    let range = number(start)?..number(end)?;
    if range.is_empty() { Err(wanted()) } else { Ok(range) }
}

/// `NAME=VALUE`.
pub(super) fn assignment(text: &str) -> Result<Assignment, String> {
    let (name, value) = text
        .split_once('=')
        .ok_or_else(|| format!("found `{text}`; must be NAME=VALUE, such as simulation.wind.speed=3"))?;
    Ok(Assignment { name: name.trim().to_owned(), value: value.trim().to_owned() })
}

/// `WxH`, pixels.
pub(super) fn size(text: &str) -> Result<(u32, u32), String> {
    let wanted = || format!("found `{text}`; must be WIDTHxHEIGHT in pixels, such as 1280x720");
    let (width, height) = text.split_once(['x', 'X', '×']).ok_or_else(wanted)?;
    let number = |text: &str| u32::from_str(text.trim()).ok().filter(|n| *n > 0).ok_or_else(wanted);
    Ok((number(width)?, number(height)?))
}

/// Seconds of one turn of the camera.
pub(super) fn turn(text: &str) -> Result<f32, String> {
    let secs = text.trim().parse::<f32>().ok().filter(|secs| (0.5..=600.0).contains(secs));
    secs.ok_or_else(|| format!("found `{text}`; must be 0.5 to 600 seconds"))
}

/// Ids separated by commas, or `all`.
pub(super) fn methods(text: &str) -> Result<Methods, String> {
    if text.trim() == "all" {
        return Ok(Methods(Vec::new()));
    }
    let method = |id: &str| ShadowMethod::from_str(id.trim()).map_err(|error| format!("{error}, or all"));
    text.split(',').map(method).collect::<Result<_, _>>().map(Methods)
}

/// A folder with a shadow method of the user's own, which is read.
pub(super) fn user_method(folder: &str) -> Result<UserMethod, String> {
    UserMethod::load(Path::new(folder)).map_err(|error| {
        if ShadowMethod::ALL.iter().any(|method| method.to_string() == folder) {
            format!("{error}. `{folder}` is built in: `record --shadow` and `compare --methods` choose it")
        } else {
            error
        }
    })
}

pub(super) fn backends(text: &str) -> Result<Backends, String> {
    if text == "both" {
        return Ok(Backends(vec![Backend::Cpu, Backend::Gpu]));
    }
    let backend = Backend::from_str(text).map_err(|error| format!("{error}, or both"))?;
    Ok(Backends(vec![backend]))
}

/// `X,Y`, pixels from the upper left corner.
pub(super) fn pixel(text: &str) -> Result<[u32; 2], String> {
    let wanted = || format!("found `{text}`; must be X,Y from the upper left corner, such as 640,200");
    let (x, y) = text.split_once(',').ok_or_else(wanted)?;
    let number = |text: &str| u32::from_str(text.trim()).map_err(|_| wanted());
    Ok([number(x)?, number(y)?])
}

pub(super) fn unit(text: &str) -> Result<Unit, String> {
    Unit::from_id(text).ok_or_else(|| format!("found `{text}`; must be auto, m, cm, mm or in"))
}

pub(super) fn up_axis(text: &str) -> Result<UpAxis, String> {
    UpAxis::from_id(text).ok_or_else(|| format!("found `{text}`; must be {}", UpAxis::IDS))
}

pub(super) fn up_axis_help(file: &str) -> String {
    format!("Axis of {file} that points up: {}", UpAxis::IDS)
}

/// The quality of a film with that id.
pub(super) fn quality(text: &str) -> Result<FilmQuality, String> {
    FilmQuality::ALL.into_iter().find(|quality| quality.id() == text).ok_or_else(|| {
        let known: Vec<_> = FilmQuality::ALL.iter().map(|quality| quality.id()).collect();
        format!("must be one of {}", known.join(", "))
    })
}

/// The file format of that id.
pub(super) fn format(text: &str) -> Result<SequenceFormat, String> {
    SequenceFormat::ALL.into_iter().find(|format| format.id() == text).ok_or_else(|| {
        let known: Vec<_> = SequenceFormat::ALL.iter().map(|format| format.id()).collect();
        format!("must be one of {}", known.join(", "))
    })
}

pub(super) fn degrees(text: &str) -> Result<f32, String> {
    f32::from_str(text)
        .ok()
        .filter(|degrees| (0.0..=360.0).contains(degrees))
        .ok_or_else(|| format!("found `{text}`; must be 0 to 360 degrees"))
}

pub(super) fn rate(text: &str) -> Result<f64, String> {
    f64::from_str(text)
        .ok()
        .filter(|fps| (1.0..=240.0).contains(fps))
        .ok_or_else(|| format!("found `{text}`; must be 1 to 240 frames per second"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_half_open() {
        assert_eq!(frames("0..240"), Ok(0..240));
        for wrong in ["", "5", "5..5", "9..3", "a..b", "-1..4", "0..99999999999999999999"] {
            assert!(frames(wrong).is_err_and(|e| e.contains(wrong)), "{wrong}");
        }
    }

    #[test]
    fn sizes_are_pixels() {
        assert_eq!(size("1280x720"), Ok((1280, 720)));
        for wrong in ["1280", "0x5", "x", "-1x2", "9999999999x1", "1.5x2"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn the_name_of_a_method_that_is_built_in_is_no_folder() {
        let of = |folder| user_method(folder).expect_err("no folder");
        assert!(of("moments").contains("`record --shadow`"), "{}", of("moments"));
        assert!(!of("no-method").contains("--shadow"), "control: {}", of("no-method"));
    }
}
