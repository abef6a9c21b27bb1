//! Light from all directions inside hair: a coarse grid of how much of it hair and head let through.
//!
//! The guides are spread into cells as fibres per metre. Running sums along the six axes give the fibres between a cell and the outside,
//! and the radiance that arrives from a direction falls with them by the two-flux rate of diffuse light (see
//! [`lovelock_appearance::fibre::ManyRow`]). A cell holds the mean over the six directions, so a point of hair only reads eight cells.
//! Both backends use the same grid.

use std::ops::Range;

use glam::{Vec3, Vec3A};
use lovelock_appearance::environment::{Environment, Surround};
use lovelock_appearance::fibre::{CosineStep, FibreTables, arithmetic};
use lovelock_base::memory::list_bytes;
use rayon::prelude::*;

use crate::{FrameInput, HairPose};

/// Cells along each edge.
pub(crate) const CELLS: usize = 32;
/// All cells.
const ALL: usize = CELLS * CELLS * CELLS;
/// From a cell to the one beside it on all three axes.
const LAST_CORNER: usize = CELLS * CELLS + CELLS + 1;
/// The smallest cell, metres.
const SMALLEST_CELL: f32 = 0.012;
/// Cells beside the hair on each side.
const MARGIN: f32 = 1.5;
/// The head as an ellipsoid in head space, metres: centre and radii, a little inside of the skin of an adult. It is the same for all bodies.
const HEAD: (Vec3, Vec3) = (Vec3::new(0.0, 0.09, 0.012), Vec3::new(0.062, 0.10, 0.08));
/// Optical depth of a metre of head.
const HEAD_DEPTH: f32 = 200.0;
/// Optical depth of a crossed fibre for the light on skin.
const SKIN_RATE: f32 = 0.35;
/// The most given strands that are spread; of more, every second, third … one is.
const MAX_STRANDS: usize = 4000;
/// The eye's cosine for which light is lost on its way through hair.
const USUAL_COSINE: f32 = 0.9;

/// Sky and ground of the default surroundings, before their brightness.
const SKY: Vec3 = Vec3::new(0.62, 0.68, 0.78);
const EARTH: Vec3 = Vec3::new(0.36, 0.33, 0.31);
/// Brightness of a picture of the surroundings at an ambient light of 0.5.
const PICTURE_BRIGHTNESS: f32 = 2.0;

/// The light from all directions of a picture: for surfaces, and from the six axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Surroundings {
    pub surround: Surround,
    pub axes: [Vec3; 6],
}

impl Surroundings {
    /// That of `input`.
    pub fn new(input: &FrameInput) -> Self {
        let picture = input.picture;
        let ambient = if picture.ambient.is_finite() { picture.ambient.max(0.0) } else { 0.0 };
        let (environment, brightness, turn) = match input.surroundings {
            Some(panorama) => (
                Environment::Picture(panorama.clone()),
                PICTURE_BRIGHTNESS * ambient,
                picture.surroundings_turn,
            ),
            None => (Environment::SkyAndGround { sky: SKY, ground: EARTH }, 0.5 * ambient, 0.0),
        };
        let turn = if turn.is_finite() { turn } else { 0.0 };
        Self {
            surround: environment.surround(turn).scaled(brightness),
            axes: environment.axis_radiance(turn).map(|radiance| radiance * brightness),
        }
    }
}

/// The grid of one frame.
#[derive(Clone, Debug)]
pub(crate) struct AmbientGrid {
    /// The corner of the grid, metres in world space.
    pub origin: Vec3,
    /// The edge of a cell, metres.
    pub cell: f32,
    /// Red, green and blue that arrive at hair in a cell, and the share of light that arrives at skin; x fastest.
    pub cells: Vec<[f32; 4]>,
    /// Fibres, and optical depth of the head, across a cell.
    fibres: Vec<f32>,
    solid: Vec<f32>,
    blurred: Vec<f32>,
    /// Light of one axis, line after line.
    by_line: Vec<[[f32; 4]; CELLS]>,
    /// The points of each line of hair, and the share of all hair that it stands for.
    hair: Vec<(Range<usize>, f32)>,
}

impl Default for AmbientGrid {
    /// A grid that lets all light through, of which there is none.
    fn default() -> Self {
        Self {
            origin: Vec3::ZERO,
            cell: 1.0,
            cells: vec![[0.0, 0.0, 0.0, 1.0]; ALL],
            fibres: Vec::new(),
            solid: Vec::new(),
            blurred: Vec::new(),
            by_line: Vec::new(),
            hair: Vec::new(),
        }
    }
}

impl AmbientGrid {
    /// Its memory, bytes.
    pub fn bytes(&self) -> u64 {
        list_bytes(&self.cells)
            + [&self.fibres, &self.solid, &self.blurred].into_iter().map(list_bytes).sum::<u64>()
            + list_bytes(&self.by_line)
            + list_bytes(&self.hair)
    }

    /// Builds the grid.
    pub fn build(&mut self, input: &FrameInput, surroundings: &Surroundings, tables: &FibreTables) {
        let points = HairPoints::new(input, std::mem::take(&mut self.hair));
        self.build_from(&points, input, surroundings, tables);
        self.hair = points.lines;
    }

    fn build_from(
        &mut self,
        points: &HairPoints,
        input: &FrameInput,
        surroundings: &Surroundings,
        tables: &FibreTables,
    ) {
        let (low, high) = points.bounds();
        if low.x > high.x {
            // Without hair everything is open.
            (self.origin, self.cell) = (Vec3::ZERO, 1.0);
            let open = surroundings.axes.iter().sum::<Vec3>() / 6.0;
            self.cells.clear();
            self.cells.resize(ALL, [open.x, open.y, open.z, 1.0]);
            return;
        }
        let widest = (high - low).max_element();
        self.cell = (widest / (CELLS as f32 - 2.0 * MARGIN)).max(SMALLEST_CELL);
        self.origin = 0.5 * (low + high) - Vec3::splat(0.5 * CELLS as f32 * self.cell);
        self.deposit(points, input);
        self.add_head(input);
        self.light(input, surroundings, tables);
    }

    /// Spreads the hair: fibres across a cell are the sum of their widths times lengths times pi/4 over the area of its face.
    fn deposit(&mut self, points: &HairPoints, input: &FrameInput) {
        self.fibres.clear();
        self.fibres.resize(ALL, 0.0);
        let inverse = 1.0 / self.cell;
        let face = std::f32::consts::FRAC_PI_4 * inverse * inverse;
        points.each_segment(|a, b, share| {
            let length = a.distance(b);
            let pieces = ((length * inverse).ceil() as usize).clamp(1, 8);
            let each = input.look.diameter * input.look.real_hairs * share * length * face / pieces as f32;
            for k in 0..pieces {
                let at = a.lerp(b, (k as f32 + 0.5) / pieces as f32);
                let of = ((at - self.origin) * inverse).max(Vec3::ZERO);
                let of = [of.x, of.y, of.z].map(|c| (c as usize).min(CELLS - 1));
                if each.is_finite() {
                    self.fibres[of[0] + CELLS * (of[1] + CELLS * of[2])] += each;
                }
            }
        });
        // A wisp is one or two cells wide.
        for stride in [1, CELLS, CELLS * CELLS] {
            self.blurred.clear();
            self.blurred.resize(ALL, 0.0);
            let from = &self.fibres;
            self.blurred.par_chunks_mut(CELLS * CELLS).enumerate().for_each(|(z, slice)| {
                for (i, out) in slice.iter_mut().enumerate() {
                    let at = z * CELLS * CELLS + i;
                    let along = at / stride % CELLS;
                    let before = if along > 0 { from[at - stride] } else { 0.0 };
                    let after = if along + 1 < CELLS { from[at + stride] } else { 0.0 };
                    *out = 0.25 * before + 0.5 * from[at] + 0.25 * after;
                }
            });
            std::mem::swap(&mut self.fibres, &mut self.blurred);
        }
    }

    /// Marks the head, which lets nothing through.
    fn add_head(&mut self, input: &FrameInput) {
        self.solid.clear();
        self.solid.resize(ALL, 0.0);
        if input.body.is_none() {
            return;
        }
        let head_from_world = input.world_from_head.inverse();
        let (centre, radii) = HEAD;
        let (origin, cell) = (self.origin, self.cell);
        self.solid.par_chunks_mut(CELLS * CELLS).enumerate().for_each(|(z, slice)| {
            for (i, out) in slice.iter_mut().enumerate() {
                let at = Vec3::new((i % CELLS) as f32, (i / CELLS) as f32, z as f32) + 0.5;
                let p = head_from_world.transform_point3(origin + at * cell);
                if ((p - centre) / radii).length_squared() < 1.0 {
                    *out = HEAD_DEPTH * cell;
                }
            }
        });
    }

    /// The light that arrives in every cell from the six directions.
    fn light(&mut self, input: &FrameInput, surroundings: &Surroundings, tables: &FibreTables) {
        let absorption = input.style.strands.colours.mean().absorption(input.look.absorption());
        let eye = CosineStep::new(USUAL_COSINE);
        let rates = absorption.to_array().map(|sigma| tables.many.row(eye, sigma)[6]);
        self.cells.clear();
        self.cells.resize(ALL, [0.0; 4]);
        let (fibres, solid) = (&self.fibres, &self.solid);
        // Lines along x, y and z, each from both ends. The sums of a direction are the same for any number of threads.
        for (axis, stride) in [(0, 1), (1, CELLS), (2, CELLS * CELLS)] {
            let first_of = |line: usize| match axis {
                0 => line * CELLS,
                1 => line / CELLS * CELLS * CELLS + line % CELLS,
                _ => line,
            };
            let of_line = |line: usize| {
                let first = first_of(line);
                let mut out = [[0.0_f32; 4]; CELLS];
                for (side, radiance) in
                    [surroundings.axes[2 * axis], surroundings.axes[2 * axis + 1]].into_iter().enumerate()
                {
                    let (mut crossed, mut blocked) = (0.0, 0.0);
                    for step in 0..CELLS {
                        // Light from the positive end comes in there.
                        let k = if side == 0 { CELLS - 1 - step } else { step };
                        let at = first + k * stride;
                        // The hair of the cell itself does not count: most of what the eye sees of it lies at its surface.
                        let (n, head) = (crossed, blocked);
                        for c in 0..3 {
                            out[k][c] += radiance[c] * (1.0 / 6.0) * arithmetic::exp(-n * rates[c] - head);
                        }
                        out[k][3] += (1.0 / 6.0) * arithmetic::exp(-n * SKIN_RATE);
                        crossed += fibres[at];
                        blocked += solid[at];
                    }
                }
                out
            };
            (0..CELLS * CELLS).into_par_iter().map(of_line).collect_into_vec(&mut self.by_line);
            for (line, lit) in self.by_line.iter().enumerate() {
                let first = first_of(line);
                for (k, light) in lit.iter().enumerate() {
                    let cell = &mut self.cells[first + k * stride];
                    for c in 0..4 {
                        cell[c] += light[c];
                    }
                }
            }
        }
    }

    /// The light at a position: red, green and blue that arrive at hair, and the share that arrives at skin.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    pub fn at(&self, p: [f32; 3]) -> [f32; 4] {
        let inverse = 1.0 / self.cell;
        let most = (CELLS - 1) as f32;
        let place =
            |axis: usize| arithmetic::clamp((p[axis] - self.origin[axis]) * inverse - 0.5, 0.0, most - 1e-3);
        let (x, y, z) = (place(0), place(1), place(2));
        let (i, j, k) = (x as usize, y as usize, z as usize);
        let (fx, fy, fz) = (x - i as f32, y - j as f32, z - k as f32);
        let first = i + CELLS * (j + CELLS * k);
        let mut out = [0.0; 4];
        // One comparison in place of eight.
        let Some(cells) = self.cells.get(first..first + LAST_CORNER + 1) else { return out };
        for (offset, weight) in [
            (0, (1.0 - fx) * (1.0 - fy) * (1.0 - fz)),
            (1, fx * (1.0 - fy) * (1.0 - fz)),
            (CELLS, (1.0 - fx) * fy * (1.0 - fz)),
            (CELLS + 1, fx * fy * (1.0 - fz)),
            (CELLS * CELLS, (1.0 - fx) * (1.0 - fy) * fz),
            (CELLS * CELLS + 1, fx * (1.0 - fy) * fz),
            (CELLS * CELLS + CELLS, (1.0 - fx) * fy * fz),
            (LAST_CORNER, fx * fy * fz),
        ] {
            let cell = &cells[offset];
            for c in 0..4 {
                out[c] += weight * cell[c];
            }
        }
        out
    }
}

/// The hair of a frame as lines that stand for shares of all hair.
struct HairPoints<'a> {
    axes: [&'a [f32]; 3],
    /// The points of each line, and the share of all hair that it stands for.
    lines: Vec<(Range<usize>, f32)>,
}

impl<'a> HairPoints<'a> {
    /// The hair of `input`, in the memory of `lines`.
    fn new(input: &FrameInput<'a>, mut lines: Vec<(Range<usize>, f32)>) -> Self {
        lines.clear();
        let all = input.style.strands.count().max(1) as f32;
        let guides = input.hair.guides().or(input.guides);
        match (guides, input.hair) {
            (Some(frame), _) | (None, HairPose::Guides(frame) | HairPose::Resident(frame, _)) => {
                let guides = &frame.guides;
                let points = guides.points_per_guide;
                let known = guides.x.len().min(guides.y.len()).min(guides.z.len());
                for wisp in &input.style.wisps {
                    let share = wisp.strand_count as f32 / (3.0 * all);
                    let of = wisp.guides.map(|guide| guide as usize * points..(guide as usize + 1) * points);
                    lines.extend(of.into_iter().filter(|line| line.end <= known).map(|line| (line, share)));
                }
                Self { axes: [&guides.x, &guides.y, &guides.z], lines }
            }
            (None, HairPose::Strands(strands)) => {
                let every = strands.count().div_ceil(MAX_STRANDS).max(1);
                let known = strands.x.len().min(strands.y.len()).min(strands.z.len());
                let ends = strands.first_point.windows(2).step_by(every);
                let of = ends.map(|ends| ends[0] as usize..ends[1] as usize);
                lines.extend(
                    of.filter(|line| line.start <= line.end && line.end <= known).map(|line| (line, 1.0)),
                );
                let share = 1.0 / lines.len().max(1) as f32;
                for line in &mut lines {
                    line.1 = share;
                }
                Self { axes: [&strands.x, &strands.y, &strands.z], lines }
            }
        }
    }

    fn point(&self, i: usize) -> Vec3 {
        Vec3::new(self.axes[0][i], self.axes[1][i], self.axes[2][i])
    }

    fn bounds(&self) -> (Vec3, Vec3) {
        let (mut low, mut high) = (Vec3A::INFINITY, Vec3A::NEG_INFINITY);
        for (line, _) in &self.lines {
            for p in line.clone().map(|i| Vec3A::from(self.point(i))).filter(|p| p.is_finite()) {
                (low, high) = (low.min(p), high.max(p));
            }
        }
        (low.into(), high.into())
    }

    fn each_segment(&self, mut of: impl FnMut(Vec3, Vec3, f32)) {
        for (line, share) in &self.lines {
            for i in line.clone().skip(1) {
                let (a, b) = (self.point(i - 1), self.point(i));
                if a.is_finite() && b.is_finite() {
                    of(a, b, *share);
                }
            }
        }
    }
}
