//! The frames of a BVH file: a table of numbers, one row per frame.
//!
//! A row is a line. Some programs write a row over several lines, and some write all numbers in lines of any length. What cannot be
//! divided into rows without doubt is refused by its line, because a number that is missing shifts all after it.

use lovelock_base::{
    numbers::{is_not_a_number, numbers_of},
    words::counted,
};

use super::raw::{RawMotion, quote};
use crate::MotionError;

/// What the lines of a table have in common.
struct Layout {
    /// Lines with numbers.
    lines: u64,
    /// Lines with as many numbers as a row.
    whole: u64,
    /// All numbers.
    total: u64,
}

impl Layout {
    fn of(text: &str, channels: usize) -> Self {
        let mut layout = Self { lines: 0, whole: 0, total: 0 };
        for line in text.lines() {
            let count = words_of(line, channels).count();
            if count > 0 {
                layout.lines += 1;
                layout.whole += u64::from(count == channels);
                layout.total += count as u64;
            }
        }
        layout
    }
}

/// The lines of rows that are written over several lines. If every row has the same ones, and their lengths tell which begins it, a
/// missing line would show.
struct Wrapping {
    /// Numbers in the lines of the first row.
    pattern: Vec<usize>,
    /// Numbers in the lines of the row that is not complete yet.
    open: Vec<usize>,
    /// Whether all rows so far have the lines of the first.
    alike: bool,
}

impl Wrapping {
    /// Closes a row.
    fn end_row(&mut self) {
        let row = std::mem::take(&mut self.open);
        if self.pattern.is_empty() {
            self.pattern = row;
        } else {
            self.alike &= row == self.pattern;
        }
    }

    /// Whether the lines show that none is missing before the row that is open: they are full but for the last of a row, or each has the
    /// numbers of one joint. `joints` are the numbers of those that have some.
    fn proves(&self, joints: &[usize]) -> bool {
        let lines = &self.pattern;
        let Some((last, full)) = lines.split_last() else { return false };
        let is_filled = full.iter().all(|&line| line == full[0] && line > *last) && !full.is_empty();
        let turned = |by: usize| lines[by..].iter().chain(&lines[..by]).eq(lines);
        let is_by_joint = lines == joints && !(1..lines.len()).any(turned);
        let is_start = self.open.len() <= lines.len()
            && self
                .open
                .iter()
                .zip(lines)
                .enumerate()
                .all(|(k, (open, line))| open == line || (k + 1 == self.open.len() && open < line));
        self.alike && is_start && (is_filled || is_by_joint)
    }
}

/// Reads the rows from `text`, which begins in line `first_line`. `promised` is the number of frames that the header states.
///
/// # Errors
/// If a line has too few or too many numbers, or a word that is no number, or if lines may be missing.
pub(super) fn read(
    file: &str,
    text: &str,
    first_line: usize,
    promised: Option<u64>,
    raw: &mut RawMotion,
) -> Result<(), MotionError> {
    let channels = raw.channels;
    let layout = Layout::of(text, channels);
    let row_per_line = promised == Some(layout.lines) || 2 * layout.whole >= layout.lines;
    // Lines of any length are believed if together they are what the header states.
    let is_filled = !row_per_line
        && promised.and_then(|frames| frames.checked_mul(channels as u64)) == Some(layout.total);
    let mut wrapping = Wrapping { pattern: Vec::new(), open: Vec::new(), alike: true };
    // Lines left, numbers of the row that is not complete yet, and the line in which it began.
    let (mut left, mut open, mut began) = (layout.lines, 0, 0);
    for (i, line) in text.lines().enumerate() {
        let count = words_of(line, channels).count();
        if count == 0 {
            continue;
        }
        left -= 1;
        if open == 0 {
            began = first_line + i;
        }
        open += count;
        if !row_per_line {
            wrapping.open.push(count);
        }
        let refuse =
            |problem: String| MotionError::malformed(file, format!("line {}", first_line + i), problem);
        let ends = open.is_multiple_of(channels) && (open == channels || count.is_multiple_of(channels));
        // A file may be cut off within its last row, which moves no other.
        let is_cut = left == 0 && open < channels && layout.lines > 1;
        if ends {
            open = 0;
            wrapping.end_row();
        } else if !is_filled && !is_cut && (row_per_line || open > channels) {
            let start: String = line.trim().chars().take(60).collect();
            let of = if open == count {
                String::new()
            } else {
                format!(" and {} from line {began} on", open - count)
            };
            return Err(refuse(format!(
                "found {count} numbers{of}, in `{start}`; a row must have {channels}"
            )));
        }
        for word in words_of(line, channels) {
            let value = number(word, raw)
                .ok_or_else(|| refuse(format!("{}; must be a number", quote(Some(word)))))?;
            raw.rows.push(value);
        }
    }
    raw.frames = raw.rows.len() / channels;
    let rest = raw.rows.len() % channels;
    let differs = promised.is_some_and(|n| n != raw.frames as u64);
    let by_joint: Vec<usize> = raw.joints.iter().map(|j| j.channels.len()).filter(|&n| n > 0).collect();
    if !row_per_line && !is_filled && (rest > 0 || differs) && !wrapping.proves(&by_joint) {
        let more =
            if rest == 0 { String::new() } else { format!(" and {rest} numbers from line {began} on") };
        let stated = promised.map_or_else(String::new, |n| format!("{n} frames, as the header states, or "));
        return Err(MotionError::malformed(
            file,
            format!("lines {first_line} to {}", first_line + text.trim_end().lines().count().max(1) - 1),
            format!(
                "found {} of {channels} numbers{more}; must be {stated}rows whose lines show that none is missing",
                counted(raw.frames, "row", "rows")
            ),
        ));
    }
    if rest > 0 {
        *raw.dropped.entry("rows".into()).or_default() += 1;
        raw.rows.truncate(raw.frames * channels);
    }
    if let Some(promised) = promised.filter(|_| differs) {
        let frames = raw.frames;
        raw.notes.push(format!("the header promises {promised} frames; the {frames} in the file are used"));
    }
    Ok(())
}

/// The numbers of a line as they are written. Two numbers without a blank between them are divided where a sign begins the second.
pub(super) fn words_of(line: &str, channels: usize) -> impl Iterator<Item = &str> {
    let is_blank = |c: char| c.is_whitespace() || c.is_control() || c == ';';
    // A comma is a decimal mark in some languages, and a separator in some tables.
    let is_decimal = line.contains(',')
        && !line.contains('.')
        && line.split(is_blank).filter(|word| !word.is_empty()).flat_map(numbers_of).count() == channels;
    let words = line.split(move |c| is_blank(c) || c == ',' && !is_decimal);
    words.filter(|word| !word.is_empty()).flat_map(numbers_of)
}

/// A number with a decimal point or a decimal comma.
pub(super) fn parsed<T: std::str::FromStr>(word: &str) -> Option<T> {
    word.parse().ok().or_else(|| word.replace(',', ".").parse().ok())
}

/// A number of a row; `None` if the word is none. Those that are not finite are counted and replaced by that of the previous row.
fn number(word: &str, raw: &mut RawMotion) -> Option<f32> {
    let parsed = parsed(word).or_else(|| is_not_a_number(word).then_some(f32::NAN))?;
    if parsed.is_finite() && parsed.abs() < 1e9 {
        return Some(parsed);
    }
    *raw.dropped.entry("numbers".into()).or_default() += 1;
    Some(raw.rows.len().checked_sub(raw.channels).map_or(0.0, |i| raw.rows[i]))
}
