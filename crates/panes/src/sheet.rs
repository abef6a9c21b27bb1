//! Composes panes with their labels into one image.

use lovelock_metrics::{Canvas, Image, Legend};
use lovelock_project::project::CompareSection;
use lovelock_render::Picture;

use crate::heat::resize;
use crate::request::LivePane;
use crate::view::LiveView;

/// Height of the header of a pane, pixels.
const HEADER: u32 = 26;
/// Pixels between panes.
const GAP: u32 = 4;
/// Margin around the colour scale, pixels.
const MARGIN: u32 = 14;
/// Colours of the page, of headers, their text, and text over images.
const PAGE: [u8; 3] = [19, 20, 23];
const LINE: [u8; 3] = [28, 30, 34];
const QUIET: [u8; 3] = [168, 172, 180];
const INK: [u8; 3] = [236, 238, 242];

/// How panes are composed into one image.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// The panes left and right of a dividing line and its position as a fraction of the width; `None` shows all panes in a grid.
    pub wipe: Option<([usize; 2], f32)>,
    /// The columns of the grid; those that show the hair largest if there is no number.
    pub columns: Option<usize>,
    /// What they show.
    pub view: LiveView,
    /// Whether times and errors are written under the panes. Times differ between runs.
    pub figures: bool,
    /// The colour of each pane's mark, sRGB.
    pub colors: [[u8; 3]; CompareSection::MAX_PANES],
}

/// A pane to compose: its number, the pane, and its time in milliseconds.
pub type SheetPane<'a> = (usize, &'a LivePane, f64);

/// A rectangle: left, top, width, height; pixels.
type Place = [u32; 4];

impl Default for Sheet {
    /// Side by side and without times, so that the same panes give the same pixels.
    fn default() -> Self {
        Self { wipe: None, columns: None, view: LiveView::default(), figures: false, colors: Self::COLORS }
    }
}

impl Sheet {
    /// Colours that colour-blind people can tell apart (Okabe and Ito, *Color universal design*, 2008), and three more, sRGB.
    pub const COLORS: [[u8; 3]; CompareSection::MAX_PANES] = [
        [230, 159, 0],
        [86, 180, 233],
        [0, 158, 115],
        [240, 228, 66],
        [213, 94, 0],
        [204, 121, 167],
        [120, 124, 240],
        [187, 220, 160],
        [190, 190, 190],
    ];

    /// Numbers of the shown panes out of `panes`.
    pub fn panes(&self, panes: usize) -> Vec<usize> {
        let last = panes.saturating_sub(1);
        match self.wipe {
            Some(([left, right], _)) if left.min(last) == right.min(last) => vec![left.min(last)],
            Some((pair, _)) => pair.map(|pane| pane.min(last)).to_vec(),
            None => (0..panes).collect(),
        }
    }

    /// The size of the whole image if each of `panes` has the size `pane`, in one column if [`Self::columns`] has no number.
    pub fn size_of(&self, panes: usize, pane: [u32; 2]) -> [u32; 2] {
        let (columns, rows) = if self.wipe.is_some() {
            (1, 1)
        } else {
            let columns = self.columns.unwrap_or(1).clamp(1, panes.max(1));
            (columns as u32, panes.max(1).div_ceil(columns) as u32)
        };
        [columns * (pane[0] + GAP) - GAP + self.legend_width(), rows * (pane[1] + HEADER + GAP) - GAP]
    }

    /// The size of each of `panes` for a whole image of that size.
    pub fn pane_size(&self, panes: usize, whole: [u32; 2]) -> [u32; 2] {
        let [.., width, height] = self.places(panes, whole).first().copied().unwrap_or([0, 0, 16, 16]);
        [width.max(16), height.max(16)]
    }

    /// The rectangles of the panes' images.
    fn places(&self, panes: usize, [width, height]: [u32; 2]) -> Vec<Place> {
        let width = width.saturating_sub(self.legend_width()).max(16);
        if self.wipe.is_some() {
            return vec![[0, HEADER, width, height.saturating_sub(HEADER).max(16)]];
        }
        let chosen = || pane_columns(panes, [width as f32, height as f32], |_| HEADER as f32);
        let columns = self.columns.unwrap_or_else(chosen).clamp(1, panes.max(1)) as u32;
        let rows = (panes.max(1) as u32).div_ceil(columns);
        let each = |length: u32, count: u32| (length + GAP).saturating_sub(count * GAP) / count;
        let (w, h) = (each(width, columns), each(height, rows));
        let place = |pane: u32| {
            let (row, column) = (pane / columns, pane % columns);
            [column * (w + GAP), row * (h + GAP) + HEADER, w.max(16), h.saturating_sub(HEADER).max(16)]
        };
        (0..panes as u32).map(place).collect()
    }

    fn legend(&self) -> Option<Legend> {
        let map = self.view.shows.colors()?;
        let range = map.range_to(self.view.largest);
        Some(Legend { map, range, title: self.view.shows.quantity().to_owned() })
    }

    fn legend_width(&self) -> u32 {
        self.legend().map_or(0, |legend| legend.width() as u32 + 2 * MARGIN)
    }

    /// Composes the panes.
    pub fn compose(&self, panes: &[SheetPane<'_>], whole: [u32; 2]) -> Picture {
        let [width, height] = whole;
        let mut canvas = Canvas::new(width as usize, height as usize, PAGE);
        let places = self.places(panes.len(), whole);
        match (self.wipe, panes, places.first()) {
            (Some((_, split)), [left, right], Some(&place)) => {
                self.wipe(&mut canvas, [left, right], split, place);
            }
            (_, panes, _) => {
                for (pane, &place) in panes.iter().zip(&places) {
                    self.put(&mut canvas, pane, place);
                }
            }
        }
        if let Some(legend) = self.legend() {
            let x = (width - self.legend_width().min(width) + MARGIN) as i32;
            let tall = (height as usize).saturating_sub(2 * MARGIN as usize).min(420);
            legend.draw(&mut canvas, x, MARGIN as i32, tall, INK);
        }
        let (width, height) = (canvas.width() as u32, canvas.height() as u32);
        Picture { width, height, rgba: canvas.into_rgba() }
    }

    /// Draws one pane with its header and figures.
    fn put(&self, canvas: &mut Canvas, pane: &SheetPane<'_>, place: Place) {
        picture(canvas, pane.1, place, 0..place[2]);
        self.header(canvas, pane, [place[0], place[1] - HEADER, place[2]]);
        self.figures(canvas, pane, place, false);
    }

    /// Draws two panes, divided by a line.
    fn wipe(&self, canvas: &mut Canvas, [left, right]: [&SheetPane<'_>; 2], split: f32, place: Place) {
        let [x, y, width, height] = place;
        let at = (split.clamp(0.0, 1.0) * width as f32).round() as u32;
        picture(canvas, left.1, place, 0..at);
        picture(canvas, right.1, place, at..width);
        let half = width / 2;
        self.header(canvas, left, [x, y - HEADER, half]);
        self.header(canvas, right, [x + half, y - HEADER, width - half]);
        canvas.fill((x + at) as i32 - 1, y as i32, 2, height as usize, [255; 3]);
        self.figures(canvas, left, [x, y, half, height], false);
        self.figures(canvas, right, [x + half, y, width - half, height], true);
    }

    /// Draws the cost of a pane, or why it is empty, at the bottom of its rectangle.
    fn figures(
        &self,
        canvas: &mut Canvas,
        (_, pane, ms): &SheetPane<'_>,
        [x, y, width, height]: Place,
        at_right: bool,
    ) {
        let lines = if let Some(problem) = &pane.problem {
            vec![problem.clone()]
        } else {
            let figures = self.figures.then(|| pane.figures_label(*ms));
            [figures, pane.colors_problem.clone()].into_iter().flatten().collect()
        };
        for (text, up) in lines.iter().zip([28, 52]) {
            let text = fitted(text, (width as usize).saturating_sub(32));
            let wide = Canvas::text_width(text);
            if wide == 0 || height < up + 12 {
                return;
            }
            let left = if at_right { (x + width) as i32 - wide as i32 - 16 } else { x as i32 + 16 };
            let top = (y + height - up) as i32;
            canvas.fill(left - 8, top - 3, wide + 16, 22, LINE);
            canvas.text(left, top, text, INK);
        }
    }

    /// Draws the header of a pane.
    fn header(&self, canvas: &mut Canvas, (index, pane, _): &SheetPane<'_>, [x, y, width]: [u32; 3]) {
        let (x, y) = (x as i32, y as i32);
        canvas.fill(x, y, width as usize, HEADER as usize, LINE);
        canvas.fill(x + 8, y + 6, 8, 14, self.colors[index % self.colors.len()]);
        let room = (width as usize).saturating_sub(30);
        let method = fitted(pane.contender.shadow.method.label(), room);
        canvas.text(x + 24, y + 5, method, INK);
        let after = Canvas::text_width(method) + 14;
        let settings = pane.settings_label();
        canvas.text(x + 24 + after as i32, y + 5, fitted(&settings, room.saturating_sub(after)), QUIET);
    }
}

/// Draws the columns `from` of a pane's image, resized to its rectangle.
fn picture(canvas: &mut Canvas, pane: &LivePane, [x, y, width, height]: Place, from: std::ops::Range<u32>) {
    // Without its pixels, for example those of a lost device, the rectangle stays empty.
    let Ok(drawn) = pane.image.picture() else { return };
    let mut drawn = Picture::clone(&drawn);
    resize(&mut drawn, width, height);
    let columns = from.start.min(width)..from.end.min(width);
    if drawn.rgba.is_empty() || (drawn.width, drawn.height) != (width, height) || columns.is_empty() {
        return;
    }
    let bytes = columns.start as usize * 4..columns.end as usize * 4;
    let part: Vec<u8> = drawn
        .rgba
        .chunks_exact(width as usize * 4)
        .flat_map(|row| row[bytes.clone()].iter().copied())
        .collect();
    if let Ok(image) = Image::new(columns.end - columns.start, height, &part) {
        canvas.put((x + columns.start) as i32, y as i32, &image);
    }
}

/// The start of a text that fits into `room` pixels.
fn fitted(text: &str, room: usize) -> &str {
    let letter = Canvas::text_width("0").max(1);
    let mut fitting = text.char_indices().nth(room / letter).map_or(text, |(end, _)| &text[..end]);
    // Letters of other scripts are wider.
    while Canvas::text_width(fitting) > room {
        let Some((end, _)) = fitting.char_indices().next_back() else { break };
        fitting = &fitting[..end];
    }
    fitting
}

/// The number of columns that shows the hair largest in `panes` on a page of that size. Over each pane is a header of the height that
/// `header` says for its width.
///
/// A camera that frames the hair fits it into the shorter side of an image, so a pane is as large as the largest square in it.
pub fn pane_columns(panes: usize, [width, height]: [f32; 2], header: impl Fn(f32) -> f32) -> usize {
    let larger = |columns: usize| {
        let rows = panes.div_ceil(columns);
        let wide = width / columns as f32;
        let high = (height / rows as f32 - header(wide)).max(1.0);
        wide.min(high)
    };
    (1..=panes.max(1)).max_by(|&a, &b| larger(a).total_cmp(&larger(b)).then(b.cmp(&a))).unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use lovelock_metrics::ColorMap;
    use lovelock_project::project::Contender;
    use lovelock_render::{Backend, Camera, Image as Shown};
    use lovelock_session::render_thread::Adapter;

    use super::*;
    use crate::request::{LiveError, LiveTimes};
    use crate::view::LiveShows;

    /// A pane of one colour.
    fn pane(color: [u8; 3], [width, height]: [u32; 2]) -> LivePane {
        let [r, g, b] = color;
        LivePane {
            contender: Contender::default(),
            project: std::sync::Arc::default(),
            asked_size: [width, height],
            image: Shown::Memory(Arc::new(Picture {
                width,
                height,
                rgba: [r, g, b, 255].repeat((width * height) as usize),
            })),
            problem: None,
            colors_problem: None,
            camera: Camera {
                eye: glam::Vec3::ZERO,
                target: glam::Vec3::Z,
                fov_y: 0.5,
                shear: glam::Vec2::ZERO,
            },
            step: 0,
            time_secs: 0.0,
            times: LiveTimes::default(),
            shadow_bytes: 1 << 20,
            shadow_fallbacks: 0,
            draw_bytes: 0,
            adapter: Adapter { name: String::new(), backend: Backend::Cpu, software: true },
            error: LiveError::NotMeasured,
            flip: None,
            shows: LiveShows::Picture,
        }
    }

    fn sheet(wipe: Option<([usize; 2], f32)>) -> Sheet {
        Sheet {
            columns: None,
            wipe,
            view: LiveView::default(),
            figures: true,
            colors: [[9, 9, 9]; CompareSection::MAX_PANES],
        }
    }

    fn at(picture: &Picture, x: u32, y: u32) -> [u8; 3] {
        let first = ((y * picture.width + x) * 4) as usize;
        [picture.rgba[first], picture.rgba[first + 1], picture.rgba[first + 2]]
    }

    const COLORS: [[u8; 3]; CompareSection::MAX_PANES] = [
        [200, 0, 0],
        [0, 200, 0],
        [0, 0, 200],
        [200, 200, 0],
        [0, 200, 200],
        [200, 0, 200],
        [200, 100, 0],
        [100, 200, 0],
        [0, 100, 200],
    ];

    #[test]
    fn each_pane_is_shown_whole_with_a_header() {
        let panes = COLORS.map(|color| pane(color, [200, 120]));
        for count in 1..=COLORS.len() {
            let shown: Vec<SheetPane> = panes[..count].iter().enumerate().map(|(i, p)| (i, p, 1.0)).collect();
            // Also in columns that the size of the whole would not have.
            let sheet = Sheet { columns: Some(count.div_ceil(2)), ..sheet(None) };
            let whole = sheet.size_of(count, [200, 120]);
            let picture = sheet.compose(&shown, whole);
            assert_eq!([picture.width, picture.height], whole);
            let places = sheet.places(count, whole);
            assert_eq!(places.len(), count);
            assert!(places.iter().all(|place| place[2..] == [200, 120]), "{places:?}");
            for (&[x, y, width, height], color) in places.iter().zip(COLORS) {
                assert_eq!(at(&picture, x + 1, y + 1), color, "{count} panes");
                assert_eq!(at(&picture, x + width - 1, y + 1), color);
                assert_eq!(at(&picture, x + width - 1, y + height - 1), color);
                let ink = (x..x + width).any(|x| at(&picture, x, y - 13) == INK);
                assert!(ink, "{count} panes: no word over the pane at {x}, {y}");
            }
        }
    }

    #[test]
    fn panes_have_the_columns_that_show_heads_largest() {
        let header = |width: f32| if width < 420.0 { 48.0 } else { 26.0 };
        // Between two open columns of panels, in the whole window, on a tall page, and where the header of more columns is higher.
        for (page, panes, expected) in [
            ([800.0, 760.0], 6, 3),
            ([1280.0, 720.0], 6, 3),
            ([840.0, 700.0], 2, 2),
            ([840.0, 700.0], 3, 2),
            ([600.0, 1200.0], 6, 2),
            ([300.0, 900.0], 2, 1),
            ([700.0, 520.0], 3, 3),
        ] {
            assert_eq!(pane_columns(panes, page, header), expected, "{panes} panes on {page:?}");
        }
    }

    #[test]
    fn a_wipe_shows_one_pane_left_of_its_line_and_the_other_right_of_it() {
        let (left, right) = (pane(COLORS[0], [200, 120]), pane(COLORS[1], [100, 60]));
        let sheet = sheet(Some(([0, 1], 0.25)));
        let whole = sheet.size_of(2, [200, 120]);
        let picture = sheet.compose(&[(0, &left, 1.0), (1, &right, 1.0)], whole);
        let row = HEADER + 20;
        assert_eq!([at(&picture, 5, row), at(&picture, 45, row)], [COLORS[0]; 2]);
        assert_eq!([at(&picture, 55, row), at(&picture, 195, row)], [COLORS[1]; 2]);
        assert_eq!(at(&picture, 50, row), [255; 3], "the line");
        assert_eq!(sheet.panes(6), [0, 1]);
        assert_eq!(sheet.panes(1), [0]);
    }

    #[test]
    fn colours_come_with_their_scale_beside_the_panes() {
        let drawn = pane(COLORS[2], [200, 200]);
        let mut colored = sheet(None);
        colored.view.shows = LiveShows::PictureError;
        let whole = colored.size_of(1, [200, 200]);
        assert!(whole[0] > sheet(None).size_of(1, [200, 200])[0]);
        let picture = colored.compose(&[(0, &drawn, 1.0)], whole);
        let beside = |picture: &Picture, color: [u8; 3]| {
            (210..picture.width).any(|x| (0..picture.height).any(|y| at(picture, x, y) == color))
        };
        let brightest = ColorMap::Magma.at(0.9975);
        let near = |a: [u8; 3], b: [u8; 3]| a.iter().zip(b).all(|(&a, b)| a.abs_diff(b) < 12);
        let found =
            (210..picture.width).any(|x| (0..picture.height).any(|y| near(at(&picture, x, y), brightest)));
        assert!(found && beside(&picture, INK));
        // Without false colours no space is reserved for the scale.
        let plain = sheet(None).compose(&[(0, &drawn, 1.0)], whole);
        assert!(!beside(&plain, ColorMap::Magma.at(0.5)));
    }

    #[test]
    fn any_size_can_be_composed() {
        let drawn = pane(COLORS[0], [64, 48]);
        let broken = LivePane {
            problem: Some("It needs 9 GiB; the limit is 1 GiB.".to_owned()),
            image: Shown::default(),
            ..drawn.clone()
        };
        let shown = [(0, &drawn, 1.0), (1, &broken, 2.0), (2, &drawn, 3.0)];
        for whole in [[16, 16], [64, 17], [1, 900], [1920, 1080]] {
            for wipe in [None, Some(([0, 1], f32::NAN)), Some(([2, 2], 9.0))] {
                let picture = sheet(wipe).compose(&shown[..wipe.map_or(3, |_| 2)], whole);
                assert_eq!([picture.width, picture.height], whole);
                assert_eq!(picture.rgba.len() as u32, 4 * whole[0] * whole[1]);
            }
        }
        let [width, height] = sheet(None).pane_size(6, [3, 3]);
        assert!(width >= 16 && height >= 16);
    }
}
