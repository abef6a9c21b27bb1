//! Helpers for the tests of hair files.

use std::path::PathBuf;

/// The folder of real files, or `None` after printing a message.
pub(crate) fn data_dir() -> Option<PathBuf> {
    let folder = std::env::var_os("LOVELOCK_DATA").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data")),
        PathBuf::from,
    );
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped: no data folder");
    None
}

/// Builds a `.hair` file by hand.
pub(crate) struct YukselFile {
    /// Points of each strand.
    pub(crate) strands: Vec<Vec<[f32; 3]>>,
    /// Whether to write the segments array; otherwise the first strand's count is the default.
    pub(crate) segments: bool,
    /// Width of point `i`, if there is such an array.
    pub(crate) thickness: Option<fn(usize) -> f32>,
    /// Transparency of point `i`.
    pub(crate) transparency: Option<fn(usize) -> f32>,
    /// Colour of point `i`.
    pub(crate) colours: Option<fn(usize) -> [f32; 3]>,
    /// Whether to write texture coordinates (zeros), as in the variant that has them.
    pub(crate) uvs: bool,
}

impl YukselFile {
    /// Strands with points and no other arrays.
    pub(crate) fn new(strands: Vec<Vec<[f32; 3]>>) -> Self {
        Self { strands, segments: true, thickness: None, transparency: None, colours: None, uvs: false }
    }

    /// The bytes of the file, as specified by the format's page.
    pub(crate) fn bytes(&self) -> Vec<u8> {
        let points: usize = self.strands.iter().map(Vec::len).sum();
        let flags = u32::from(self.segments)
            | 2
            | u32::from(self.thickness.is_some()) << 2
            | u32::from(self.transparency.is_some()) << 3
            | u32::from(self.colours.is_some()) << 4
            | u32::from(self.uvs) << 5;
        let default_segments = if self.segments { 0 } else { self.strands[0].len() as u32 - 1 };
        let mut bytes = b"HAIR".to_vec();
        for number in [self.strands.len() as u32, points as u32, flags, default_segments] {
            bytes.extend(number.to_le_bytes());
        }
        for number in [0.1_f32, 0.25, 0.4, 0.3, 0.2] {
            bytes.extend(number.to_le_bytes());
        }
        bytes.resize(128, 0);
        if self.segments {
            bytes.extend(self.strands.iter().flat_map(|strand| (strand.len() as u16 - 1).to_le_bytes()));
        }
        let mut floats: Vec<f32> = self.strands.iter().flatten().flatten().copied().collect();
        floats.extend(self.thickness.iter().flat_map(|of| (0..points).map(of)));
        floats.extend(self.transparency.iter().flat_map(|of| (0..points).map(of)));
        floats.extend(self.colours.iter().flat_map(|of| (0..points).flat_map(of)));
        floats.extend(std::iter::repeat_n(0.0, if self.uvs { 2 * points } else { 0 }));
        bytes.extend(floats.iter().flat_map(|float| float.to_le_bytes()));
        bytes
    }
}

/// Strands of different lengths that hang down along Z, side by side.
pub(crate) fn hanging(counts: &[usize]) -> Vec<Vec<[f32; 3]>> {
    counts
        .iter()
        .enumerate()
        .map(|(strand, &count)| {
            (0..count).map(|i| [strand as f32, 0.5, -(i as f32) / (count - 1).max(1) as f32]).collect()
        })
        .collect()
}

/// A TressFX file of straight strands: version 3 with positions at 296, or version 4 with positions at 160.
pub(crate) fn tressfx(version: f32, strands: usize, per_strand: usize) -> Vec<u8> {
    let four = version >= 4.0;
    let mut bytes = version.to_le_bytes().to_vec();
    bytes.extend((strands as u32).to_le_bytes());
    bytes.extend((per_strand as u32).to_le_bytes());
    bytes.resize(if four { 160 } else { 296 }, 0);
    let (at, offset) = if four { (12, 160_u32) } else { (144, 296) };
    bytes[at..at + 4].copy_from_slice(&offset.to_le_bytes());
    for strand in 0..strands {
        for point in 0..per_strand {
            let mut numbers = vec![strand as f32, -(point as f32), 2.0];
            if four {
                numbers.push(if point == 0 { 0.0 } else { 1.0 });
            }
            bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        }
    }
    bytes
}
