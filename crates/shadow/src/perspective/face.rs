//! The planes onto which hair is projected.

use glam::{Mat4, Vec3, Vec3Swizzles, Vec4};

use super::STEEPEST;
use super::cube::{SIDES, side_of, turned};
use crate::LightFrame;
use crate::bounds::{Bounds, round_up_to_step};

/// The cosine of the largest angle between a ray and the middle of its plane is larger than this: that of the corner of a cube is 0.577.
const LEAST_COSINE: f32 = 0.5;

/// Hair seen from a light that stands somewhere.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Perspective {
    /// One plane, or the sides of a cube; `None` for a side without hair.
    faces: Vec<Option<Face>>,
    /// The axes of the light in the world, a point near the hair, and that point seen from the light along the axes.
    pub axes: [Vec3; 3],
    pub anchor: Vec3,
    pub offset: Vec3,
}

/// One plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Face {
    /// Unit axes in the world: from the light to the middle of the plane, and two along the plane.
    pub axes: [Vec3; 3],
    /// The point from which positions are measured, world space: near the hair, so that a far light does not cost digits.
    pub anchor: Vec3,
    /// That point, seen from the light, along the axes.
    pub offset: Vec3,
    /// Distance of the plane, metres.
    pub plane: f32,
    /// Hair nearer along the middle axis than this is cut off, metres.
    pub nearest: f32,
    /// Hair within this distance from the light casts no shadow, metres.
    pub radius: f32,
    /// The largest tangents of the hair on the plane.
    pub slope: f32,
    /// The projected hair.
    pub bounds: Bounds,
}

impl Perspective {
    /// The planes for the light `frame` and hair within `bounds` along its axes around `anchor`; `None` for a directional light.
    /// `margin` is how far a side of a cube reaches into its neighbours, as a tangent.
    pub fn new(frame: &LightFrame, anchor: Vec3, bounds: &Bounds, margin: f32) -> Option<Self> {
        let source = frame.source?;
        let axes = [frame.x, frame.y, frame.z];
        let offset = frame.light_from_world(anchor - source.position);
        let radius = source.safe_radius();
        let mut faces = Vec::new();
        let (low, high) = (bounds.min + offset, bounds.max + offset);
        let nearest = LEAST_COSINE * radius;
        let face = |side: usize, plane: f32, slope: f32| {
            let along = |v: Vec3| Vec3::from(turned(v.to_array(), side));
            Face {
                axes: turned(axes, side),
                anchor,
                offset: along(offset),
                plane,
                nearest,
                radius,
                slope,
                bounds: Bounds { ignored: bounds.ignored, ..Bounds::EMPTY },
            }
        };
        let sees = |face: Face, side: usize| {
            let (a, b) =
                (Vec3::from(turned(low.to_array(), side)), Vec3::from(turned(high.to_array(), side)));
            face.seeing(a.min(b), a.max(b))
        };
        let before = face(0, round_up_to_step(offset.length().max(radius)), STEEPEST);
        let is_some = bounds.min.x <= bounds.max.x;
        let steepest = [low, high].map(|v| (v / low.x.max(f32::MIN_POSITIVE)).yz().abs());
        if is_some && low.x > nearest && steepest[0].max(steepest[1]).length() <= STEEPEST {
            faces.push(sees(before, 0));
        } else if is_some {
            let farthest = low.abs().max(high.abs()).length();
            let plane = round_up_to_step((0.5 * farthest).max(radius));
            faces.extend((0..SIDES).map(|side| sees(face(side, plane, 1.0 + margin), side)));
        }
        if faces.iter().all(Option::is_none) {
            // Without hair everything is lit.
            faces = vec![Some(before)];
        }
        Some(Self { faces, axes, anchor, offset })
    }

    /// The planes: one, or one per side of a cube.
    pub fn faces(&self) -> &[Option<Face>] {
        &self.faces
    }

    /// The plane of a point in the world.
    pub fn face_of(&self, p: Vec3) -> usize {
        if self.faces.len() == 1 {
            return 0;
        }
        let d = p - self.anchor;
        side_of(self.offset + Vec3::from(self.axes.map(|axis| axis.dot(d))))
    }
}

/// The margin of a side of a cube of which a map divides each edge into at least `edge` texels: one and a half of them, which filters
/// read beyond the edge, where sizes are rounded up by at most a sixteenth of an octave.
pub(crate) fn margin(edge: u32) -> f32 {
    let edge = edge.max(12) as f32;
    3.2 / (edge - 6.2)
}

impl Face {
    /// This plane with the bounds of hair from `low` to `high`, along its axes from the light; `None` if it sees none.
    fn seeing(self, low: Vec3, high: Vec3) -> Option<Self> {
        let (near, far) = (low.x.max(self.nearest), high.x);
        let is_before = near <= far;
        if !is_before {
            return None;
        }
        let least =
            |low: f32| (if low < 0.0 { low / near } else { low / far }).clamp(-self.slope, self.slope);
        let most = |high: f32| -least(-high);
        let (from, to) =
            (Vec3::new(0.0, least(low.y), least(low.z)), Vec3::new(0.0, most(high.y), most(high.z)));
        let is_within = from.yz().max_element() < self.slope && to.yz().min_element() > -self.slope;
        if !is_within {
            return None;
        }
        let start = self.offset.length();
        // Rounding must not put hair before the first depth.
        let rounding = 4e-7 * (start + high.abs().max(low.abs()).max_element());
        let gap = |low: f32, high: f32| low.max(-high).max(0.0);
        let closest = Vec3::new(near, gap(low.y, high.y), gap(low.z, high.z)).length();
        let widest = |low: f32, high: f32| low.abs().max(high.abs()).min(self.slope * far);
        let farthest = Vec3::new(far, widest(low.y, high.y), widest(low.z, high.z)).length();
        let first = Vec3::new(closest.max(self.radius) - start - rounding, 0.0, 0.0);
        let last = Vec3::new(farthest.max(self.radius) - start + rounding, 0.0, 0.0);
        let (min, max) = (self.plane * from + first, self.plane * to + last);
        let bounds = Bounds { min, max, ..self.bounds };
        Some(Self { bounds, ..self })
    }

    /// A point of the world along the axes, from the light.
    #[inline]
    pub fn seen(&self, p: Vec3) -> Vec3 {
        self.offset + self.along(p - self.anchor)
    }

    #[inline]
    fn along(&self, d: Vec3) -> Vec3 {
        Vec3::from(self.axes.map(|axis| axis.dot(d)))
    }

    /// The projection of a point of the world: its distance from the light less that of the anchor, and its place on the plane,
    /// metres. NaN behind the light, where everything is lit.
    #[inline]
    pub fn project(&self, p: Vec3) -> Vec3 {
        let d = self.along(p - self.anchor);
        let q = self.offset + d;
        let (distance, start) = (q.length(), self.offset.length());
        // The difference of the distances, without losing digits where both are large.
        let sum = distance + start;
        let depth = if sum > 0.0 { d.dot(q + self.offset) / sum } else { 0.0 };
        let scale = if q.x > 0.0 { self.plane / q.x } else { f32::NAN };
        Vec3::new(depth, q.y * scale, q.z * scale)
    }

    /// The factor on the width of a straight piece of strand between two points, at the place `at` on it; all are seen from the light
    /// along the axes.
    ///
    /// Width and length of a piece both grow on the plane as it is nearer. The texel that it covers is larger off the middle of the
    /// plane, and so is the width of a ribbon that faces the light: together by `√(1 + h²)`, where h is the tangent at which the line
    /// of the piece passes the middle.
    #[inline]
    pub fn widening(&self, from: Vec3, to: Vec3, at: Vec3) -> f32 {
        let (a, b) = (from.yz() / from.x, to.yz() / to.x);
        let length = a.distance(b);
        let h = if length > 0.0 { a.perp_dot(b) / length } else { 0.0 };
        self.plane * (1.0 + h * h).sqrt() / at.x
    }

    /// The factor on the optical depth of a point: the cell around it is smaller as it is nearer.
    #[inline]
    pub fn narrowing(&self, q: Vec3) -> f32 {
        let t = q.yz() / q.x;
        let nearer = self.plane / q.x;
        nearer * nearer * (1.0 + t.length_squared()).sqrt()
    }

    /// Whether a point, seen from the light along the axes, is before the plane's hair.
    #[inline]
    pub fn sees(&self, q: Vec3) -> bool {
        q.x >= self.nearest && q.yz().abs().max_element() <= self.slope * q.x
    }

    /// The part of a segment, as fractions of its length, that the plane sees; `None` if it sees nothing of it or if an end is not
    /// finite.
    pub fn clip(&self, from: Vec3, to: Vec3) -> Option<(f32, f32)> {
        let (mut first, mut last) = (0.0_f32, 1.0_f32);
        let mut keep = |a: f32, b: f32| {
            // Where the distance to a bounding plane, a at the start and b at the end, is not negative. False for NaN.
            let at = a / (a - b);
            match (a >= 0.0, b >= 0.0) {
                (true, true) => {}
                (true, false) => last = last.min(at),
                (false, true) => first = first.max(at),
                (false, false) => last = -1.0,
            }
        };
        keep(from.x - self.nearest, to.x - self.nearest);
        for axis in 1..3 {
            let (a, b) = (self.slope * from.x, self.slope * to.x);
            keep(a - from[axis], b - to[axis]);
            keep(a + from[axis], b + to[axis]);
        }
        (first < last && (to - from).is_finite()).then_some((first, last))
    }

    /// The matrix of a [`ColumnMap`](crate::ColumnMap) of the world, given that of the projected hair.
    pub fn uv_from_world(&self, uv_from_projected: Mat4) -> Mat4 {
        let row = |axis: usize, scale: f32| {
            let axis_per = self.axes[axis] * scale;
            axis_per.extend(self.offset[axis] * scale - axis_per.dot(self.anchor))
        };
        // Homogeneous: the places on the plane times the distance along the middle, which is the fourth coordinate.
        // The distance from the light is no projection; nothing reads it.
        let projected_from_world =
            Mat4::from_cols(Vec4::ZERO, row(1, self.plane), row(2, self.plane), row(0, 1.0)).transpose();
        uv_from_projected * projected_from_world
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LightSource;

    /// The planes for a box of hair of half size `half` around `middle`, in light from `position`.
    fn around(position: Vec3, middle: Vec3, half: f32) -> Perspective {
        let frame = LightFrame::new(Vec3::new(0.2, -1.0, 0.4))
            .standing(LightSource { position, radius: 0.01 }, middle);
        // A box along the axes of the light.
        let bounds = Bounds { min: Vec3::splat(-half), max: Vec3::splat(half), ignored: 0 };
        Perspective::new(&frame, middle, &bounds, 0.05).expect("it stands somewhere")
    }

    fn directions(count: usize) -> impl Iterator<Item = Vec3> {
        (0..count).map(move |i| {
            let (z, a) = (1.0 - (2 * i + 1) as f32 / count as f32, i as f32 * 2.399_963);
            let r = (1.0 - z * z).sqrt();
            Vec3::new(r * a.cos(), r * a.sin(), z)
        })
    }

    #[test]
    fn far_hair_has_one_plane_and_near_hair_six() {
        let middle = Vec3::new(0.1, 1.6, 0.0);
        for (distance, planes) in [(1000.0, 1), (1.0, 1), (0.5, 1), (0.3, 6), (0.1, 6), (0.0, 6)] {
            let seen = around(middle + distance * Vec3::new(0.6, 0.8, 0.0), middle, 0.2);
            assert_eq!(seen.faces().len(), planes, "{distance}");
        }
        let directional = Perspective::new(
            &LightFrame::default(),
            middle,
            &Bounds { min: -Vec3::ONE, max: Vec3::ONE, ignored: 0 },
            0.1,
        );
        assert_eq!(directional, None, "control");
    }

    #[test]
    fn rays_are_parallel_and_depth_is_the_distance() {
        let (middle, position) = (Vec3::new(0.1, 1.6, 0.0), Vec3::new(0.4, 2.0, 0.6));
        for half in [0.1, 0.6] {
            let seen = around(position, middle, half);
            for way in directions(500) {
                let points = [0.05, 0.3, 0.5].map(|distance| position + distance * way);
                let at = seen.face_of(points[1]);
                let Some(face) = &seen.faces()[at] else { continue };
                let placed = points.map(|p| face.project(p));
                if face.seen(points[1]).x <= 0.0 {
                    assert!(placed[1].y.is_nan(), "behind the light");
                    continue;
                }
                if face.seen(points[1]).x < 0.3 * 0.3 {
                    // So far to the side places on the plane are far away.
                    continue;
                }
                let start = position.distance(middle);
                for (placed, distance) in placed.into_iter().zip([0.05, 0.3, 0.5]) {
                    assert!((placed.x - (distance - start)).abs() < 1e-6, "{placed} at {distance}");
                    let off = (placed.yz() - placed_on(&points[2], face)).length();
                    assert!(off < 2e-5 * (1.0 + placed.yz().length()), "{off}");
                }
            }
        }
    }

    fn placed_on(p: &Vec3, face: &Face) -> glam::Vec2 {
        face.project(*p).yz()
    }

    #[test]
    fn every_point_of_the_hair_is_within_the_bounds_of_its_plane() {
        let middle = Vec3::new(0.1, 1.6, 0.0);
        for distance in [0.0, 0.15, 0.4, 3.0, 1000.0] {
            let seen = around(middle + distance * Vec3::new(0.36, 0.48, 0.8), middle, 0.2);
            for (i, way) in directions(800).enumerate() {
                let along = 0.19 * way * ((i % 7) as f32 / 6.0);
                // The box lies along the axes of the light.
                let p = middle
                    + Vec3::from([0, 1, 2].map(|c| (0..3).map(|a| seen.axes[a][c] * along[a]).sum::<f32>()));
                let face = seen.faces()[seen.face_of(p)].expect("it sees hair");
                let (q, placed) = (face.seen(p), face.project(p));
                if !face.sees(q) || q.length() < face.radius {
                    continue;
                }
                let slack = Vec3::splat(1e-6 * (1.0 + distance));
                let inside = placed.cmpge(face.bounds.min - slack).all()
                    && placed.cmple(face.bounds.max + slack).all();
                assert!(inside, "{distance}: {placed} in {:?}", face.bounds);
            }
        }
    }

    #[test]
    fn a_thousand_metres_away_no_digit_is_lost() {
        let middle = Vec3::new(0.1, 1.6, 0.0);
        let seen = around(middle + 1000.0 * Vec3::Y, middle, 0.2);
        let face = seen.faces()[0].expect("it sees hair");
        let (a, b) = (face.project(middle), face.project(middle - 1e-4 * Vec3::Y));
        assert!((b.x - a.x - 1e-4).abs() < 1e-6, "{} of 1e-4", b.x - a.x);
        let c = face.project(middle + 1e-4 * Vec3::X);
        let moved = c.yz().distance(a.yz()) * 1000.0 / face.plane;
        assert!((moved - 1e-4).abs() < 2e-6, "{moved} of 1e-4");
    }

    /// The area on the plane of a thin ribbon that faces the light, over that of a ribbon along the same line whose width is that of the
    /// strand: what `widening` should be.
    fn area_ratio(face: &Face, from: Vec3, to: Vec3, width: f32) -> f64 {
        let side = (to - from).cross(from + to).normalize_or_zero() * (0.5 * width);
        let on_plane = |q: Vec3| {
            let q = q.as_dvec3();
            glam::DVec2::new(q.y / q.x, q.z / q.x) * f64::from(face.plane)
        };
        let corners = [from + side, to + side, to - side, from - side].map(on_plane);
        let area: f64 = (0..4).map(|i| corners[i].perp_dot(corners[(i + 1) % 4])).sum::<f64>().abs() * 0.5;
        area / (on_plane(from).distance(on_plane(to)) * f64::from(width))
    }

    #[test]
    fn a_ribbon_that_faces_the_light_covers_its_width_on_the_plane() {
        let seen = around(Vec3::ZERO, Vec3::ZERO, 0.5);
        let mut worst = 0.0_f64;
        for (i, way) in directions(300).enumerate() {
            let face = seen.faces()[seen.face_of(way)].expect("it sees hair");
            let from = face.seen(way * (0.1 + 0.001 * i as f32));
            let along = directions(301).nth(i).expect("as many").cross(from.normalize_or_zero());
            let to = from + 0.004 * along.normalize_or_zero() + 0.001 * from.normalize_or_zero();
            let found = f64::from(face.widening(from, to, from.midpoint(to)));
            worst = worst.max((found / area_ratio(&face, from, to, 1e-3) - 1.0).abs());
        }
        // 2e-4 measured, of which the finite width is the largest part.
        assert!(worst < 1e-3, "{worst}");
        // Control: in the corner of a side the tilt of the plane matters.
        let face = seen.faces()[0].expect("it sees hair");
        let (from, to) = (Vec3::new(0.3, 0.29, 0.28), Vec3::new(0.3, 0.288, 0.282));
        let flat = face.plane / 0.3;
        let tilted = face.widening(from, to, from);
        assert!(tilted > 1.3 * flat, "{tilted} beside {flat}");
    }

    #[test]
    fn segments_are_cut_at_the_edges_of_a_plane() {
        let seen = around(Vec3::ZERO, Vec3::ZERO, 0.5);
        let face = seen.faces()[0].expect("it sees hair");
        let inside = (Vec3::new(0.2, 0.0, 0.0), Vec3::new(0.2, 0.1, 0.0));
        assert_eq!(face.clip(inside.0, inside.1), Some((0.0, 1.0)));
        let (first, last) = face.clip(Vec3::new(0.2, 0.0, 0.0), Vec3::new(0.2, 0.42, 0.0)).expect("half");
        assert!(first == 0.0 && (last - 0.5).abs() < 1e-6, "{last}");
        let (first, last) = face.clip(Vec3::new(-0.2, 0.0, 0.0), Vec3::new(0.2, 0.0, 0.0)).expect("half");
        assert!(last == 1.0 && (first - (0.2 + face.nearest) / 0.4).abs() < 1e-6, "{first}");
        for (a, b) in [
            (Vec3::new(-0.2, 0.0, 0.0), Vec3::new(-0.1, 0.0, 0.0)),
            (Vec3::new(0.2, 0.5, 0.0), Vec3::new(0.2, 0.4, 0.0)),
            (Vec3::NAN, Vec3::X),
            (Vec3::X, Vec3::new(f32::INFINITY, 0.0, 0.0)),
        ] {
            assert_eq!(face.clip(a, b), None, "{a} to {b}");
        }
    }

    #[test]
    fn a_column_map_is_found_from_the_world() {
        let seen = around(Vec3::new(0.4, 2.0, 0.6), Vec3::new(0.1, 1.6, 0.0), 0.1);
        let face = seen.faces()[0].expect("it sees hair");
        let affine = Mat4::from_scale(Vec3::new(3.0, 2.0, 1.0))
            * Mat4::from_cols(
                // Columns run along the first axis of the plane, rows along the second.
                Vec4::ZERO,
                Vec4::X,
                Vec4::Y,
                Vec4::new(0.25, 0.5, 0.0, 1.0),
            );
        for way in directions(50) {
            let p = Vec3::new(0.1, 1.6, 0.0) + 0.1 * way;
            let placed = face.project(p);
            let at = face.uv_from_world(affine) * p.extend(1.0);
            let wanted = affine * placed.extend(1.0);
            assert!(
                (at.x / at.w - wanted.x).abs() < 1e-5 && (at.y / at.w - wanted.y).abs() < 1e-5,
                "{at} {wanted}"
            );
            assert!((at.w - face.seen(p).x).abs() < 1e-5);
        }
        let behind = face.uv_from_world(affine) * Vec4::new(0.7, 2.4, 1.2, 1.0);
        assert!(behind.w < 0.0, "{behind}");
    }
}
