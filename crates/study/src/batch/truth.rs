//! The ground truth that methods are compared with.
//!
//! *Footprint truth* is converged transmittance: the mean of the light over the texel of the method's own map, the best that the
//! map could represent. *Point truth* is the exact method on the finest map that the strands allow, read in the texel of each point:
//! it contains the detail that is lost in a texel.

use glam::Vec3;
use lovelock_metrics::errors;
use lovelock_render::{ShadowMethod, ShadowSettings, TexelFilter};
use lovelock_shadow::{
    CONVERGED_CHANGE, CpuShadow, MapKind, ShadowError, ShadowInput, converged, cpu_shadow,
};

use super::hair::LitHair;
use crate::report::{FootprintTruth, PointTruth};

/// Points with fewer fragments before them count as points where light enters.
const FIRST: u32 = 10;

/// The footprint of a mean. Maps with the same footprint share a ground truth.
#[derive(Clone, Debug, PartialEq)]
enum Footprint {
    /// Edge of a cell, metres, and number of cells.
    Cells(f32, u64),
    /// Edge of a texel, metres, and number of texels.
    Texels(f32, u64),
    /// A map that cannot be built: its settings, and why.
    Unknown(Box<ShadowSettings>, String),
}

/// Converged transmittance of the first light at every strand point, for one footprint.
#[derive(Debug)]
pub(super) struct Truth {
    footprint: Footprint,
    /// Settings of a method with this footprint.
    pub settings: ShadowSettings,
    /// Transmittance, or why there is none.
    pub transmittance: Result<Vec<f32>, String>,
    pub facts: FootprintTruth,
}

impl Truth {
    /// Number of texels or cells of the maps with this footprint.
    pub(super) fn cells(&self) -> Option<u64> {
        match self.footprint {
            Footprint::Cells(_, cells) | Footprint::Texels(_, cells) => Some(cells),
            Footprint::Unknown(..) => None,
        }
    }
}

/// The ground truths of one instant.
#[derive(Debug, Default)]
pub(super) struct Truths(pub Vec<Truth>);

impl Truths {
    /// The index of the ground truth for the method of `settings`, computed if it is new, and the edge of a texel or cell of its map,
    /// metres. `name` is added to the ground truth.
    pub(super) fn find(
        &mut self,
        lit: LitHair,
        settings: &ShadowSettings,
        name: Option<&str>,
    ) -> (usize, Option<f32>) {
        let (footprint, cell_size) = footprint(lit, settings);
        let known = self.0.iter().position(|truth| truth.footprint == footprint);
        let at = known.unwrap_or_else(|| {
            // If the method needs too much memory, the finer ground truth does too.
            let (transmittance, facts) = match &footprint {
                Footprint::Unknown(_, why) => (Err(why.clone()), FootprintTruth::default()),
                _ => converge(lit, settings),
            };
            self.0.push(Truth { footprint, settings: *settings, transmittance, facts });
            self.0.len() - 1
        });
        if let Some(name) = name {
            self.0[at].facts.methods.push(name.to_owned());
        }
        (at, cell_size)
    }
}

/// The footprint of the method's map. `none` uses that of `exact`.
fn footprint(lit: LitHair, settings: &ShadowSettings) -> (Footprint, Option<f32>) {
    let has_map = settings.method.map_kind() != MapKind::None;
    let method = if has_map { settings.method } else { ShadowMethod::Exact };
    let settings = ShadowSettings { method, ..*settings };
    let mut map = cpu_shadow(method);
    if let Err(error) = map.build(&lit.shadow_input(), &settings) {
        return (Footprint::Unknown(Box::new(settings), error.to_string()), None);
    }
    let report = map.report();
    let footprint = if method.map_kind() == MapKind::Cells {
        Footprint::Cells(report.cell_size, report.cells_total)
    } else {
        Footprint::Texels(report.cell_size, report.cells_total)
    };
    (footprint, has_map.then_some(report.cell_size))
}

/// Edge of a texel (or cell) of the method's map, metres; `None` if it has no map, or the map cannot be built.
pub(super) fn cell_size(lit: LitHair, settings: &ShadowSettings) -> Option<f32> {
    footprint(lit, settings).1
}

/// Converged transmittance at every strand point, and its convergence.
pub(super) fn converge(
    lit: LitHair,
    settings: &ShadowSettings,
) -> (Result<Vec<f32>, String>, FootprintTruth) {
    let strands = &lit.hair.strands;
    converge_at(&lit.shadow_input(), settings, [&strands.x, &strands.y, &strands.z])
}

/// The same at any points, world space, metres.
pub(super) fn converge_at(
    input: &ShadowInput,
    settings: &ShadowSettings,
    points: [&[f32]; 3],
) -> (Result<Vec<f32>, String>, FootprintTruth) {
    match converged(input, settings, points) {
        Ok(found) => {
            let facts = FootprintTruth {
                methods: Vec::new(),
                converged: found.change <= CONVERGED_CHANGE,
                samples: found.samples,
                change: found.change,
                changes: found.changes,
                points: found.transmittance.len() as u64,
            };
            (Ok(found.transmittance), facts)
        }
        Err(error) => (Err(error.to_string()), FootprintTruth::default()),
    }
}

/// Texels along each edge of the ground truth at points, at most. Its difference from a map of half as many is reported.
const FINEST: u32 = 2048;

/// The map of any method.
type AnyMap = Box<dyn CpuShadow + Send + Sync>;

/// The ground truth at points.
pub(super) struct Points {
    pub map: AnyMap,
    pub transmittance: Vec<f32>,
    /// Points with few fragments before them.
    pub first: Vec<usize>,
    pub facts: PointTruth,
}

impl std::fmt::Debug for Points {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Points").field("facts", &self.facts).finish_non_exhaustive()
    }
}

impl Points {
    /// # Errors
    /// If the exact method needs more memory than it may use, with the numbers.
    pub(super) fn new(lit: LitHair) -> Result<Self, ShadowError> {
        let (map, transmittance, edge) = exact(lit, FINEST)?;
        // With few strands on a small head there is no coarser map.
        let (_, coarser, _) = exact(lit, edge / 2)?;
        let change = errors(&coarser, &transmittance).rmse as f32;
        let strands = &lit.hair.strands;
        let at = |point: usize| Vec3::new(strands.x[point], strands.y[point], strands.z[point]);
        let all: Vec<Vec3> = (0..strands.points()).map(at).collect();
        let before = map.fragments_before(&all).unwrap_or_default();
        let first =
            before.iter().enumerate().filter(|(_, count)| **count < FIRST).map(|(at, _)| at).collect();
        let facts = PointTruth { resolution: edge, memory_bytes: map.report().memory_bytes, change };
        Ok(Self { map, transmittance, first, facts })
    }

    /// Whether `settings` give the map of this ground truth, which must not be compared with itself.
    pub(super) fn is_made_by(&self, settings: &ShadowSettings, cell_size: Option<f32>) -> bool {
        settings.method == ShadowMethod::Exact && cell_size == Some(self.map.report().cell_size)
    }
}

/// The exact method with at most that many texels along the edge: its map, the transmittance at every strand point, and the actual
/// number of texels.
fn exact(lit: LitHair, resolution: u32) -> Result<(AnyMap, Vec<f32>, u32), ShadowError> {
    let mut settings = ShadowSettings { method: ShadowMethod::Exact, ..lit.project.shadow };
    (settings.exact.resolution, settings.exact.filter) = (resolution, TexelFilter::Nearest);
    let mut map = cpu_shadow(ShadowMethod::Exact);
    map.build(&lit.shadow_input(), &settings)?;
    let strands = &lit.hair.strands;
    let mut transmittance = vec![1.0; strands.points()];
    map.transmittance_at(&strands.x, &strands.y, &strands.z, &mut transmittance);
    let edge = (map.report().cells_total as f64).sqrt().round() as u32;
    Ok((map, transmittance, edge))
}
