//! Decodes the images of a file: PNG, JPEG and WebP, recognised by their bytes.

use std::borrow::Cow;
use std::io::Cursor;

use image::{ImageFormat, ImageReader, Limits};
use lovelock_base::words::counted;
use rayon::prelude::*;

use super::jpeg;
use super::plan::{SIDE, STORED_SIDE, TOTAL_BYTES, Verdict, halved, plan};
use crate::Image;

/// Images of more pixels are decoded one after the other, so that the memory for decoding stays bounded.
const SIDE_BY_SIDE_PIXELS: u64 = 1 << 24;
/// Images that a note tells one by one.
const TOLD: usize = 6;

/// An image as the file stores it.
pub(crate) struct Encoded<'a> {
    /// What it is called in notes.
    pub(crate) name: String,
    /// Its bytes, or why they are missing.
    pub(crate) bytes: Result<Cow<'a, [u8]>, String>,
}

/// Decodes images. The second value is the place of each in the list of decoded ones; `None` for those that are lost, which notes tell.
pub(super) fn decode(encoded: &[Encoded], notes: &mut Vec<String>) -> (Vec<Image>, Vec<Option<usize>>) {
    let opened: Vec<Result<([u32; 2], ImageFormat), String>> = encoded
        .iter()
        .map(|image| open(image.bytes.as_deref().map_err(Clone::clone)?, &image.name))
        .collect();
    let sizes: Vec<[u32; 2]> =
        opened.iter().map(|opened| opened.as_ref().map_or([0, 0], |(size, _)| *size)).collect();
    let verdicts = plan(&sizes);
    let read = |index: usize| -> Result<Image, String> {
        let (size, format) = opened[index].clone()?;
        let halvings = match verdicts[index] {
            Verdict::Halved(times) => times,
            Verdict::TooLarge => {
                return Err(format!("has {} by {} pixels, more than are read", size[0], size[1]));
            }
            Verdict::TooMany => return Err("the images before it have as many pixels as are read".to_owned()),
        };
        let bytes = encoded[index].bytes.as_deref().map_err(Clone::clone)?;
        let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
        reader.limits(limits(size));
        let pixels = reader.decode().map_err(|error| sentence(&error))?.into_rgba8();
        let stored = [pixels.width(), pixels.height()];
        let (size, pixels) =
            (0..halvings).fold((stored, pixels.into_raw()), |(size, pixels), _| half(size, &pixels));
        if size.contains(&0) {
            return Err("has no pixels".to_owned());
        }
        Ok(Image { name: encoded[index].name.clone(), size, pixels: pixels.into() })
    };
    let is_small =
        |index: &usize| u64::from(sizes[*index][0]) * u64::from(sizes[*index][1]) <= SIDE_BY_SIDE_PIXELS;
    let (small, large): (Vec<usize>, Vec<usize>) = (0..encoded.len()).partition(is_small);
    let mut results: Vec<(usize, Result<Image, String>)> =
        small.into_par_iter().map(|index| (index, read(index))).collect();
    results.extend(large.into_iter().map(|index| (index, read(index))));
    results.sort_by_key(|(index, _)| *index);

    let (mut images, mut places, mut lost) = (Vec::new(), vec![None; encoded.len()], Vec::new());
    let (mut reduced, mut cut) = (0, Vec::new());
    for (index, result) in results {
        match result {
            Ok(image) => {
                places[index] = Some(images.len());
                reduced += usize::from(matches!(verdicts[index], Verdict::Halved(1..)));
                if opened[index].as_ref().is_ok_and(|(_, format)| *format == ImageFormat::Jpeg)
                    && encoded[index].bytes.as_deref().is_ok_and(|bytes| !jpeg::has_end(bytes))
                {
                    cut.push(format!("the image `{}` is cut short: a part of it may be grey", image.name));
                }
                images.push(image);
            }
            Err(problem) => {
                lost.push(format!("the image `{}` is left out: it {problem}", encoded[index].name));
            }
        }
    }
    tell(lost, "left out", "for such reasons", notes);
    tell(cut, "found", "cut short", notes);
    if reduced > 0 {
        notes.push(format!(
            "reduced {}, because at most {SIDE} by {SIDE} pixels and {} MB in all are kept",
            counted(reduced, "image", "images"),
            TOTAL_BYTES >> 20
        ));
    }
    (images, places)
}

/// Adds the first sentences, and the number of further ones.
fn tell(sentences: Vec<String>, verb: &str, end: &str, notes: &mut Vec<String>) {
    let more = sentences.len().saturating_sub(TOLD);
    notes.extend(sentences.into_iter().take(TOLD));
    if more > 0 {
        notes.push(format!("{verb} {} {end}", counted(more, "more image", "more images")));
    }
}

/// Size and format by the first bytes. The name tells a format that has none of its own.
fn open(bytes: &[u8], name: &str) -> Result<([u32; 2], ImageFormat), String> {
    let Ok(format @ (ImageFormat::Png | ImageFormat::Jpeg | ImageFormat::WebP)) = image::guess_format(bytes)
    else {
        return Err(format!("is {}; PNG, JPEG and WebP are read", other_format(bytes, name)));
    };
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    // The plan judges the sides.
    let mut any_side = limits([1, 1]);
    (any_side.max_image_width, any_side.max_image_height) = (None, None);
    reader.limits(any_side);
    let (width, height) = reader.into_dimensions().map_err(|error| sentence(&error))?;
    if width == 0 || height == 0 {
        return Err(format!("has {width} by {height} pixels"));
    }
    Ok(([width, height], format))
}

/// Memory for decoding an image of a size: 16 bits of four channels, and what decoders need besides.
fn limits(size: [u32; 2]) -> Limits {
    let mut limits = Limits::default();
    limits.max_image_width = Some(STORED_SIDE);
    limits.max_image_height = Some(STORED_SIDE);
    limits.max_alloc = Some(12 * u64::from(size[0]) * u64::from(size[1]) + (16 << 20));
    limits
}

/// What bytes are that are no image of a known format.
fn other_format(bytes: &[u8], name: &str) -> &'static str {
    match bytes {
        [] => "empty",
        [0xab, b'K', b'T', b'X', b' ', b'2', b'0', ..] => "in KTX2",
        [0xab, b'K', b'T', b'X', ..] => "in KTX",
        [b'D', b'D', b'S', b' ', ..] => "in DDS",
        [_, _, _, _, b'f', b't', b'y', b'p', b'a', b'v', b'i', ..] => "in AVIF",
        [b'G', b'I', b'F', b'8', ..] => "in GIF",
        [b'B', b'M', ..] => "in BMP",
        [b'I', b'I', 42, 0, ..] | [b'M', b'M', 0, 42, ..] => "in TIFF",
        [b'8', b'B', b'P', b'S', ..] => "in PSD",
        [b'#', b'?', ..] => "in HDR",
        _ if name.to_ascii_lowercase().ends_with(".tga") => "in TGA",
        _ => "in no known format",
    }
}

fn sentence(error: &image::ImageError) -> String {
    use image::ImageError;
    match error {
        ImageError::Limits(_) => "needs more memory for decoding than images of its size do".to_owned(),
        ImageError::IoError(_) => "is cut short".to_owned(),
        other => {
            let text: String = other.to_string().chars().filter(|c| !c.is_control()).take(160).collect();
            format!("is broken ({text})")
        }
    }
}

/// An image of half the width and height: the mean of the pixels that each of its own covers. A last odd row or column is left out.
fn half(size: [u32; 2], pixels: &[u8]) -> ([u32; 2], Vec<u8>) {
    let half = halved(size, 1);
    let [width, height] = size.map(|side| side as usize);
    let columns = half[0] as usize;
    let mut out = vec![0_u8; 4 * columns * half[1] as usize];
    out.par_chunks_exact_mut((4 * columns).max(1)).enumerate().for_each(|(y, row)| {
        let rows = [2 * y, (2 * y + 1).min(height - 1)];
        for (x, pixel) in row.as_chunks_mut::<4>().0.iter_mut().enumerate() {
            let columns = [2 * x, (2 * x + 1).min(width - 1)];
            for (channel, value) in pixel.iter_mut().enumerate() {
                let four = rows
                    .iter()
                    .flat_map(|y| columns.iter().map(move |x| pixels[4 * (y * width + x) + channel]));
                *value = ((four.map(u32::from).sum::<u32>() + 2) / 4) as u8;
            }
        }
    });
    (half, out)
}

#[cfg(test)]
mod tests;
