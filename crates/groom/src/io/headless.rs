//! `.hair` files without a signature, as `MonoHair`, `DeepMVSHair` and other works on the reconstruction of hair write them.
//!
//! A u32 number of strands, a u32 number of points; for each strand a u16 number of points; then three f32 for each point, root first. Unlike
//! Yuksel's, the numbers are those of points, not of segments.

use glam::Vec3;
use lovelock_base::words::counted;

use super::HairFileError;
use super::bytes::{Bytes, triples};
use super::file::RawHair;
use super::format::HairFormat;
use super::source::Source;
use super::units::UpAxis;

pub(super) static FORMAT: HairFormat = HairFormat {
    label: "MonoHair .hair",
    extensions: &["hair"],
    signature: "the numbers of strands, of points and of the points of each strand (MonoHair)",
    states_unit: false,
    common_up: UpAxis::Y,
    magics: &[],
    may_begin: begins,
    by_chance: false,
    read,
    write: None,
};

const HEADER: u64 = 8;
/// More strands than in any head of hair.
const MOST_STRANDS: u32 = 1 << 24;

/// Whether the numbers of points of the first strands fit the number of all.
fn begins(start: &[u8]) -> bool {
    let Some(&[a, b, c, d, e, f, g, h]) = start.first_chunk::<8>() else { return false };
    let (strands, points) = (u32::from_le_bytes([a, b, c, d]), u32::from_le_bytes([e, f, g, h]));
    if !(1..=MOST_STRANDS).contains(&strands) || points < strands {
        return false;
    }
    let counts: Vec<u16> = point_counts(&start[8..]).take(strands as usize).collect();
    let sum: u64 = counts.iter().map(|&count| u64::from(count)).sum();
    let left = u64::from(strands) - counts.len() as u64;
    // Strands that are not seen yet have a point at least, and 65,535 at most.
    let points = u64::from(points);
    !counts.is_empty() && !counts.contains(&0) && sum + left <= points && points <= sum + left * 65_535
}

fn point_counts(array: &[u8]) -> impl Iterator<Item = u16> + '_ {
    array.as_chunks::<2>().0.iter().map(|&two| u16::from_le_bytes(two))
}

fn read(name: &str, source: Source<'_>) -> Result<RawHair, HairFileError> {
    let data = source.into_bytes(name)?;
    let file = Bytes::new(name, &data);
    file.header(HEADER)?;
    let (strands, points) = (u64::from(file.u32(0)), u64::from(file.u32(4)));
    let counts = file.array(HEADER, strands, 2, "numbers of points")?;
    let expected: u64 = point_counts(counts).map(u64::from).sum();
    if expected != points {
        let wanted = format!("{expected}, from the {}", counted(strands, "strand", "strands"));
        return Err(file.malformed(4, counted(points, "point", "points"), wanted));
    }
    let offset = HEADER + counts.len() as u64;
    let array = file.array(offset, points, 12, "points")?;
    let mut raw = RawHair::new(
        point_counts(counts).map(u32::from).collect(),
        triples(array, 12).map(Vec3::from).collect(),
    );
    raw.trailing_bytes = file.len() - offset - array.len() as u64;
    Ok(raw)
}

#[cfg(test)]
mod tests {
    use crate::load_hair_bytes;

    fn file(counts: &[u16]) -> Vec<u8> {
        let points: u32 = counts.iter().map(|&count| u32::from(count)).sum();
        let mut bytes = [(counts.len() as u32).to_le_bytes(), points.to_le_bytes()].concat();
        bytes.extend(counts.iter().flat_map(|count| count.to_le_bytes()));
        for i in 0..points {
            bytes.extend([i as f32 * 0.25, 1.6, -0.1].iter().flat_map(|number: &f32| number.to_le_bytes()));
        }
        bytes
    }

    #[test]
    fn hair_without_a_signature_is_read_under_any_name() {
        for name in ["a.hair", "a.data", "a.bin", "a"] {
            let hair = load_hair_bytes(name, &file(&[3, 2, 5])).expect(name);
            assert_eq!(
                (hair.strands(), hair.points.len(), hair.format.as_str()),
                (3, 10, "MonoHair .hair"),
                "{name}"
            );
            assert_eq!(hair.strand(2)[0].x, 1.25);
        }
        // More strands than the start of a file shows, and one strand.
        let many = load_hair_bytes("a.hair", &file(&[2; 5000])).expect("hair");
        assert_eq!((many.strands(), many.points.len()), (5000, 10_000));
        assert_eq!(load_hair_bytes("a.hair", &file(&[20])).expect("hair").strands(), 1);
        let trailing = load_hair_bytes("a.hair", &[file(&[4, 4]), vec![0; 5]].concat()).expect("hair");
        assert_eq!(trailing.dropped.get("trailing_bytes"), Some(&5));
    }

    #[test]
    fn what_does_not_fit_is_refused_in_words_about_hair_files() {
        let mut short = file(&[3, 2, 5]);
        short.truncate(60);
        let mut wrong = file(&[3, 2, 5]);
        wrong[4] = 200;
        for (bytes, words) in [
            (short, "points"),
            (wrong, "HAIR"),
            (b"nothing of this kind".to_vec(), "`HAIR`"),
            (vec![1, 0, 0, 0, 1, 0, 0, 0], "HAIR"),
        ] {
            let error = load_hair_bytes("a.hair", &bytes).expect_err(words).to_string();
            assert!(error.contains(words) && !error.contains("USC") && !error.contains("glTF"), "{error}");
        }
    }
}
