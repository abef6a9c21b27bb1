//! The database of hair rendering intermediate results (Xu et al., "SATF", section 5).

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use crate::features::{Features, SectorRef};
use crate::layout::{
    ANGLES, DEPTHS, OPACITIES, PATTERNS, RECORD, REFLECTANCES, SECTORS, opacity_start, reflectance_start,
};
use crate::record;
use crate::trace::trace;
use crate::{generate, layout};

/// Records of all sectors for all azimuths of view and of light.
#[derive(Clone, PartialEq, Eq)]
pub struct Database {
    /// `[sector][view][texel]`.
    opacities: Vec<u8>,
    /// `[sector][view][light][texel]`.
    reflectances: Vec<u8>,
}

impl std::fmt::Debug for Database {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Database").field("sectors", &SECTORS).finish_non_exhaustive()
    }
}

impl Database {
    /// Its memory, bytes.
    pub fn bytes(&self) -> u64 {
        (self.opacities.capacity() + self.reflectances.capacity()) as u64
    }

    /// Makes the database: sectors of random strands, traced for every view and light. Uses rayon's threads and has the
    /// same bytes for any number of them. `progress` receives rising fractions up to 1, from those threads.
    pub fn build(progress: &(dyn Fn(f32) + Sync)) -> Self {
        let mut opacities = vec![0; OPACITIES];
        let mut reflectances = vec![0; REFLECTANCES];
        let done = AtomicUsize::new(0);
        opacities
            .par_chunks_exact_mut(OPACITIES / PATTERNS)
            .zip(reflectances.par_chunks_exact_mut(REFLECTANCES / PATTERNS))
            .enumerate()
            .for_each(|(pattern, (opacities, reflectances))| {
                build_pattern(pattern, opacities, reflectances);
                let now = done.fetch_add(1, Ordering::Relaxed) + 1;
                progress(now as f32 / PATTERNS as f32);
            });
        let mut database = Self { opacities, reflectances };
        database.fill_mips();
        database
    }

    /// A database from the finest level of its records, `[sector][view][32]` and `[sector][view][light][32]`.
    pub(crate) fn from_finest(opacities: &[u8], reflectances: &[u8]) -> Self {
        let mut database = Self { opacities: vec![0; OPACITIES], reflectances: vec![0; REFLECTANCES] };
        for (all, finest) in
            [(&mut database.opacities, opacities), (&mut database.reflectances, reflectances)]
        {
            for (record, finest) in all.chunks_exact_mut(RECORD).zip(finest.chunks_exact(layout::TEXELS)) {
                record[..layout::TEXELS].copy_from_slice(finest);
            }
        }
        database.fill_mips();
        database
    }

    fn fill_mips(&mut self) {
        self.opacities
            .par_chunks_exact_mut(RECORD)
            .zip(self.reflectances.par_chunks_exact_mut(ANGLES * RECORD))
            .for_each(|(opacity, reflectances)| {
                record::opacity_mips(opacity);
                for reflectance in reflectances.chunks_exact_mut(RECORD) {
                    record::reflectance_mips(opacity, reflectance);
                }
            });
    }

    /// The sector with the features nearest to `features`.
    pub fn find(&self, features: &Features) -> SectorRef {
        SectorRef::of(features)
    }

    /// The opacities of all sectors, `[sector][view][texel]`: [`OPACITIES`] bytes, opacity times 255.
    pub fn opacities(&self) -> &[u8] {
        &self.opacities
    }

    /// The reflectances of all sectors, `[sector][view][light][texel]`: [`REFLECTANCES`] bytes, reflectance times 255, not
    /// multiplied by the opacity.
    pub fn reflectances(&self) -> &[u8] {
        &self.reflectances
    }

    /// The opacities of sector `sector` seen from azimuth number `view`: [`RECORD`] bytes.
    pub fn opacity_record(&self, sector: usize, view: usize) -> &[u8] {
        &self.opacities[opacity_start(sector, view)..][..RECORD]
    }

    /// The reflectances of sector `sector` seen from azimuth number `view` and lit from number `light`.
    pub fn reflectance_record(&self, sector: usize, view: usize, light: usize) -> &[u8] {
        &self.reflectances[reflectance_start(sector, view, light)..][..RECORD]
    }
}

/// Writes the finest level of all records of the sectors of `pattern`.
fn build_pattern(pattern: usize, opacities: &mut [u8], reflectances: &mut [u8]) {
    let sectors = generate::sectors(pattern);
    for (depth, made) in sectors.iter().enumerate().take(DEPTHS) {
        for view in 0..ANGLES {
            let rays = trace(&made.sector, view);
            let opacity = &mut opacities[opacity_start(depth, view)..][..RECORD];
            let reflectances = &mut reflectances[reflectance_start(depth, view, 0)..][..ANGLES * RECORD];
            record::write(&rays, made.sigma, &mut opacity[..layout::TEXELS], reflectances);
        }
    }
}
