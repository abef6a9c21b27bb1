//! AMD TressFX `.tfx`, versions 3.x and 4.x.
//!
//! Both hold strands of equal numbers of points, strand after strand, root first. Version 3 has a header of
//! 296 bytes and positions of three floats; version 4 has a header of 160 bytes and positions of four, the
//! fourth an inverse mass (0 where the point is held). Neither AMD's limit to 4, 8, 16, 32 or 64 points a
//! strand nor its multiples of 64 strands belong to the format, so they are not asked for here.

use super::HairFileError;
use super::HairFormat;
use super::bytes::{Bytes, triples};
use super::clean::RawHair;

const HEADER_3: u64 = 296;
const HEADER_4: u64 = 160;

pub(super) fn read_v3(name: &str, data: &[u8], version: f32) -> Result<RawHair, HairFileError> {
    let file = Bytes::new(name, data);
    file.header(HEADER_3)?;
    let positions = Positions { header: HEADER_3, offset_at: 144, stride: 12 };
    let mut raw = positions.read(&file, HairFormat::TressFx3(version))?;
    raw.both_ends_pinned = file.u32(16) != 0;
    let follow_hairs = file.u32(12);
    if follow_hairs > 0 {
        raw.notes.push(format!(
            "The file asks for {follow_hairs} follow hairs a strand, which are not in it and were not made."
        ));
    }
    let optional = [
        (148, "thickness"),
        (152, "strand texture coordinates"),
        (156, "vertex colours"),
        (160, "guide indices"),
        (164, "vertex texture coordinates"),
    ];
    finish(&file, &mut raw, &optional, &[]);
    Ok(raw)
}

pub(super) fn read_v4(name: &str, data: &[u8], version: f32) -> Result<RawHair, HairFileError> {
    let file = Bytes::new(name, data);
    file.header(HEADER_4)?;
    let positions = Positions { header: HEADER_4, offset_at: 12, stride: 16 };
    let mut raw = positions.read(&file, HairFormat::TressFx4(version))?;
    // The last point of a strand is free in ordinary files; a zero inverse mass there holds the tip.
    let (strands, per_strand) = (raw.point_counts.len(), file.u32(8) as usize);
    let array = file.array(u64::from(file.u32(12)), raw.points.len() as u64, 16, "positions")?;
    raw.both_ends_pinned = strands > 0
        && (1..=strands).all(|strand| {
            let at = strand * per_strand * 16 - 4;
            array[at..at + 4] == [0; 4]
        });
    let uv_bytes = 8 * strands as u64;
    let optional = [(20, "vertex texture coordinates"), (24, "thickness"), (28, "vertex colours")];
    finish(&file, &mut raw, &optional, &[(16, "strand texture coordinates", uv_bytes)]);
    Ok(raw)
}

/// Where a version keeps its positions.
struct Positions {
    header: u64,
    offset_at: usize,
    stride: u64,
}

impl Positions {
    fn read(&self, file: &Bytes<'_>, format: HairFormat) -> Result<RawHair, HairFileError> {
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
        // A product of two u32 counts fits u64; strands of no points would be a count without bytes.
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
        Ok(RawHair { trailing_bytes, ..RawHair::new(format, point_counts, points) })
    }
}

/// Notes the optional arrays and what follows the known ones. `optional` arrays have a place in the header
/// alone (AMD documents no size that real files could confirm); `sized` ones also have bytes.
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
        raw.notes.push("The file holds both ends of its strands; only roots are held here.".to_owned());
    }
}
