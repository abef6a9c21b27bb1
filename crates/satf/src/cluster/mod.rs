//! Clusters of a hairstyle: the hair of each wisp as features of the sectors of its layers (Xu et al., "SATF", section 3).
//!
//! Made once per hairstyle. The places of strands in the disk are constant, so a frame only needs the size of the disks.

mod face;
mod placing;
mod settings;
mod sharing;
mod sorting;

use std::f32::consts::TAU;

use lovelock_groom::{Hairstyle, HairstyleError};
use rayon::prelude::*;

pub use face::Face;
pub use settings::{ClusterSettings, Grid};

use crate::disk::{DiskFrames, DiskPlan};
use crate::features::Features;
use sharing::{Own, Shared};

/// The clusters of a hairstyle: one per wisp that has strands.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Clusters {
    /// How each cluster is divided.
    pub grid: Grid,
    /// Where the disks are.
    pub plan: DiskPlan,
    /// The set of features of each cluster; clusters of one macro-cluster have the same.
    pub set_of: Vec<u32>,
    /// The amount of hair, in strands of full width, that a part of 1 stands for in each cluster.
    pub scales: Vec<f32>,
    /// The features of each set: `[set][sample][layer][sector]`.
    pub faces: Vec<Face>,
}

/// Memory of the features of clusters, in bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FeatureBytes {
    /// As they are kept: one set per macro-cluster.
    pub shared: usize,
    /// If each cluster had its own.
    pub unshared: usize,
}

impl Clusters {
    /// The clusters of `style`. The same for any number of threads.
    ///
    /// # Errors
    /// The hairstyle is inconsistent.
    pub fn of(style: &Hairstyle, settings: &ClusterSettings) -> Result<Self, HairstyleError> {
        style.check()?;
        let wisps: Vec<u32> =
            (0..style.wisps.len() as u32).filter(|&w| style.wisps[w as usize].strand_count > 0).collect();
        let grid = settings.grid(wisps.len(), style.guides.points_per_guide - 1);
        let least = lovelock_base::numbers::within(settings.strand_diameter, 1e-6, 1e-2, 80e-6);
        let made: Vec<_> = wisps
            .par_iter()
            .map(|&w| {
                let placed = placing::place(style, &style.wisps[w as usize], 2 * grid.along + 1, least);
                let (scale, faces) = sorting::sort(&placed, &grid);
                let fits = placed.fits.into_iter().step_by(2);
                (Own { scale, faces }, placed.end, fits.collect::<Vec<_>>())
            })
            .collect();

        let mut plan = DiskPlan { samples: grid.samples(), wisps, least, ..DiskPlan::default() };
        let mut own = Vec::with_capacity(made.len());
        for (hair, end, fits) in made {
            own.push(hair);
            plan.ends.push(end);
            plan.fits.extend(fits);
        }
        let tolerance = lovelock_base::numbers::within(settings.macro_tolerance, 0.0, 1.0, 0.0);
        let Shared { set_of, scales, faces } = sharing::share(&own, &grid, tolerance);
        Ok(Self { grid, plan, set_of, scales, faces })
    }

    /// Number of clusters.
    pub fn count(&self) -> usize {
        self.set_of.len()
    }

    /// Number of sets of features: macro-clusters.
    pub fn sets(&self) -> usize {
        self.faces.len().checked_div(self.grid.faces()).unwrap_or(0)
    }

    /// Memory of the features.
    pub fn bytes(&self) -> FeatureBytes {
        let one = size_of::<Face>() * self.grid.faces();
        let index = size_of::<u32>() * self.count();
        FeatureBytes { shared: one * self.sets() + index, unshared: one * self.count() }
    }

    /// The kept features of a sector.
    pub fn face(&self, cluster: usize, sample: usize, layer: usize, sector: usize) -> Face {
        let set = self.set_of[cluster] as usize;
        self.faces[set * self.grid.faces() + self.grid.face(sample, layer, sector)]
    }

    /// The hair in a sector, in strands of full width.
    pub fn amount(&self, cluster: usize, sample: usize, layer: usize, sector: usize) -> f32 {
        self.face(cluster, sample, layer, sector).part() * self.scales[cluster]
    }

    /// The features of a sector in the disks `frames`, for strands that shadow and cover with `width` metres.
    ///
    /// N strands of the width w in a sector of the height h and the mean arc length c have the density `N w / (c h)`. Along
    /// the radius that is the optical depth `N w / c`: the height cancels.
    pub fn features(
        &self,
        frames: &DiskFrames,
        cluster: usize,
        sample: usize,
        layer: usize,
        sector: usize,
        width: f32,
    ) -> Features {
        let face = self.face(cluster, sample, layer, sector);
        let step = TAU / self.grid.sectors as f32;
        let u = (sector as f32 + 0.5) * step;
        let arc = self.grid.radius(layer) * step * frames.arc_speed(cluster, sample, u);
        let covered = face.part() * self.scales[cluster] * width;
        Features {
            optical_depth: if arc > 0.0 { covered / arc } else { 0.0 },
            s_centroid: face.s_centroid(),
            t_centroid: face.t_centroid(),
            curl: face.curl(),
        }
    }
}
