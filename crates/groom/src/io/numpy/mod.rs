//! Strands as arrays of `NumPy`, `.npy` and `.npz`: strands × points × 3 (`DiffLocks`, Perm, hairutil), or points × 3 with the numbers of points of
//! the strands in a second array.
//!
//! Shorter strands may end with points that are not numbers, or with copies of one point, such as zeros ([`filling`]). The three numbers of a
//! point may also run along the first or the second side. A `.npz` file is a ZIP archive of arrays; which one holds the strands is told by
//! shape and name.

mod array;
mod filling;
mod relative;
mod sides;

use std::io::{Cursor, Read, Seek, Write as _};

use glam::Vec3;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

use super::HairFileError;
use super::file::{HairFile, RawHair};
use super::format::HairFormat;
use super::source::Source;
use super::units::UpAxis;
use array::{Layout, MAGIC, layout};
use sides::Sides;

pub(super) static ARRAY: HairFormat = HairFormat {
    label: "NumPy array",
    extensions: &["npy"],
    signature: "`\\x93NUMPY` (an array of NumPy)",
    states_unit: false,
    common_up: UpAxis::Y,
    magics: &[MAGIC],
    may_begin: |_| false,
    by_chance: false,
    read: read_array,
    write: Some(write_array),
};

pub(super) static ARCHIVE: HairFormat = HairFormat {
    label: "NumPy archive",
    extensions: &["npz"],
    signature: "`PK` (a ZIP archive of arrays of NumPy)",
    states_unit: false,
    common_up: UpAxis::Y,
    magics: &[],
    may_begin: |start| start.starts_with(b"PK\x03\x04") || start.starts_with(b"PK\x05\x06"),
    // Packages of other formats begin in the same way.
    by_chance: true,
    read: read_archive,
    write: Some(write_archive),
};

/// Names of arrays of points, the most common ones first.
const NAMES: [&str; 12] = [
    "positions",
    "points",
    "point",
    "strands",
    "strand_points",
    "hair",
    "hair_strands",
    "vertices",
    "data",
    "pts",
    "curves",
    "arr_0",
];
/// The most arrays of an archive that are looked at.
const MOST_ARRAYS: usize = 1024;
/// How much an archive may unpack to: this many times its size, and this many bytes more.
const UNPACKED: (u64, u64) = (64, 1 << 26);
/// Bytes of an entry that contain the description of its array.
const DESCRIPTION: u64 = 1 << 12;
const WANTED: &str = "an array of floats with strands × points × 3 numbers";

fn malformed(name: &str, found: String, wanted: &str) -> HairFileError {
    HairFileError::Malformed { name: name.to_owned(), offset: 0, found, wanted: wanted.to_owned() }
}

fn read_array(name: &str, source: Source<'_>) -> Result<RawHair, HairFileError> {
    let data = source.into_bytes(name)?;
    let layout = layout(&data).map_err(|found| malformed(name, found, WANTED))?;
    if !Sides::fit(&layout) {
        return Err(malformed(name, layout.words(), WANTED));
    }
    let numbers = layout
        .numbers(&data, single)
        .map_err(|found| malformed(name, found, "as many numbers as its shape"))?;
    let mut raw = strands(&layout, &numbers);
    if relative::begin_in_one_place(&raw) {
        raw.notes.push(relative::NOTE.to_owned());
    }
    raw.trailing_bytes = layout.bytes().map_or(0, |bytes| (data.len() - layout.start - bytes) as u64);
    Ok(raw)
}

/// The points of an array of strands.
fn strands(layout: &Layout, numbers: &[f32]) -> RawHair {
    let Some(sides) = Sides::of(layout, numbers) else { return RawHair::new(Vec::new(), Vec::new()) };
    let mut raw = RawHair::new(vec![sides.points as u32; sides.strands], sides.all(numbers).collect());
    filling::end_strands(&mut raw);
    raw.notes.extend(sides.note());
    raw
}

fn point(numbers: &[f32]) -> Vec3 {
    Vec3::new(numbers[0], numbers[1], numbers[2])
}

fn single(number: f64) -> f32 {
    number as f32
}

/// The arrays of an archive.
struct Arrays<R> {
    archive: ZipArchive<R>,
    /// Name and layout of each.
    all: Vec<(String, Layout)>,
    /// Bytes that may still be unpacked.
    left: u64,
}

impl<R: Read + Seek> Arrays<R> {
    fn open(name: &str, reader: R, length: u64) -> Result<Self, HairFileError> {
        let refused =
            |error: zip::result::ZipError| malformed(name, format!("no whole ZIP archive ({error})"), "one");
        let mut archive = ZipArchive::new(reader).map_err(refused)?;
        let mut arrays = Vec::new();
        for index in 0..archive.len().min(MOST_ARRAYS) {
            let Ok(entry) = archive.by_index(index) else { continue };
            let file = entry.name().to_owned();
            let mut start = Vec::new();
            let read = entry.take(DESCRIPTION).read_to_end(&mut start);
            // What is no array is of no use here.
            if let (Ok(_), Ok(layout)) = (read, layout(&start)) {
                arrays.push((file, layout));
            }
        }
        let left = length.saturating_mul(UNPACKED.0).saturating_add(UNPACKED.1);
        Ok(Self { archive, all: arrays, left })
    }

    /// The numbers of an array.
    fn numbers<T: Copy>(
        &mut self,
        name: &str,
        at: usize,
        of: impl Fn(f64) -> T,
    ) -> Result<Vec<T>, HairFileError> {
        let (file, layout) = &self.all[at];
        let bytes = layout
            .bytes()
            .and_then(|bytes| bytes.checked_add(layout.start))
            .map_or(u64::MAX, |bytes| bytes as u64);
        if bytes > self.left {
            let found = format!("`{file}` of {bytes} bytes");
            return Err(malformed(
                name,
                found,
                &format!("{} at most, for an archive of this size", self.left),
            ));
        }
        self.left -= bytes;
        let mut data = Vec::new();
        let unpack = |data: &mut Vec<u8>, archive: &mut ZipArchive<R>| -> Result<usize, String> {
            let entry = archive.by_name(file).map_err(|error| error.to_string())?;
            entry.take(bytes).read_to_end(data).map_err(|error| error.to_string())
        };
        unpack(&mut data, &mut self.archive).map_err(|error| {
            malformed(name, format!("`{file}` that cannot be unpacked ({error})"), "a whole archive")
        })?;
        layout
            .numbers(&data, of)
            .map_err(|found| malformed(name, format!("`{file}`: {found}"), "as many numbers as its shape"))
    }
}

/// The place of an array's name among those known for points.
fn rank(file: &str) -> usize {
    let stem = file.rsplit('/').next().unwrap_or(file).trim_end_matches(".npy").to_ascii_lowercase();
    NAMES.iter().position(|name| *name == stem).unwrap_or(NAMES.len())
}

fn read_archive(name: &str, source: Source<'_>) -> Result<RawHair, HairFileError> {
    let data = source.into_bytes(name)?;
    let mut arrays = Arrays::open(name, Cursor::new(&data[..]), data.len() as u64)?;
    let places = 0..arrays.all.len();
    let size = |at: usize| arrays.all[at].1.count().unwrap_or_default();
    let best = |fits: &dyn Fn(&Layout) -> bool| {
        let fitting = places.clone().filter(|&at| fits(&arrays.all[at].1));
        let known = |at: usize| (rank(&arrays.all[at].0), !Sides::are_usual(&arrays.all[at].1));
        fitting.min_by_key(|&at| (known(at), std::cmp::Reverse(size(at))))
    };
    let whole = best(&Sides::fit);
    let flat = best(&|layout| layout.has_floats() && matches!(layout.shape[..], [_, 3]));
    let is_count = |layout: &Layout| layout.has_integers() && layout.shape.len() == 1;
    let counts: Vec<usize> = places.clone().filter(|&at| is_count(&arrays.all[at].1)).collect();
    let others = |used: &[usize], arrays: &[(String, Layout)]| {
        let left = arrays.iter().enumerate().filter(|(at, _)| !used.contains(at));
        left.map(|(_, (file, layout))| format!("{} ({})", file.trim_end_matches(".npy"), layout.words()))
            .collect::<Vec<_>>()
    };
    let (mut raw, used) = if let Some(at) = whole {
        let layout = arrays.all[at].1.clone();
        let mut raw = strands(&layout, &arrays.numbers(name, at, single)?);
        let roots = roots_of(name, &mut arrays, raw.point_counts.len())?;
        let mut used = vec![at];
        if let Some((of, places)) = roots
            && relative::move_to(&mut raw, &places)
        {
            let array = arrays.all[of].0.trim_end_matches(".npy");
            raw.notes.push(format!("The strands are relative to their roots, which the array {array} has."));
            used.push(of);
        } else if relative::begin_in_one_place(&raw) {
            raw.notes.push(relative::NOTE.to_owned());
        }
        (raw, used)
    } else if let Some(at) = flat
        && let Some((of, counts)) = counts_of(name, &mut arrays, &counts, at)?
    {
        let points = arrays.numbers(name, at, single)?.chunks_exact(3).map(point).collect();
        (RawHair::new(counts, points), vec![at, of])
    } else {
        let found = match &others(&[], &arrays.all)[..] {
            [] => "an archive without an array of NumPy".to_owned(),
            all => format!("the arrays {}", all.join(", ")),
        };
        return Err(malformed(name, found, WANTED));
    };
    let left = others(&used, &arrays.all);
    if !left.is_empty() {
        let read = arrays.all[used[0]].0.trim_end_matches(".npy");
        raw.notes.push(format!("Read the array {read}; left out: {}.", left.join(", ")));
    }
    Ok(raw)
}

/// The array with a place for the root of each of `strands` strands, by its name, and these places.
fn roots_of<R: Read + Seek>(
    name: &str,
    arrays: &mut Arrays<R>,
    strands: usize,
) -> Result<Option<(usize, Vec<Vec3>)>, HairFileError> {
    let is_root = |(file, layout): &(String, Layout)| {
        file.to_ascii_lowercase().contains("root")
            && layout.has_floats()
            && matches!(layout.shape[..], [count, 3] | [1, count, 3] | [count, 1, 3] if count == strands)
    };
    let Some(at) = arrays.all.iter().position(is_root) else { return Ok(None) };
    let numbers = arrays.numbers(name, at, single)?;
    Ok(Some((at, numbers.chunks_exact(3).map(point).collect())))
}

/// The array that says how many points each strand has, where the points of all are in one array: numbers that add up to that of the points,
/// the first point of each strand, or the strand of each point.
fn counts_of<R: Read + Seek>(
    name: &str,
    arrays: &mut Arrays<R>,
    candidates: &[usize],
    points: usize,
) -> Result<Option<(usize, Vec<u32>)>, HairFileError> {
    let total = arrays.all[points].1.shape[0];
    if total > u32::MAX as usize {
        return Ok(None);
    }
    for &at in candidates {
        if arrays.all[at].1.shape[0] > total + 1 {
            continue;
        }
        let numbers = arrays.numbers(name, at, |number| number)?;
        let rises = numbers.array_windows().all(|[a, b]| a <= b);
        let is_valid = numbers.iter().all(|number| (0.0..=total as f64).contains(number));
        if !is_valid || numbers.is_empty() {
            continue;
        }
        if numbers.iter().sum::<f64>() == total as f64 {
            return Ok(Some((at, numbers.iter().map(|&count| count as u32).collect())));
        }
        if rises && numbers[0] == 0.0 && numbers.len() < total {
            let mut ends = numbers.clone();
            if ends.last() != Some(&(total as f64)) {
                ends.push(total as f64);
            }
            return Ok(Some((at, ends.array_windows().map(|[a, b]| (b - a) as u32).collect())));
        }
        if rises && numbers.len() == total {
            return Ok(Some((
                at,
                numbers.chunk_by(|a, b| a == b).map(|strand| strand.len() as u32).collect(),
            )));
        }
    }
    Ok(None)
}

/// Writes metres, Y up.
fn write_array(hair: &HairFile) -> Result<Vec<u8>, String> {
    let mut counts = hair.first_point.array_windows().map(|[a, b]| b - a);
    let points = counts.next().unwrap_or_default();
    if let Some(other) = counts.find(|&count| count != points) {
        return Err(format!(
            "strands of {points} and of {other} points; arrays of NumPy hold strands of equal numbers of points"
        ));
    }
    let numbers = hair.points.iter().flat_map(Vec3::to_array);
    Ok(array::file(&[hair.strands(), points as usize, 3], numbers))
}

/// Writes the array `positions`, not compressed.
fn write_archive(hair: &HairFile) -> Result<Vec<u8>, String> {
    let array = write_array(hair)?;
    let pack = || -> Result<Vec<u8>, Box<dyn std::error::Error>> {
        let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Stored)
            .large_file(array.len() >= 1 << 31);
        writer.start_file("positions.npy", options)?;
        writer.write_all(&array)?;
        Ok(writer.finish()?.into_inner())
    };
    pack().map_err(|error| format!("the archive cannot be written ({error})"))
}

#[cfg(test)]
mod tests;
