//! The maps of an area light on the CPU.

use glam::Vec3;
use rayon::prelude::*;

use crate::{
    ColumnMap, CpuShadow, RayStructure, ShadowError, ShadowInput, ShadowMethod, ShadowReport, ShadowSettings,
};

type AnyMap = Box<dyn CpuShadow + Send + Sync>;

/// Makes the empty map of a light without an area.
type Make = fn(ShadowMethod) -> AnyMap;

/// The map of a light: one, or one for each of its samples. Transmittance is the mean of all.
///
/// What has to be that of one light (structure along a ray, transmittance behind all hair) is that of the middle.
pub(crate) struct SoftMap {
    method: ShadowMethod,
    make: Make,
    /// At least one.
    maps: Vec<AnyMap>,
}

impl SoftMap {
    /// An empty map: everything is lit.
    pub fn new(method: ShadowMethod, make: Make) -> Self {
        Self { method, make, maps: vec![make(method)] }
    }

    /// The map of the middle.
    fn middle(&self) -> &AnyMap {
        &self.maps[0]
    }
}

impl std::fmt::Debug for SoftMap {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SoftMap").field("samples", &self.maps.len()).finish_non_exhaustive()
    }
}

/// Points whose transmittance is added up together.
const POINTS_PER_PIECE: usize = 8192;

impl CpuShadow for SoftMap {
    fn build(&mut self, input: &ShadowInput, settings: &ShadowSettings) -> Result<(), ShadowError> {
        let samples = input.light.samples(input.anchor);
        // Memory is kept from build to build.
        let (make, method) = (self.make, self.method);
        self.maps.resize_with(samples.len(), || make(method));
        let maps = input.maps.max(1).saturating_mul(samples.len() as u32);
        for (map, light) in self.maps.iter_mut().zip(samples) {
            if let Err(error) = map.build(&ShadowInput { light, maps, ..*input }, settings) {
                // Everything is lit.
                *self = Self::new(self.method, self.make);
                return Err(error);
            }
        }
        Ok(())
    }

    fn transmittance(&self, p: Vec3) -> f32 {
        match &self.maps[..] {
            [only] => only.transmittance(p),
            all => all.iter().map(|map| map.transmittance(p)).sum::<f32>() / all.len() as f32,
        }
    }

    fn transmittance_at(&self, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]) {
        let [first, more @ ..] = &self.maps[..] else { return };
        first.transmittance_at(x, y, z, out);
        if more.is_empty() {
            return;
        }
        let mut found = vec![1.0; out.len()];
        for map in more {
            map.transmittance_at(x, y, z, &mut found);
            let pieces = out.par_chunks_mut(POINTS_PER_PIECE).zip(found.par_chunks(POINTS_PER_PIECE));
            pieces.for_each(|(sums, found)| sums.iter_mut().zip(found).for_each(|(sum, t)| *sum += t));
        }
        let count = self.maps.len() as f32;
        out.par_chunks_mut(POINTS_PER_PIECE).for_each(|sums| sums.iter_mut().for_each(|sum| *sum /= count));
    }

    fn report(&self) -> ShadowReport {
        match &self.maps[..] {
            [only] => only.report(),
            all => {
                // Each map has scratch memory of its own.
                let scratch_bytes = all.iter().map(|map| map.report().scratch_bytes).sum();
                let sum =
                    all.iter().map(|map| map.report()).fold(ShadowReport::default(), ShadowReport::joined);
                ShadowReport { scratch_bytes, ..sum }
            }
        }
    }

    fn column_map(&self) -> Option<ColumnMap> {
        self.middle().column_map()
    }

    fn column_maps(&self) -> Vec<ColumnMap> {
        self.middle().column_maps()
    }

    fn fragments_before(&self, points: &[Vec3]) -> Option<Vec<u32>> {
        let mut sums = self.middle().fragments_before(points)?;
        for map in &self.maps[1..] {
            sums.iter_mut()
                .zip(map.fragments_before(points)?)
                .for_each(|(sum, n)| *sum = sum.saturating_add(n));
        }
        let count = self.maps.len() as u32;
        for sum in &mut sums {
            *sum /= count;
        }
        Some(sums)
    }

    fn along_ray(&self, p: Vec3) -> RayStructure {
        self.middle().along_ray(p)
    }
}
