//! Guides that a graphics device has because it simulates them.

use glam::Affine3A;
use lovelock_gpu::{Gpu, PooledBuffer};

/// The guides of an instant in the memory of a graphics device.
///
/// The lists are those of a [`GuideFrame`](lovelock_groom::GuideFrame): all x, then all y, then all z, world space, metres.
#[derive(Clone, Debug)]
pub struct ResidentGuides {
    pub(crate) now: PooledBuffer,
    pub(crate) before: Option<Before>,
}

/// The step before, for an instant between it and the next one.
#[derive(Clone, Debug)]
pub(crate) struct Before {
    pub(crate) guides: PooledBuffer,
    /// The transforms of the head in both steps.
    pub(crate) heads: [Affine3A; 2],
    /// The fraction from the step before (0) to the next one (1).
    pub(crate) t: f32,
}

impl ResidentGuides {
    /// The guides of a step.
    pub fn of_step(guides: PooledBuffer) -> Self {
        Self { now: guides, before: None }
    }

    /// The guides at the fraction `t` (0 to 1) from one step to the next, mixed on the device as on the CPU. Each step has its guides and
    /// the transform of the head, and both have the same layout.
    pub fn between([(before, from), (now, to)]: [(&PooledBuffer, Affine3A); 2], t: f32) -> Self {
        let before = Before { guides: before.clone(), heads: [from, to], t };
        Self { now: now.clone(), before: Some(before) }
    }

    /// Whether the device of `gpu` has all of them, with `points` points.
    pub(crate) fn is_on(&self, gpu: &Gpu, points: usize) -> bool {
        let fits = |guides: &PooledBuffer| guides.is_on(gpu) && guides.raw().size() == 12 * points as u64;
        fits(&self.now) && self.before.as_ref().is_none_or(|before| fits(&before.guides))
    }
}
