//! Transmittance of each method along rays of light through chosen strand points.

use glam::Vec3;
use lovelock_panes::probe::{ProbeCurve, ProbeMark};
use lovelock_render::{FrameInput, RenderError, Renderer, ShadowMethod, ShadowSettings, ValueRenderer};
use lovelock_shadow::{
    CONVERGED_CHANGE, LightFrame, RayMarkKind, ShadowError, ShadowInput, converged, cpu_shadow,
};

use super::truth::Points;
use crate::report::{NamedTruth, ProbeReport};

/// Number of sampled positions on a ray.
const PLACES: usize = 241;

/// Half of the range of a ray if there is no hair to determine it, metres.
const DEFAULT_REACH: f32 = 0.05;

/// Transmittance of the default probes: in the light, in between, in the shade.
const WANTED: [f32; 3] = [0.85, 0.5, 0.15];

/// One ray.
#[derive(Debug)]
pub(super) struct Probe {
    position: Vec3,
    /// Sampled depths, metres along the light from the point, and their positions.
    depths: Vec<f32>,
    places: Vec<Vec3>,
    pub report: ProbeReport,
}

/// Required margin of hair around a probe, pixels.
const RIM: usize = 4;

/// Default probe pixels: hair in the light, in between and in the shade, chosen by the transmittance of the image's pixels in row
/// order, inside the hair if there is enough. Empty if there is no hair.
pub(super) fn default_pixels(transmittance: &[f32], width: u32) -> Vec<[u32; 2]> {
    let columns = width.max(1) as usize;
    let is_hair = |at: usize| transmittance.get(at).is_some_and(|light| light.is_finite());
    let within = |at: &usize| {
        let (x, y) = (at % columns, at / columns);
        let around = [(x.checked_sub(RIM), Some(y)), (Some(x + RIM), Some(y)), (Some(x), y.checked_sub(RIM))];
        let around = around.into_iter().chain([(Some(x), Some(y + RIM))]);
        let mut around = around.map(|place| if let (Some(x), Some(y)) = place { Some((x, y)) } else { None });
        around.all(|place| place.is_some_and(|(x, y)| x < columns && is_hair(y * columns + x)))
    };
    let seen: Vec<usize> = (0..transmittance.len()).filter(|at| is_hair(*at)).collect();
    let inner: Vec<usize> = seen.iter().copied().filter(within).collect();
    let among = if inner.is_empty() { &seen } else { &inner };
    let mut chosen: Vec<[u32; 2]> = Vec::new();
    for wanted in WANTED {
        let off = |at: &usize| (transmittance[*at] - wanted).abs();
        let Some(best) = among.iter().copied().min_by(|a, b| off(a).total_cmp(&off(b))) else { break };
        let pixel = [(best % columns) as u32, (best / columns) as u32];
        if !chosen.contains(&pixel) {
            chosen.push(pixel);
        }
    }
    chosen
}

impl Probe {
    /// The ray through the hair at a pixel; `None` if there is no hair.
    pub(super) fn new(
        values: &mut ValueRenderer,
        input: &FrameInput,
        [width, height]: [u32; 2],
        pixel: [u32; 2],
        light: LightFrame,
        truth: Option<&Points>,
    ) -> Option<Self> {
        let hit = values.pick(input, width, height, pixel.map(|at| at as f32 + 0.5))?;
        let steps: Vec<(f32, f32)> = truth
            .map(|truth| truth.map.along_ray(hit.position).marks)
            .unwrap_or_default()
            .iter()
            .filter(|mark| mark.kind == RayMarkKind::FRAGMENT)
            .map(|mark| (mark.start, mark.transmittance))
            .collect();
        let reach = |of: Option<&(f32, f32)>, usual: f32| of.map_or(usual, |step| step.0);
        let low = reach(steps.first(), -DEFAULT_REACH).min(0.0);
        let high = reach(steps.last(), DEFAULT_REACH).max(0.0);
        let margin = 0.05 * (high - low) + 1e-3;
        let depth = |i: usize| low - margin + (high - low + 2.0 * margin) * i as f32 / (PLACES - 1) as f32;
        let depths: Vec<f32> = (0..PLACES).map(depth).collect();
        let way = light.way_at(hit.position);
        let places = depths.iter().map(|depth| hit.position + *depth * way).collect();
        let first = input.style.strands.first_point.get(hit.strand).copied().unwrap_or(0);
        let report = ProbeReport {
            pixel,
            strand: hit.strand as u32,
            point: (hit.point as u32).saturating_sub(first),
            position: hit.position.to_array(),
            steps,
            ..ProbeReport::default()
        };
        Some(Self { position: hit.position, depths, places, report })
    }

    /// Computes the mean of the light over a texel of the exact map along the ray, and returns its convergence.
    ///
    /// # Errors
    /// If it does not fit in memory, with the numbers.
    pub(super) fn find_reference(
        &mut self,
        input: &ShadowInput,
        settings: &ShadowSettings,
    ) -> Result<NamedTruth, ShadowError> {
        let axis = |of: fn(&Vec3) -> f32| self.places.iter().map(of).collect::<Vec<f32>>();
        let settings = ShadowSettings { method: ShadowMethod::Exact, ..*settings };
        let found = converged(input, &settings, [&axis(|p| p.x), &axis(|p| p.y), &axis(|p| p.z)])?;
        self.report.reference = self.depths.iter().copied().zip(found.transmittance).collect();
        Ok(NamedTruth {
            name: self.name(),
            converged: found.change <= CONVERGED_CHANGE,
            samples: found.samples,
            change: found.change,
        })
    }

    /// Its name in reports.
    pub(super) fn name(&self) -> String {
        format!("probe at {},{}", self.report.pixel[0], self.report.pixel[1])
    }

    /// Looks up the map of the last image along the ray.
    ///
    /// # Errors
    /// If the device is lost.
    pub(super) fn ask(
        &mut self,
        renderer: &mut Renderer,
        input: &ShadowInput,
        settings: &ShadowSettings,
        name: &str,
    ) -> Result<(), RenderError> {
        let mut asked = self.places.clone();
        asked.push(self.position);
        let mut light = renderer.transmittance_at(0, &asked)?;
        let value = light.pop().unwrap_or(1.0);
        // The marks come from the CPU definition.
        let mut map = cpu_shadow(settings.method);
        let marks = match map.build(input, settings) {
            Ok(()) => map.along_ray(self.position).marks,
            Err(_) => Vec::new(),
        };
        let marks = marks.iter().map(|mark| ProbeMark {
            kind: mark.kind.label.to_lowercase(),
            start: mark.start,
            end: mark.end,
            weight: mark.optical_depth,
        });
        self.report.methods.push(ProbeCurve {
            method: name.to_owned(),
            curve: self.depths.iter().copied().zip(light).collect(),
            value,
            marks: marks.collect(),
        });
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_lie_within_the_hair_and_have_the_light_that_is_wanted() {
        let n = f32::NAN;
        assert_eq!(default_pixels(&[n; 12], 4), [[0; 2]; 0]);
        assert_eq!(default_pixels(&[], 0), [[0; 2]; 0]);
        // Too little hair to be inside of.
        assert_eq!(default_pixels(&[n, 0.1, 0.9, n], 4), [[2, 0], [1, 0]]);
        // Hair from column 5 on, brighter to the right; its margin is excluded.
        let (width, height) = (40, 20);
        let light = |at: usize| if at % width < 5 { n } else { (at % width) as f32 / width as f32 };
        let picture: Vec<f32> = (0..width * height).map(light).collect();
        let chosen = default_pixels(&picture, width as u32);
        assert_eq!(chosen.iter().map(|pixel| pixel[0]).collect::<Vec<_>>(), [34, 20, 9]);
        assert!(chosen.iter().all(|pixel| (4..16).contains(&pixel[1])), "{chosen:?}");
    }
}
