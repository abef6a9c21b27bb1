//! The rays on the CPU: the definition of the method.

use glam::Vec3;
use lovelock_base::settings::Settings;
use rayon::prelude::*;

use super::hierarchy::Hierarchy;
use super::samples::{Ray, Rays};
use super::{COLUMNS, safe_width};
use crate::cpu::safe_extinction;
use crate::exp::exp_of_minus;
use crate::world::{ColumnViews, column_map};
use crate::{
    ColumnMap, CpuShadow, LightFrame, RayMark, RayMarkKind, RayStructure, ShadowError, ShadowInput,
    ShadowMethod, ShadowReport, ShadowSettings,
};

/// Points per parallel task of a lookup.
const POINTS_PER_LOOKUP: usize = 64;

/// Optical depth behind which no more strands are counted: e^−16 is a fifteen-thousandth of a step of 8 bits.
const DARK: f32 = 16.0;

/// The hierarchy of [`ShadowMethod::RayTraced`]; everything is lit until it is built.
#[derive(Debug, Default)]
pub struct RayTraced {
    built: Option<Built>,
}

#[derive(Debug)]
struct Built {
    hierarchy: Hierarchy,
    anchor: Vec3,
    rays: Rays,
    /// Optical depth of a ribbon.
    each: f32,
    /// Ribbons behind which it is dark.
    most: u32,
    columns: ColumnViews,
    report: ShadowReport,
}

/// The number of ribbons of an optical depth behind which it is dark.
pub(super) fn most_ribbons(each: f32) -> u32 {
    if each > 0.0 { (DARK / each).ceil().clamp(1.0, 4e9) as u32 } else { 1 }
}

impl Built {
    fn new(input: &ShadowInput, settings: &ShadowSettings) -> Result<Self, ShadowError> {
        let settings = settings.ray_traced.clamped();
        let segments = (input.strands.points() as u64).saturating_sub(input.strands.count() as u64);
        let needed_bytes = Hierarchy::needed_bytes(segments);
        let limit_bytes = input.share_of(settings.memory_limit_bytes);
        if needed_bytes > limit_bytes {
            let (method, maps) = (ShadowMethod::RayTraced, input.maps.max(1));
            return Err(ShadowError::TooLarge { method, needed_bytes, limit_bytes, maps });
        }
        let extent = ShadowInput { light: LightFrame::WORLD, ..*input }.bounds();
        let width = safe_width(input.strand_width);
        let each = safe_extinction(input.extinction_scale);
        // Nothing blocks light: no ray need be traced.
        let is_lit = width == 0.0 || each == 0.0;
        let nothing = ShadowInput { strands: &lovelock_groom::Strands::default(), ..*input };
        let hierarchy = Hierarchy::new(if is_lit { &nothing } else { input }, &extent, width);
        let report = ShadowReport {
            memory_bytes: hierarchy.bytes(),
            cell_size: width,
            samples: hierarchy.len() as u64,
            points_ignored: extent.ignored,
            needed_bytes,
            ..ShadowReport::default()
        };
        let columns = ColumnViews::new(&input.light, input.anchor, (COLUMNS, width + 1e-4), &input.bounds());
        // Positions are those from the anchor.
        let light = input.light.seen_from(input.anchor);
        let rays = Rays::new(&light, settings.rays, width);
        let most = most_ribbons(each);
        Ok(Self { hierarchy, anchor: input.anchor, rays, each, most, columns, report })
    }

    fn light(&self, ray: &Ray) -> f32 {
        exp_of_minus(self.each * self.hierarchy.count(ray, self.most) as f32)
    }

    fn light_at(&self, p: Vec3) -> f32 {
        self.rays.mean(p - self.anchor, |ray| self.light(ray))
    }
}

impl CpuShadow for RayTraced {
    fn build(&mut self, input: &ShadowInput, settings: &ShadowSettings) -> Result<(), ShadowError> {
        self.built = None;
        self.built = Some(Built::new(input, settings)?);
        Ok(())
    }

    fn transmittance(&self, p: Vec3) -> f32 {
        self.built.as_ref().map_or(1.0, |built| built.light_at(p))
    }

    fn transmittance_at(&self, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]) {
        assert!(x.len() == out.len() && y.len() == out.len() && z.len() == out.len(), "slices of one length");
        let Some(built) = &self.built else {
            out.fill(1.0);
            return;
        };
        let points = x.par_iter().zip(y).zip(z).zip(out).with_min_len(POINTS_PER_LOOKUP);
        points.for_each(|(((x, y), z), out)| *out = built.light_at(Vec3::new(*x, *y, *z)));
    }

    fn report(&self) -> ShadowReport {
        self.built.as_ref().map_or_else(ShadowReport::default, |built| built.report)
    }

    fn column_map(&self) -> Option<ColumnMap> {
        self.column_maps().into_iter().next()
    }

    fn column_maps(&self) -> Vec<ColumnMap> {
        let Some(built) = &self.built else { return Vec::new() };
        built.columns.0.iter().flatten().map(|view| column_map(view, |p| built.light_at(p))).collect()
    }

    fn along_ray(&self, p: Vec3) -> RayStructure {
        let Some((built, ray)) =
            self.built.as_ref().and_then(|built| Some((built, built.rays.middle(p - built.anchor)?)))
        else {
            return RayStructure::default();
        };
        let mut depths = Vec::new();
        let mut put = |depth: f32| {
            depths.push(depth);
            true
        };
        // From a little behind, so that the strand of the point is there, too.
        let gap = 2.0 * ray.nearest();
        let before = Ray { from: ray.from - gap * ray.along, length: ray.length + gap, ..ray };
        built.hierarchy.for_each_hit(&before, |distance| put(gap - distance));
        let behind = Ray { along: -ray.along, length: f32::INFINITY, ..ray };
        built.hierarchy.for_each_hit(&behind, &mut put);
        depths.sort_by(f32::total_cmp);
        let mark = |(before, depth): (usize, f32)| RayMark {
            kind: RayMarkKind::FRAGMENT,
            start: depth,
            end: depth,
            optical_depth: built.each,
            transmittance: exp_of_minus(built.each * (before + 1) as f32),
        };
        RayStructure { marks: depths.into_iter().enumerate().map(mark).collect() }
    }
}
