//! The records of a VMD file.
//!
//! All numbers are little-endian. A header of 30 bytes (`Vocaloid Motion Data 0002`, or `Vocaloid Motion Data file` in old
//! files) and the name of the model (20 bytes, 10 in old files). Then counted lists: keys of bones (111 bytes each), keys of
//! facial morphs (23), of the camera (61), of the light (28), of its shadow (9), and of the model's visibility and inverse
//! kinematics. Old files and cut ones lack the last lists. Names are Shift-JIS, padded with zeros.

use std::collections::BTreeMap;

use encoding_rs::SHIFT_JIS;
use glam::{Quat, Vec3};

use crate::MotionError;

/// The first bytes of every file.
pub(super) const MAGIC: &[u8] = b"Vocaloid Motion Data";
/// Sizes of the lists' records, bytes.
const BONE: usize = 111;
const FACE: usize = 23;
const OTHERS: [(&str, usize); 3] = [("camera_keys", 61), ("light_keys", 28), ("shadow_keys", 9)];
const SWITCH: usize = 21;

/// One key of a bone, in the file's unit and left-handed axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Key {
    pub(super) frame: u32,
    /// Displacement from the bone's rest position.
    pub(super) position: Vec3,
    pub(super) rotation: Quat,
    /// Control points (x1, y1, x2, y2) of the curves of x, y, z and the rotation from the key before to this one, 0 to 1.
    pub(super) curves: [[f32; 4]; 4],
}

/// The content of a file.
#[derive(Debug, Default)]
pub(super) struct RawVmd {
    /// Keys of each bone in the order of frames, one per frame.
    pub(super) bones: BTreeMap<String, Vec<Key>>,
    /// For each bone of inverse kinematics, the frames at which it is switched on or off.
    pub(super) switches: BTreeMap<String, BTreeMap<u32, bool>>,
    /// For each morph of the face its weights by frame.
    pub(super) faces: BTreeMap<String, BTreeMap<u32, f32>>,
    pub(super) dropped: BTreeMap<String, u64>,
}

struct Reader<'a> {
    file: &'a str,
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Reader<'a> {
    fn take(&mut self, count: usize, what: &str) -> Result<&'a [u8], MotionError> {
        let found = self.bytes.get(self.at..).and_then(|rest| rest.get(..count));
        let found = found.ok_or_else(|| {
            let left = self.bytes.len().saturating_sub(self.at);
            let problem = format!("{left} bytes left; {what} take {count}: the file is truncated");
            MotionError::malformed(self.file, format!("byte {}", self.at), problem)
        })?;
        self.at += count;
        Ok(found)
    }

    /// The count of a list, compared with what is left of the file. `None` where the file ends before the list.
    fn count(&mut self, size: usize, what: &str) -> Result<Option<usize>, MotionError> {
        if self.at == self.bytes.len() {
            return Ok(None);
        }
        let start = self.at;
        let count = u32_of(self.take(4, "a count")?) as usize;
        let left = self.bytes.len() - self.at;
        if count.checked_mul(size).is_none_or(|bytes| bytes > left) {
            let problem = format!("{count} {what} of {size} bytes in {left} bytes; the file is truncated");
            return Err(MotionError::malformed(self.file, format!("byte {start}"), problem));
        }
        Ok(Some(count))
    }
}

fn u32_of(bytes: &[u8]) -> u32 {
    bytes.first_chunk().map_or(0, |&four| u32::from_le_bytes(four))
}

fn f32_of(bytes: &[u8]) -> f32 {
    f32::from_bits(u32_of(bytes))
}

/// A name without its padding; wide Latin letters, as in the names of inverse kinematics, become plain ones.
fn name_of(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|&byte| byte == 0).unwrap_or(bytes.len());
    let (name, _) = SHIFT_JIS.decode_without_bom_handling(&bytes[..end]);
    let plain = |c: char| match c {
        '\u{ff01}'..='\u{ff5e}' => char::from_u32(u32::from(c) - 0xfee0).unwrap_or(c),
        c => c,
    };
    name.chars().map(plain).collect()
}

/// Parses a file.
pub(super) fn parse(file: &str, bytes: &[u8]) -> Result<RawVmd, MotionError> {
    let mut reader = Reader { file, bytes, at: 0 };
    let head = reader.take(30, "the words at the start")?;
    if !head.starts_with(MAGIC) {
        return Err(MotionError::malformed(file, "byte 0", "no `Vocaloid Motion Data`"));
    }
    let old = head[MAGIC.len()..].starts_with(b" file");
    reader.take(if old { 10 } else { 20 }, "the name of the model")?;
    let mut raw = RawVmd::default();
    let bones = reader.count(BONE, "keys of bones")?.unwrap_or(0);
    for record in reader.take(bones * BONE, "keys of bones")?.chunks_exact(BONE) {
        match key(record) {
            Some(key) => raw.bones.entry(name_of(&record[..15])).or_default().push(key),
            None => *raw.dropped.entry("keys_of_no_number".into()).or_default() += 1,
        }
    }
    for keys in raw.bones.values_mut() {
        // Of several keys at one frame, the last counts.
        keys.reverse();
        keys.sort_by_key(|key| key.frame);
        keys.dedup_by_key(|key| key.frame);
    }
    let Some(faces) = reader.count(FACE, "keys of facial morphs")? else { return Ok(raw) };
    for record in reader.take(faces * FACE, "keys of facial morphs")?.chunks_exact(FACE) {
        let weight = f32_of(&record[19..]);
        if weight.is_finite() {
            let of_morph = raw.faces.entry(name_of(&record[..15])).or_default();
            of_morph.insert(u32_of(&record[15..]), weight.clamp(-1.0, 2.0));
        } else {
            *raw.dropped.entry("keys_of_no_number".into()).or_default() += 1;
        }
    }
    for (what, size) in OTHERS {
        let Some(count) = reader.count(size, what)? else { return Ok(raw) };
        reader.take(count * size, what)?;
        if count > 0 {
            raw.dropped.insert(what.into(), count as u64);
        }
    }
    let Some(count) = reader.count(9, "switches of inverse kinematics")? else { return Ok(raw) };
    for _ in 0..count {
        let head = reader.take(9, "a switch of inverse kinematics")?;
        let (frame, names) = (u32_of(head), u32_of(&head[5..]) as usize);
        let names = names.saturating_mul(SWITCH);
        for switch in reader.take(names, "the switches of a frame")?.chunks_exact(SWITCH) {
            raw.switches.entry(name_of(&switch[..20])).or_default().insert(frame, switch[20] != 0);
        }
    }
    Ok(raw)
}

/// The key in a record of 111 bytes; `None` if it contains a number that is none.
fn key(record: &[u8]) -> Option<Key> {
    let number = |k: usize| f32_of(&record[19 + 4 * k..]);
    let position = Vec3::new(number(0), number(1), number(2));
    let rotation = Quat::from_xyzw(number(3), number(4), number(5), number(6));
    if !position.is_finite() || !rotation.is_finite() || position.abs().max_element() > 1e6 {
        return None;
    }
    // A rotation of zeros is none.
    let length = rotation.length();
    let rotation = if length > 1e-6 { rotation * length.recip() } else { Quat::IDENTITY };
    let curve = &record[47..];
    // The first row holds the numbers of all four curves; the rows after it are the same, shifted by one each. Newer
    // programs keep two flags at the third and fourth byte of the first row, so these two are taken from the second.
    let shifted = curve[16 + 3] == curve[4];
    let at = |k: usize| {
        let byte = if shifted && (k == 2 || k == 3) { curve[16 + k - 1] } else { curve[k] };
        f32::from(byte.min(127)) / 127.0
    };
    let curves = std::array::from_fn(|c| [at(c), at(4 + c), at(8 + c), at(12 + c)]);
    Some(Key { frame: u32_of(&record[15..]), position, rotation, curves })
}
