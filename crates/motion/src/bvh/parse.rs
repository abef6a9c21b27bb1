//! Tolerant parsing of the text of a BVH file: names with spaces, any line ends, wrong counts.

use std::borrow::Cow;
use std::collections::BTreeMap;

use lovelock_base::{numbers::numbers_of, words::counted};

use super::raw::{Channel, RawJoint, RawMotion, quote};
use super::rows::{parsed, words_of};
use crate::MotionError;
use crate::clip::LONGEST_SECS;

/// Largest number of joints of a file.
const JOINT_LIMIT: usize = 10_000;
/// Deepest nesting of joints.
const DEPTH_LIMIT: usize = 1_000;

/// A position in the text, with its line number.
struct Cursor<'a> {
    file: &'a str,
    rest: &'a str,
    line: usize,
}

impl<'a> Cursor<'a> {
    fn skip_space(&mut self) {
        let trimmed = self.rest.trim_start();
        let skipped = &self.rest[..self.rest.len() - trimmed.len()];
        self.line += skipped.bytes().filter(|&b| b == b'\n').count();
        self.rest = trimmed;
    }

    /// The next word; a brace is a word of its own even without spaces.
    fn word(&mut self) -> Option<&'a str> {
        self.skip_space();
        let first = self.rest.chars().next()?;
        let end = if matches!(first, '{' | '}') {
            1
        } else {
            self.rest.find(|c: char| c.is_whitespace() || c == '{' || c == '}').unwrap_or(self.rest.len())
        };
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        Some(word)
    }

    /// The rest of the line up to a brace: a name.
    fn name(&mut self) -> &'a str {
        let end = self.rest.find(['\n', '\r', '{']).unwrap_or(self.rest.len());
        let (name, rest) = self.rest.split_at(end);
        self.rest = rest;
        name.trim()
    }

    fn error(&self, problem: impl Into<String>) -> MotionError {
        MotionError::malformed(self.file, format!("line {}", self.line), problem)
    }

    fn expect(&mut self, wanted: &str) -> Result<(), MotionError> {
        match self.word() {
            Some(word) if word.eq_ignore_ascii_case(wanted) => Ok(()),
            found => Err(self.error(format!("{}; must be `{wanted}`", quote(found)))),
        }
    }
}

/// Parses a file.
pub(super) fn parse(file: &str, bytes: &[u8]) -> Result<RawMotion, MotionError> {
    let text = String::from_utf8_lossy(bytes);
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    // A return alone ends a line, as in files of old Macintoshes.
    let text = if text.contains('\r') {
        Cow::Owned(text.replace("\r\n", "\n").replace('\r', "\n"))
    } else {
        Cow::Borrowed(text)
    };
    let text: &str = &text;
    let mut cursor = Cursor { file, rest: text, line: 1 };
    cursor.expect("HIERARCHY")?;
    let mut raw = RawMotion::default();
    parse_hierarchy(&mut cursor, &mut raw)?;
    parse_rows(&mut cursor, &mut raw)?;
    if raw.frames == 0 {
        let found = format!("{} joints and no complete frame of {} numbers", raw.joints.len(), raw.channels);
        return Err(MotionError::Empty { file: file.into(), found, wanted: "at least one frame of motion" });
    }
    // A joint without channels has no bytes in a row, so a small file could otherwise claim a huge number of
    // transforms.
    if (raw.frames as u64) * (raw.joints.len() as u64) > (bytes.len() as u64).max(1 << 20) {
        let problem = format!(
            "{} frames of {} joints; too many for the size of the file",
            raw.frames,
            raw.joints.len()
        );
        return Err(cursor.error(problem));
    }
    Ok(raw)
}

/// Reads joints up to and including the word MOTION.
fn parse_hierarchy(cursor: &mut Cursor, raw: &mut RawMotion) -> Result<(), MotionError> {
    // The open braces: a joint, or an end site of the joint before it.
    let mut open: Vec<Option<usize>> = Vec::new();
    loop {
        let word = cursor.word();
        match word.map(str::to_ascii_uppercase).as_deref() {
            Some(kind @ ("ROOT" | "JOINT" | "END")) => {
                let name = cursor.name().to_owned();
                let parent = open.last().copied().flatten();
                if kind != "ROOT" && parent.is_none() {
                    return Err(cursor.error(format!("`{kind} {name}` outside a joint")));
                }
                cursor.expect("{")?;
                if kind == "END" {
                    open.push(None);
                } else {
                    if parent.is_none() && !raw.joints.is_empty() {
                        let problem = format!("a second root, `{name}`; must be the motion of one figure");
                        return Err(cursor.error(problem));
                    }
                    open.push(Some(raw.joints.len()));
                    raw.joints.push(RawJoint { name, parent, ..RawJoint::default() });
                }
                if raw.joints.len() > JOINT_LIMIT || open.len() > DEPTH_LIMIT {
                    let problem = format!("more than {JOINT_LIMIT} joints or {DEPTH_LIMIT} levels");
                    return Err(cursor.error(problem));
                }
            }
            Some("OFFSET") => {
                let offset = parse_offset(cursor, &mut raw.dropped)?;
                match (open.last(), open.len().checked_sub(2).map(|i| open[i])) {
                    (Some(Some(joint)), _) => raw.joints[*joint].offset = offset,
                    (Some(None), Some(Some(joint))) => raw.joints[joint].end = Some(offset),
                    _ => return Err(cursor.error("an OFFSET outside a joint")),
                }
            }
            Some("CHANNELS") => {
                let joint = open.last().copied().flatten();
                let channels = parse_channels(cursor)?;
                let Some(joint) = joint.filter(|&j| raw.joints[j].channels.is_empty()) else {
                    return Err(cursor.error("CHANNELS outside a joint, or twice in one"));
                };
                raw.channels += channels.len();
                raw.joints[joint].channels = channels;
            }
            Some("}") => {
                if open.pop().is_none() {
                    return Err(cursor.error("a closing brace too many"));
                }
            }
            Some("MOTION") if open.is_empty() && !raw.joints.is_empty() => return Ok(()),
            Some("MOTION") => {
                return Err(cursor.error(format!("MOTION with {} joints still open", open.len())));
            }
            _ => {
                return Err(cursor.error(format!("{}; must be a joint, its end, or MOTION", quote(word))));
            }
        }
    }
}

fn parse_offset(cursor: &mut Cursor, dropped: &mut BTreeMap<String, u64>) -> Result<[f32; 3], MotionError> {
    let (mut offset, mut known) = ([0.0_f32; 3], 0);
    // The whole line tells decimal commas from commas between numbers.
    let end = cursor.rest.find('\n').unwrap_or(cursor.rest.len());
    let (line, rest) = cursor.rest.split_at(end);
    let words: Vec<Option<f32>> = words_of(line, offset.len()).map(parsed).collect();
    if let Ok(numbers) = <[Option<f32>; 3]>::try_from(words)
        && let [Some(x), Some(y), Some(z)] = numbers
    {
        (offset, known) = ([x, y, z], 3);
        cursor.rest = rest;
    }
    while known < offset.len() {
        let word = cursor.word();
        let refuse = || cursor.error(format!("{}; must be a number", quote(word)));
        for part in numbers_of(word.ok_or_else(refuse)?) {
            let value = offset.get_mut(known).ok_or_else(refuse)?;
            *value = parsed(part).ok_or_else(refuse)?;
            known += 1;
        }
    }
    if offset.iter().all(|v| v.is_finite() && v.abs() < 1e9) {
        Ok(offset)
    } else {
        *dropped.entry("offsets".into()).or_default() += 1;
        Ok([0.0; 3])
    }
}

fn parse_channels(cursor: &mut Cursor) -> Result<Vec<Channel>, MotionError> {
    let word = cursor.word();
    let count = word.and_then(|w| w.parse::<usize>().ok()).filter(|&n| n <= 9);
    let count = count.ok_or_else(|| cursor.error(format!("{}; must be up to 9 channels", quote(word))))?;
    (0..count)
        .map(|_| {
            let word = cursor.word();
            channel(word.unwrap_or_default())
                .ok_or_else(|| cursor.error(format!("{}; must be a channel such as Xrotation", quote(word))))
        })
        .collect()
}

fn channel(word: &str) -> Option<Channel> {
    let word = word.to_ascii_lowercase();
    let axis = match word.bytes().next()? {
        b'x' => 0,
        b'y' => 1,
        b'z' => 2,
        _ => return None,
    };
    match &word[1..] {
        "position" | "translation" => Some(Channel::Position(axis)),
        "rotation" => Some(Channel::Rotation(axis)),
        _ => None,
    }
}

fn parse_rows(cursor: &mut Cursor, raw: &mut RawMotion) -> Result<(), MotionError> {
    let mut promised_frames = None;
    let mut frame_secs: Option<f64> = None;
    let (mut time_line, mut stated) = (cursor.line, String::new());
    // `Frames: 12`, `Frames:12` and `Frame Time: 0.01`, in any order and case.
    while let Some((line, rest)) = {
        cursor.skip_space();
        let end = cursor.rest.find('\n').unwrap_or(cursor.rest.len());
        let (line, rest) = cursor.rest.split_at(end);
        line.split_once(':').map(|parts| (parts, rest))
    } {
        let (key, value) = (line.0.trim().to_ascii_lowercase(), line.1.trim());
        match key.as_str() {
            "frames" => promised_frames = value.parse::<u64>().ok(),
            "frame time" => {
                frame_secs = parsed(value);
                (time_line, stated) = (cursor.line, value.chars().take(40).collect());
            }
            _ => {
                return Err(
                    cursor.error(format!("{}; must be `Frames:` or `Frame Time:`", quote(Some(&key))))
                );
            }
        }
        cursor.rest = rest;
    }
    raw.frame_secs = match frame_secs {
        Some(secs) if secs.is_finite() && secs > 1e-6 && secs < 1e4 => secs,
        _ => {
            let found = if stated.is_empty() { "none".to_owned() } else { format!("`{stated}`") };
            raw.notes.push(format!("the frame time is {found}; 30 frames per second are used"));
            1.0 / 30.0
        }
    };
    if raw.channels > 0 {
        cursor.skip_space();
        super::rows::read(cursor.file, cursor.rest, cursor.line, promised_frames, raw)?;
    }
    let lasts = raw.frames.saturating_sub(1) as f64 * raw.frame_secs;
    if lasts > LONGEST_SECS {
        let problem = format!(
            "a frame time of {} s makes {} last {lasts:.0} s; must be at most {LONGEST_SECS} s",
            raw.frame_secs,
            counted(raw.frames, "frame", "frames")
        );
        return Err(MotionError::malformed(cursor.file, format!("line {time_line}"), problem));
    }
    Ok(())
}
