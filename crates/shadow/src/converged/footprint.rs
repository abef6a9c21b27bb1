//! The box of one texel around a point, in subtexels.

use std::ops::Range;

use glam::Vec3;

/// The subtexels that a box covers along one axis, and the covered fractions of the first and the last.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Span {
    start: f64,
    end: f64,
}

impl Span {
    /// The subtexels within `of` that it touches, each with its covered fraction.
    fn parts(self, of: &Range<u32>) -> impl Iterator<Item = (u32, f64)> {
        let first = self.start.max(f64::from(of.start)).floor() as u32;
        let end = self.end.min(f64::from(of.end)).ceil().max(0.0) as u32;
        (first.max(of.start)..end).map(move |at| {
            let at_f = f64::from(at);
            (at, (self.end.min(at_f + 1.0) - self.start.max(at_f)).max(0.0))
        })
    }
}

/// A box of one texel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Footprint {
    columns: Span,
    rows: Span,
}

impl Footprint {
    /// The box around a point in texel coordinates, with `samples` subtexels along an edge; `None` for NaN and for points before
    /// all hair.
    pub(super) fn new(place: Vec3, samples: u32) -> Option<Self> {
        if !place.is_finite() || place.z <= 0.0 {
            return None;
        }
        let samples = f64::from(samples);
        let span =
            |c: f32| Span { start: (f64::from(c) - 0.5) * samples, end: (f64::from(c) + 0.5) * samples };
        Some(Self { columns: span(place.x), rows: span(place.y) })
    }

    /// The light lost in the box within the rows `rows` of `columns` subtexels: the sum over subtexels of the covered fraction times
    /// 1 minus `light` of column and row.
    pub(super) fn lost(&self, rows: &Range<u32>, columns: u32, light: impl Fn(u32, u32) -> f32) -> f64 {
        let mut lost = 0.0;
        for (row, high) in self.rows.parts(rows) {
            for (column, wide) in self.columns.parts(&(0..columns)) {
                lost += high * wide * (1.0 - f64::from(light(column, row)));
            }
        }
        lost
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_covers_its_area_wherever_it_lies() {
        for (x, y) in [(5.0, 5.0), (5.5, 7.25), (3.3, 9.9)] {
            for samples in [1, 2, 8] {
                let footprint = Footprint::new(Vec3::new(x, y, 0.5), samples).expect("finite");
                let edge = 16 * samples;
                let whole = footprint.lost(&(0..edge), edge, |_, _| 0.0);
                assert!((whole - f64::from(samples * samples)).abs() < 1e-9);
                // The sum over strips is the same.
                let strips: f64 =
                    (0..edge).map(|row| footprint.lost(&(row..row + 1), edge, |_, _| 0.0)).sum();
                assert!((strips - whole).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn what_lies_outside_is_lit() {
        let corner = Footprint::new(Vec3::new(0.0, 0.0, 0.5), 4).expect("finite");
        assert!((corner.lost(&(0..64), 64, |_, _| 0.0) - 4.0).abs() < 1e-9);
        for p in [Vec3::new(-1e9, 3.0, 0.5), Vec3::new(3.0, 1e9, 0.5), Vec3::new(-0.5, 3.0, 0.5)] {
            assert_eq!(Footprint::new(p, 4).expect("finite").lost(&(0..64), 64, |_, _| 0.0), 0.0, "{p}");
        }
        assert_eq!(Footprint::new(Vec3::new(3.0, 3.0, f32::NAN), 4), None);
    }
}
