//! A map of any method, for a light of any kind.

use glam::Vec3;
use rayon::prelude::*;

use super::cube::SIDES;
use super::{Face, Perspective, Projected};
use crate::methods::voxel_map::longest_strand;
use crate::{
    Bounds, ColumnMap, CpuShadow, RayStructure, ShadowError, ShadowInput, ShadowReport, ShadowSettings,
};

type AnyMap = Box<dyn CpuShadow + Send + Sync>;

/// Points that are projected together.
const POINTS_PER_PIECE: usize = 2048;

/// The map of a light: that of a method, or one of its maps for each plane of a light that stands somewhere.
pub(crate) struct LightMap {
    make: fn() -> AnyMap,
    parallel: AnyMap,
    standing: Option<Standing>,
}

/// The maps of a light that stands somewhere.
struct Standing {
    perspective: Perspective,
    /// One map per plane that sees hair.
    maps: Vec<Option<AnyMap>>,
}

impl LightMap {
    /// An empty map: everything is lit.
    pub fn new(make: fn() -> AnyMap) -> Self {
        Self { make, parallel: make(), standing: None }
    }

    fn build_standing(
        &mut self,
        perspective: Perspective,
        input: &ShadowInput,
        settings: &ShadowSettings,
    ) -> Result<(), ShadowError> {
        // Memory is kept from build to build.
        let mut kept = self.standing.take().map_or_else(Vec::new, |standing| standing.maps);
        kept.resize_with(perspective.faces().len(), || None);
        let faces = perspective.faces().len() as u32;
        let longest = longest_strand(input.strands);
        let settings = &if faces > 1 { settings.for_sides() } else { *settings };
        let mut maps = Vec::with_capacity(kept.len());
        for (face, map) in perspective.faces().iter().zip(kept) {
            let Some(face) = face else {
                maps.push(None);
                continue;
            };
            let mut map = map.unwrap_or_else(self.make);
            let projected = Projected::new(input, face, longest, settings.counts_points());
            map.build(&projected.input(input, face, faces), settings)?;
            maps.push(Some(map));
        }
        self.standing = Some(Standing { perspective, maps });
        Ok(())
    }
}

impl std::fmt::Debug for LightMap {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let planes = self.standing.as_ref().map(|standing| standing.maps.len());
        f.debug_struct("LightMap").field("planes", &planes).finish_non_exhaustive()
    }
}

impl Standing {
    /// The planes with their maps.
    fn maps(&self) -> impl Iterator<Item = (&Face, &AnyMap)> {
        let of = |(face, map)| Some((Option::as_ref(face)?, Option::as_ref(map)?));
        self.perspective.faces().iter().zip(&self.maps).filter_map(of)
    }

    /// The plane of a point, with its map; `None` where everything is lit.
    fn map_of(&self, p: Vec3) -> Option<(&Face, &AnyMap)> {
        let at = self.perspective.face_of(p);
        Some((self.perspective.faces()[at].as_ref()?, self.maps[at].as_ref()?))
    }

    /// Transmittance of a piece of points.
    fn look_up(&self, [x, y, z]: [&[f32]; 3], out: &mut [f32]) {
        let point = |i: usize| Vec3::new(x[i], y[i], z[i]);
        let mut asked = Asked::default();
        if let ([face], [map]) = (self.perspective.faces(), &self.maps[..]) {
            let (Some(face), Some(map)) = (face, map) else {
                out.fill(1.0);
                return;
            };
            (0..out.len()).for_each(|i| asked.push(face.project(point(i))));
            map.transmittance_at(&asked.x, &asked.y, &asked.z, out);
            return;
        }
        let sides: Vec<_> = (0..out.len()).map(|i| self.perspective.face_of(point(i))).collect();
        let mut found = Vec::new();
        for side in 0..SIDES {
            let these = || (0..out.len()).filter(|i| sides[*i] == side);
            asked.clear();
            if let (Some(face), Some(map)) = (&self.perspective.faces()[side], &self.maps[side]) {
                these().for_each(|i| asked.push(face.project(point(i))));
                found.resize(asked.x.len(), 1.0);
                map.transmittance_at(&asked.x, &asked.y, &asked.z, &mut found);
                these().zip(&found).for_each(|(i, t)| out[i] = *t);
            } else {
                these().for_each(|i| out[i] = 1.0);
            }
        }
    }
}

/// Projected points.
#[derive(Debug, Default)]
struct Asked {
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
}

impl Asked {
    fn push(&mut self, p: Vec3) {
        self.x.push(p.x);
        self.y.push(p.y);
        self.z.push(p.z);
    }

    fn clear(&mut self) {
        self.x.clear();
        self.y.clear();
        self.z.clear();
    }
}

/// The planes of the light of `input`; `None` for a directional light.
pub(crate) fn perspective_of(input: &ShadowInput, settings: &ShadowSettings) -> Option<Perspective> {
    input.light.source?;
    Perspective::new(&input.light, input.anchor, &Bounds::of_strands(input), settings.face_margin())
}

impl CpuShadow for LightMap {
    fn build(&mut self, input: &ShadowInput, settings: &ShadowSettings) -> Result<(), ShadowError> {
        let Some(perspective) = perspective_of(input, settings) else {
            self.standing = None;
            return self.parallel.build(input, settings);
        };
        self.parallel = (self.make)();
        self.build_standing(perspective, input, settings)
    }

    fn transmittance(&self, p: Vec3) -> f32 {
        let Some(standing) = &self.standing else { return self.parallel.transmittance(p) };
        standing.map_of(p).map_or(1.0, |(face, map)| map.transmittance(face.project(p)))
    }

    fn transmittance_at(&self, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]) {
        let Some(standing) = &self.standing else { return self.parallel.transmittance_at(x, y, z, out) };
        assert!(x.len() == out.len() && y.len() == out.len() && z.len() == out.len(), "slices of one length");
        let piece = POINTS_PER_PIECE;
        let points = x.par_chunks(piece).zip(y.par_chunks(piece)).zip(z.par_chunks(piece));
        points.zip(out.par_chunks_mut(piece)).for_each(|(((x, y), z), out)| standing.look_up([x, y, z], out));
    }

    fn report(&self) -> ShadowReport {
        let Some(standing) = &self.standing else { return self.parallel.report() };
        let reports = || standing.maps().map(|(_, map)| map.report());
        // Each map has scratch memory of its own.
        let scratch_bytes = reports().map(|report| report.scratch_bytes).sum();
        ShadowReport { scratch_bytes, ..reports().fold(ShadowReport::default(), ShadowReport::joined) }
    }

    fn column_map(&self) -> Option<ColumnMap> {
        self.column_maps().into_iter().next()
    }

    fn column_maps(&self) -> Vec<ColumnMap> {
        let Some(standing) = &self.standing else { return self.parallel.column_maps() };
        let of = |(face, map): (&Face, &AnyMap)| {
            let columns = map.column_map()?;
            Some(ColumnMap { uv_from_world: face.uv_from_world(columns.uv_from_world), ..columns })
        };
        standing.maps().filter_map(of).collect()
    }

    fn fragments_before(&self, points: &[Vec3]) -> Option<Vec<u32>> {
        let Some(standing) = &self.standing else { return self.parallel.fragments_before(points) };
        let mut counts = vec![0; points.len()];
        for (at, (face, map)) in standing.perspective.faces().iter().zip(&standing.maps).enumerate() {
            let (Some(face), Some(map)) = (face, map) else { continue };
            let these: Vec<_> =
                (0..points.len()).filter(|i| standing.perspective.face_of(points[*i]) == at).collect();
            let places: Vec<_> = these.iter().map(|i| face.project(points[*i])).collect();
            let found = map.fragments_before(&places)?;
            these.iter().zip(found).for_each(|(i, count)| counts[*i] = count);
        }
        Some(counts)
    }

    fn along_ray(&self, p: Vec3) -> RayStructure {
        let Some(standing) = &self.standing else { return self.parallel.along_ray(p) };
        standing.map_of(p).map_or_else(RayStructure::default, |(face, map)| map.along_ray(face.project(p)))
    }
}
