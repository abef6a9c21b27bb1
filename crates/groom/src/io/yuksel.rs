//! Cem Yuksel's `.hair` (<http://www.cemyuksel.com/research/hairmodels/>).
//!
//! A header of 128 bytes, then the arrays whose bits are set, in the order of the bits. A strand of `s`
//! segments has `s + 1` points.

use super::HairFileError;
use super::HairFormat;
use super::bytes::{Bytes, floats, triples};
use super::clean::RawHair;

const HEADER: u64 = 128;
const SEGMENTS: u32 = 1;
const POINTS: u32 = 1 << 1;
const THICKNESS: u32 = 1 << 2;
const TRANSPARENCY: u32 = 1 << 3;
const COLOURS: u32 = 1 << 4;
/// `LuxRender`'s variant: texture coordinates, two floats a point.
const UVS: u32 = 1 << 5;
const KNOWN: u32 = SEGMENTS | POINTS | THICKNESS | TRANSPARENCY | COLOURS | UVS;

pub(super) fn read(name: &str, data: &[u8]) -> Result<RawHair, HairFileError> {
    let file = Bytes::new(name, data);
    file.header(HEADER)?;
    let (strands, points) = (u64::from(file.u32(4)), u64::from(file.u32(8)));
    let (flags, default_segments) = (file.u32(12), file.u32(16));
    if flags & POINTS == 0 {
        return Err(file.malformed(12, format!("flags {flags:#x}"), "bit 1 set: an array of points"));
    }
    let mut notes = Vec::new();
    if flags & !KNOWN != 0 {
        notes.push(format!("Unknown flags {:#x} at byte 12 were ignored.", flags & !KNOWN));
    }

    let mut offset = HEADER;
    let segments = if flags & SEGMENTS == 0 {
        None
    } else {
        let array = file.array(offset, strands, 2, "segment counts")?;
        offset += array.len() as u64;
        Some(array)
    };
    let counted = match segments {
        Some(array) => segment_counts(array).map(|segments| u64::from(segments) + 1).sum(),
        None => strands * (u64::from(default_segments) + 1),
    };
    if counted != points {
        let by = if segments.is_some() { "the segments array" } else { "the default number of segments" };
        return Err(file.malformed(
            8,
            format!("{points} points"),
            format!("{counted}, as {strands} strands have by {by}"),
        ));
    }

    let mut take = |bit: u32, size: u64, what: &str| {
        if flags & bit == 0 {
            return Ok(None);
        }
        let array = file.array(offset, points, size, what)?;
        offset += array.len() as u64;
        Ok(Some(array))
    };
    let positions = take(POINTS, 12, "points")?.unwrap_or_default();
    let thickness = take(THICKNESS, 4, "thickness values")?;
    let transparency = take(TRANSPARENCY, 4, "transparency values")?;
    let colours = take(COLOURS, 12, "colours")?;
    if take(UVS, 8, "texture coordinates")?.is_some() {
        notes.push("Texture coordinates were left out: they have no use here.".to_owned());
    }

    // Every count has been checked against the file's size by now: the allocations below are bounded by it.
    let point_counts = match segments {
        Some(array) => segment_counts(array).map(|segments| u32::from(segments) + 1).collect(),
        None => vec![default_segments.saturating_add(1); strands as usize],
    };
    let default_colour = [file.f32(28), file.f32(32), file.f32(36)];
    Ok(RawHair {
        format: HairFormat::Yuksel,
        point_counts,
        points: triples(positions, 12).map(Into::into).collect(),
        thickness: thickness.map(floats),
        transparency: transparency.map(floats),
        colours: colours.map(|array| triples(array, 12).collect()),
        default_thickness: Some(file.f32(20)).filter(|value| value.is_finite()),
        default_transparency: Some(file.f32(24)).filter(|value| value.is_finite()),
        default_colour: Some(default_colour).filter(|colour| colour.iter().all(|value| value.is_finite())),
        both_ends_pinned: false,
        trailing_bytes: file.len() - offset,
        notes,
    })
}

fn segment_counts(array: &[u8]) -> impl Iterator<Item = u16> + '_ {
    array.as_chunks::<2>().0.iter().map(|&two| u16::from_le_bytes(two))
}
