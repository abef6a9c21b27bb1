//! `.data` files of USC-HairSalon and of works that follow it (<http://www-scf.usc.edu/~liwenhu/SHM/database.html>), and `.bin` files of
//! `CT2Hair` and kenshi84's hairutil.
//!
//! An i32 number of strands; for each strand an i32 number of points, then its points, root first. A point is three f32 (`.data`), three f32
//! and an i32 visibility (`.data`), or three f32, a direction or colour of three f32 and a label (`.bin`). Only the length of the file tells
//! these dialects apart from each other.

use glam::Vec3;

use super::HairFileError;
use super::bytes::{Bytes, triples};
use super::file::RawHair;
use super::format::HairFormat;
use super::source::Source;
use super::units::UpAxis;

pub(super) static FORMAT: HairFormat = HairFormat {
    label: "USC-HairSalon .data",
    extensions: &["data"],
    signature: "the number of strands and of the points of the first one (USC-HairSalon)",
    states_unit: false,
    common_up: UpAxis::Y,
    magics: &[],
    may_begin,
    by_chance: true,
    read: |name, source| read(name, source, [12, 16, 28, 24]),
    write: None,
};

pub(super) static BIN: HairFormat = HairFormat {
    label: "CT2Hair .bin",
    extensions: &["bin"],
    signature: "the number of strands and of the points of the first one (CT2Hair)",
    states_unit: false,
    common_up: UpAxis::Y,
    magics: &[],
    may_begin,
    by_chance: true,
    read: |name, source| read(name, source, [28, 12, 16, 24]),
    write: None,
};

/// More strands or points of a strand than in any head of hair.
const MAX_STRANDS: i32 = 1 << 24;
const MAX_STRAND_POINTS: i32 = 1 << 16;

fn may_begin(start: &[u8]) -> bool {
    let number = |at: usize| start.get(at..)?.first_chunk::<4>().map(|&four| i32::from_le_bytes(four));
    number(0).is_some_and(|strands| (1..=MAX_STRANDS).contains(&strands))
        && number(4).is_some_and(|points| (0..=MAX_STRAND_POINTS).contains(&points))
}

/// Reads strands whose points have one of these sizes, bytes, the first one that fits.
fn read(name: &str, source: Source<'_>, strides: [u64; 4]) -> Result<RawHair, HairFileError> {
    let data = source.into_bytes(name)?;
    let file = Bytes::new(name, &data);
    file.header(4)?;
    let ends = strides.map(|stride| walk(&file, stride));
    let Some(stride) = strides.into_iter().zip(&ends).find(|(_, end)| **end == Ok(file.len())) else {
        let place = |(stride, end): (&u64, &Result<u64, u64>)| match end {
            Ok(end) => format!("with {stride} bytes per point the strands end at byte {end}"),
            Err(at) => format!("with {stride} bytes per point the strand at byte {at} does not fit"),
        };
        let places: Vec<String> = strides.iter().zip(&ends).take(3).map(place).collect();
        return Err(file.malformed(
            0,
            format!("a file of {} bytes: {}", file.len(), places.join(", ")),
            "strands that end where the file does",
        ));
    };
    let stride = stride.0;
    let mut point_counts = Vec::with_capacity(file.u32(0) as usize);
    let mut points: Vec<Vec3> = Vec::with_capacity((file.len() / stride) as usize);
    let mut at = 4;
    while at < file.len() {
        let count = u64::from(file.u32(at as usize));
        let array = file.array(at + 4, count, stride, "points")?;
        point_counts.push(count as u32);
        points.extend(triples(array, stride as usize).map(Vec3::from));
        at += 4 + count * stride;
    }
    Ok(RawHair::new(point_counts, points))
}

/// The byte after the last strand with this size of a point, or that of the strand that does not fit.
fn walk(file: &Bytes<'_>, stride: u64) -> Result<u64, u64> {
    let mut at = 4;
    for _ in 0..file.u32(0) {
        if at + 4 > file.len() {
            return Err(at);
        }
        let count = file.u32(at as usize);
        let end = at + 4 + u64::from(count) * stride;
        if end > file.len() {
            return Err(at);
        }
        at = end;
    }
    Ok(at)
}

#[cfg(test)]
mod tests {
    use crate::load_hair_bytes;

    /// Strands of the given numbers of points; `visibility` adds the fourth word of a point.
    fn data(counts: &[i32], visibility: bool) -> Vec<u8> {
        let mut bytes = (counts.len() as i32).to_le_bytes().to_vec();
        for (strand, &count) in counts.iter().enumerate() {
            bytes.extend(count.to_le_bytes());
            for point in 0..count {
                for value in [strand as f32 * 0.01, 1.7 - point as f32 * 0.02, 0.1] {
                    bytes.extend(value.to_le_bytes());
                }
                if visibility {
                    bytes.extend(1_i32.to_le_bytes());
                }
            }
        }
        bytes
    }

    #[test]
    fn both_dialects_are_told_apart_by_their_length() {
        let counts = [3, 1, 100, 2];
        for visibility in [false, true] {
            let file = load_hair_bytes("a.data", &data(&counts, visibility)).expect("hair");
            assert_eq!((file.strands(), file.points.len()), (3, 105), "{visibility}");
            assert_eq!(file.dropped["one_point_strands"], 1);
            assert_eq!(file.strand(1)[99], glam::Vec3::new(0.02, 1.7 - 99.0 * 0.02, 0.1));
            assert_eq!(file.format, "USC-HairSalon .data");
        }
        // The cluster files have 5 strands of 100 points in 6024 bytes.
        assert_eq!(data(&[100; 5], false).len(), 6024);
    }

    #[test]
    fn a_file_of_another_length_is_refused() {
        for change in [-1_isize, 1, 4, 12] {
            let mut bytes = data(&[3, 4], false);
            bytes.resize((bytes.len() as isize + change) as usize, 0);
            let error = load_hair_bytes("a.data", &bytes).expect_err("another length").to_string();
            assert!(
                error.starts_with("a.data: byte 0: found a file of")
                    && error.contains("with 16 bytes per point the strand at"),
                "{error}"
            );
        }
        // A count that claims more than the file holds allocates nothing.
        let mut bytes = data(&[3, 4], false);
        bytes[..4].copy_from_slice(&16_000_000_i32.to_le_bytes());
        assert!(load_hair_bytes("a.data", &bytes).is_err());
        bytes[4..8].copy_from_slice(&(-3_i32).to_le_bytes());
        assert!(load_hair_bytes("a.data", &bytes).is_err());
    }
}
