//! A line of text as glyphs with their pixels.

use std::ops::Range;
use std::sync::Arc;

use harfrust::{BufferFlags, Direction, ShapeOptions, ShaperData, UnicodeBuffer};
use skrifa::instance::{LocationRef, Size};
use skrifa::outline::DrawSettings;
use skrifa::{FontRef, GlyphId, MetadataProvider as _};
use unicode_segmentation::UnicodeSegmentation as _;

use crate::coverage::Outline;
use crate::fonts::{Face, Fonts};
use crate::order::Piece;
use crate::picture::picture;

/// The longest text that is shaped, bytes. Names and labels are shorter.
const MAX_BYTES: usize = 4096;

/// The pixels of a glyph, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub enum Ink {
    /// Opacity, to be drawn in the colour of the text.
    Coverage(Vec<u8>),
    /// Colours with straight opacity, sRGB.
    Color(Vec<[u8; 4]>),
}

/// A glyph and its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Glyph {
    /// Its left edge from the start of the line, pixels.
    pub left: i32,
    /// Its upper edge from the base line, pixels, downward.
    pub top: i32,
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Its pixels.
    pub ink: Ink,
}

/// Glyphs of a line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Line {
    /// The glyphs from left to right.
    pub glyphs: Vec<Glyph>,
    /// The width, pixels.
    pub width: f32,
}

/// Lays out and draws a piece of text at `px` pixels per em. Characters that no font has are left out, and return `None` if they are all
/// there is.
pub fn line(fonts: &Fonts, piece: Piece<'_>, px: f32) -> Option<Line> {
    let text = if piece.text.len() > MAX_BYTES { "" } else { piece.text };
    let px = if px.is_finite() { px.clamp(1.0, 400.0) } else { return None };
    let mut runs = runs(fonts, text);
    if piece.from_right {
        runs.reverse();
    }
    let mut line = Line::default();
    let any = !runs.is_empty();
    for (face, range) in runs {
        shape(&face, &text[range], piece.from_right, px, &mut line);
    }
    any.then_some(line)
}

/// One grapheme cluster as one glyph with the line's width, for what sets its own glyphs.
pub fn cluster(fonts: &Fonts, text: &str, px: f32) -> Option<Line> {
    let line = line(fonts, Piece { text, from_right: false }, px)?;
    (!line.glyphs.is_empty()).then_some(line)
}

/// Parts of a text with one face each. A cluster has the face of its first character.
fn runs(fonts: &Fonts, text: &str) -> Vec<(Arc<Face>, Range<usize>)> {
    let mut runs: Vec<(Arc<Face>, Range<usize>)> = Vec::new();
    for (start, cluster) in text.grapheme_indices(true) {
        let Some(first) = cluster.chars().next() else { continue };
        let end = start + cluster.len();
        // A space has the font of what it follows, so that its run is not divided.
        if first.is_whitespace()
            && let Some((_, range)) = runs.last_mut().filter(|(_, range)| range.end == start)
        {
            range.end = end;
            continue;
        }
        let Some(face) = fonts.face_for(first) else { continue };
        match runs.last_mut() {
            Some((known, range)) if Arc::ptr_eq(known, &face) && range.end == start => range.end = end,
            _ => runs.push((face, start..end)),
        }
    }
    runs
}

/// Adds the glyphs of a run to a line.
fn shape(face: &Face, text: &str, from_right: bool, px: f32, line: &mut Line) {
    let Some(font) = face.font() else { return };
    let data = ShaperData::new(&font);
    let shaper = data.shaper(&font).build();
    let mut buffer = UnicodeBuffer::new();
    buffer.set_flags(BufferFlags::BEGINNING_OF_TEXT | BufferFlags::END_OF_TEXT);
    buffer.push_str(text);
    buffer.guess_segment_properties();
    buffer.set_direction(if from_right { Direction::RightToLeft } else { Direction::LeftToRight });
    let shaped = shaper.shape(buffer, ShapeOptions::new());
    let scale = px / f32::from(font.metrics(Size::unscaled(), LocationRef::default()).units_per_em.max(1));
    for (info, place) in shaped.glyph_infos().iter().zip(shaped.glyph_positions()) {
        let origin = [line.width + place.x_offset as f32 * scale, -(place.y_offset as f32) * scale];
        line.glyphs.extend(draw(&font, GlyphId::new(info.glyph_id), origin, px));
        line.width += place.x_advance as f32 * scale;
    }
}

/// The pixels of a glyph whose start on the base line is at `origin`.
fn draw(font: &FontRef<'_>, glyph: GlyphId, [x, y]: [f32; 2], px: f32) -> Option<Glyph> {
    if let Some(picture) = picture(font, glyph, px) {
        return Some(Glyph {
            left: (x + picture.left).round() as i32,
            top: (y + picture.top).round() as i32,
            width: picture.width,
            height: picture.height,
            ink: Ink::Color(picture.rgba),
        });
    }
    let mut outline = Outline::default();
    let settings = DrawSettings::unhinted(Size::new(px), LocationRef::default());
    font.outline_glyphs().get(glyph)?.draw(settings, &mut outline).ok()?;
    let covered = outline.coverage()?;
    Some(Glyph {
        left: x.round() as i32 + covered.left,
        top: y.round() as i32 + covered.top,
        width: covered.width,
        height: covered.height,
        ink: Ink::Coverage(covered.alpha),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::order::pieces;
    use crate::script::Script;

    /// The line of a text; `None` where the system has no font for its script.
    fn of(text: &str) -> Option<Line> {
        let fonts = Fonts::of_system();
        fonts.face_for(text.chars().next()?)?;
        line(fonts, *pieces(text).first()?, 16.0)
    }

    fn ink(line: &Line) -> usize {
        let of = |glyph: &Glyph| match &glyph.ink {
            Ink::Coverage(alpha) => alpha.iter().filter(|alpha| **alpha > 60).count(),
            Ink::Color(rgba) => rgba.iter().filter(|pixel| pixel[3] > 60).count(),
        };
        line.glyphs.iter().map(of).sum()
    }

    #[test]
    fn every_script_with_a_font_has_ink_within_its_line() {
        for text in ["笑い", "喜悦", "웃음", "ابتسامة", "חיוך", "मुस्कान", "ยิ้ม", "😀"]
        {
            let Some(line) = of(text) else { continue };
            assert!(line.width > 8.0, "{text}: {}", line.width);
            assert!(ink(&line) > 20, "{text}: {}", ink(&line));
            for glyph in &line.glyphs {
                assert!(glyph.top > -40 && glyph.top + (glyph.height as i32) < 20, "{text}: {glyph:?}");
                assert!(glyph.left > -8 && (glyph.left as f32) < line.width + 4.0, "{text}: {glyph:?}");
            }
        }
    }

    #[test]
    fn arabic_letters_are_joined() {
        let Some(word) = of("بب") else { return };
        // Alone, a letter has another form, which is wider than the two forms of a pair.
        let Some(letter) = of("ب") else { return };
        assert!(word.width < 1.9 * letter.width, "{} against {}", word.width, letter.width);
        // Control: the letters of another script add up.
        if let (Some(two), Some(one)) = (of("ああ"), of("あ")) {
            assert!((two.width - 2.0 * one.width).abs() < 0.01);
        }
    }

    #[test]
    fn a_line_from_the_right_begins_with_its_last_letter() {
        let (Some(word), Some(last)) = (of("אבג"), of("ג")) else { return };
        let (first, alone) = (&word.glyphs[0], &last.glyphs[0]);
        assert_eq!((first.width, first.height, &first.ink), (alone.width, alone.height, &alone.ink));
    }

    #[test]
    fn odd_texts_do_no_harm() {
        let fonts = Fonts::of_system();
        for text in
            ["", "\n", "\u{200d}\u{200d}", "\u{202e}abc", "a\u{301}\u{301}\u{301}", &"あ".repeat(9000)]
        {
            for piece in pieces(text) {
                for px in [0.0, 3.0, f32::NAN, 1e9] {
                    drop(line(fonts, piece, px));
                }
            }
        }
        assert_eq!(Script::of('\u{200d}'), Script::Other);
    }
}
