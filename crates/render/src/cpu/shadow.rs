//! The shadow method of one frame on the CPU: one map per light, looked up once per strand point and once per vertex of the body.

use glam::Vec3;
use lovelock_base::clock::Stopwatch;
use lovelock_base::memory::list_bytes;
use lovelock_gpu::PassTime;
use lovelock_groom::Strands;
use lovelock_groom::fine::moved_apart;
use lovelock_shadow::{ColumnMap, CpuShadow, LightFrame, ShadowError, ShadowInput, ShadowMethod, cpu_shadow};
use rayon::prelude::*;

use crate::shadow_look::{PIECE, ShadowLook, has_soft_skin, pack};
use crate::skin::Neighbours;
use crate::standing::placed_frame;
use crate::{FrameInput, Light, MAX_LIGHTS, RayStructure, RenderError};

/// The shadows of all lights, kept from frame to frame.
#[derive(Default)]
pub(crate) struct ShadowStage {
    method: Option<ShadowMethod>,
    lights: Vec<LightShadow>,
    /// Four 8-bit transmittances per strand point, the first light in the lowest byte.
    pub at_points: Vec<u32>,
    /// The same for each vertex of the body.
    pub at_vertices: Vec<u32>,
    /// The transmittance behind all hair per light, for the ground: a map, none, or one per side of a cube around it.
    pub columns: Vec<Vec<ColumnMap>>,
    /// Mean transmittance of the first light over the strands' points.
    pub mean: f32,
    /// Bytes of all maps.
    pub bytes: u64,
    /// The times of builds and lookups, added up over lights.
    pub passes: Vec<PassTime>,
    /// The time of every pass when it was last run, for what is kept while nothing moves.
    pub made: Vec<PassTime>,
    vertices: [Vec<f32>; 3],
    /// The places at which strands are looked up.
    asked: [Vec<f32>; 3],
    neighbours: Neighbours,
    softer: Vec<u32>,
    /// Whether the last run was completed.
    is_whole: bool,
}

struct LightShadow {
    /// The axes of its direction, and those of its maps.
    base: LightFrame,
    frame: LightFrame,
    shadow: Box<dyn CpuShadow + Send + Sync>,
    /// Transmittance at the strands' points and at the body's vertices.
    at_points: Vec<f32>,
    at_vertices: Vec<f32>,
}

impl LightShadow {
    /// Builds the map, one of `maps` that share the limit of memory.
    fn build(
        &mut self,
        light: &Light,
        maps: u32,
        look: &ShadowLook,
        strands: &Strands,
    ) -> Result<(), ShadowError> {
        // Transported instead of recomputed, so that the map does not roll while the light is dragged.
        self.base = self.base.transported(light.direction);
        self.frame = placed_frame(self.base, light, look.anchor());
        let from = ShadowInput {
            strands,
            strand_width: look.strand_width,
            extinction_scale: look.extinction_scale,
            light: self.frame,
            anchor: look.anchor(),
            maps,
            projected: None,
        };
        self.shadow.build(&from, &look.settings)
    }

    /// Looks up strand points, if any are passed, and vertices, unless their transmittance is given.
    fn look_up(&mut self, points: Option<[&[f32]; 3]>, vertices: &[Vec<f32>; 3], known: [Option<&[f32]>; 2]) {
        let vertices = vertices.each_ref().map(Vec::as_slice);
        let asked = [(points, &mut self.at_points), (Some(vertices), &mut self.at_vertices)];
        for ((asked, answers), known) in asked.into_iter().zip(known) {
            let Some([x, y, z]) = asked else { continue };
            answers.resize(x.len(), 1.0);
            match known {
                Some(known) => answers.copy_from_slice(known),
                None => self.shadow.transmittance_at(x, y, z, answers),
            }
        }
    }
}

impl std::fmt::Debug for ShadowStage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ShadowStage")
            .field("method", &self.method)
            .field("lights", &self.lights.len())
            .finish_non_exhaustive()
    }
}

impl ShadowStage {
    /// The memory of the maps and of what was looked up in them, bytes.
    pub fn kept_bytes(&self) -> u64 {
        let of_light = |light: &LightShadow| list_bytes(&light.at_points) + list_bytes(&light.at_vertices);
        self.bytes
            + self.lights.iter().map(of_light).sum::<u64>()
            + [&self.at_points, &self.at_vertices, &self.softer].into_iter().map(list_bytes).sum::<u64>()
            + self.vertices.iter().chain(&self.asked).map(list_bytes).sum::<u64>()
    }

    /// Builds the maps from the `stored` strands, and looks up the points of the `drawn` ones and the vertices. Fine strands, each of so
    /// many points, are looked up at places that are apart: see [`moved_apart`].
    ///
    /// # Errors
    /// The map would exceed its memory limit, or given transmittance does not match the picture.
    pub fn run(
        &mut self,
        input: &FrameInput,
        stored: &Strands,
        drawn: (&Strands, Option<usize>),
    ) -> Result<(), RenderError> {
        self.is_whole = false;
        let lights: Vec<Light> = Light::enabled(input.lights).collect();
        let method = if input.known.is_some() { ShadowMethod::Exact } else { input.shadow.method };
        if self.method != Some(method) {
            self.lights.clear();
            self.made.clear();
            self.method = Some(method);
        }
        self.lights.truncate(lights.len());
        let empty: &[Vec3] = &[];
        let positions = input.body.map_or(empty, |(_, skin)| &skin.positions[..]);
        if let Some(known) = input.known {
            known.check(lights.len(), drawn.0.points(), positions.len())?;
        }
        self.vertices.par_iter_mut().enumerate().for_each(|(axis, values)| {
            values.clear();
            values.extend(positions.iter().map(|p| p[axis]));
        });
        while self.lights.len() < lights.len() {
            let base = LightFrame::new(lights[self.lights.len()].direction);
            self.lights.push(LightShadow {
                base,
                frame: base,
                shadow: cpu_shadow(method),
                at_points: Vec::new(),
                at_vertices: Vec::new(),
            });
        }
        let maps = lights.len() as u32;
        self.passes.clear();
        let part = Stopwatch::start();
        let look = ShadowLook::of(input);
        self.lights
            .par_iter_mut()
            .zip(&lights)
            .try_for_each(|(shadow, light)| shadow.build(light, maps, &look, stored))?;
        self.passed("shadow/build", &part);
        self.look_up(input, drawn);

        let part = Stopwatch::start();
        self.columns.clear();
        self.columns.extend(self.lights.iter().map(|light| light.shadow.column_maps()));
        self.passed("shadow/columns", &part);
        self.bytes = self.lights.iter().map(|light| light.shadow.report().memory_bytes).sum();
        self.is_whole = true;
        Ok(())
    }

    /// Looks up the points of other strands, and the vertices, in the maps of the last run.
    ///
    /// # Errors
    /// There was none.
    pub fn look_up_again(
        &mut self,
        input: &FrameInput,
        drawn: (&Strands, Option<usize>),
    ) -> Result<(), RenderError> {
        if !self.is_whole {
            return Err(RenderError::NoPicture);
        }
        self.passes.clear();
        self.look_up(input, drawn);
        Ok(())
    }

    /// Packed transmittances of further points in the maps of the last run, as many for each light, whose places for a light are those of
    /// `asked`. `answers` is scratch memory, a list per light.
    pub fn look_up_more<'a>(
        &self,
        asked: impl Fn(usize) -> &'a Strands + Sync,
        answers: &mut [Vec<f32>; MAX_LIGHTS],
        packed: &mut Vec<u32>,
    ) {
        self.lights.par_iter().zip(&mut answers[..]).enumerate().for_each(|(k, (light, answers))| {
            let Strands { x, y, z, .. } = asked(k);
            answers.resize(x.len(), 1.0);
            light.shadow.transmittance_at(x, y, z, answers);
        });
        let lights = self.lights.len().min(MAX_LIGHTS);
        pack(&answers.each_ref().map(Vec::as_slice)[..lights], asked(0).points(), packed);
    }

    fn look_up(&mut self, input: &FrameInput, (drawn, points): (&Strands, Option<usize>)) {
        let part = Stopwatch::start();
        let reach = ShadowLook::of(input).reach;
        let positions = [&drawn.x[..], &drawn.y[..], &drawn.z[..]];
        let apart = points.filter(|_| reach > 0.0 && input.known.is_none());
        if let Some(points) = apart {
            self.look_up_apart(positions, points, reach);
        }
        let vertices = &self.vertices;
        self.lights.par_iter_mut().enumerate().for_each(|(k, shadow)| {
            let known = input.known.map_or([None; 2], |known| {
                [known.at_points, known.at_vertices].map(|lists| lists.get(k).map(Vec::as_slice))
            });
            shadow.look_up(apart.is_none().then_some(positions), vertices, known);
        });
        let at_points: Vec<&[f32]> = self.lights.iter().map(|light| &light.at_points[..]).collect();
        pack(&at_points, drawn.points(), &mut self.at_points);
        let at_vertices: Vec<&[f32]> = self.lights.iter().map(|light| &light.at_vertices[..]).collect();
        pack(&at_vertices, self.vertices[0].len(), &mut self.at_vertices);
        if let (Some((body, _)), true) = (input.body, has_soft_skin(input, apart.is_some())) {
            self.neighbours.follow(body);
            self.neighbours.soften(&mut self.at_vertices, &mut self.softer);
        }
        self.mean = at_points.first().map_or(1.0, |values| mean(values));
        self.passed("shadow/ask", &part);
    }

    /// Looks up points at the places of their strands, in pieces, because copies of all positions would need much memory.
    fn look_up_apart(&mut self, positions: [&[f32]; 3], points: usize, reach: f32) {
        let count = positions.iter().map(|axis| axis.len()).min().unwrap_or(0);
        for light in &mut self.lights {
            light.at_points.resize(count, 1.0);
        }
        for from in (0..count).step_by(POINTS_AT_ONCE) {
            let until = (from + POINTS_AT_ONCE).min(count);
            for (axis, (asked, positions)) in self.asked.iter_mut().zip(positions).enumerate() {
                asked.resize(until - from, 0.0);
                moved_apart(positions, (axis, from), points, reach, asked);
            }
            let [x, y, z] = &self.asked;
            self.lights.par_iter_mut().for_each(|light| {
                light.shadow.transmittance_at(x, y, z, &mut light.at_points[from..until]);
            });
        }
    }

    fn passed(&mut self, name: &str, part: &Stopwatch) {
        let pass = PassTime { name: name.to_owned(), ms: part.ms() };
        self.made.retain(|made| made.name != name);
        self.made.push(pass.clone());
        self.passes.push(pass);
    }

    /// The axes of the maps of light `light` of the last run; those of light from above if it has none.
    pub fn frame(&self, light: usize) -> LightFrame {
        self.lights.get(light).map_or_else(LightFrame::default, |light| light.frame)
    }

    /// Transmittance of light `light` at the strand points of the last run.
    pub fn transmittance(&self, light: usize) -> Result<&[f32], RenderError> {
        self.light(light).map(|light| &light.at_points[..])
    }

    /// Looks up points in the map of light `light` of the last run.
    pub fn transmittance_at(&self, light: usize, points: &[Vec3]) -> Result<Vec<f32>, RenderError> {
        let light = self.light(light)?;
        let [x, y, z] = [0, 1, 2].map(|axis| points.iter().map(|p| p[axis]).collect::<Vec<_>>());
        let mut answers = vec![1.0; points.len()];
        light.shadow.transmittance_at(&x, &y, &z, &mut answers);
        Ok(answers)
    }

    /// What the map of light `light` of the last run holds along the light through `p`.
    pub fn along_ray(&self, light: usize, p: Vec3) -> Result<RayStructure, RenderError> {
        self.light(light).map(|light| light.shadow.along_ray(p))
    }

    fn light(&self, light: usize) -> Result<&LightShadow, RenderError> {
        if !self.is_whole {
            return Err(RenderError::NoPicture);
        }
        self.lights.get(light).ok_or(RenderError::NoLight { light, lights: self.lights.len() })
    }
}

/// Points that are looked up together at places of their own.
const POINTS_AT_ONCE: usize = 1 << 18;

/// The mean of values, added up in an order that does not depend on the number of threads; 1 if there are none.
fn mean(values: &[f32]) -> f32 {
    let sums: Vec<f64> =
        values.par_chunks(PIECE).map(|piece| piece.iter().map(|&t| f64::from(t)).sum()).collect();
    if values.is_empty() { 1.0 } else { (sums.iter().sum::<f64>() / values.len() as f64) as f32 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means() {
        assert_eq!(mean(&[]), 1.0);
        let values: Vec<f32> = (0..20_000).map(|i| (i % 2) as f32).collect();
        assert_eq!(mean(&values), 0.5);
    }
}
