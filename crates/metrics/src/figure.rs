//! Images with text: labels and the legend of a colour map.

use crate::color_map::ColorMap;
use crate::image::Image;
use crate::ticks::ticks;
use lovelock_glyphs::{Fonts, Ink, Line, Piece, line, pieces, seen};
use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};
use std::ops::RangeInclusive;

/// The largest width and height of a canvas in pixels.
const LARGEST: usize = 32_768;

/// An image to draw into: sRGB, four bytes per pixel, rows from the top. Everything outside is clipped.
#[derive(Clone, Debug, PartialEq)]
pub struct Canvas {
    width: usize,
    height: usize,
    rgba: Vec<u8>,
}

impl Canvas {
    /// Height of a line of [`text`](Self::text) in pixels.
    pub const LINE: usize = 16;

    /// A canvas filled with an opaque colour. Width and height are clamped to 1 to 32,768 pixels.
    pub fn new(width: usize, height: usize, color: [u8; 3]) -> Self {
        let [width, height] = [width, height].map(|edge| edge.clamp(1, LARGEST));
        let [r, g, b] = color;
        Self { width, height, rgba: [r, g, b, 255].repeat(width * height) }
    }

    /// Pixels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The bytes, four per pixel.
    pub fn rgba(&self) -> &[u8] {
        &self.rgba
    }

    /// The bytes, four per pixel.
    pub fn into_rgba(self) -> Vec<u8> {
        self.rgba
    }

    /// Width of [`text`](Self::text) in pixels.
    pub fn text_width(text: &str) -> usize {
        spans(text).iter().map(Span::width).sum()
    }

    /// Blends a colour over a pixel with `alpha` of 255.
    fn blend(&mut self, x: i32, y: i32, color: [u8; 3], alpha: u8) {
        let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y)) else { return };
        if x >= self.width || y >= self.height {
            return;
        }
        let pixel = &mut self.rgba[(y * self.width + x) * 4..][..4];
        for (below, above) in pixel.iter_mut().zip(color) {
            let sum = u16::from(*below) * u16::from(255 - alpha) + u16::from(above) * u16::from(alpha);
            *below = ((sum + 127) / 255) as u8;
        }
        pixel[3] = 255;
    }

    /// Fills a rectangle of `width` by `height` pixels at `x`, `y`.
    pub fn fill(&mut self, x: i32, y: i32, width: usize, height: usize, color: [u8; 3]) {
        let inside = |start: i32, length: usize, edge: usize| {
            start.max(0)..start.saturating_add(length.min(LARGEST) as i32).min(edge as i32)
        };
        for y in inside(y, height, self.height) {
            for x in inside(x, width, self.width) {
                self.blend(x, y, color, 255);
            }
        }
    }

    /// Copies an image to `x`, `y`. The canvas shows through transparent pixels.
    pub fn put(&mut self, x: i32, y: i32, picture: &Image<'_>) {
        for (row, pixels) in picture.rgba().chunks_exact(picture.width() * 4).enumerate() {
            for (column, pixel) in pixels.chunks_exact(4).enumerate() {
                let place = (x.saturating_add(column as i32), y.saturating_add(row as i32));
                self.blend(place.0, place.1, [pixel[0], pixel[1], pixel[2]], pixel[3]);
            }
        }
    }

    /// Draws one line of text with its upper left corner at `x`, `y`, in Noto Sans Mono, [`LINE`](Self::LINE) pixels high. Characters
    /// outside Latin 1 have the glyphs of the system's fonts, in the order in which they are read; without such a font they become
    /// question marks.
    pub fn text(&mut self, x: i32, y: i32, text: &str, color: [u8; 3]) {
        let mut pen = x;
        for span in spans(text) {
            match &span {
                Span::Latin(letters) => self.latin(pen, y, letters, color),
                Span::Other(line) => self.line(pen, y, line, color),
            }
            pen = pen.saturating_add(span.width() as i32);
            if pen > LARGEST as i32 {
                break;
            }
        }
    }

    /// Draws letters of the font of this program.
    fn latin(&mut self, x: i32, y: i32, letters: &str, color: [u8; 3]) {
        let mut pen = x;
        for letter in letters.chars() {
            let Some(glyph) = raster(letter).or_else(|| raster('?')) else { continue };
            for (row, line) in glyph.rows().enumerate() {
                for (column, &ink) in line.iter().enumerate() {
                    self.blend(pen.saturating_add(column as i32), y.saturating_add(row as i32), color, ink);
                }
            }
            pen = pen.saturating_add(glyph.width() as i32);
            if pen > LARGEST as i32 {
                break;
            }
        }
    }

    /// Draws glyphs of a font of the system.
    fn line(&mut self, x: i32, y: i32, line: &Line, color: [u8; 3]) {
        for glyph in &line.glyphs {
            let left = x.saturating_add(glyph.left);
            let top = y.saturating_add(BASE + glyph.top);
            for at in 0..glyph.width * glyph.height {
                let (column, row) = (at % glyph.width, at / glyph.width);
                let place = (left.saturating_add(column as i32), top.saturating_add(row as i32));
                match &glyph.ink {
                    Ink::Coverage(alpha) => self.blend(place.0, place.1, color, alpha[at]),
                    Ink::Color(rgba) => {
                        let [r, g, b, alpha] = rgba[at];
                        self.blend(place.0, place.1, [r, g, b], alpha);
                    }
                }
            }
        }
    }
}

/// The base line below the upper edge of a line, and the size of the system's fonts, pixels.
const BASE: i32 = 12;
const SIZE: f32 = 13.0;

fn raster(letter: char) -> Option<noto_sans_mono_bitmap::RasterizedChar> {
    get_raster(letter, FontWeight::Regular, RasterHeight::Size16)
}

/// A part of a line, from left to right.
enum Span {
    /// Letters of the font of this program, in the order in which they are seen.
    Latin(String),
    /// Glyphs of the system's fonts.
    Other(Line),
}

impl Span {
    fn width(&self) -> usize {
        match self {
            Self::Latin(letters) => {
                letters.chars().count() * get_raster_width(FontWeight::Regular, RasterHeight::Size16)
            }
            Self::Other(line) => line.width.ceil().max(0.0) as usize,
        }
    }
}

/// The parts of a line from left to right. The system's fonts are only read for a character that the font of this program lacks.
fn spans(text: &str) -> Vec<Span> {
    if text.chars().all(|letter| raster(letter).is_some()) {
        return vec![Span::Latin(text.to_owned())];
    }
    let mut spans = Vec::new();
    for piece in pieces(text) {
        let before = spans.len();
        let mut rest = piece.text;
        while let Some(first) = rest.chars().next() {
            // A mark over a Latin letter stays in the font of this program, where it is a question mark.
            let is_latin = raster(first).is_some();
            let end = rest.char_indices().find(|(_, c)| raster(*c).is_some() != is_latin);
            let (part, after) = rest.split_at(end.map_or(rest.len(), |(at, _)| at));
            rest = after;
            let part = Piece { text: part, ..piece };
            let drawn = if is_latin { None } else { line(Fonts::of_system(), part, SIZE) };
            spans.push(drawn.map_or_else(|| Span::Latin(seen(part)), Span::Other));
        }
        if piece.from_right {
            spans[before..].reverse();
        }
    }
    spans
}

/// The legend of a colour map: a bar with round numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Legend {
    /// The colour map.
    pub map: ColorMap,
    /// Values of the first and the last colour.
    pub range: RangeInclusive<f32>,
    /// The quantity with its unit, in one line above the bar.
    pub title: String,
}

/// Text colour on a white background.
const INK: [u8; 3] = [32, 33, 36];
const PAPER: [u8; 3] = [255, 255, 255];
/// Colour of missing values, which is in no colour map.
const NOTHING: [u8; 3] = [222, 225, 230];

impl Legend {
    /// Width of the bar in pixels.
    const BAR: usize = 18;

    /// Draws the legend at `x`, `y`, `height` pixels high: the title, and below it a vertical bar with the largest number at
    /// the top.
    pub fn draw(&self, canvas: &mut Canvas, x: i32, y: i32, height: usize, ink: [u8; 3]) {
        canvas.text(x, y, &self.title, ink);
        let line = Canvas::LINE as i32;
        let top = y.saturating_add(line + line / 2 + 4);
        let length = height.saturating_sub(Canvas::LINE * 2 + 4).clamp(1, LARGEST) as i32;
        for row in 0..length {
            let t = 1.0 - (row as f32 + 0.5) / length as f32;
            canvas.fill(x, top + row, Self::BAR, 1, self.map.at(t));
        }
        let (low, high) = (f64::from(*self.range.start()), f64::from(*self.range.end()));
        let ticks = ticks(low, high, (length as usize / 40).clamp(2, 8));
        let after = x.saturating_add(Self::BAR as i32);
        for &value in &ticks.values {
            let row = top + ((high - value) / (high - low) * f64::from(length - 1)).round() as i32;
            canvas.fill(after, row, 5, 1, ink);
            canvas.text(after + 8, row - line / 2, &ticks.label(value), ink);
        }
    }

    /// Width of the legend in pixels, for any height.
    pub fn width(&self) -> usize {
        let (low, high) = (f64::from(*self.range.start()), f64::from(*self.range.end()));
        let labels = (2..=8).filter_map(|wanted| {
            let ticks = ticks(low, high, wanted);
            ticks.values.iter().map(|&value| Canvas::text_width(&ticks.label(value))).max()
        });
        (Self::BAR + 8 + labels.max().unwrap_or(0)).max(Canvas::text_width(&self.title))
    }

    /// A false-colour image with the legend on its right, on white. Transparent pixels become a grey that is in no colour map.
    pub fn beside(&self, picture: &Image<'_>) -> Canvas {
        let margin = 12;
        let height = picture.height().max(Canvas::LINE * 6);
        let mut canvas = Canvas::new(picture.width() + self.width() + 2 * margin, height, PAPER);
        canvas.fill(0, 0, picture.width(), picture.height(), NOTHING);
        canvas.put(0, 0, picture);
        self.draw(&mut canvas, (picture.width() + margin) as i32, 4, height - 8, INK);
        canvas
    }
}

#[cfg(test)]
mod tests {
    use super::{Canvas, INK, Legend, NOTHING};
    use crate::{ColorMap, Image};

    fn pixel(canvas: &Canvas, x: usize, y: usize) -> [u8; 3] {
        let at = (y * canvas.width() + x) * 4;
        [0, 1, 2].map(|i| canvas.rgba()[at + i])
    }

    #[test]
    fn text_stays_inside_its_width() {
        let mut canvas = Canvas::new(80, 20, [255; 3]);
        canvas.text(4, 2, "Ab·1", [0; 3]);
        let wide = Canvas::text_width("Ab·1");
        let dark = |x: usize| (0..20).any(|y| pixel(&canvas, x, y)[0] < 100);
        assert!((4..4 + wide).any(dark) && !(4 + wide..80).any(dark) && !(0..4).any(dark));
        // Negative control: a different text gives a different image.
        let mut other = Canvas::new(80, 20, [255; 3]);
        other.text(4, 2, "Ab·2", [0; 3]);
        assert_ne!(canvas, other);
    }

    #[test]
    fn other_scripts_have_their_own_glyphs() {
        let draw = |text: &str| {
            let mut canvas = Canvas::new(120, 20, [255; 3]);
            canvas.text(4, 2, text, [0; 3]);
            canvas
        };
        // Without a font for it, a character is a question mark.
        for text in ["笑い", "한글", "שלום", "مرحبا"] {
            let width = Canvas::text_width(text);
            assert!(width > 10 && width < 100, "{text}: {width}");
            if lovelock_glyphs::Fonts::of_system().face_for(text.chars().next().unwrap()).is_some() {
                assert_ne!(draw(text), draw(&"?".repeat(text.chars().count())), "{text}");
                let canvas = draw(text);
                assert!((0..120).any(|x| (0..20).any(|y| pixel(&canvas, x, y)[0] < 100)), "{text}");
            }
        }
        // The words of a right-to-left text stand from right to left; Latin letters do not.
        assert_ne!(draw("שלום טוב"), draw("טוב שלום"));
    }

    #[test]
    fn nothing_is_drawn_outside() {
        let mut canvas = Canvas::new(10, 10, [9; 3]);
        let before = canvas.clone();
        canvas.text(-500, 3, "far", [0; 3]);
        canvas.text(i32::MAX, i32::MAX, "far", [0; 3]);
        canvas.fill(i32::MIN, 0, 5, 5, [0; 3]);
        canvas.fill(10, 0, usize::MAX, 5, [0; 3]);
        canvas.put(0, -2, &Image::new(1, 2, &[0; 8]).unwrap());
        assert_eq!(canvas, before);
        canvas.fill(8, 8, usize::MAX, usize::MAX, [1; 3]);
        assert_eq!((pixel(&canvas, 9, 9), pixel(&canvas, 7, 7)), ([1; 3], [9; 3]));
        assert_eq!(Canvas::new(0, usize::MAX, [0; 3]).rgba().len(), 4 * 32_768);
    }

    #[test]
    fn a_legend_shows_the_ends_of_its_map_and_greys_what_is_missing() {
        let legend = Legend { map: ColorMap::Magma, range: 0.0..=0.2, title: "error".into() };
        let painted = crate::paint(&[0.0, f32::NAN], 0.0..=0.2, ColorMap::Magma).repeat(200);
        let canvas = legend.beside(&Image::new(2, 200, &painted).unwrap());
        assert_eq!(canvas.height(), 200);
        assert_eq!((pixel(&canvas, 0, 5), pixel(&canvas, 1, 5)), (ColorMap::Magma.at(0.0), NOTHING));
        let bar: Vec<_> = (0..200).map(|y| pixel(&canvas, 2 + 12 + 4, y)).collect();
        for t in [0.02, 0.5, 0.98] {
            let wanted = ColorMap::Magma.at(t);
            let near = |color: &&[u8; 3]| (0..3).all(|i| color[i].abs_diff(wanted[i]) < 4);
            assert!(bar.iter().any(|color| near(&color)), "{t}: {wanted:?}");
        }
        let marks = (0..200).filter(|&y| pixel(&canvas, 2 + 12 + Legend::BAR + 2, y) == INK).count();
        assert_eq!(marks, 3, "0.0, 0.1 and 0.2");
        // An empty range has a bar without numbers.
        let flat = Legend { range: 0.0..=0.0, ..legend };
        assert_eq!(flat.beside(&Image::new(2, 200, &painted).unwrap()).height(), 200);
    }
}
