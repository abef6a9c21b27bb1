//! The colours of a mask where they differ from those that the image shows, so that paint is seen at once.

use egui::epaint::{Mesh, Vertex, WHITE_UV};
use egui::{Color32, Pos2, Shape, Stroke};
use glam::Vec3;
use lovelock_session::render_thread::{RenderedImage, ShownMask};
use lovelock_style::{HeadBox, Mask};

use super::View;
use super::head::Head;
use super::pick::SeenHair;
use crate::window::theme;

/// Values that differ by less look the same.
const SAME: f32 = 0.02;
/// Width of a strand, points.
const WIDTH: f32 = 2.5;
/// Brightness of the colours: about that which light and shadow leave them in the image.
const LIGHT: f32 = 0.85;
/// Hair this far before the scalp hides it, metres.
const HIDES: f32 = 0.006;

/// The shapes of hair and scalp whose value of `mask` is not what the image shows.
pub(crate) fn changed(
    view: View,
    head: Head<'_>,
    seen: &mut SeenHair,
    image: &RenderedImage,
    mask: &ShownMask,
) -> Vec<Shape> {
    let before: Option<&Mask> = image.mask.as_deref().map(|shown| &shown.mask);
    if before == Some(&mask.mask) {
        return Vec::new();
    }
    let head_box = HeadBox::of(&image.snapshot.scene.style.scalp);
    let color = |place: Vec3| {
        let value = mask.mask.at(&head_box, place);
        let is_new = before.is_none_or(|before| (before.at(&head_box, place) - value).abs() > SAME);
        (color_of(mask, value), is_new)
    };
    let mut shapes = vec![Shape::mesh(scalp(view, head, seen, image, &color))];
    let mut line = |root: Vec3, points: Vec<Pos2>| {
        shapes.push(Shape::line(points, Stroke::new(WIDTH, color(root).0)));
    };
    seen.strands_in_front(view, &image.snapshot, |root| color(root).1, &mut line);
    shapes
}

fn color_of(mask: &ShownMask, value: f32) -> Color32 {
    let [low, high] = mask.scale.range;
    let place = ((value - low) / (high - low)).clamp(0.0, 1.0) * 255.0;
    theme::from_srgb(mask.scale.colors[place.round() as usize].map(|v| (f32::from(v) * LIGHT) as u8))
}

/// The triangles of the scalp that no hair hides and whose colour is new.
fn scalp(
    view: View,
    head: Head<'_>,
    seen: &mut SeenHair,
    image: &RenderedImage,
    color: &dyn Fn(Vec3) -> (Color32, bool),
) -> Mesh {
    let scalp = head.scalp;
    let mut mesh = Mesh::default();
    let hairy = |v: usize| scalp.mask.get(v).is_some_and(|mask| *mask >= 0.5);
    let colors: Vec<(Color32, bool)> = scalp.positions.iter().map(|p| color(*p)).collect();
    for triangle in &scalp.triangles {
        let corners = triangle.map(|v| v as usize);
        let is_new = corners.iter().all(|v| hairy(*v)) && corners.iter().any(|v| colors[*v].1);
        let places = corners.map(|v| view.to_screen_and_depth(head.world(scalp.positions[v])));
        let [Some(a), Some(b), Some(c)] = places.map(|place| place.filter(|_| is_new)) else { continue };
        let (ab, ac) = (b.0 - a.0, c.0 - a.0);
        // Others face away.
        if ab.x * ac.y - ab.y * ac.x >= 0.0 {
            continue;
        }
        let middle = a.0 + (ab + ac) / 3.0;
        if seen.depth_at(view, &image.snapshot, middle) < (a.1 + b.1 + c.1) / 3.0 - HIDES {
            continue;
        }
        let first = mesh.vertices.len() as u32;
        for (v, (pos, _)) in corners.into_iter().zip([a, b, c]) {
            mesh.vertices.push(Vertex { pos, uv: WHITE_UV, color: colors[v].0 });
        }
        mesh.indices.extend([first, first + 1, first + 2]);
    }
    mesh
}
