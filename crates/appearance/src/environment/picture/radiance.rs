//! The Radiance picture format, `.hdr`: <https://radsite.lbl.gov/radiance/refer/filefmts.pdf>.
//!
//! Read here and not by the `image` crate, whose decoder holds the whole picture in memory, 1.5 GiB for the largest
//! that is read, and overflows on a chain of empty runs.

use std::io::{self, BufRead, Read as _};

use super::{NewReducer, Reducer};
use crate::environment::error::Problem;

/// Bytes of the longest header that is read. Those of common tools have some hundred.
const MAX_HEADER_BYTES: u64 = 1 << 16;

/// The colours that are read.
const FORMAT: &str = "32-bit_rle_rgbe";

/// What the line of the size must look like.
const SIZE: &str = "a line of the size such as \"-Y 1024 +X 2048\"";

/// Red, green, blue and their exponent.
type Rgbe = [u8; 4];

/// The size and the order of the pixels.
struct Layout {
    width: u64,
    height: u64,
    /// The first row is the lowest.
    bottom_up: bool,
    /// The first column is the rightmost.
    right_to_left: bool,
}

/// Reads a picture row by row.
pub(super) fn read(mut content: impl BufRead, reducer: NewReducer<'_>) -> Result<Reducer, Problem> {
    let layout = read_header(&mut content)?;
    let mut reducer = reducer(layout.width, layout.height)?;
    let (width, height) = (layout.width as usize, layout.height as usize);
    let mut row = vec![[0; 4]; width];
    for at in 0..height {
        read_row(&mut content, &mut row).map_err(|problem| match problem {
            Problem::Io(error) if error.kind() == io::ErrorKind::UnexpectedEof => {
                Problem::CutShort { found: format!("{at} rows"), wanted: format!("{height} rows") }
            }
            other => other,
        })?;
        let y = if layout.bottom_up { height - 1 - at } else { at };
        if layout.right_to_left {
            reducer.add(0, y, row.iter().rev().map(|&pixel| radiance(pixel)));
        } else {
            reducer.add(0, y, row.iter().map(|&pixel| radiance(pixel)));
        }
    }
    Ok(reducer)
}

/// Reads the lines up to the size of the picture.
fn read_header(content: &mut impl BufRead) -> Result<Layout, Problem> {
    let mut header = content.take(MAX_HEADER_BYTES);
    let mut line = Vec::new();
    let mut next = |line: &mut Vec<u8>| -> Result<String, Problem> {
        line.clear();
        header.read_until(b'\n', line)?;
        if line.pop() != Some(b'\n') {
            return Err(match header.limit() {
                0 => Problem::Damaged { found: format!("no size in {MAX_HEADER_BYTES} bytes"), wanted: SIZE },
                _ => Problem::CutShort { found: "a part of the header".to_owned(), wanted: SIZE.to_owned() },
            });
        }
        Ok(String::from_utf8_lossy(line).trim().to_owned())
    };
    while let text = next(&mut line)?
        && !text.is_empty()
    {
        if let Some(format) = text.strip_prefix("FORMAT=")
            && format.trim() != FORMAT
        {
            let found = format!("colours {:?}", shortened(format.trim()));
            return Err(Problem::Variant { found, wanted: FORMAT });
        }
    }
    parse_size(&next(&mut line)?)
}

/// The start of a text that may be long.
fn shortened(text: &str) -> String {
    text.chars().take(40).collect()
}

/// Reads a line such as `-Y 1024 +X 2048`.
fn parse_size(line: &str) -> Result<Layout, Problem> {
    let words: Vec<&str> = line.split_whitespace().take(5).collect();
    let damaged = || Problem::Damaged { found: format!("{:?}", shortened(line)), wanted: SIZE };
    let [first, rows, second, columns] = words[..] else { return Err(damaged()) };
    let number = |word: &str| word.parse::<u32>().map(u64::from).map_err(|_| damaged());
    let (height, width) = (number(rows)?, number(columns)?);
    let (bottom_up, right_to_left) = match (first, second) {
        ("-Y", "+X") => (false, false),
        ("-Y", "-X") => (false, true),
        ("+Y", "+X") => (true, false),
        ("+Y", "-X") => (true, true),
        ("+X" | "-X", "+Y" | "-Y") => {
            return Err(Problem::Variant {
                found: format!("columns one by one ({line:?})"),
                wanted: "rows, -Y before +X",
            });
        }
        _ => return Err(damaged()),
    };
    Ok(Layout { width, height, bottom_up, right_to_left })
}

/// Reads one row, in any of the three encodings.
fn read_row(content: &mut impl BufRead, row: &mut [Rgbe]) -> Result<(), Problem> {
    let mut first = [0; 4];
    content.read_exact(&mut first)?;
    if first[0] == 2 && first[1] == 2 && first[2] < 128 && (8..32_768).contains(&row.len()) {
        let announced = usize::from(u16::from_be_bytes([first[2], first[3]]));
        if announced != row.len() {
            return Err(Problem::Damaged {
                found: format!("a row of {announced} pixels in a picture {} wide", row.len()),
                wanted: "rows as wide as the picture",
            });
        }
        (0..4).try_for_each(|component| read_component(content, row, component))
    } else {
        read_pixels(content, row, first)
    }
}

/// Reads one component of a row: runs of one byte, and bytes as they are.
fn read_component(content: &mut impl BufRead, row: &mut [Rgbe], component: usize) -> Result<(), Problem> {
    let mut bytes = [0; 128];
    let mut rest = row;
    while !rest.is_empty() {
        let mut code = [0];
        content.read_exact(&mut code)?;
        let run = code[0] > 128;
        let count = usize::from(if run { code[0] - 128 } else { code[0] });
        let bytes = &mut bytes[..count];
        if run {
            let mut value = [0];
            content.read_exact(&mut value)?;
            bytes.fill(value[0]);
        } else {
            content.read_exact(bytes)?;
        }
        let Some((now, later)) = rest.split_at_mut_checked(count) else { return Err(run_too_long()) };
        for (pixel, &byte) in now.iter_mut().zip(&*bytes) {
            pixel[component] = byte;
        }
        rest = later;
    }
    Ok(())
}

/// Reads whole pixels. Of the oldest encoding, red, green and blue of 1 repeat the pixel before; repeats that follow
/// each other are digits of base 256, the lowest first.
fn read_pixels(content: &mut impl BufRead, row: &mut [Rgbe], first: Rgbe) -> Result<(), Problem> {
    let (mut at, mut digit) = (0_usize, 0_u32);
    let mut pixel = first;
    loop {
        if pixel[..3] == [1, 1, 1] {
            let Some(&before) = at.checked_sub(1).and_then(|before| row.get(before)) else {
                return Err(Problem::Damaged {
                    found: "a row that starts with a repeat".to_owned(),
                    wanted: "a pixel to repeat",
                });
            };
            // Three digits exceed the widest row.
            let count = if digit < 3 { usize::from(pixel[3]) << (8 * digit) } else { usize::MAX };
            let end = at.checked_add(count).ok_or_else(run_too_long)?;
            row.get_mut(at..end).ok_or_else(run_too_long)?.fill(before);
            (at, digit) = (end, digit + 1);
        } else {
            *row.get_mut(at).ok_or_else(run_too_long)? = pixel;
            (at, digit) = (at + 1, 0);
        }
        if at >= row.len() {
            return Ok(());
        }
        content.read_exact(&mut pixel)?;
    }
}

fn run_too_long() -> Problem {
    Problem::Damaged { found: "a run longer than the row".to_owned(), wanted: "runs that end with the row" }
}

/// Radiance of a pixel: the mantissas are 256ths, the exponent is shifted by 128, and 0 is black.
fn radiance([r, g, b, e]: Rgbe) -> [f32; 3] {
    // As f64, since the smallest are below the normal range of f32.
    let scale = if e == 0 { 0.0 } else { (f64::from(e) - 136.0).exp2() };
    [r, g, b].map(|mantissa| (f64::from(mantissa) * scale) as f32)
}
