//! Guide strands at rest and at one instant of the simulation.

use glam::{Affine3A, Vec3};

/// The guide strands of a hairstyle at rest, in head space.
///
/// Structure of arrays, guide after guide, root first: point `p` of guide `g` is at index `g * points_per_guide + p`.
/// All guides have the same number of points, equally spaced along each guide. The points beyond the end of a cut guide
/// lie on its end (see [`crate::trimmed`]).
#[derive(Debug, Default, PartialEq)]
pub struct Guides {
    /// Points per guide, at least 2. A guide has one link fewer.
    pub points_per_guide: usize,
    /// Positions in head space, metres; each of length `count * points_per_guide`.
    pub x: Vec<f32>,
    /// See `x`.
    pub y: Vec<f32>,
    /// See `x`.
    pub z: Vec<f32>,
}

impl Clone for Guides {
    fn clone(&self) -> Self {
        let Self { points_per_guide, x, y, z } = self;
        Self { points_per_guide: *points_per_guide, x: x.clone(), y: y.clone(), z: z.clone() }
    }

    /// Uses the memory of the lists, because guides are copied in every frame.
    fn clone_from(&mut self, source: &Self) {
        self.points_per_guide = source.points_per_guide;
        for (to, from) in [(&mut self.x, &source.x), (&mut self.y, &source.y), (&mut self.z, &source.z)] {
            to.clone_from(from);
        }
    }
}

impl Guides {
    /// Number of guide strands.
    pub fn count(&self) -> usize {
        self.x.len().checked_div(self.points_per_guide).unwrap_or(0)
    }

    /// Point `point` of guide `guide`, in head space, metres.
    pub fn point(&self, guide: usize, point: usize) -> Vec3 {
        let i = guide * self.points_per_guide + point;
        Vec3::new(self.x[i], self.y[i], self.z[i])
    }

    /// Appends one guide. `points` must hold `points_per_guide` points.
    pub fn push(&mut self, points: &[Vec3]) {
        assert_eq!(points.len(), self.points_per_guide, "a guide of the wrong number of points");
        for p in points {
            self.x.push(p.x);
            self.y.push(p.y);
            self.z.push(p.z);
        }
    }
}

/// The guide strands at one instant, in world space: what the simulator produces and interpolation reads.
///
/// Has the layout of [`Guides`].
#[derive(Debug, PartialEq)]
pub struct GuideFrame {
    /// Time on the clip's clock, seconds.
    pub time_secs: f64,
    /// The rigid transform that carries head space to world space at that time.
    pub world_from_head: Affine3A,
    /// Positions in world space, metres.
    pub guides: Guides,
}

impl Clone for GuideFrame {
    fn clone(&self) -> Self {
        let Self { time_secs, world_from_head, guides } = self;
        Self { time_secs: *time_secs, world_from_head: *world_from_head, guides: guides.clone() }
    }

    fn clone_from(&mut self, source: &Self) {
        (self.time_secs, self.world_from_head) = (source.time_secs, source.world_from_head);
        self.guides.clone_from(&source.guides);
    }
}

impl GuideFrame {
    /// The rest shape carried rigidly by `world_from_head`: the hair before simulation.
    pub fn at_rest(guides: &Guides, world_from_head: Affine3A, time_secs: f64) -> Self {
        let mut placed = guides.clone();
        for i in 0..guides.x.len() {
            let p = world_from_head.transform_point3(Vec3::new(guides.x[i], guides.y[i], guides.z[i]));
            (placed.x[i], placed.y[i], placed.z[i]) = (p.x, p.y, p.z);
        }
        Self { time_secs, world_from_head, guides: placed }
    }
}
