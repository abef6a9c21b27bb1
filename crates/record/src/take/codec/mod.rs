//! Encoding of the frames of a chunk as bytes.

use glam::{Affine3A, Mat3A, Vec3A};

use super::bytes::Bytes;
use super::layout::{LAYOUT_BYTES, Layout};
use super::predict::{Coefficients, Rows, TAPS, fit};

/// Bytes of a frame without its guides.
pub(super) const META_BYTES: usize = 80;

/// Everything in a frame except its guides, stored exactly.
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

/// Frames of a chunk, decoded.
#[derive(Debug)]
pub(super) struct DecodedChunk {
    pub(super) layout: Layout,
    pub(super) metas: Vec<Meta>,
    numbers: Rows,
}

impl DecodedChunk {
    /// Bytes that the frames take in memory.
    pub(super) fn bytes(&self) -> usize {
        self.metas.len() * size_of::<Meta>() + self.numbers.bytes()
    }

    /// Copies the integers of one frame into `out`, in the order of [`Layout::numbers`].
    pub(super) fn numbers(&self, frame: usize, out: &mut Vec<i32>) {
        out.clear();
        for axis in 0..3 {
            for point in 0..self.layout.points {
                out.extend_from_slice(self.numbers.row(point, frame, axis));
            }
        }
    }
}

/// The data part of a chunk: layout, metas, coefficients, one byte per residual, then the rest of the residuals that need more.
/// `numbers` contains one frame after another, each in the order of [`Layout::numbers`].
pub(super) fn encode(metas: &[Meta], numbers: &[i32], layout: Layout) -> Vec<u8> {
    let frames = metas.len();
    let links = Rows::links_of(numbers, frames, layout);
    let mut out = Vec::with_capacity(
        LAYOUT_BYTES + frames * (META_BYTES + layout.numbers()) + layout.points * TAPS * 2,
    );
    layout.write(&mut out);
    for meta in metas {
        meta.write(&mut out);
    }
    let coefficients: Vec<Coefficients> = (0..layout.points).map(|point| fit(&links, point)).collect();
    for value in coefficients.iter().flatten() {
        out.extend(value.to_le_bytes());
    }
    let mut long = Vec::new();
    let mut predicted = vec![0; layout.guides];
    for (point, own) in coefficients.iter().enumerate() {
        for frame in 0..frames {
            for axis in 0..3 {
                links.predict(point, frame, axis, own, &mut predicted);
                let row = links.row(point, frame, axis);
                out.extend(row.iter().zip(&predicted).map(|(&value, &guess)| {
                    let zigzag = zigzag(value.wrapping_sub(guess));
                    if zigzag >= LONG {
                        write_varint(zigzag - LONG, &mut long);
                    }
                    zigzag.min(LONG) as u8
                }));
            }
        }
    }
    out.extend(long);
    out
}

/// Decodes the data part `raw` of a chunk of `frames` frames. Returns what is wrong if it is invalid. `known` is the layout
/// of a take of version 1, whose chunks do not contain theirs.
pub(super) fn decode(raw: &[u8], frames: usize, known: Option<Layout>) -> Result<DecodedChunk, String> {
    let mut bytes = Bytes::new(raw);
    let layout = match known {
        Some(layout) => layout,
        None => Layout::read(&mut bytes)?,
    };
    let short = || format!("{} bytes of frames, which are too few", raw.len());
    let metas =
        (0..frames).map(|_| Meta::read(&mut bytes)).collect::<Option<Vec<Meta>>>().ok_or_else(short)?;
    let mut coefficients = Vec::new();
    for _ in 0..layout.points {
        let pairs = bytes.take(2 * TAPS).ok_or_else(short)?;
        let mut own = Coefficients::default();
        for (value, pair) in own.iter_mut().zip(pairs.chunks_exact(2)) {
            *value = i16::from_le_bytes([pair[0], pair[1]]);
        }
        coefficients.push(own);
    }
    // Checked before anything of that size is allocated.
    let count = layout.numbers().checked_mul(frames).ok_or_else(short)?;
    let plane = bytes.take(count).ok_or_else(short)?;
    let mut rows = Rows::new(frames, layout);
    let mut predicted = vec![0; layout.guides];
    let mut residuals = plane.chunks_exact(layout.guides);
    for (point, own) in coefficients.iter().enumerate() {
        for frame in 0..frames {
            for axis in 0..3 {
                let residuals = residuals.next().unwrap_or_default();
                rows.predict(point, frame, axis, own, &mut predicted);
                let row = rows.row_mut(point, frame, axis);
                for ((value, &guess), &byte) in row.iter_mut().zip(&predicted).zip(residuals) {
                    *value = guess.wrapping_add(unzigzag(u32::from(byte)));
                }
                for (k, _) in residuals.iter().enumerate().filter(|(_, byte)| u32::from(**byte) == LONG) {
                    let rest = read_varint(&mut bytes).and_then(|rest| rest.checked_add(LONG));
                    row[k] = predicted[k].wrapping_add(unzigzag(rest.ok_or_else(short)?));
                }
            }
        }
    }
    if bytes.left() > 0 {
        return Err(format!("{} bytes after the last frame", bytes.left()));
    }
    rows.add_up();
    Ok(DecodedChunk { layout, metas, numbers: rows })
}

/// The part of a residual above this value is stored after the bytes of all residuals.
const LONG: u32 = 255;

/// Maps small positive and negative numbers to small unsigned ones.
fn zigzag(value: i32) -> u32 {
    ((value << 1) ^ (value >> 31)) as u32
}

fn unzigzag(value: u32) -> i32 {
    (value >> 1) as i32 ^ -((value & 1) as i32)
}

/// Writes seven bits per byte, lowest first. The highest bit is set in all bytes but the last.
fn write_varint(mut value: u32, out: &mut Vec<u8>) {
    while value >= 128 {
        out.push(value as u8 | 128);
        value >>= 7;
    }
    out.push(value as u8);
}

fn read_varint(bytes: &mut Bytes<'_>) -> Option<u32> {
    let mut value = 0_u32;
    for shift in [0, 7, 14, 21, 28] {
        let byte = u32::from(bytes.take(1)?[0]);
        let part = byte & 127;
        if shift == 28 && part > 15 {
            return None;
        }
        value |= part << shift;
        if byte < 128 {
            return Some(value);
        }
    }
    None
}

#[cfg(test)]
mod tests;
