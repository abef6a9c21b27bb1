//! The frames of a BVH file: a table of numbers, one row per frame.
//!
//! A row is a line. Some programs write a row over several lines, and some write all numbers in lines of any length. What cannot be
//! divided into rows without doubt is refused by its line, because a number that is missing shifts all after it.

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

/// Reads the rows from `text`, which begins in line `first_line`. `promised` is the number of frames that the header states.
///
/// # Errors
/// If a line has too few or too many numbers, or a word that is no number.
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
        let refuse =
            |problem: String| MotionError::malformed(file, format!("line {}", first_line + i), problem);
        let ends = open.is_multiple_of(channels) && (open == channels || count.is_multiple_of(channels));
        // A file may be cut off within its last row, which moves no other.
        let is_cut = left == 0 && open < channels && layout.lines > 1;
        if ends {
            open = 0;
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
    if !raw.rows.len().is_multiple_of(channels) {
        *raw.dropped.entry("rows".into()).or_default() += 1;
        raw.rows.truncate(raw.frames * channels);
    }
    if let Some(promised) = promised.filter(|&n| n != raw.frames as u64) {
        let frames = raw.frames;
        raw.notes.push(format!("the header promises {promised} frames; the {frames} in the file are used"));
    }
    Ok(())
}

/// The numbers of a line as they are written. Two numbers without a blank between them are divided where a sign begins the second.
fn words_of(line: &str, channels: usize) -> impl Iterator<Item = &str> {
    let is_blank = |c: char| c.is_whitespace() || c.is_control() || c == ';';
    // A comma is a decimal mark in some languages, and a separator in some tables.
    let is_decimal = line.contains(',')
        && !line.contains('.')
        && line.split(is_blank).filter(|word| !word.is_empty()).flat_map(numbers_of).count() == channels;
    let words = line.split(move |c| is_blank(c) || c == ',' && !is_decimal);
    words.filter(|word| !word.is_empty()).flat_map(numbers_of)
}

/// Divides a word before each sign that begins another number, which is one that follows a digit or a decimal point.
pub(super) fn numbers_of(word: &str) -> impl Iterator<Item = &str> {
    let bytes = word.as_bytes();
    let begins = |at: usize| {
        matches!(bytes[at], b'-' | b'+') && (bytes[at - 1].is_ascii_digit() || bytes[at - 1] == b'.')
    };
    let mut from = 0;
    let cuts = (1..=bytes.len()).filter(move |&at| at == bytes.len() || begins(at));
    cuts.map(move |at| {
        let part = &word[from..at];
        from = at;
        part
    })
}

/// A number of a row; `None` if the word is none. Those that are not finite are counted and replaced by that of the previous row.
fn number(word: &str, raw: &mut RawMotion) -> Option<f32> {
    let parsed = word.parse::<f32>().ok().or_else(|| word.replace(',', ".").parse().ok());
    // As the library of Microsoft writes them.
    let parsed = parsed.or_else(|| word.contains(".#").then_some(f32::NAN))?;
    if parsed.is_finite() && parsed.abs() < 1e9 {
        return Some(parsed);
    }
    *raw.dropped.entry("numbers".into()).or_default() += 1;
    Some(raw.rows.len().checked_sub(raw.channels).map_or(0.0, |i| raw.rows[i]))
}
