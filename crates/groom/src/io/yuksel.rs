//! Cem Yuksel's `.hair` (<http://www.cemyuksel.com/research/hairmodels/>).
//!
//! A header of 128 bytes, then the arrays whose flags are set, in the order of the bits. A strand of `s` segments has
//! `s + 1` points.

use lovelock_base::words::counted;

use super::HairFileError;
use super::bytes::{Bytes, floats, triple_bytes, triples};
use super::file::{HairFile, RawHair};
use super::format::HairFormat;
use super::source::Source;
use super::units::{Facing, UpAxis, rotation_to_head_axes};

pub(super) static FORMAT: HairFormat = HairFormat {
    label: "Yuksel .hair",
    extensions: &["hair"],
    signature: "`HAIR` (Yuksel)",
    states_unit: false,
    common_up: UpAxis::Z,
    magics: &[MAGIC, SMALL_MAGIC],
    may_begin: |_| false,
    by_chance: false,
    read,
    write: Some(write),
};

const MAGIC: &[u8] = b"HAIR";
/// As some works on the reconstruction of hair write it.
const SMALL_MAGIC: &[u8] = b"hair";

const HEADER: u64 = 128;
const SEGMENTS: u32 = 1;
const POINTS: u32 = 1 << 1;
const THICKNESS: u32 = 1 << 2;
const TRANSPARENCY: u32 = 1 << 3;
const COLOURS: u32 = 1 << 4;
/// `LuxRender`'s variant: texture coordinates, two floats per point.
const UVS: u32 = 1 << 5;
const KNOWN: u32 = SEGMENTS | POINTS | THICKNESS | TRANSPARENCY | COLOURS | UVS;

fn read(name: &str, source: Source<'_>) -> Result<RawHair, HairFileError> {
    let data = source.into_bytes(name)?;
    let file = Bytes::new(name, &data);
    file.header(HEADER)?;
    let (mut strands, mut points) = (u64::from(file.u32(4)), u64::from(file.u32(8)));
    let (flags, default_segments) = (file.u32(12), file.u32(16));
    if flags & POINTS == 0 {
        return Err(file.malformed(12, format!("flags {flags:#x}"), "bit 1 set: an array of points"));
    }
    let mut notes = Vec::new();
    if flags & !KNOWN != 0 {
        notes.push(format!("Unknown flags {:#x} at byte 12 were ignored.", flags & !KNOWN));
    }
    // Writers that are cut off leave no true numbers.
    if is_unknown(strands)
        && let Some(found) = strands_by_length(&data[HEADER as usize..], flags, default_segments)
    {
        notes.push(format!(
            "The header states {}; by the length of the file there are {found}.",
            counted(strands, "strand", "strands")
        ));
        strands = found;
    }

    let mut offset = HEADER;
    let segments = if flags & SEGMENTS == 0 {
        None
    } else {
        let array = file.array(offset, strands, 2, "segment counts")?;
        offset += array.len() as u64;
        Some(array)
    };
    let expected = match segments {
        Some(array) => segment_counts(array).map(|segments| u64::from(segments) + 1).sum(),
        None => strands * (u64::from(default_segments) + 1),
    };
    if expected > 0 && is_unknown(points) {
        let stated = counted(points, "point", "points");
        notes.push(format!("The header states {stated}; the {expected} of the strands were read."));
        points = expected;
    }
    if expected != points {
        let by = if segments.is_some() { "the segments array" } else { "the default number of segments" };
        let strands = counted(strands, "strand", "strands");
        return Err(file.malformed(
            8,
            counted(points, "point", "points"),
            format!("{expected}, from {strands} and {by}"),
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
        notes.push("Texture coordinates were left out: they are not used.".to_owned());
    }

    // Every count has been compared with the file's size by now, so the allocations below are bounded by it.
    let point_counts = match segments {
        Some(array) => segment_counts(array).map(|segments| u32::from(segments) + 1).collect(),
        None => vec![default_segments.saturating_add(1); strands as usize],
    };
    let default_colour = [file.f32(28), file.f32(32), file.f32(36)];
    Ok(RawHair {
        thickness: thickness.map(floats),
        transparency: transparency.map(floats),
        colours: colours.map(|array| triples(array, 12).collect()),
        default_thickness: Some(file.f32(20)).filter(|value| value.is_finite()),
        default_transparency: Some(file.f32(24)).filter(|value| value.is_finite()),
        default_colour: Some(default_colour).filter(|colour| colour.iter().all(|value| value.is_finite())),
        trailing_bytes: file.len() - offset,
        notes,
        ..RawHair::new(point_counts, triples(positions, 12).map(Into::into).collect())
    })
}

/// Whether a count is what writers put there that do not know it yet.
fn is_unknown(count: u64) -> bool {
    [0, u64::from(u32::MAX)].contains(&count)
}

/// The number of strands whose arrays end where the file does.
fn strands_by_length(arrays: &[u8], flags: u32, default_segments: u32) -> Option<u64> {
    let sizes = [(POINTS, 12), (THICKNESS, 4), (TRANSPARENCY, 4), (COLOURS, 12), (UVS, 8)];
    let per_point: u64 = sizes.iter().filter(|(bit, _)| flags & bit != 0).map(|(_, size)| size).sum();
    let length = arrays.len() as u64;
    if flags & SEGMENTS == 0 {
        let per_strand = per_point * (u64::from(default_segments) + 1);
        return Some(length / per_strand).filter(|strands| *strands > 0 && length.is_multiple_of(per_strand));
    }
    let mut bytes = 0;
    let ends = segment_counts(arrays).map(|segments| {
        bytes += 2 + per_point * (u64::from(segments) + 1);
        bytes
    });
    (1..)
        .zip(ends.take_while(|end| *end <= length))
        .find(|(_, end)| *end == length)
        .map(|(strands, _)| strands)
}

fn segment_counts(array: &[u8]) -> impl Iterator<Item = u16> + '_ {
    array.as_chunks::<2>().0.iter().map(|&two| u16::from_le_bytes(two))
}

/// Writes metres, Z up, the face toward +Y, as is common for this format. Fails for a strand of more than 65536 points: the
/// format counts with 16 bits.
fn write(hair: &HairFile) -> Result<Vec<u8>, String> {
    let turn = rotation_to_head_axes(UpAxis::Z, Facing::PlusY).inverse();
    let flags: u32 = 0b11
        | u32::from(hair.thickness.is_some()) << 2
        | u32::from(hair.transparency.is_some()) << 3
        | u32::from(hair.colours.is_some()) << 4;
    let mut out = MAGIC.to_vec();
    for word in [hair.strands() as u32, hair.points.len() as u32, flags, 0] {
        out.extend(word.to_le_bytes());
    }
    let [r, g, b] = hair.default_colour.unwrap_or([0.3, 0.2, 0.1]);
    let (thickness, transparency) =
        (hair.default_thickness.unwrap_or(1e-4), hair.default_transparency.unwrap_or(0.0));
    out.extend([thickness, transparency, r, g, b].into_iter().flat_map(f32::to_le_bytes));
    out.resize(HEADER as usize, 0);
    for [start, end] in hair.first_point.array_windows() {
        let segments = u16::try_from(end - start - 1)
            .map_err(|_| format!("a strand of {} points; .hair allows at most 65536", end - start))?;
        out.extend(segments.to_le_bytes());
    }
    out.extend(hair.points.iter().flat_map(|&point| triple_bytes(turn * point)));
    for values in [&hair.thickness, &hair.transparency].into_iter().flatten() {
        out.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    }
    out.extend(hair.colours.iter().flatten().flat_map(|&colour| triple_bytes(colour.into())));
    Ok(out)
}
