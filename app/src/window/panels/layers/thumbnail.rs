//! Small pictures of masks: the head from above.

use std::collections::HashMap;

use egui::epaint::{Mesh, Vertex, WHITE_UV};
use egui::{Color32, Pos2, Rect, vec2};
use glam::Vec3;
use lovelock_style::{HeadBox, Mask};

/// Rings and sectors of a picture.
const RINGS: usize = 7;
const SECTORS: usize = 20;
/// Angle from the top of the head that the edge of a picture shows, radians: hair below the ears is seen as well.
const EDGE: f32 = 2.0;

/// The pictures of masks, kept until the masks change.
#[derive(Clone, Debug, Default)]
pub(super) struct Thumbnails {
    of: HashMap<u32, (Mask, Vec<u8>)>,
}

impl Thumbnails {
    /// The mask of layer `id` as a disk in `rect`, brighter where it is stronger; the face is at the top.
    pub(super) fn mesh(&mut self, id: u32, mask: &Mask, rect: Rect, alpha: f32) -> Mesh {
        let (of, values) = self.of.entry(id).or_insert_with(|| (mask.clone(), values(mask)));
        if of != mask {
            of.clone_from(mask);
            *values = self::values(mask);
        }
        disk(values, rect, alpha)
    }

    /// Forgets all masks but those of these layers.
    pub(super) fn keep(&mut self, is_there: impl Fn(u32) -> bool) {
        self.of.retain(|id, _| is_there(*id));
    }
}

/// The mask at the middle and then around each ring, 255 for 1.
fn values(mask: &Mask) -> Vec<u8> {
    // Places relative to a head are those on a head of this size.
    let head = HeadBox { middle: Vec3::ZERO, half: Vec3::ONE };
    let byte = |place: Vec3| (mask.at(&head, place).clamp(0.0, 1.0) * 255.0).round() as u8;
    let mut out = vec![byte(Vec3::Y)];
    for ring in 1..=RINGS {
        let (sin, cos) = (EDGE * ring as f32 / RINGS as f32).sin_cos();
        for sector in 0..SECTORS {
            let [x, y] = around(sector);
            // The wearer's left is at the left.
            out.push(byte(Vec3::new(-x * sin, cos, -y * sin)));
        }
    }
    out
}

/// The direction of a sector on the screen, where y points down.
fn around(sector: usize) -> [f32; 2] {
    let (sin, cos) = (std::f32::consts::TAU * sector as f32 / SECTORS as f32).sin_cos();
    [sin, -cos]
}

fn disk(values: &[u8], rect: Rect, alpha: f32) -> Mesh {
    let mut mesh = Mesh::default();
    let radius = 0.5 * rect.width().min(rect.height());
    let mut vertex = |pos: Pos2, value: u8| {
        let color = Color32::from_gray(value).gamma_multiply(alpha);
        mesh.vertices.push(Vertex { pos, uv: WHITE_UV, color });
    };
    vertex(rect.center(), values[0]);
    for ring in 1..=RINGS {
        let out = radius * ring as f32 / RINGS as f32;
        for sector in 0..SECTORS {
            let [x, y] = around(sector);
            vertex(rect.center() + vec2(x, y) * out, values[1 + (ring - 1) * SECTORS + sector]);
        }
    }
    let at = |ring: usize, sector: usize| (1 + ring * SECTORS + sector % SECTORS) as u32;
    for sector in 0..SECTORS {
        mesh.add_triangle(0, at(0, sector), at(0, sector + 1));
        for ring in 1..RINGS {
            let [a, b] = [at(ring - 1, sector), at(ring - 1, sector + 1)];
            let [c, d] = [at(ring, sector), at(ring, sector + 1)];
            mesh.add_triangle(a, c, d);
            mesh.add_triangle(a, d, b);
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use lovelock_style::{MaskPart, MaskRegion};

    use super::*;

    /// The brightness of the corner of a picture's mesh that is nearest to a place, from -1 to 1 across it.
    fn at(mesh: &Mesh, x: f32, y: f32) -> u8 {
        let near = mesh.vertices.iter().min_by(|a, b| {
            let distance = |v: &Vertex| v.pos.distance(egui::pos2(12.0 + 12.0 * x, 12.0 + 12.0 * y));
            distance(a).total_cmp(&distance(b))
        });
        near.expect("a vertex").color.r()
    }

    #[test]
    fn regions_are_bright_where_they_lie_from_above() {
        let rect = Rect::from_min_size(Pos2::ZERO, vec2(24.0, 24.0));
        let mut thumbnails = Thumbnails::default();
        let sides = [[0.0, -0.6], [0.0, 0.6], [-0.6, 0.0], [0.6, 0.0]];
        let mut bright = |mask: &Mask| {
            let mesh = thumbnails.mesh(3, mask, rect, 1.0);
            sides.map(|[x, y]| at(&mesh, x, y))
        };
        assert_eq!(bright(&Mask::default()), [255; 4], "white without a mask");
        let of = |region| Mask::of(MaskPart::region(region));
        // Half is 127 or 128, by the rounding of the middle of the head.
        let near = |found: [u8; 4], wanted: [u8; 4]| {
            assert!(found.iter().zip(&wanted).all(|(a, b)| a.abs_diff(*b) <= 1), "{found:?} {wanted:?}");
        };
        near(bright(&of(MaskRegion::Front)), [255, 0, 128, 128]);
        near(bright(&of(MaskRegion::Left)), [128, 128, 255, 0]);
        assert_eq!(bright(&of(MaskRegion::Nape))[0], 0);
        thumbnails.keep(|_| false);
        assert!(thumbnails.of.is_empty());
    }
}
