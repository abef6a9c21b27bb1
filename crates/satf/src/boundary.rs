//! Between the two boundary sectors of a hair shell volume (Xu et al., "SATF", section 6.2, equations 6 and 7).

use std::f32::consts::{PI, TAU};

use crate::database::Database;
use crate::features::{Features, SectorRef, depth_of};
use crate::layout::DEPTHS;

/// What a record is looked up by: features, and the azimuths of view and light in radians. Symbol: `Params(b)`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Params {
    /// Features of the sector.
    pub features: Features,
    /// Azimuth of the eye.
    pub theta_v: f32,
    /// Azimuth of the light.
    pub theta_l: f32,
}

impl Params {
    /// Distance of two sets of parameters, for equation 6.
    ///
    /// The paper adds quantities of different units. Here optical depths are divided by the largest of the database,
    /// centroids are as they are, and differences of angles are in half turns, the short way round.
    pub fn distance(&self, other: &Self) -> f32 {
        let most = depth_of(DEPTHS - 1);
        let (a, b) = (&self.features, &other.features);
        let parts = [
            (a.optical_depth - b.optical_depth) / most,
            a.s_centroid - b.s_centroid,
            a.t_centroid - b.t_centroid,
            wrapped(self.theta_v - other.theta_v) / PI,
            wrapped(self.theta_l - other.theta_l) / PI,
        ];
        parts.iter().map(|part| part * part).sum::<f32>().sqrt()
    }

    /// The average of two sets of parameters, by circular means of the angles. The curl is that of `self`.
    pub fn mean(&self, other: &Self) -> Self {
        let (a, b) = (&self.features, &other.features);
        Self {
            features: Features {
                optical_depth: 0.5 * (a.optical_depth + b.optical_depth),
                s_centroid: 0.5 * (a.s_centroid + b.s_centroid),
                t_centroid: 0.5 * (a.t_centroid + b.t_centroid),
                curl: a.curl,
            },
            theta_v: circular_mean(self.theta_v, other.theta_v),
            theta_l: circular_mean(self.theta_l, other.theta_l),
        }
    }
}

/// An angle brought into −π..=π, radians.
pub fn wrapped(angle: f32) -> f32 {
    angle - (angle / TAU).round() * TAU
}

/// The middle of the shorter arc between two angles, in −π..=π, radians.
pub fn circular_mean(a: f32, b: f32) -> f32 {
    wrapped(a + 0.5 * wrapped(b - a))
}

/// How the records of the two boundary sectors are used.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum Sweep {
    /// Both records, blended along the volume. No seam shows between volumes.
    #[default]
    Two,
    /// As in the paper: the record of the average where the parameters differ by less than this threshold, which is 0.1 by
    /// default, and both where they differ by more.
    OneBelow(f32),
}

impl Sweep {
    /// The paper's choice with the default threshold.
    pub const PAPER: Self = Self::OneBelow(0.1);
}

/// A record: a sector, and the azimuths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecordRef {
    /// The sector.
    pub sector: SectorRef,
    /// Azimuth of the eye, radians.
    pub theta_v: f32,
    /// Azimuth of the light, radians.
    pub theta_l: f32,
}

/// The records of a hair shell volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumeRecords {
    /// At the bottom, nearer the root.
    pub bottom: RecordRef,
    /// At the top; `None` where the record of the bottom is swept along the volume.
    pub top: Option<RecordRef>,
    /// Whether the nearest records and texels are read, as in the paper, or blended ones.
    pub literal: bool,
}

impl VolumeRecords {
    /// The records of the volume between two boundary sectors.
    pub fn new(bottom: &Params, top: &Params, sweep: Sweep, literal: bool) -> Self {
        let record = |of: &Params| RecordRef {
            sector: if literal {
                SectorRef::literal(of.features.optical_depth)
            } else {
                SectorRef::of(&of.features)
            },
            theta_v: of.theta_v,
            theta_l: of.theta_l,
        };
        let one = match sweep {
            Sweep::Two => false,
            Sweep::OneBelow(threshold) => bottom.distance(top) < threshold,
        };
        if one {
            Self { bottom: record(&bottom.mean(top)), top: None, literal }
        } else {
            Self { bottom: record(bottom), top: Some(record(top)), literal }
        }
    }

    /// Opacity and reflectance at the fraction `gamma` of the volume, 0 at the bottom, and `u` of the arc (equation 7).
    pub fn sample(&self, database: &Database, gamma: f32, u: f32, mip: f32) -> (f32, f32) {
        let read = |of: &RecordRef| {
            if self.literal {
                database.sample_nearest(of.sector, [of.theta_v, of.theta_l], u, mip)
            } else {
                database.sample(of.sector, of.theta_v, of.theta_l, u, mip)
            }
        };
        let bottom = read(&self.bottom);
        let Some(top) = self.top.as_ref().map(read) else { return bottom };
        (bottom.0 + (top.0 - bottom.0) * gamma, bottom.1 + (top.1 - bottom.1) * gamma)
    }
}
