//! Depth of field: cameras at places of an aperture, whose images are averaged.

use glam::{Affine3A, Vec2, Vec3};
use lovelock_motion::{Body, Region, Skull};
use lovelock_project::project::{CameraSection, FocusOn};
use lovelock_render::Camera;

/// The nearest plane that a lens can be focused on, metres.
const NEAREST: f32 = 0.05;
/// Where a face is on a skull: in its middle, a little below the widest part, at the front.
const FACE: Vec3 = Vec3::new(0.0, -0.2, 1.0);

/// What a lens may be focused on.
pub(crate) struct Figure<'a> {
    pub body: &'a Body,
    /// Of the vertices of its surface, world space.
    pub positions: &'a [Vec3],
    pub world_from_head: Affine3A,
    pub skull: Option<Skull>,
}

/// A lens that is focused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Radius of the aperture, metres.
    pub radius: f32,
    /// Distance of the plane in focus along the camera's axis, metres.
    pub focus: f32,
}

impl Lens {
    /// The lens of a camera before a figure; `None` if it has no depth of field.
    pub(crate) fn of(section: &CameraSection, camera: &Camera, figure: &Figure<'_>) -> Option<Self> {
        let lens = &section.lens;
        if !lens.enabled {
            return None;
        }
        let axis = (camera.target - camera.eye).normalize_or(Vec3::NEG_Z);
        let along = |p: Vec3| (p - camera.eye).dot(axis);
        let focus = match lens.focus {
            FocusOn::Distance => lens.distance,
            FocusOn::Target => along(camera.target),
            FocusOn::Eyes => nearest_eye(figure, along),
        };
        let focus = if focus.is_finite() { focus.max(NEAREST) } else { along(camera.target).max(NEAREST) };
        Some(Self { radius: lens.radius(camera.fov_y), focus })
    }

    /// The camera of sample `index`: at the middle of the aperture first, then at places that fill it evenly, however many there are.
    #[must_use]
    pub fn camera(&self, camera: &Camera, index: u32) -> Camera {
        camera.through(self.radius * place(index), self.focus)
    }
}

/// A place in a disc of radius 1: points of Halton's sequence for the bases 2 and 3, which the area of the disc is mapped to.
fn place(index: u32) -> Vec2 {
    Vec2::from_angle(std::f32::consts::TAU * radical(index, 3)) * radical(index, 2).sqrt()
}

/// The digits of a number in a base, mirrored at the point (van der Corput).
pub(crate) fn radical(index: u32, base: u32) -> f32 {
    let (mut rest, mut digit, mut sum) = (index, 1.0, 0.0);
    while rest > 0 {
        digit /= base as f32;
        sum += digit * (rest % base) as f32;
        rest /= base;
    }
    sum
}

/// How far along the axis the nearer eye is; the front of the head of a figure without eyes.
fn nearest_eye(figure: &Figure<'_>, along: impl Fn(Vec3) -> f32) -> f32 {
    let eyes = eye_vertices(figure.body);
    let nearest = eyes.filter_map(|vertex| figure.positions.get(vertex as usize)).map(|&p| along(p));
    let nearest = nearest.fold(f32::INFINITY, f32::min);
    if nearest.is_finite() {
        return nearest;
    }
    let face = figure.skull.map_or(Vec3::ZERO, |skull| skull.place(FACE));
    along(figure.world_from_head.transform_point3(face))
}

/// The corners of the triangles whose material is that of eyes.
fn eye_vertices(body: &Body) -> impl Iterator<Item = u32> + '_ {
    let of_eyes = |material: &u16| {
        body.materials.get(usize::from(*material)).is_some_and(|material| material.region == Region::Eye)
    };
    let mesh = &body.mesh;
    let triangles = mesh.triangles.iter().zip(&mesh.materials).filter(move |(_, material)| of_eyes(material));
    triangles.flat_map(|(triangle, _)| *triangle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_fill_the_aperture_evenly() {
        let all: Vec<Vec2> = (0..64).map(place).collect();
        assert_eq!(all[0], Vec2::ZERO);
        assert!(all.iter().all(|p| p.length() <= 1.0));
        let mean = all.iter().sum::<Vec2>() / 64.0;
        assert!(mean.length() < 0.05, "{mean}");
        let inner = all.iter().filter(|p| p.length() < 0.5_f32.sqrt()).count();
        assert!((30..=34).contains(&inner), "half of the area has half of the samples: {inner}");
    }

    #[test]
    fn a_disc_of_samples_has_the_diameter_of_the_circle_of_confusion() {
        let camera = Camera { eye: Vec3::ZERO, target: Vec3::NEG_Z, fov_y: 0.4, shear: Vec2::ZERO };
        let lens = Lens { radius: 0.02, focus: 2.0 };
        let height = 1000;
        let spread = |depth: f32| {
            let pixel = |index| {
                let clip = lens.camera(&camera, index).clip_from_world(1.0);
                let p = clip.project_point3(Vec3::new(0.0, 0.0, -depth));
                Vec2::new(p.x, p.y) * 0.5 * height as f32
            };
            (0..512).map(|index| pixel(index).length()).fold(0.0, f32::max) * 2.0
        };
        // On paper: diameter of the aperture times |z - F| / z, in the plane in focus, and from there to pixels.
        for depth in [1.5_f32, 1.9, 2.2, 4.0] {
            let metres = 2.0 * lens.radius * (depth - lens.focus).abs() / depth;
            let truth = metres / lens.focus * camera.pixels_per_metre_at_one_metre(height);
            assert!((spread(depth) - truth).abs() < 0.03 * truth, "{depth}: {} {truth}", spread(depth));
        }
        assert!(spread(2.0) < 0.01, "in focus");
    }
}
