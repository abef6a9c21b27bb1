//! The rendered strands at one instant, in world space.

use std::sync::Arc;

use glam::Vec3;
use lovelock_base::memory::list_bytes;

/// Every rendered strand at one instant, in world space: the input of shadowing and drawing.
///
/// Structure of arrays, strand after strand, root first. Reused from frame to frame without allocation.
#[derive(Clone, Debug, Default)]
pub struct Strands {
    /// Index of the first point of each strand, then the total number of points (strands + 1 entries).
    pub first_point: Arc<[u32]>,
    /// Positions in world space, metres.
    pub x: Vec<f32>,
    /// See `x`.
    pub y: Vec<f32>,
    /// See `x`.
    pub z: Vec<f32>,
}

impl Strands {
    /// The memory of the points, bytes.
    pub fn bytes(&self) -> u64 {
        [&self.x, &self.y, &self.z].into_iter().map(list_bytes).sum::<u64>()
            + 4 * self.first_point.len() as u64
    }

    /// Number of strands.
    pub fn count(&self) -> usize {
        self.first_point.len().saturating_sub(1)
    }

    /// Number of points of all strands.
    pub fn points(&self) -> usize {
        self.x.len()
    }

    /// Number of segments of all strands.
    pub fn segments(&self) -> usize {
        self.points() - self.count()
    }

    /// Point `i`, world space, metres.
    pub fn point(&self, i: usize) -> Vec3 {
        Vec3::new(self.x[i], self.y[i], self.z[i])
    }
}
