//! The point of a triangle that is closest to another point (Ericson 2005, "Real-Time Collision Detection", section 5.1.5), or where a ray
//! meets it.

use glam::Vec3;

/// The part of a triangle that holds the closest point. Corners have the indices 0, 1 and 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ClosestPart {
    /// A corner.
    Corner(usize),
    /// An edge from one corner to another, and how far along it: 0 to 1, or NaN for an edge without length.
    Edge(usize, usize, f32),
    /// The face, with weights of the corners that are not divided by their sum.
    Face([f32; 3]),
}

/// Finds the part of a triangle that is closest to `p`.
#[inline]
pub fn closest_part(p: Vec3, &[a, b, c]: &[Vec3; 3]) -> ClosestPart {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return ClosestPart::Corner(0);
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return ClosestPart::Corner(1);
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return ClosestPart::Edge(0, 1, d1 / (d1 - d3));
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return ClosestPart::Corner(2);
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return ClosestPart::Edge(0, 2, d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return ClosestPart::Edge(1, 2, (d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    ClosestPart::Face([va, vb, vc])
}

/// The point of a triangle closest to `p`. The point of a face is found from `face`, which gets the weights of
/// [`ClosestPart::Face`].
#[inline]
pub fn closest_point_with(p: Vec3, triangle: &[Vec3; 3], face: impl FnOnce([f32; 3]) -> Vec3) -> Vec3 {
    match closest_part(p, triangle) {
        ClosestPart::Corner(i) => triangle[i],
        ClosestPart::Edge(i, j, t) => triangle[i] + (triangle[j] - triangle[i]) * t,
        ClosestPart::Face(weights) => face(weights),
    }
}

/// Barycentric coordinates of the point of a triangle closest to `p`; finite for triangles without area.
#[inline]
pub fn closest_barycentric(p: Vec3, triangle: &[Vec3; 3]) -> [f32; 3] {
    let mut weights = [0.0; 3];
    match closest_part(p, triangle) {
        ClosestPart::Corner(i) => weights[i] = 1.0,
        ClosestPart::Edge(i, j, t) => {
            let t = if t.is_nan() { 0.0 } else { t };
            (weights[i], weights[j]) = (1.0 - t, t);
        }
        ClosestPart::Face([va, vb, vc]) => {
            let sum = va + vb + vc;
            let share = |v: f32| if sum > 0.0 { (v / sum).clamp(0.0, 1.0) } else { 0.0 };
            let (v, w) = (share(vb), share(vc));
            weights = [1.0 - v - w, v, w];
        }
    }
    weights
}

/// The intersection of a ray and a triangle: weights of the second and third corner, and the distance in lengths of `along` (Möller and
/// Trumbore 1997).
#[inline]
pub fn ray_meets([a, b, c]: [Vec3; 3], eye: Vec3, along: Vec3) -> Option<[f32; 3]> {
    let (to_b, to_c) = (b - a, c - a);
    let p = along.cross(to_c);
    let determinant = to_b.dot(p);
    if !determinant.is_finite() || determinant == 0.0 {
        return None;
    }
    let from = (eye - a) / determinant;
    let u = from.dot(p);
    let q = from.cross(to_b);
    let (v, t) = (along.dot(q), to_c.dot(q));
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some([u, v, t])
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: [Vec3; 3] = [Vec3::ZERO, Vec3::X, Vec3::Y];

    #[test]
    fn each_part_is_found_by_hand() {
        let part = |x, y| closest_part(Vec3::new(x, y, 3.0), &TRIANGLE);
        assert_eq!(part(-1.0, -1.0), ClosestPart::Corner(0));
        assert_eq!(part(2.0, -1.0), ClosestPart::Corner(1));
        assert_eq!(part(-1.0, 2.0), ClosestPart::Corner(2));
        assert_eq!(part(0.25, -1.0), ClosestPart::Edge(0, 1, 0.25));
        assert_eq!(part(-1.0, 0.25), ClosestPart::Edge(0, 2, 0.25));
        assert_eq!(part(1.0, 1.0), ClosestPart::Edge(1, 2, 0.5));
        assert_eq!(part(0.25, 0.25), ClosestPart::Face([0.5, 0.25, 0.25]));
    }

    #[test]
    fn points_and_barycentric_coordinates_agree() {
        let mut random = crate::random::SplitMix64::new(1);
        for _ in 0..1000 {
            let triangle = [(); 3].map(|()| random.signed_vec3());
            let p = 2.0 * random.signed_vec3();
            let [a, b, c] = triangle;
            let [u, v, w] = closest_barycentric(p, &triangle);
            let point = closest_point_with(p, &triangle, |[va, vb, vc]| {
                a + ((b - a) * vb + (c - a) * vc) / (va + vb + vc)
            });
            assert!((a * u + b * v + c * w).distance(point) < 1e-5);
            assert!(triangle.iter().all(|corner| point.distance(p) <= corner.distance(p) + 1e-6));
        }
    }

    #[test]
    fn a_triangle_without_area_has_finite_coordinates() {
        for triangle in [[Vec3::ONE; 3], [Vec3::ZERO, Vec3::X, Vec3::X], [Vec3::ZERO, Vec3::ZERO, Vec3::X]] {
            let weights = closest_barycentric(Vec3::new(0.25, 1.0, 0.0), &triangle);
            assert!(
                weights.iter().all(|w| w.is_finite()) && weights.iter().sum::<f32>() == 1.0,
                "{weights:?}"
            );
        }
    }
}
