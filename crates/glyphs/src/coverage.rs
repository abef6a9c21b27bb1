//! Outlines as coverage of pixels: exact areas of the outline in each pixel, summed along rows (as in the rasteriser of font-rs, Levien
//! 2016).

use skrifa::outline::OutlinePen;

/// Pieces into which a curve is divided.
const PIECES: u16 = 8;

/// The largest width and height of a glyph, pixels.
const MAX: usize = 1024;

/// The lines of an outline, in pixels, y downward.
#[derive(Default)]
pub(crate) struct Outline {
    lines: Vec<[[f32; 2]; 2]>,
    first: [f32; 2],
    last: [f32; 2],
}

impl Outline {
    fn line(&mut self, to: [f32; 2]) {
        if to != self.last {
            self.lines.push([self.last, to]);
            self.last = to;
        }
    }

    /// The smallest and largest corner; `None` without a line, or if the outline is too large to draw.
    fn bounds(&self) -> Option<[[f32; 2]; 2]> {
        let mut bounds: Option<[[f32; 2]; 2]> = None;
        for point in self.lines.iter().flatten() {
            if !(point[0].is_finite() && point[1].is_finite()) {
                return None;
            }
            let [low, high] = bounds.get_or_insert([*point, *point]);
            *low = [0, 1].map(|axis| low[axis].min(point[axis]));
            *high = [0, 1].map(|axis| high[axis].max(point[axis]));
        }
        bounds.filter(|[low, high]| (0..2).all(|axis| high[axis] - low[axis] < MAX as f32))
    }

    /// The coverage of the pixels in the outline's box, with the left and upper edge of the box; `None` if it covers nothing.
    pub(crate) fn coverage(&self) -> Option<Coverage> {
        let [low, high] = self.bounds()?;
        let [left, top] = low.map(f32::floor);
        let width = (high[0].ceil() - left) as usize + 1;
        let height = (high[1].ceil() - top) as usize;
        if height == 0 {
            return None;
        }
        let mut area = vec![0.0; (width + 2) * height];
        for [from, to] in &self.lines {
            let at = |point: &[f32; 2]| [point[0] - left, point[1] - top];
            accumulate(&mut area, width + 2, height, at(from), at(to));
        }
        let mut alpha = Vec::with_capacity(width * height);
        for row in area.chunks_exact(width + 2) {
            let mut sum = 0.0_f32;
            for step in &row[..width] {
                sum += step;
                alpha.push((sum.abs().min(1.0) * 255.0).round() as u8);
            }
        }
        Some(Coverage { left: left as i32, top: top as i32, width, height, alpha })
    }
}

/// Pixels of an outline.
pub(crate) struct Coverage {
    pub(crate) left: i32,
    pub(crate) top: i32,
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Opacity, rows from the top.
    pub(crate) alpha: Vec<u8>,
}

/// Adds the signed area that one line changes in each row, so that sums along rows are coverage.
fn accumulate(area: &mut [f32], stride: usize, height: usize, from: [f32; 2], to: [f32; 2]) {
    if from[1] == to[1] {
        return;
    }
    let (sign, [x0, y0], [x1, y1]) = if from[1] < to[1] { (1.0, from, to) } else { (-1.0, to, from) };
    let slope = (x1 - x0) / (y1 - y0);
    let mut x = x0;
    for y in y0.floor() as usize..(y1.ceil() as usize).min(height) {
        let rows = (y1.min((y + 1) as f32) - y0.max(y as f32)).max(0.0);
        let next = x + slope * rows;
        let (low, high) = if x < next { (x, next) } else { (next, x) };
        let is_upright = high - low < 1e-6;
        let high = if is_upright { low } else { high };
        let first = low.floor().max(0.0);
        let cells = (high.ceil() - first).max(1.0) as usize;
        let row = &mut area[y * stride..(y + 1) * stride];
        let signed = rows * sign;
        // The area right of the line within each cell is what the cell gains; the rest goes to the next.
        let span = (high - low).max(1e-6);
        let mut before = 0.0;
        for cell in 0..cells {
            let at = first as usize + cell;
            let edge = first + cell as f32;
            // The share of the line's height whose x is left of the right edge of the cell, and its mean place there.
            let (start, end) = (low.max(edge), high.min(edge + 1.0));
            let share = if is_upright { 1.0 } else { ((end - start) / span).max(0.0) };
            let middle = 0.5 * (start + end) - edge;
            let gained = signed * share * (1.0 - middle);
            let Some(slot) = row.get_mut(at) else { break };
            *slot += gained + before;
            before = signed * share - gained;
        }
        if let Some(slot) = row.get_mut(first as usize + cells) {
            *slot += before;
        }
        x = next;
    }
}

impl OutlinePen for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        self.close();
        (self.first, self.last) = ([x, -y], [x, -y]);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.line([x, -y]);
    }

    fn quad_to(&mut self, cx0: f32, cy0: f32, x: f32, y: f32) {
        let (from, by, to) = (self.last, [cx0, -cy0], [x, -y]);
        for piece in 1..=PIECES {
            let t = f32::from(piece) / f32::from(PIECES);
            let u = 1.0 - t;
            self.line([0, 1].map(|k| u * u * from[k] + 2.0 * u * t * by[k] + t * t * to[k]));
        }
    }

    fn curve_to(&mut self, cx0: f32, cy0: f32, cx1: f32, cy1: f32, x: f32, y: f32) {
        let (from, a, b, to) = (self.last, [cx0, -cy0], [cx1, -cy1], [x, -y]);
        for piece in 1..=PIECES {
            let t = f32::from(piece) / f32::from(PIECES);
            let u = 1.0 - t;
            self.line([0, 1].map(|k| {
                u * u * u * from[k] + 3.0 * u * u * t * a[k] + 3.0 * u * t * t * b[k] + t * t * t * to[k]
            }));
        }
    }

    fn close(&mut self) {
        self.line(self.first);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon(points: &[[f32; 2]]) -> Outline {
        let mut outline = Outline::default();
        outline.move_to(points[0][0], points[0][1]);
        for point in &points[1..] {
            outline.line_to(point[0], point[1]);
        }
        outline.close();
        outline
    }

    fn area(coverage: &Coverage) -> f32 {
        coverage.alpha.iter().map(|alpha| f32::from(*alpha) / 255.0).sum()
    }

    #[test]
    fn a_rectangle_covers_its_area() {
        let found = polygon(&[[1.25, 0.0], [4.5, 0.0], [4.5, 2.5], [1.25, 2.5]]).coverage().expect("covers");
        assert_eq!((found.left, found.top), (1, -3));
        // Three quarters of the first column, the upper row half.
        assert_eq!(found.alpha[found.width], 191);
        assert_eq!(found.alpha[found.width + 1], 255);
        assert_eq!(found.alpha[1], 128);
        assert!((area(&found) - 3.25 * 2.5).abs() < 0.05, "{}", area(&found));
    }

    #[test]
    fn a_triangle_and_a_hole_cover_their_area_whatever_the_direction() {
        let triangle = polygon(&[[0.3, 0.2], [7.9, 1.4], [3.1, 6.8]]);
        let wanted = 0.5 * ((7.9 - 0.3) * (6.8 - 0.2) - (3.1 - 0.3) * (1.4 - 0.2));
        let found = triangle.coverage().expect("covers");
        assert!((area(&found) - wanted as f32).abs() < 0.1, "{} {wanted}", area(&found));
        let mut ring = polygon(&[[0.0, 0.0], [8.0, 0.0], [8.0, 8.0], [0.0, 8.0]]);
        for (at, point) in [[2.0, 2.0], [2.0, 6.0], [6.0, 6.0], [6.0, 2.0]].into_iter().enumerate() {
            if at == 0 { ring.move_to(point[0], point[1]) } else { ring.line_to(point[0], point[1]) }
        }
        ring.close();
        assert!((area(&ring.coverage().expect("covers")) - 48.0).abs() < 0.05);
    }

    #[test]
    fn an_outline_without_area_or_bounds_covers_nothing() {
        assert!(Outline::default().coverage().is_none());
        assert!(polygon(&[[0.0, 0.0], [f32::NAN, 1.0], [3.0, 3.0]]).coverage().is_none());
        assert!(polygon(&[[0.0, 0.0], [1e9, 1.0], [3.0, 3.0]]).coverage().is_none());
    }
}
