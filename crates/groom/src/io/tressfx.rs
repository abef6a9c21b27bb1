//! AMD TressFX `.tfx`, versions 3.x and 4.x.
//!
//! Both store strands with equal numbers of points, strand after strand, root first. Version 3 has a header of 296
//! bytes and positions of three floats. Version 4 has a header of 160 bytes and positions of four floats, the fourth
//! being an inverse mass (0 for a held point). AMD's limits (4, 8, 16, 32 or 64 points per strand, multiples of 64
//! strands) are not part of the format and are not checked.

use super::HairFileError;
use super::bytes::{Bytes, triple_bytes, triples};
use super::file::{HairFile, RawHair};
use super::format::HairFormat;
use super::source::Source;
use super::units::UpAxis;

pub(super) static FORMAT: HairFormat = HairFormat {
    label: "TressFX .tfx",
    extensions: &["tfx"],
    signature: "a version from 3.0 to 4.9 as a float (TressFX)",
    states_unit: false,
    common_up: UpAxis::Y,
    magics: &[],
    may_begin: |start| version_of(start).is_some(),
    by_chance: true,
    read,
    write: Some(write),
};

const HEADER_3: u64 = 296;
const HEADER_4: u64 = 160;

/// The version, if these bytes are the start of a file of this format.
fn version_of(start: &[u8]) -> Option<f32> {
    let version = f32::from_le_bytes(*start.first_chunk()?);
    (3.0..5.0).contains(&version).then_some(version)
}

fn read(name: &str, source: Source<'_>) -> Result<RawHair, HairFileError> {
    let data = source.into_bytes(name)?;
    let file = Bytes::new(name, &data);
    let version = version_of(&data).unwrap_or_default();
    let raw = if version < 4.0 { read_3(&file) } else { read_4(&file) }?;
    Ok(RawHair { version: Some(version), ..raw })
}

fn read_3(file: &Bytes<'_>) -> Result<RawHair, HairFileError> {
    file.header(HEADER_3)?;
    let positions = Positions { header: HEADER_3, offset_at: 144, stride: 12 };
    let mut raw = positions.read(file)?;
    raw.both_ends_pinned = file.u32(16) != 0;
    let follow_hairs = file.u32(12);
    if follow_hairs > 0 {
        raw.notes.push(format!(
            "The file asks for {follow_hairs} follow hairs per strand, which it does not contain; none were made."
        ));
    }
    let optional = [
        (148, "thickness"),
        (152, "strand texture coordinates"),
        (156, "vertex colours"),
        (160, "guide indices"),
        (164, "vertex texture coordinates"),
    ];
    finish(file, &mut raw, &optional, &[]);
    Ok(raw)
}

fn read_4(file: &Bytes<'_>) -> Result<RawHair, HairFileError> {
    file.header(HEADER_4)?;
    let positions = Positions { header: HEADER_4, offset_at: 12, stride: 16 };
    let mut raw = positions.read(file)?;
    // The last point of a strand is free in most files; an inverse mass of zero there holds the tip.
    let (strands, per_strand) = (raw.point_counts.len(), file.u32(8) as usize);
    let array = file.array(u64::from(file.u32(12)), raw.points.len() as u64, 16, "positions")?;
    raw.both_ends_pinned = strands > 0
        && (1..=strands).all(|strand| {
            let at = strand * per_strand * 16 - 4;
            array[at..at + 4] == [0; 4]
        });
    let uv_bytes = 8 * strands as u64;
    let optional = [(20, "vertex texture coordinates"), (24, "thickness"), (28, "vertex colours")];
    finish(file, &mut raw, &optional, &[(16, "strand texture coordinates", uv_bytes)]);
    Ok(raw)
}

/// The position array of a version.
struct Positions {
    header: u64,
    offset_at: usize,
    stride: u64,
}

impl Positions {
    fn read(&self, file: &Bytes<'_>) -> Result<RawHair, HairFileError> {
        let (strands, per_strand) = (u64::from(file.u32(4)), u64::from(file.u32(8)));
        let offset = u64::from(file.u32(self.offset_at));
        if offset < self.header {
            return Err(file.malformed(
                self.offset_at as u64,
                format!("positions at byte {offset}"),
                format!("a place after the header of {} bytes", self.header),
            ));
        }
        if offset > file.len() {
            return Err(file.malformed(
                self.offset_at as u64,
                format!("positions at byte {offset} of a file of {} bytes", file.len()),
                "a place inside the file",
            ));
        }
        // The product of two u32 counts fits u64. Strands without points would be a count without bytes.
        if strands == 0 || per_strand == 0 {
            return Err(file.malformed(
                4,
                format!("{strands} strands of {per_strand} points"),
                "at least one strand of two points",
            ));
        }
        let array = file.array(offset, strands * per_strand, self.stride, "positions")?;
        if strands * per_strand > u64::from(u32::MAX) {
            return Err(file.malformed(4, format!("{} points", strands * per_strand), "at most 4294967295"));
        }
        let point_counts = vec![per_strand as u32; strands as usize];
        let points = triples(array, self.stride as usize).map(Into::into).collect();
        let trailing_bytes = file.len() - offset - array.len() as u64;
        Ok(RawHair { trailing_bytes, ..RawHair::new(point_counts, points) })
    }
}

/// Adds notes on the optional arrays, and corrects the number of trailing bytes. For `optional` arrays only the
/// header's offset is known (AMD documents no size that real files could confirm); `sized` ones also have a size in
/// bytes.
fn finish(file: &Bytes<'_>, raw: &mut RawHair, optional: &[(usize, &str)], sized: &[(usize, &str, u64)]) {
    for &(at, what, bytes) in sized {
        let offset = u64::from(file.u32(at));
        if offset == 0 {
            continue;
        }
        if offset + bytes > file.len() {
            raw.notes.push(format!("The {what} at byte {offset} lie outside the file and were left out."));
        } else {
            raw.trailing_bytes = raw.trailing_bytes.min(file.len() - (offset + bytes));
        }
    }
    for &(at, what) in optional {
        let offset = u64::from(file.u32(at));
        if offset == 0 {
            continue;
        }
        if offset >= file.len() {
            raw.notes.push(format!("The {what} at byte {offset} lie outside the file and were left out."));
        } else {
            raw.notes.push(format!("The {what} at byte {offset} were left out."));
            raw.trailing_bytes = 0;
        }
    }
    if raw.both_ends_pinned {
        raw.notes.push("The file fixes both ends of its strands; only roots are fixed here.".to_owned());
    }
}

/// Writes version 4 in centimetres with Y up, like AMD's own files. Fails for strands that differ in their number of points:
/// the format has one number for all of them.
fn write(hair: &HairFile) -> Result<Vec<u8>, String> {
    let counts = || hair.first_point.array_windows().map(|[start, end]| end - start);
    let (least, most) = (counts().min().unwrap_or(0), counts().max().unwrap_or(0));
    if least != most {
        return Err(format!(
            "strands of {least} to {most} points; .tfx needs the same number in all strands"
        ));
    }
    let mut out = 4.0_f32.to_le_bytes().to_vec();
    for word in [hair.strands() as u32, most, HEADER_4 as u32] {
        out.extend(word.to_le_bytes());
    }
    out.resize(HEADER_4 as usize, 0);
    for (i, &point) in hair.points.iter().enumerate() {
        // The inverse mass: only roots are held.
        let free = if (i as u32).is_multiple_of(most) { 0.0_f32 } else { 1.0 };
        out.extend(triple_bytes(point * 100.0).into_iter().chain(free.to_le_bytes()));
    }
    Ok(out)
}
