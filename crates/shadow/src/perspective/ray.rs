//! Pieces of projected strands along rays of the light: the twin of `ray.wgsl`.

use glam::{Vec3, Vec4, Vec4Swizzles};

use super::MAX_WIDENING;
use crate::ProjectedStrands;

/// A straight piece of strand, projected onto a plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray {
    /// Its ends: the distance from the light less that of the anchor, the place on the plane, and the factor on the width.
    ends: [Vec4; 2],
    plane: f32,
    start: f32,
    /// Whether it is so short that the distance is linear on the plane, too.
    is_short: bool,
}

impl Ray {
    /// The piece between the points `first` and `first + 1`.
    pub fn new(projected: &ProjectedStrands, [from, to]: [Vec3; 2], first: usize) -> Self {
        let ends = [from.extend(projected.widths[first]), to.extend(projected.widths[first + 1])];
        let is_short = 16.0 * from.distance(to) < from.x + projected.start;
        Self { ends, plane: projected.plane, start: projected.start, is_short }
    }

    /// The distance from the light less that of the anchor, and the factor on the width, at the fraction `t` on the plane.
    ///
    /// There the factor is linear, and the distance is not. Of a piece that is shorter than a sixteenth of its distance from the light it
    /// differs by less than a two-thousandth of that from a line.
    #[inline]
    pub fn at(&self, t: f32) -> [f32; 2] {
        let [a, b] = self.ends;
        let middle = a + (b - a) * t;
        let on_plane = |p: Vec4| (self.plane * self.plane + p.yz().length_squared()).sqrt();
        let distance = if self.is_short {
            middle.x
        } else {
            (a.x + self.start) * (a.w / middle.w) * (on_plane(middle) / on_plane(a)) - self.start
        };
        [distance, middle.w.min(MAX_WIDENING)]
    }

    /// The largest factor on the width.
    pub fn widest(&self) -> f32 {
        self.ends[0].w.max(self.ends[1].w).min(MAX_WIDENING)
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3Swizzles;

    use super::*;
    use crate::perspective::{Face, Perspective};
    use crate::{Bounds, LightFrame, LightSource};

    #[test]
    fn the_distance_along_a_long_piece_is_that_of_its_points() {
        let source = LightSource { position: Vec3::ZERO, radius: 0.001 };
        let frame = LightFrame::new(Vec3::X).standing(source, Vec3::X);
        let bounds = Bounds { min: Vec3::splat(-0.5), max: Vec3::splat(0.5), ignored: 0 };
        let seen = Perspective::new(&frame, Vec3::X, &bounds, 0.05).expect("it stands somewhere");
        let face: Face = seen.faces()[0].expect("it sees hair");
        for (a, b) in [
            (Vec3::new(0.6, -0.3, 0.1), Vec3::new(1.3, 0.4, -0.2)),
            (Vec3::new(0.5, 0.2, 0.0), Vec3::new(0.9, 0.2, 0.01)),
            (Vec3::new(1.0, 0.1, 0.1), Vec3::new(1.0, 0.11, 0.1)),
        ] {
            let [placed_a, placed_b] = [a, b].map(|p| face.project(p));
            let widths = [a, b].map(|p| face.widening(face.seen(a), face.seen(b), face.seen(p)));
            let projected = ProjectedStrands {
                widths: &widths,
                bounds: face.bounds,
                longest_strand: 1.0,
                plane: face.plane,
                start: face.offset.length(),
            };
            let ray = Ray::new(&projected, [placed_a, placed_b], 0);
            let whole = placed_b.yz() - placed_a.yz();
            for i in 0..=20 {
                let p = a.lerp(b, i as f32 / 20.0);
                let placed = face.project(p);
                let t = (placed.yz() - placed_a.yz()).dot(whole) / whole.length_squared();
                let [distance, width] = ray.at(t);
                assert!((distance - placed.x).abs() < 3e-5, "{p}: {distance} for {}", placed.x);
                let wanted = face.widening(face.seen(a), face.seen(b), face.seen(p));
                assert!((width - wanted).abs() < 1e-4 * wanted, "{p}: {width} for {wanted}");
            }
        }
    }
}
