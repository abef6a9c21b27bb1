//! The surface on which hair grows.

use glam::Vec3;
use thiserror::Error;

use lovelock_base::random::SplitMix64;

/// A triangle mesh of the head in head space, with a mask of where hair grows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scalp {
    /// Vertices of the head (not of the whole body), head space, metres.
    pub positions: Vec<Vec3>,
    /// Outward unit normal of each vertex.
    pub normals: Vec<Vec3>,
    /// Vertex indices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Mask of each vertex: 1 where hair grows, 0 where none does (face, ears, neck).
    pub mask: Vec<f32>,
}

/// A point of a [`Scalp`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScalpPoint {
    /// Index of its triangle.
    pub triangle: u32,
    /// Position, head space, metres.
    pub position: Vec3,
    /// Outward unit normal, interpolated from the vertices.
    pub normal: Vec3,
    /// The mask, interpolated from the vertices.
    pub mask: f32,
}

/// A fault of a [`Scalp`].
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum ScalpError {
    /// `normals` or `mask` does not have one entry per vertex.
    #[error("the scalp has {positions} vertices but {normals} normals and {mask} mask values")]
    Lengths {
        /// Number of vertices.
        positions: usize,
        /// Number of normals.
        normals: usize,
        /// Number of mask values.
        mask: usize,
    },
    /// A triangle refers to a missing vertex.
    #[error("triangle {0} of the scalp names a vertex that does not exist")]
    Index(usize),
    /// A number that is not finite.
    #[error("vertex {0} of the scalp has a number that is not finite")]
    NotFinite(usize),
    /// The mask is below the hairline on every triangle that has an area.
    #[error("no part of the scalp may grow hair: its mask is below the hairline everywhere")]
    Bare,
}

impl Scalp {
    /// Checks lengths, indices and numbers.
    ///
    /// # Errors
    /// The first fault found.
    pub fn check(&self) -> Result<(), ScalpError> {
        let (positions, normals, mask) = (self.positions.len(), self.normals.len(), self.mask.len());
        if normals != positions || mask != positions {
            return Err(ScalpError::Lengths { positions, normals, mask });
        }
        if let Some(bad) = self.triangles.iter().position(|t| t.iter().any(|&v| v as usize >= positions)) {
            return Err(ScalpError::Index(bad));
        }
        let finite = |v: usize| {
            self.positions[v].is_finite() && self.normals[v].is_finite() && self.mask[v].is_finite()
        };
        (0..positions).find(|&v| !finite(v)).map_or(Ok(()), |v| Err(ScalpError::NotFinite(v)))
    }

    /// The point of triangle `triangle` with barycentric coordinates `b`, which sum to 1.
    pub fn point(&self, triangle: u32, b: [f32; 3]) -> ScalpPoint {
        let [i, j, k] = self.triangles[triangle as usize].map(|v| v as usize);
        let position = self.positions[i] * b[0] + self.positions[j] * b[1] + self.positions[k] * b[2];
        let normal = self.normals[i] * b[0] + self.normals[j] * b[1] + self.normals[k] * b[2];
        ScalpPoint {
            triangle,
            position,
            normal: normal.normalize_or(self.face_normal(triangle)),
            mask: self.mask[i] * b[0] + self.mask[j] * b[1] + self.mask[k] * b[2],
        }
    }

    /// Outward unit normal of a triangle; +Y for one without area.
    pub fn face_normal(&self, triangle: u32) -> Vec3 {
        self.twice_area(triangle).normalize_or(Vec3::Y)
    }

    /// Middle and half of the size of the box of the vertices whose mask is at least a half, head space, metres; `None` where no hair
    /// may grow.
    pub fn hairy_box(&self) -> Option<(Vec3, Vec3)> {
        let hairy = self.positions.iter().zip(&self.mask).filter(|(p, mask)| **mask >= 0.5 && p.is_finite());
        let (low, high) =
            hairy.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), (p, _)| (l.min(*p), h.max(*p)));
        low.cmple(high).all().then(|| (0.5 * (low + high), 0.5 * (high - low)))
    }

    /// The area whose mask is at least `hairline`, in square metres. Triangles count as a whole.
    pub fn hairy_area(&self, hairline: f32) -> f32 {
        (0..self.triangles.len() as u32).map(|t| self.hairy_weight(t, hairline)).sum()
    }

    /// `count` independent points, uniform over the area whose mask is at least `hairline`, determined by `seed`. Empty
    /// where no hair may grow.
    pub fn sample(&self, count: usize, hairline: f32, seed: u32) -> Vec<ScalpPoint> {
        let mut total = 0.0_f64;
        let sums: Vec<f64> = (0..self.triangles.len() as u32)
            .map(|t| {
                total += f64::from(self.hairy_weight(t, hairline));
                total
            })
            .collect();
        let mut rng = SplitMix64::of_stream(seed, 0x5ca1);
        let mut points = Vec::with_capacity(if total > 0.0 { count } else { 0 });
        // Points below the hairline are rejected, so this needs more tries than points.
        for _ in 0..count.saturating_mul(64) {
            if points.len() == count || total <= 0.0 {
                break;
            }
            let pick = f64::from(rng.unit()) * total;
            let triangle = sums.partition_point(|&sum| sum <= pick).min(sums.len() - 1) as u32;
            let (mut a, mut b) = (rng.unit(), rng.unit());
            if a + b > 1.0 {
                (a, b) = (1.0 - a, 1.0 - b);
            }
            let point = self.point(triangle, [1.0 - a - b, a, b]);
            if point.mask >= hairline {
                points.push(point);
            }
        }
        points
    }

    /// Area of a triangle if the mask of any of its vertices is above the hairline, otherwise 0.
    fn hairy_weight(&self, triangle: u32, hairline: f32) -> f32 {
        let hairy = self.triangles[triangle as usize].iter().any(|&v| self.mask[v as usize] >= hairline);
        if hairy { 0.5 * self.twice_area(triangle).length() } else { 0.0 }
    }

    fn twice_area(&self, triangle: u32) -> Vec3 {
        let [a, b, c] = self.triangles[triangle as usize].map(|v| self.positions[v as usize]);
        (b - a).cross(c - a)
    }
}
