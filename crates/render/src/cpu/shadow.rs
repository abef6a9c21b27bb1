//! The shadow method of one frame on the CPU: one map per light, looked up once per strand point and once per vertex of the body.

mod casters;

use glam::Vec3;
use lovelock_base::clock::Stopwatch;
use lovelock_base::memory::list_bytes;
use lovelock_gpu::PassTime;
use lovelock_groom::Strands;
use lovelock_groom::fine::moved_apart;
use lovelock_shadow::{ColumnMap, CpuShadow, LightFrame, ShadowError, ShadowInput, ShadowMethod, cpu_shadow};
use rayon::prelude::*;

use self::casters::Casters;
pub(super) use self::casters::{caster_step, casters_of};
use super::kept::Unchanged;
use crate::shadow_look::{PIECE, ShadowLook, has_soft_skin, pack};
use crate::skin::Neighbours;
use crate::standing::placed_frame;
use crate::{FrameInput, KnownTransmittance, Light, MAX_LIGHTS, RayStructure, RenderError};

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
    /// Records of all maps that are read in a simpler way.
    pub fallbacks: u64,
    /// The times of builds and lookups, added up over lights: the time of the stage, divided in proportion to what each took on its thread.
    pub passes: Vec<PassTime>,
    /// The same of what was kept, when it was last run.
    pub kept: Vec<PassTime>,
    /// The time to look up and pack what all lights share, milliseconds.
    packed_ms: f64,
    /// The strands that cast shadows, where those are not all.
    casters: Casters,
    vertices: [Vec<f32>; 3],
    /// The places at which strands are looked up.
    asked: [Vec<f32>; 3],
    neighbours: Neighbours,
    softer: Vec<u32>,
    /// Whether the transmittances at vertices were softened when they were packed.
    is_softened: bool,
    /// Whether the last run was completed.
    is_whole: bool,
    /// Whether hair has moved since the last run.
    is_behind: bool,
}

struct LightShadow {
    /// The axes of its direction, and those of its maps.
    base: LightFrame,
    frame: LightFrame,
    shadow: Box<dyn CpuShadow + Send + Sync>,
    /// Transmittance at the strands' points and at the body's vertices.
    at_points: Vec<f32>,
    at_vertices: Vec<f32>,
    /// One of how many strands is in its map.
    step: usize,
    /// What the next run keeps.
    keeps: Keeps,
    /// The time of each of [`PASSES`] when it was last run, milliseconds.
    made_ms: [f64; 3],
}

/// The passes of a light.
const PASSES: [&str; 3] = ["shadow/build", "shadow/ask", "shadow/columns"];

/// What is kept of the last frame for one light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Keeps {
    map: bool,
    points: bool,
    vertices: bool,
}

impl Keeps {
    /// Whether each of [`PASSES`] is left out.
    fn passes(self) -> [bool; 3] {
        [self.map, self.points && self.vertices, self.map]
    }
}

impl LightShadow {
    /// Builds the map, one of `maps` that share the limit of memory.
    fn build(&mut self, light: &Light, frame: &LightRun) -> Result<(), ShadowError> {
        let look = frame.look;
        // Transported instead of recomputed, so that the map does not roll while the light is dragged.
        self.base = self.base.transported(light.direction);
        self.frame = placed_frame(self.base, light, look.anchor());
        let from = ShadowInput {
            strands: frame.casters,
            // Texels, profiles and ribbons follow the width of a strand, so it stays that of the strands. What the casters stand for is
            // in the factor on their optical depth, of which the methods with fewer casters are sums.
            strand_width: look.strand_width,
            extinction_scale: look.extinction_scale * frame.each_for,
            light: self.frame,
            anchor: look.anchor(),
            maps: frame.maps,
            projected: None,
        };
        self.shadow.build(&from, &look.settings)
    }

    /// Builds the map, looks up strand points, if any are passed, and vertices, unless their transmittance is given, and makes the map of
    /// the ground, all as far as they are not kept.
    fn run(
        &mut self,
        frame: &LightRun,
        (k, light): (usize, &Light),
        columns: &mut Vec<ColumnMap>,
    ) -> Result<(), ShadowError> {
        let keeps = self.keeps;
        let watch = Stopwatch::start();
        if !keeps.map {
            self.build(light, frame)?;
            self.step = frame.step;
        }
        let built_ms = watch.ms();
        let points = frame.points.filter(|_| !keeps.points);
        let vertices = frame.vertices.each_ref().map(Vec::as_slice);
        let vertices = Some(vertices).filter(|_| !keeps.vertices);
        let known = frame.known.map_or([None; 2], |known| {
            [known.at_points, known.at_vertices].map(|lists| lists.get(k).map(Vec::as_slice))
        });
        let asked = [(points, &mut self.at_points), (vertices, &mut self.at_vertices)];
        for ((asked, answers), known) in asked.into_iter().zip(known) {
            let Some([x, y, z]) = asked else { continue };
            answers.resize(x.len(), 1.0);
            match known {
                Some(known) => answers.copy_from_slice(known),
                None => self.shadow.transmittance_at(x, y, z, answers),
            }
        }
        let asked_ms = watch.ms();
        if !keeps.map {
            *columns = self.shadow.column_maps();
        }
        let times = [built_ms, asked_ms - built_ms, watch.ms() - asked_ms];
        for ((made, now), is_kept) in self.made_ms.iter_mut().zip(times).zip(keeps.passes()) {
            *made = if is_kept { *made } else { now };
        }
        Ok(())
    }
}

/// What the maps of all lights have in common.
struct LightRun<'a> {
    maps: u32,
    look: &'a ShadowLook,
    /// The strands that cast shadows, one of how many that is, and the number of strands that each stands for.
    casters: &'a Strands,
    step: usize,
    each_for: f32,
    /// Where strands are looked up, unless they are looked up at places of their own.
    points: Option<[&'a [f32]; 3]>,
    vertices: &'a [Vec<f32>; 3],
    known: Option<KnownTransmittance<'a>>,
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
            + self.casters.strands.bytes()
    }

    /// Builds the maps from the `stored` strands, and looks up the points of the `drawn` ones and the vertices, as far as that is not
    /// `unchanged`. In a draft, not all strands of much hair are in maps that add strands up; finer maps that are known serve it too.
    /// `same_points` tells whether the drawn points are those of the last frame. Fine strands, each of so many points, are
    /// looked up at places that are apart: see [`moved_apart`].
    ///
    /// A thread builds one map while others look up finished ones: lights wait for each other only at the end.
    ///
    /// # Errors
    /// The map would exceed its memory limit, or given transmittance does not match the picture.
    pub fn run(
        &mut self,
        input: &FrameInput,
        stored: &Strands,
        (drawn, points): (&Strands, Option<usize>),
        (unchanged, same_points): (Unchanged, bool),
    ) -> Result<(), RenderError> {
        let was_whole = std::mem::take(&mut self.is_whole) & !std::mem::take(&mut self.is_behind);
        self.passes.clear();
        self.kept.clear();
        let lights: Vec<Light> = Light::enabled(input.lights).collect();
        let method = if input.known.is_some() { ShadowMethod::Exact } else { input.shadow.method };
        if self.method != Some(method) {
            self.lights.clear();
            self.method = Some(method);
        }
        self.lights.truncate(lights.len());
        let positions = input.body.map_or(&[][..], |(_, skin)| &skin.positions);
        if let Some(known) = input.known {
            known.check(lights.len(), drawn.points(), positions.len())?;
        }
        let step = caster_step(input, stored.points());
        for (k, light) in self.lights.iter_mut().enumerate() {
            let map = was_whole && unchanged.strands && unchanged.lights[k] && light.step <= step;
            light.keeps = Keeps { map, points: map && same_points, vertices: map && unchanged.surface };
        }
        while self.lights.len() < lights.len() {
            let base = LightFrame::new(lights[self.lights.len()].direction);
            self.lights.push(LightShadow {
                base,
                frame: base,
                shadow: cpu_shadow(method),
                at_points: Vec::new(),
                at_vertices: Vec::new(),
                step,
                keeps: Keeps::default(),
                made_ms: [0.0; 3],
            });
        }
        if self.lights.iter().any(|light| !light.keeps.vertices) || lights.is_empty() {
            self.vertices.par_iter_mut().enumerate().for_each(|(axis, values)| {
                values.clear();
                values.extend(positions.iter().map(|p| p[axis]));
            });
        }
        self.columns.resize_with(lights.len(), Vec::new);
        let look = ShadowLook::of(input);
        let places = [&drawn.x[..], &drawn.y[..], &drawn.z[..]];
        let apart = points.filter(|_| look.reach > 0.0 && input.known.is_none());
        let stage = Stopwatch::start();
        let is_thinned = step > 1 && self.lights.iter().any(|light| !light.keeps.map);
        let each_for = if is_thinned { self.casters.follow(stored, step) } else { 1.0 };
        let frame = LightRun {
            maps: lights.len() as u32,
            look: &look,
            casters: if is_thinned { &self.casters.strands } else { stored },
            step,
            each_for,
            points: apart.is_none().then_some(places),
            vertices: &self.vertices,
            known: input.known,
        };
        self.lights
            .par_iter_mut()
            .zip(&mut self.columns)
            .zip(&lights)
            .enumerate()
            .try_for_each(|(k, ((shadow, columns), light))| shadow.run(&frame, (k, light), columns))?;
        let lights_ms = stage.ms();
        let packed_anew = self.pack_lights(input, places, apart.map(|points| (points, look.reach)));
        if packed_anew {
            self.packed_ms = stage.ms() - lights_ms;
        }
        self.take_times(lights_ms, packed_anew);
        let reports = || self.lights.iter().map(|light| light.shadow.report());
        self.bytes = reports().map(|report| report.memory_bytes).sum();
        self.fallbacks = reports().map(|report| report.fallbacks).sum();
        self.is_whole = true;
        Ok(())
    }

    /// Takes notice that hair moves without a run: the next one keeps nothing.
    pub fn fall_behind(&mut self) {
        self.is_behind = true;
    }

    /// Looks up points apart, and packs the transmittances of all lights. Returns whether anything changed.
    fn pack_lights(&mut self, input: &FrameInput, places: [&[f32]; 3], apart: Option<(usize, f32)>) -> bool {
        let keeps = |of: fn(Keeps) -> bool| self.lights.iter().all(|light| of(light.keeps));
        let is_softened = input.body.is_some() && has_soft_skin(input, apart.is_some());
        // Without lights the lists of the last frame may have another length.
        let has_lights = !self.lights.is_empty();
        let same_points = has_lights && keeps(|keeps| keeps.points);
        let same_vertices = has_lights && keeps(|keeps| keeps.vertices) && is_softened == self.is_softened;
        if !same_points {
            if let Some((points, reach)) = apart {
                self.look_up_apart(places, points, reach);
            }
            let at_points: Vec<&[f32]> = self.lights.iter().map(|light| &light.at_points[..]).collect();
            pack(&at_points, places[0].len(), &mut self.at_points);
            self.mean = at_points.first().map_or(1.0, |values| mean(values));
        }
        if !same_vertices {
            let at_vertices: Vec<&[f32]> = self.lights.iter().map(|light| &light.at_vertices[..]).collect();
            pack(&at_vertices, self.vertices[0].len(), &mut self.at_vertices);
            if let (Some((body, _)), true) = (input.body, is_softened) {
                self.neighbours.follow(body);
                self.neighbours.soften(&mut self.at_vertices, &mut self.softer);
            }
        }
        self.is_softened = is_softened;
        !(same_points && same_vertices)
    }

    /// Lists the times of passes, of which those of lights together took `lights_ms`.
    fn take_times(&mut self, lights_ms: f64, packed_anew: bool) {
        let ran = |light: &LightShadow, pass: usize| !light.keeps.passes()[pass];
        let on_threads: f64 = self
            .lights
            .iter()
            .flat_map(|light| {
                (0..PASSES.len()).filter(|&pass| ran(light, pass)).map(|pass| light.made_ms[pass])
            })
            .sum();
        let scale = if on_threads > 0.0 { lights_ms / on_threads } else { 0.0 };
        for light in &mut self.lights {
            for (made, is_kept) in light.made_ms.iter_mut().zip(light.keeps.passes()) {
                *made *= if is_kept { 1.0 } else { scale };
            }
        }
        for (pass, name) in PASSES.into_iter().enumerate() {
            let sum = |new: bool| -> (usize, f64) {
                let those = self.lights.iter().filter(|light| ran(light, pass) == new);
                (those.clone().count(), those.map(|light| light.made_ms[pass]).sum())
            };
            let ((new, mut new_ms), (old, mut old_ms)) = (sum(true), sum(false));
            let is_asked = pass == 1;
            if is_asked {
                *(if packed_anew { &mut new_ms } else { &mut old_ms }) += self.packed_ms;
            }
            if new > 0 || is_asked && packed_anew {
                self.passes.push(PassTime { name: name.to_owned(), ms: new_ms });
            }
            if old > 0 {
                self.kept.push(PassTime { name: name.to_owned(), ms: old_ms });
            }
        }
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

    /// Looks up points at the places of their strands, in pieces, because copies of all positions would need much memory. A piece is moved
    /// once and looked up for all lights.
    fn look_up_apart(&mut self, positions: [&[f32]; 3], points: usize, reach: f32) {
        let count = positions.iter().map(|axis| axis.len()).min().unwrap_or(0);
        for light in self.lights.iter_mut().filter(|light| !light.keeps.points) {
            light.at_points.resize(count, 1.0);
        }
        for axis in &mut self.asked {
            axis.resize(count.min(POINTS_AT_ONCE), 0.0);
        }
        for from in (0..count).step_by(POINTS_AT_ONCE) {
            let until = (from + POINTS_AT_ONCE).min(count);
            let mut pieces: Vec<[&mut [f32]; MAX_LIGHTS]> = Vec::new();
            pieces.resize_with((until - from).div_ceil(POINTS_PER_PIECE), Default::default);
            let mut maps: [Option<&(dyn CpuShadow + Send + Sync)>; MAX_LIGHTS] = [None; MAX_LIGHTS];
            for (k, light) in self.lights.iter_mut().enumerate().filter(|(_, light)| !light.keeps.points) {
                let LightShadow { shadow, at_points, .. } = light;
                maps[k] = Some(&**shadow);
                let answers = at_points[from..until].chunks_mut(POINTS_PER_PIECE);
                pieces.iter_mut().zip(answers).for_each(|(piece, answers)| piece[k] = answers);
            }
            let [x, y, z] = &mut self.asked;
            pieces
                .par_iter_mut()
                .zip(x.par_chunks_mut(POINTS_PER_PIECE))
                .zip(y.par_chunks_mut(POINTS_PER_PIECE))
                .zip(z.par_chunks_mut(POINTS_PER_PIECE))
                .enumerate()
                .for_each(|(piece, (((answers, x), y), z))| {
                    let start = from + piece * POINTS_PER_PIECE;
                    let mut moved = [x, y, z].map(|axis| &mut axis[..(until - start).min(POINTS_PER_PIECE)]);
                    for (axis, (asked, positions)) in moved.iter_mut().zip(positions).enumerate() {
                        moved_apart(positions, (axis, start), points, reach, asked);
                    }
                    let [x, y, z] = moved;
                    for (map, answers) in maps.iter().zip(answers) {
                        if let Some(map) = map {
                            map.transmittance_at(x, y, z, answers);
                        }
                    }
                });
        }
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

/// Points that are looked up together at places of their own, and those of a task.
const POINTS_AT_ONCE: usize = 1 << 18;
const POINTS_PER_PIECE: usize = 4096;

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
