//! The generalised disk: the cross-sections of a wisp (Xu et al., "SATF", section 3.2).
//!
//! Nothing is fitted. At each sample along a wisp, the offsets of its three guides from their mean, in the plane of the
//! frame that its strands follow, define a linear map from a reference triangle. A strand with constant weights of the guides
//! has a constant place in that triangle, and so in the disk around it, whatever the guides do.

use std::cell::RefCell;

use glam::{Mat2, Mat3, Vec2, Vec3};
use lovelock_groom::{GuideFrame, Hairstyle, WispCurve};
use rayon::prelude::*;

use crate::ellipse::Ellipse;

/// The corners of the reference triangle, on the unit circle: at `π/2 + 2πg/3`.
const CORNERS: [Vec2; 3] = [Vec2::Y, Vec2::new(-HALF_ROOT_3, -0.5), Vec2::new(HALF_ROOT_3, -0.5)];
const HALF_ROOT_3: f32 = 0.866_025_4;

/// The place of a strand with `weights` in the disk of its wisp's guides, before offsets.
pub fn place_of(weights: [f32; 3]) -> Vec2 {
    CORNERS[0] * weights[0] + CORNERS[1] * weights[1] + CORNERS[2] * weights[2]
}

/// A cross-section of the guides of a wisp.
#[derive(Clone, Copy, Debug)]
pub struct GuideSection {
    /// Mean of the guides.
    pub mean: Vec3,
    /// The frame: normal, binormal, tangent.
    pub frame: Mat3,
    /// From the reference triangle to the offsets along normal and binormal, metres. Symbol: `M`.
    pub map: Mat2,
}

impl GuideSection {
    /// The cross-section at `param`, in links.
    pub fn of(curve: &WispCurve, param: f32) -> Self {
        let guides = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|w| curve.blend(w, param));
        let mean = (guides[0] + guides[1] + guides[2]) / 3.0;
        let frame = curve.frame(param);
        let mut map = Mat2::ZERO;
        for (guide, corner) in guides.iter().zip(CORNERS) {
            let from_mean = *guide - mean;
            // The corners' outer products sum to 3/2.
            let offset = Vec2::new(from_mean.dot(frame.x_axis), from_mean.dot(frame.y_axis)) * (2.0 / 3.0);
            map += Mat2::from_cols(offset * corner.x, offset * corner.y);
        }
        Self { mean, frame, map }
    }
}

/// Where the disks of a hairstyle's clusters are along its wisps, and how they lie around the strands: constant in time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DiskPlan {
    /// Cross-sections of each cluster: the number of hair shell volumes along it, and one more.
    pub samples: usize,
    /// The wisp of each cluster.
    pub wisps: Vec<u32>,
    /// The parameter of the last cross-section of each cluster, in links: where its longest strand ends.
    pub ends: Vec<f32>,
    /// The least semi-axis before fitting, metres: the diameter of a strand.
    pub least: f32,
    /// How the disk fits the strands, for each cluster and cross-section: `[cluster][sample]`.
    pub fits: Vec<DiskFit>,
}

/// How a disk lies around the strands of its cross-section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiskFit {
    /// Mean place of the strands in the disk of the guides.
    pub place: Vec2,
    /// Mean offset of the strands along normal and binormal, metres.
    pub offset: Vec2,
    /// Factor on the semi-axes with which the disk holds the strands.
    pub scale: f32,
}

impl Default for DiskFit {
    /// The disk through the guides.
    fn default() -> Self {
        Self { place: Vec2::ZERO, offset: Vec2::ZERO, scale: 1.0 }
    }
}

impl DiskPlan {
    /// The plan of disks through the guides of `wisps`, from root to tip.
    pub fn through_guides(style: &Hairstyle, wisps: Vec<u32>, along: usize, least: f32) -> Self {
        let samples = along.max(1) + 1;
        let links = style.guides.points_per_guide.saturating_sub(1) as f32;
        let ends = vec![links; wisps.len()];
        Self { samples, ends, least, fits: vec![DiskFit::default(); wisps.len() * samples], wisps }
    }

    /// The parameter of cross-section `sample` of `cluster`, in links.
    pub fn param(&self, cluster: usize, sample: usize) -> f32 {
        self.ends[cluster] * sample as f32 / (self.samples - 1) as f32
    }
}

/// The disks of all clusters at one instant: `[cluster][sample]` in each array. Reused without allocation.
///
/// The point `(v, u)` of a disk is `centre + v (cos u · x + sin u · y)`.
#[derive(Clone, Debug, Default)]
pub struct DiskFrames {
    /// Cross-sections per cluster.
    pub samples: usize,
    /// Centres, world space, metres. Symbol: `T`.
    pub centre: Vec<Vec3>,
    /// The end of the radius at u = 0, from the centre, metres.
    pub x: Vec<Vec3>,
    /// The end of the radius at u = π/2, from the centre, metres.
    pub y: Vec<Vec3>,
    /// Unit vectors along the wisp, from root to tip.
    pub tangent: Vec<Vec3>,
    /// Unit vectors: the first axis of the frame in which [`DiskFrames::ellipse`] is given; the second is `tangent × normal`.
    pub normal: Vec<Vec3>,
    /// Semi-axes and angles. Symbols: `A`, `B`, `φ`, `θ`.
    pub ellipse: Vec<Ellipse>,
}

thread_local! {
    static CURVE: RefCell<WispCurve> = RefCell::default();
}

impl DiskFrames {
    /// Places the disks of `plan` for the guides of `frame`. Clusters are shared among rayon's threads.
    ///
    /// # Panics
    /// If `plan` belongs to another hairstyle, or `frame` has fewer guides than `style`.
    pub fn place(&mut self, style: &Hairstyle, frame: &GuideFrame, plan: &DiskPlan) {
        self.samples = plan.samples;
        let count = plan.wisps.len() * plan.samples;
        for axis in [&mut self.centre, &mut self.x, &mut self.y, &mut self.tangent, &mut self.normal] {
            axis.resize(count, Vec3::ZERO);
        }
        self.ellipse.resize(count, Ellipse::default());
        let samples = plan.samples.max(1);
        let centre = self.centre.par_chunks_mut(samples).zip(self.x.par_chunks_mut(samples));
        let radii = self.y.par_chunks_mut(samples).zip(self.tangent.par_chunks_mut(samples));
        let rest = self.normal.par_chunks_mut(samples).zip(self.ellipse.par_chunks_mut(samples));
        centre.zip(radii).zip(rest).enumerate().for_each(
            |(cluster, (((centre, x), (y, tangent)), (normal, ellipse)))| {
                CURVE.with_borrow_mut(|curve| {
                    let wisp = &style.wisps[plan.wisps[cluster] as usize];
                    curve.place(&style.guides, wisp, &style.widest, &frame.guides, frame.world_from_head);
                    let mut before = None;
                    for i in 0..samples {
                        let section = GuideSection::of(curve, plan.param(cluster, i));
                        let fit = &plan.fits[cluster * samples + i];
                        let found = next(section.map, before.as_ref());
                        before = Some(found);
                        let fitted = found.widened(plan.least).scaled(fit.scale);
                        let map = fitted.matrix();
                        let world = |p: Vec2| section.frame.x_axis * p.x + section.frame.y_axis * p.y;
                        centre[i] = section.mean + world(section.map * fit.place + fit.offset);
                        x[i] = world(map.x_axis);
                        y[i] = world(map.y_axis);
                        tangent[i] = section.frame.z_axis;
                        normal[i] = section.frame.x_axis;
                        ellipse[i] = fitted;
                    }
                });
            },
        );
    }

    /// The point `(v, u)` of cross-section `sample` of `cluster`: v from 0 at the centre to 1, u in radians.
    pub fn point(&self, cluster: usize, sample: usize, v: f32, u: f32) -> Vec3 {
        let i = cluster * self.samples + sample;
        self.centre[i] + v * (u.cos() * self.x[i] + u.sin() * self.y[i])
    }

    /// Metres per radian along the circle of radius 1 at `u`.
    pub fn arc_speed(&self, cluster: usize, sample: usize, u: f32) -> f32 {
        let i = cluster * self.samples + sample;
        (u.cos() * self.y[i] - u.sin() * self.x[i]).length()
    }
}

/// The factors of `map` after those of the cross-section before, neither widened nor fitted.
pub(crate) fn next(map: Mat2, before: Option<&Ellipse>) -> Ellipse {
    before.map_or_else(|| Ellipse::of(map), |before| Ellipse::continued(map, before))
}
