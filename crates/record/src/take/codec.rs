//! The frames of a chunk as bytes.

use glam::{Affine3A, Mat3A, Vec3A};

use super::bytes::Bytes;
use super::quantise::Layout;

/// Bytes of a frame besides its guides.
pub(super) const META_BYTES: usize = 80;

/// All of a frame but its guides, exactly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Meta {
    pub(super) time_secs: f64,
    pub(super) clip_secs: f64,
    pub(super) wall_frame: u64,
    pub(super) substeps: u32,
    pub(super) jumped: bool,
    pub(super) world_from_head: Affine3A,
}

impl Meta {
    fn write(&self, out: &mut Vec<u8>) {
        out.extend(self.time_secs.to_bits().to_le_bytes());
        out.extend(self.clip_secs.to_bits().to_le_bytes());
        out.extend(self.wall_frame.to_le_bytes());
        out.extend(self.substeps.to_le_bytes());
        out.extend(u32::from(self.jumped).to_le_bytes());
        let head = &self.world_from_head;
        for v in head.matrix3.to_cols_array().into_iter().chain(head.translation.to_array()) {
            out.extend(v.to_bits().to_le_bytes());
        }
    }

    fn read(bytes: &mut Bytes<'_>) -> Option<Self> {
        let time_secs = f64::from_bits(bytes.u64()?);
        let clip_secs = f64::from_bits(bytes.u64()?);
        let wall_frame = bytes.u64()?;
        let substeps = bytes.u32()?;
        let jumped = bytes.u32()? != 0;
        let mut head = [0.0; 12];
        for v in &mut head {
            *v = f32::from_bits(bytes.u32()?);
        }
        let column = |c: usize| Vec3A::new(head[3 * c], head[3 * c + 1], head[3 * c + 2]);
        let world_from_head =
            Affine3A { matrix3: Mat3A::from_cols(column(0), column(1), column(2)), translation: column(3) };
        Some(Self { time_secs, clip_secs, wall_frame, substeps, jumped, world_from_head })
    }
}

/// The data part of a chunk: the metas, then the numbers of all frames.
pub(super) fn encode(metas: &[Meta], numbers: &[i32], layout: Layout) -> Vec<u8> {
    let size = layout.numbers();
    let mut out = Vec::with_capacity(metas.len() * META_BYTES + numbers.len() * 4);
    for meta in metas {
        meta.write(&mut out);
    }
    let residuals: Vec<u32> = (0..numbers.len())
        .map(|i| {
            let before = if i >= size { numbers[i - size] } else { 0 };
            let off = numbers[i].wrapping_sub(before);
            ((off << 1) ^ (off >> 31)) as u32
        })
        .collect();
    for byte in 0..4 {
        out.extend(residuals.iter().map(|r| (r >> (8 * byte)) as u8));
    }
    out
}

/// The frames of a chunk.
#[derive(Debug)]
pub(super) struct Decoded {
    pub(super) metas: Vec<Meta>,
    pub(super) numbers: Vec<i32>,
}

impl Decoded {
    /// Bytes that it takes in memory.
    pub(super) fn bytes(&self) -> usize {
        self.metas.len() * size_of::<Meta>() + self.numbers.len() * size_of::<i32>()
    }
}

/// The frames in the data part `raw` of a chunk of `frames` frames; says what is wrong where it is none.
pub(super) fn decode(raw: &[u8], frames: usize, layout: Layout) -> Result<Decoded, String> {
    let size = layout.numbers();
    let wanted =
        size.checked_mul(4).and_then(|n| n.checked_add(META_BYTES)).and_then(|n| n.checked_mul(frames));
    if wanted != Some(raw.len()) {
        return Err(format!("{} bytes of frames, wanted {}", raw.len(), wanted.unwrap_or(usize::MAX)));
    }
    let mut bytes = Bytes::new(raw);
    let metas: Option<Vec<Meta>> = (0..frames).map(|_| Meta::read(&mut bytes)).collect();
    let metas = metas.ok_or("frames that end too early")?;
    let planes = bytes.take(bytes.left()).unwrap_or_default();
    let count = size * frames;
    let mut numbers: Vec<i32> = Vec::with_capacity(count);
    for i in 0..count {
        let byte = |b: usize| u32::from(planes[b * count + i]) << (8 * b);
        let zigzag = byte(0) | byte(1) | byte(2) | byte(3);
        let off = (zigzag >> 1) as i32 ^ -((zigzag & 1) as i32);
        let before = if i >= size { numbers[i - size] } else { 0 };
        numbers.push(before.wrapping_add(off));
    }
    Ok(Decoded { metas, numbers })
}
