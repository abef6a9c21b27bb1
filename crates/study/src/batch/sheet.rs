//! Frames of a film of panes, with the error of every frame as a curve below.

use lovelock_metrics::{Canvas, Image, Legend, ticks};
use lovelock_panes::sheet::Sheet as Colors;
use lovelock_render::Picture;

/// The most pixels of a film along each edge.
const LARGEST: [u32; 2] = [1920, 1080];
/// Height of the name over a pane, pixels.
const HEADER: u32 = 24;
/// Height of the curves with their numbers, pixels.
const CURVES: u32 = 200;
/// Pixels left of the curves, for numbers, and at the other sides.
const LEFT: u32 = 72;
/// See [`LEFT`].
const MARGIN: u32 = 20;
/// Width at the right, for the scale of colours.
const SCALE: u32 = 120;
/// Pixels between panes.
const GAP: u32 = 4;

const PAGE: [u8; 3] = [19, 20, 23];
const LINE: [u8; 3] = [44, 47, 53];
const QUIET: [u8; 3] = [150, 155, 163];
const INK: [u8; 3] = [236, 238, 242];

/// A pane: a method and its error in every frame.
#[derive(Clone, Debug)]
pub(super) struct Pane {
    pub name: String,
    pub errors: Vec<f64>,
}

/// Panes with curves below.
#[derive(Clone, Debug)]
pub(super) struct Sheet {
    panes: Vec<Pane>,
    /// Size of a pane's image, pixels.
    pane: [u32; 2],
    columns: u32,
    first_frame: u64,
}

impl Sheet {
    /// For images of the shape of `size`, which become smaller where they do not fit.
    pub(super) fn new(panes: Vec<Pane>, [width, height]: [u32; 2], first_frame: u64) -> Self {
        let count = panes.len().max(1) as u32;
        let columns = (1..=count).find(|columns| columns * columns >= count).unwrap_or(1);
        let rows = count.div_ceil(columns);
        let room = [
            (LARGEST[0] - SCALE) / columns - GAP,
            ((LARGEST[1] - CURVES) / rows).saturating_sub(HEADER + GAP),
        ];
        let fits = |edge: u32, room: u32| f64::from(room) / f64::from(edge.max(1));
        let scale = fits(width, room[0]).min(fits(height, room[1])).min(1.0);
        let pane = [width, height].map(|edge| ((f64::from(edge) * scale) as u32).max(16));
        Self { panes, pane, columns, first_frame }
    }

    /// The size of a pane's image, pixels.
    pub(super) fn pane(&self) -> [u32; 2] {
        self.pane
    }

    /// The size of a frame, pixels: even, as films want it.
    pub(super) fn size(&self) -> [u32; 2] {
        let rows = (self.panes.len().max(1) as u32).div_ceil(self.columns);
        let width = self.columns * (self.pane[0] + GAP) + SCALE;
        let height = rows * (self.pane[1] + HEADER + GAP) + CURVES;
        // Room for the numbers of the curves beside a small pane.
        [width.max(480), height].map(|edge| edge.next_multiple_of(2))
    }

    /// Composes the panes of frame number `frame`, from 0.
    pub(super) fn compose(&self, frame: usize, pictures: &[Picture], scale: Option<&Legend>) -> Canvas {
        let [width, height] = self.size();
        let mut canvas = Canvas::new(width as usize, height as usize, PAGE);
        for (at, (pane, picture)) in self.panes.iter().zip(pictures).enumerate() {
            let (row, column) = (at as u32 / self.columns, at as u32 % self.columns);
            let x = (column * (self.pane[0] + GAP)) as i32;
            let y = (row * (self.pane[1] + HEADER + GAP)) as i32;
            canvas.fill(x + 6, y + 4, 8, 16, color(at));
            let letters = (self.pane[0] as usize).saturating_sub(26) / Canvas::text_width("0").max(1);
            let now = pane.errors.get(frame).map_or(String::new(), |error| format!("  {error:.4}"));
            let name: String = pane.name.chars().take(letters.saturating_sub(now.len())).collect();
            canvas.text(x + 20, y + 4, &(name + &now), INK);
            if let Ok(image) = Image::new(picture.width, picture.height, &picture.rgba) {
                canvas.put(x, y + HEADER as i32, &image);
            }
        }
        if let Some(scale) = scale {
            let tall = (height - CURVES).saturating_sub(2 * MARGIN).min(400) as usize;
            scale.draw(&mut canvas, (width - SCALE + 12) as i32, MARGIN as i32, tall, INK);
        }
        self.curves(&mut canvas, frame);
        canvas
    }

    /// Draws the errors of all frames, and a line at the one that is shown.
    fn curves(&self, canvas: &mut Canvas, frame: usize) {
        let [width, height] = self.size();
        let (left, right) = (LEFT as i32, (width - MARGIN) as i32);
        let (top, bottom) = ((height - CURVES + MARGIN) as i32, (height - 2 * MARGIN) as i32);
        let frames = self.panes.iter().map(|pane| pane.errors.len()).max().unwrap_or(0);
        let largest = self.panes.iter().flat_map(|pane| &pane.errors).fold(1e-6_f64, |most, e| most.max(*e));
        let x = |at: f64| left + ((at / (frames.max(2) - 1) as f64) * f64::from(right - left)) as i32;
        let y = |error: f64| bottom - ((error / largest).clamp(0.0, 1.0) * f64::from(bottom - top)) as i32;
        let marks = ticks(0.0, largest, 4);
        for &value in &marks.values {
            canvas.fill(left, y(value), (right - left) as usize, 1, LINE);
            let word = marks.label(value);
            canvas.text(left - Canvas::text_width(&word) as i32 - 6, y(value) - 8, &word, QUIET);
        }
        canvas.text(left, top - 18, "RMSE of transmittance in each frame", QUIET);
        canvas.fill(x(frame as f64), top, 1, (bottom - top) as usize, INK);
        let number = format!("frame {}", self.first_frame + frame as u64);
        let wide = Canvas::text_width(&number) as i32;
        canvas.text((x(frame as f64) - wide / 2).clamp(left, right - wide), bottom + 8, &number, INK);
        for (at, pane) in self.panes.iter().enumerate() {
            for (i, pair) in pane.errors.windows(2).enumerate() {
                let (from, to) = (x(i as f64), x(i as f64 + 1.0));
                for column in from..=to {
                    let share = f64::from(column - from) / f64::from((to - from).max(1));
                    let next = f64::from(column + 1 - from) / f64::from((to - from).max(1));
                    let at_share = |share: f64| y(pair[0] + (pair[1] - pair[0]) * share.min(1.0));
                    let (a, b) = (at_share(share), at_share(next));
                    canvas.fill(column, a.min(b), 2, (a - b).unsigned_abs() as usize + 2, color(at));
                }
            }
        }
    }
}

/// The colour of a pane's curve.
fn color(pane: usize) -> [u8; 3] {
    Colors::COLORS[pane % Colors::COLORS.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sheet(count: usize, errors: &[f64]) -> Sheet {
        let pane = |at: usize| Pane { name: format!("method {at}"), errors: errors.to_vec() };
        Sheet::new((0..count).map(pane).collect(), [1280, 720], 40)
    }

    #[test]
    fn one_to_nine_panes_fit_into_a_film() {
        for count in 1..=9 {
            let sheet = sheet(count, &[0.1, 0.2]);
            let [width, height] = sheet.size();
            assert!(width <= LARGEST[0] && height <= LARGEST[1] && width % 2 == 0 && height % 2 == 0);
            let [w, h] = sheet.pane();
            assert!((f64::from(w) / f64::from(h) - 16.0 / 9.0).abs() < 0.02, "{count}: {w} × {h}");
            let red = Picture { width: w, height: h, rgba: [200, 0, 0, 255].repeat((w * h) as usize) };
            let drawn = sheet.compose(0, &vec![red; count], None);
            let reds = drawn.rgba().chunks_exact(4).filter(|pixel| pixel[..3] == [200, 0, 0]).count();
            assert_eq!(reds, count * (w * h) as usize, "{count}: panes overlap or are cut");
        }
    }

    #[test]
    fn curves_rise_with_errors_and_a_line_marks_the_frame() {
        let sheet = sheet(1, &[0.0, 0.0, 0.4]);
        let drawn = sheet.compose(0, &[], None);
        let [width, height] = sheet.size().map(|edge| edge as usize);
        let at = |x: usize, y: usize| &drawn.rgba()[(y * width + x) * 4..][..3];
        let height_of = |x: usize| (height - CURVES as usize..height).find(|y| *at(x, *y) == color(0)[..]);
        let (flat, steep) = (height_of(width / 4).expect("a curve"), height_of(width - 40).expect("a curve"));
        assert!(steep + 80 < flat, "{steep} is above {flat}");
        let middle = height - CURVES as usize / 2;
        assert_eq!(*at(LEFT as usize, middle), INK[..]);
        let last = sheet.compose(2, &[], None);
        assert_ne!(last.rgba(), drawn.rgba());
    }

    #[test]
    fn no_frames_and_no_panes_are_drawn_empty() {
        for sheet in [sheet(0, &[]), sheet(2, &[]), sheet(1, &[0.1])] {
            let [width, height] = sheet.size();
            assert_eq!(sheet.compose(7, &[], None).rgba().len(), (width * height * 4) as usize);
        }
    }
}
