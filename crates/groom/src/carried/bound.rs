//! Strands that are bound to the triangles of a surface.

use std::sync::Arc;

use glam::{Mat3, Vec3};
use lovelock_base::memory::list_bytes;
use lovelock_base::random::SplitMix64;
use rayon::prelude::*;

use super::grow::{Halves, POINTS, strand_at};
use super::roots::{SkinRoot, roots_of};
use super::{SkinGroom, SkinSurface};
use crate::{COLOUR_SAMPLES, Guides, Hairstyle, StrandColours, StrandSet, Strands};

/// The most strands of one groom.
const MAX_STRANDS: f32 = 50_000.0;
/// The most vertices of a mask.
const MAX_MARKED: usize = 100_000;
/// The least value of a mask on a vertex that is in it.
const MARKED: f32 = 0.5;
/// Strands that are placed by one task.
const STRANDS_PER_TASK: usize = 512;
/// Points of those.
const PIECE: usize = STRANDS_PER_TASK * POINTS;

/// Whether a mask on the vertices of a body marks a part of it on which hair of the skin can grow: at most half of its vertices and at
/// most 100,000. A mask of all vertices is an error of the file.
pub fn is_mask_of_hair(mask: &[f32]) -> bool {
    let marked = mask.iter().filter(|value| **value >= MARKED).count();
    marked <= MAX_MARKED && marked <= mask.len() / 2
}

/// Hair that grows on the skin of one body.
#[derive(Clone, Debug)]
pub struct SkinHair {
    /// The strands with what does not change from instant to instant: taper, shade and colours. There are no guides.
    pub style: Arc<Hairstyle>,
    /// Width of the widest strand at its root, metres; tapers are fractions of it.
    pub width: f32,
    first_point: Arc<[u32]>,
    /// The corners of the triangle of each strand.
    triangles: Vec<[u32; 3]>,
    /// The weights of those corners at the root.
    weights: Vec<[f32; 3]>,
    /// The points of all strands relative to their root, in the frame of the triangle.
    points: Vec<Vec3>,
}

impl SkinHair {
    /// Grows `grooms` on a surface. `mask` returns the mask of a name, one value per vertex. `scale` is the size of the head as a multiple
    /// of the shipped dancer's. `None` if nothing grows; nothing does where [`is_mask_of_hair`] says no.
    ///
    /// The same surface, masks and grooms give the same strands; more of a groom begin with the same ones.
    pub fn grow<'m>(
        surface: &SkinSurface,
        grooms: &[SkinGroom],
        mask: impl Fn(&str) -> Option<&'m [f32]>,
        scale: f32,
    ) -> Option<Self> {
        let mut hair = Self {
            style: Arc::default(),
            width: grooms.iter().map(|groom| groom.width * scale).fold(0.0, f32::max),
            first_point: Arc::default(),
            triangles: Vec::new(),
            weights: Vec::new(),
            points: Vec::new(),
        };
        let mut set = StrandSet { first_point: vec![0], ..StrandSet::default() };
        let mut colours = Vec::new();
        for (g, groom) in grooms.iter().enumerate() {
            let Some(mask) = mask(groom.mask).filter(|mask| is_mask_of_hair(mask)) else { continue };
            let count = if groom.strands > 0.0 { groom.strands.min(MAX_STRANDS).round() as usize } else { 0 };
            let halves = Halves::of(surface, mask);
            let mut of_roots = SplitMix64::of_stream(0x5c1_0000 + g as u32, 0);
            let roots = roots_of(surface, mask, (groom.roots, count), &mut of_roots);
            for (i, root) in roots.into_iter().enumerate() {
                let mut random = SplitMix64::of_stream(0x5c1_0000 + g as u32, 1 + i as u64);
                let Some(points) = strand_at(surface, (groom, &halves), root, scale, &mut random) else {
                    continue;
                };
                if hair.bind(surface, root, &points).is_none() {
                    continue;
                }
                let widest = groom.width * scale / hair.width.max(1e-9);
                set.taper.extend((0..POINTS).map(|k| {
                    let t = k as f32 / (POINTS - 1) as f32;
                    widest * (1.0 - (1.0 - groom.tip) * t * t.sqrt())
                }));
                set.shade.push(random.unit());
                set.wisp.push(0);
                set.weights.push([1.0, 0.0, 0.0]);
                set.first_point.push(hair.points.len() as u32);
                colours.push([groom.colour; COLOUR_SAMPLES]);
            }
        }
        if hair.triangles.is_empty() {
            return None;
        }
        set.guide_param = vec![0.0; hair.points.len()];
        set.colours = StrandColours::new(colours);
        hair.first_point = set.first_point.as_slice().into();
        let guides = Guides { points_per_guide: 2, ..Guides::default() };
        hair.style = Arc::new(Hairstyle {
            name: "hair of the skin".to_owned(),
            strands: set,
            guides,
            ..Hairstyle::default()
        });
        Some(hair)
    }

    /// Adds a strand with these points; `None` if its triangle has no area.
    fn bind(&mut self, surface: &SkinSurface, root: SkinRoot, points: &[Vec3; POINTS]) -> Option<()> {
        let triangle = *surface.triangles.get(root.triangle)?;
        let world_from_triangle = frame_of(surface.corners(triangle)?)?;
        let triangle_from_world = world_from_triangle.transpose();
        let relative = points.map(|p| triangle_from_world * (p - points[0]));
        if !relative.iter().all(|p| p.is_finite()) {
            return None;
        }
        self.triangles.push(triangle);
        self.weights.push(root.weights);
        self.points.extend(relative);
        Some(())
    }

    /// Number of strands.
    pub fn count(&self) -> usize {
        self.triangles.len()
    }

    /// Its memory, bytes.
    pub fn bytes(&self) -> u64 {
        self.style.bytes()
            + list_bytes(&self.triangles)
            + list_bytes(&self.weights)
            + list_bytes(&self.points)
            + 4 * self.first_point.len() as u64
    }

    /// Writes the strands on the surface of an instant, world space, whose vertices are those of the surface at rest. A strand whose
    /// triangle has no area lies at its root. The result does not depend on the number of threads.
    pub fn place(&self, positions: &[Vec3], out: &mut Strands) {
        if !Arc::ptr_eq(&out.first_point, &self.first_point) {
            out.first_point = Arc::clone(&self.first_point);
        }
        for axis in [&mut out.x, &mut out.y, &mut out.z] {
            axis.resize(self.points.len(), 0.0);
        }
        out.x
            .par_chunks_mut(PIECE)
            .zip(out.y.par_chunks_mut(PIECE))
            .zip(out.z.par_chunks_mut(PIECE))
            .enumerate()
            .for_each(|(piece, ((x, y), z))| {
                let strands = x.chunks_mut(POINTS).zip(y.chunks_mut(POINTS)).zip(z.chunks_mut(POINTS));
                for (i, ((x, y), z)) in strands.enumerate() {
                    let strand = piece * STRANDS_PER_TASK + i;
                    let own = &self.points[strand * POINTS..(strand + 1) * POINTS];
                    let (root, frame) = self.placed_frame(strand, positions);
                    for (k, p) in own.iter().map(|p| root + frame * *p).enumerate() {
                        (x[k], y[k], z[k]) = (p.x, p.y, p.z);
                    }
                }
            });
    }

    /// The root of a strand on a surface, and the axes of its triangle; none without an area.
    fn placed_frame(&self, strand: usize, positions: &[Vec3]) -> (Vec3, Mat3) {
        let corners = self.triangles[strand].map(|i| positions.get(i as usize).copied().unwrap_or(Vec3::NAN));
        let root = (0..3).map(|k| corners[k] * self.weights[strand][k]).sum();
        (root, frame_of(corners).unwrap_or(Mat3::ZERO))
    }
}

/// The axes of a triangle: along its first edge, across it, and its normal; `None` without an area.
fn frame_of([a, b, c]: [Vec3; 3]) -> Option<Mat3> {
    let along = (b - a).try_normalize()?;
    let normal = along.cross(c - a).try_normalize()?;
    Some(Mat3::from_cols(along, normal.cross(along), normal))
}
