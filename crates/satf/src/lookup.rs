//! Reading records: the semantics-aware texture function (Xu et al., "SATF", equation 4).
//!
//! Plain arithmetic on bytes, so that a shader can do the same.

use std::f32::consts::TAU;

use crate::database::Database;
use crate::features::SectorRef;
use crate::layout::{ANGLES, MIP_START, MIPS, RECORD, texels_of};

/// Two neighbours on a circle of equally spaced samples, whose number is a power of two, and where between them a position is.
#[derive(Clone, Copy, Debug)]
struct Between {
    low: usize,
    high: usize,
    fraction: f32,
}

/// Positions are at least minus this; a multiple of every number of samples.
const TURNS: f32 = 1024.0;

impl Between {
    /// Around `position`, in samples, on a circle of `count`. A position that is no number is at 0.
    #[inline]
    fn new(position: f32, count: usize) -> Self {
        let position = if position.is_nan() { 0.0 } else { (position + TURNS).clamp(0.0, 2.0 * TURNS) };
        let low = position as usize;
        Self { low: low & (count - 1), high: (low + 1) & (count - 1), fraction: position - low as f32 }
    }

    /// The sample nearest to `position`.
    #[inline]
    fn nearest(position: f32, count: usize) -> Self {
        Self { fraction: 0.0, ..Self::new(position + 0.5, count) }
    }

    #[inline]
    fn mix(self, value: impl Fn(usize) -> f32) -> f32 {
        let low = value(self.low);
        // Half of all samples of a literal look-up need no second value.
        if self.fraction == 0.0 { low } else { low + (value(self.high) - low) * self.fraction }
    }
}

/// Where the values of a look-up are.
struct Place {
    view: Between,
    light: Between,
    /// Two levels of detail, each with its first texel and its texels.
    levels: [(usize, Between); 2],
    level_fraction: f32,
}

impl Place {
    #[inline]
    fn new(of: SectorRef, angles: [f32; 2], u: f32, mip: f32, nearest: bool) -> Self {
        let side = if of.mirrored { -1.0 } else { 1.0 };
        let u = if of.mirrored { 1.0 - u } else { u };
        let around = |position: f32, count: usize| {
            if nearest { Between::nearest(position, count) } else { Between::new(position, count) }
        };
        let [view, light] = angles.map(|angle| around(side * angle * (ANGLES as f32 / TAU), ANGLES));
        // The maximum of NaN and 0 is 0.
        let mip = mip.max(0.0).min((MIPS - 1) as f32);
        let mip = if nearest { mip.round() } else { mip };
        let fine = mip as usize;
        let levels = [fine, (fine + 1).min(MIPS - 1)].map(|level| {
            let count = texels_of(level);
            (MIP_START[level], around(u * count as f32 - 0.5, count))
        });
        Self { view, light, levels, level_fraction: mip - fine as f32 }
    }

    /// The value of a record.
    #[inline]
    fn texels(&self, record: &[u8; RECORD]) -> f32 {
        // With the mask the compiler sees that no index is out of range.
        let level =
            |(start, texels): (usize, Between)| texels.mix(|i| f32::from(record[(start + i) & (RECORD - 1)]));
        let fine = level(self.levels[0]);
        if self.level_fraction == 0.0 {
            fine
        } else {
            fine + (level(self.levels[1]) - fine) * self.level_fraction
        }
    }
}

/// Record number `index` of an array of records.
#[inline]
fn record(records: &[u8], index: usize) -> &[u8; RECORD] {
    let start = index * RECORD;
    records[start..].first_chunk().unwrap_or(&[0; RECORD])
}

impl Database {
    #[inline]
    fn opacity_at(&self, of: SectorRef, place: &Place) -> f32 {
        let first = of.index as usize * ANGLES;
        let stored = place.view.mix(|view| place.texels(record(self.opacities(), first + view))) / 255.0;
        if of.tau_ratio == 1.0 { stored } else { 1.0 - (1.0 - stored).powf(of.tau_ratio) }
    }

    #[inline]
    fn reflectance_at(&self, of: SectorRef, place: &Place) -> f32 {
        let first = of.index as usize * ANGLES;
        place.view.mix(|view| {
            let first = (first + view) * ANGLES;
            place.light.mix(|light| place.texels(record(self.reflectances(), first + light)))
        }) / 255.0
    }

    /// The opacity at `u` of the outer arc, 0..1 and periodic, toward the azimuth `theta_v`.
    ///
    /// Azimuths are in radians in the plane of the sector, from the outward normal, positive toward rising u. `mip` is the
    /// level of detail: 0 with 32 texels to 5 with a single one. Linear between texels, azimuths and levels.
    pub fn opacity(&self, of: SectorRef, theta_v: f32, u: f32, mip: f32) -> f32 {
        self.opacity_at(of, &Place::new(of, [theta_v, 0.0], u, mip, false))
    }

    /// Opacity and reflectance at `u` toward the azimuth `theta_v`, lit from the azimuth `theta_l`: see
    /// [`Database::opacity`]. The reflectance is that of the hair that is met, not multiplied by the opacity.
    pub fn sample(&self, of: SectorRef, theta_v: f32, theta_l: f32, u: f32, mip: f32) -> (f32, f32) {
        let place = Place::new(of, [theta_v, theta_l], u, mip, false);
        (self.opacity_at(of, &place), self.reflectance_at(of, &place))
    }

    /// Opacity and reflectance as they are stored, without the ratio of optical depths: see [`Database::sample`].
    #[inline]
    pub fn sample_stored(&self, of: SectorRef, angles: [f32; 2], u: f32, mip: f32) -> (f32, f32) {
        let place = Place::new(of, angles, u, mip, false);
        (self.opacity_at(SectorRef { tau_ratio: 1.0, ..of }, &place), self.reflectance_at(of, &place))
    }

    /// The reflectance alone of [`Database::sample_stored`]: for a further light, because the opacity does not depend on light.
    #[inline]
    pub fn reflectance_stored(&self, of: SectorRef, angles: [f32; 2], u: f32, mip: f32) -> f32 {
        self.reflectance_at(of, &Place::new(of, angles, u, mip, false))
    }

    /// [`Database::sample`] of the nearest record and texel, as in the paper.
    pub fn sample_nearest(&self, of: SectorRef, angles: [f32; 2], u: f32, mip: f32) -> (f32, f32) {
        let place = Place::new(of, angles, u, mip, true);
        (self.opacity_at(of, &place), self.reflectance_at(of, &place))
    }

    /// The mean of [`Database::sample_stored`] over all azimuths of view: for an eye that looks along the strands, which has no
    /// azimuth.
    pub fn stored_any_view(&self, of: SectorRef, theta_l: f32, u: f32, mip: f32) -> (f32, f32) {
        let mut sum = (0.0, 0.0);
        for view in 0..ANGLES {
            let theta_v = view as f32 * (TAU / ANGLES as f32);
            let (opacity, reflectance) = self.sample_stored(of, [theta_v, theta_l], u, mip);
            sum = (sum.0 + opacity, sum.1 + reflectance);
        }
        (sum.0 / ANGLES as f32, sum.1 / ANGLES as f32)
    }
}
