//! Strands as a plane of a light sees them.

use std::sync::Arc;

use glam::Vec3;
use lovelock_groom::Strands;
use rayon::prelude::*;

use super::Face;
use crate::{LightFrame, ProjectedStrands, ShadowInput};

/// Strands per parallel task.
const STRANDS_PER_TASK: usize = 256;

/// Projected strands, each a single segment of one, or a single point. Points have widths.
#[derive(Clone, Debug, Default)]
pub(crate) struct Projected {
    strands: Strands,
    widths: Vec<f32>,
    longest_strand: f32,
}

impl Projected {
    /// Projects all strands of `input` onto a plane: what it sees of the segments between their points, or only the points. The order is
    /// that of the strands.
    pub fn new(input: &ShadowInput, face: &Face, longest_strand: f32, only_points: bool) -> Self {
        let count = input.strands.count();
        let tasks = count.div_ceil(STRANDS_PER_TASK);
        let parts: Vec<Part> = (0..tasks)
            .into_par_iter()
            .map(|task| {
                let first = task * STRANDS_PER_TASK;
                let mut part = Part::default();
                for strand in first..(first + STRANDS_PER_TASK).min(count) {
                    part.add(input.strands, strand, face, only_points);
                }
                part
            })
            .collect();
        let points = parts.iter().map(|part| part.points.len()).sum();
        let mut strands = Strands::default();
        for axis in [&mut strands.x, &mut strands.y, &mut strands.z] {
            axis.reserve_exact(points);
        }
        let mut widths = Vec::with_capacity(points);
        for Part { points, widths: more } in parts {
            strands.x.extend(points.iter().map(|p| p.x));
            strands.y.extend(points.iter().map(|p| p.y));
            strands.z.extend(points.iter().map(|p| p.z));
            widths.extend(more);
        }
        let each = if only_points { 1 } else { 2 };
        strands.first_point = (0..=points as u32).step_by(each).collect::<Arc<[u32]>>();
        Self { strands, widths, longest_strand }
    }

    /// The input of a method whose light is parallel, one of `faces` maps of a light.
    pub fn input<'a>(&'a self, input: &ShadowInput, face: &Face, faces: u32) -> ShadowInput<'a> {
        let projected = ProjectedStrands {
            widths: &self.widths,
            bounds: face.bounds,
            longest_strand: self.longest_strand,
            plane: face.plane,
            start: face.offset.length(),
        };
        ShadowInput {
            strands: &self.strands,
            strand_width: input.strand_width,
            extinction_scale: input.extinction_scale,
            light: PARALLEL,
            anchor: Vec3::ZERO,
            maps: input.maps.max(1).saturating_mul(faces.max(1)),
            projected: Some(projected),
        }
    }
}

/// The axes of projected hair.
pub(crate) const PARALLEL: LightFrame = LightFrame::WORLD;

/// Some projected strands.
#[derive(Debug, Default)]
struct Part {
    points: Vec<Vec3>,
    widths: Vec<f32>,
}

impl Part {
    fn add(&mut self, strands: &Strands, strand: usize, face: &Face, only_points: bool) {
        let points = strands.first_point[strand] as usize..strands.first_point[strand + 1] as usize;
        if only_points {
            for point in points {
                let p = strands.point(point);
                let q = face.seen(p);
                // False for NaN.
                if face.sees(q) && q.length() >= face.radius {
                    self.points.push(face.project(p));
                    self.widths.push(face.narrowing(q));
                }
            }
            return;
        }
        for (a, b) in points.clone().zip(points.skip(1)) {
            self.add_segment(strands.point(a), strands.point(b), face);
        }
    }

    fn add_segment(&mut self, a: Vec3, b: Vec3, face: &Face) {
        let (from, to) = (face.seen(a), face.seen(b));
        let Some((first, last)) = face.clip(from, to) else { return };
        let at = |a: Vec3, b: Vec3, t: f32| if t >= 1.0 { b } else { a.lerp(b, t) };
        let ends = [first, last].map(|t| at(from, to, t));
        if ends[0].midpoint(ends[1]).length() < face.radius {
            return;
        }
        self.points.extend([first, last].map(|t| face.project(at(a, b, t))));
        self.widths.extend(ends.map(|end| face.widening(ends[0], ends[1], end)));
    }
}
