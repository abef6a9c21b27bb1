//! A mask in false colours: on hair by the mask at its root, and on the scalp.

use std::sync::Arc;

use glam::Vec3;
use lovelock_groom::{Hairstyle, Scalp};
use lovelock_motion::{Body, head_mesh};
use lovelock_render::ColorScale;
use lovelock_style::{HeadBox, Mask, strand_roots};
use rayon::prelude::*;

use crate::scene::Scene;

/// A mask that an image shows in place of the colours of hair.
#[derive(Clone, Debug, PartialEq)]
pub struct ShownMask {
    /// The mask.
    pub mask: Mask,
    /// The colours of its values, 0 to 1.
    pub scale: ColorScale,
}

/// What the image of a mask needs, kept while the mask, the hairstyle and the body stay.
#[derive(Debug, Default)]
pub(super) struct MaskView {
    of: Option<(Arc<ShownMask>, Arc<Hairstyle>, Arc<Body>)>,
    /// The mask at the root of each stored strand.
    pub values: Vec<f32>,
    painted: Option<Arc<Body>>,
    /// Which vertices of a body are those of its head.
    head: Option<(Arc<Body>, Vec<u32>)>,
}

impl MaskView {
    /// Makes this the view of a mask on a scene. Returns the body with the colours of the mask on its scalp.
    pub fn follow(&mut self, shown: &Arc<ShownMask>, scene: &Scene) -> Arc<Body> {
        let same = self.of.as_ref().is_some_and(|(mask, style, body)| {
            Arc::ptr_eq(mask, shown) && Arc::ptr_eq(style, &scene.style) && Arc::ptr_eq(body, &scene.body)
        });
        if let Some(painted) = self.painted.as_ref().filter(|_| same) {
            return Arc::clone(painted);
        }
        let head = HeadBox::of(&scene.style.scalp);
        let mask = &shown.mask;
        self.values = strand_roots(&scene.style).into_par_iter().map(|root| mask.at(&head, root)).collect();
        let known = self.head.as_ref().is_some_and(|(of, _)| Arc::ptr_eq(of, &scene.body));
        if !known {
            self.head = Some((Arc::clone(&scene.body), head_mesh(&scene.body).vertex));
        }
        let vertices = self.head.as_ref().map_or(&[][..], |(_, vertices)| vertices);
        let painted = Arc::new(painted(&scene.body, vertices, &scene.style.scalp, shown));
        self.of = Some((Arc::clone(shown), Arc::clone(&scene.style), Arc::clone(&scene.body)));
        self.painted = Some(Arc::clone(&painted));
        painted
    }
}

/// The body with the colours of a mask where hair grows. `vertices` are those of the scalp.
fn painted(body: &Body, vertices: &[u32], scalp: &Scalp, shown: &ShownMask) -> Body {
    let mut body = body.clone();
    let mesh = &mut body.mesh;
    // The roots of hair would colour the skin as well.
    let hairy_skin = std::mem::take(&mut mesh.scalp);
    mesh.colors.resize(mesh.positions.len(), Vec3::splat(0.5));
    // No texture changes the colours of the mask.
    let is_hairy = |&vertex: &u32| hairy_skin.get(vertex as usize).is_some_and(|hairy| *hairy > 0.0);
    for (corners, material) in mesh.triangles.iter().zip(&mut mesh.materials) {
        if corners.iter().any(is_hairy) {
            *material = u16::MAX;
        }
    }
    let head = HeadBox::of(scalp);
    if vertices.len() != scalp.positions.len() {
        // A scalp that was fitted has a net of its own; the body has its mask.
        let origin = body.skeleton.rest_position(body.head_joint);
        for ((p, color), hairy) in mesh.positions.iter().zip(&mut mesh.colors).zip(hairy_skin) {
            let value = shown.mask.at(&head, *p - origin);
            *color = color.lerp(color_of(&shown.scale, value), hairy.clamp(0.0, 1.0));
        }
        return body;
    }
    for (i, &vertex) in vertices.iter().enumerate() {
        let hairy = scalp.mask.get(i).copied().unwrap_or(0.0).clamp(0.0, 1.0);
        if let Some(color) = mesh.colors.get_mut(vertex as usize).filter(|_| hairy > 0.0) {
            let value = shown.mask.at(&head, scalp.positions[i]);
            *color = color.lerp(color_of(&shown.scale, value), hairy);
        }
    }
    body
}

/// The colour of a value, linear sRGB.
fn color_of(scale: &ColorScale, value: f32) -> Vec3 {
    let [low, high] = scale.range;
    let place = ((value - low) / (high - low)).clamp(0.0, 1.0) * 255.0;
    let encoded = Vec3::from(scale.colors[place.round() as usize].map(f32::from)) / 255.0;
    let linear = |v: f32| if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) };
    Vec3::new(linear(encoded.x), linear(encoded.y), linear(encoded.z))
}

#[cfg(test)]
mod tests {
    use lovelock_style::{MaskPart, MaskRegion};

    use super::*;
    use crate::testing::scene;

    fn shown(region: MaskRegion) -> Arc<ShownMask> {
        let colors = std::array::from_fn(|k| [k as u8, 0, 255 - k as u8]);
        let scale = ColorScale { range: [0.0, 1.0], colors, behind: 1.0, saturation: 1.0, relief: 0.0 };
        let part = MaskPart { softness: 0.0, ..MaskPart::region(region) };
        Arc::new(ShownMask { mask: Mask::of(part), scale })
    }

    #[test]
    fn strands_have_the_mask_at_their_root_and_the_scalp_its_colours() {
        let scene = scene();
        let mut view = MaskView::default();
        let left = shown(MaskRegion::Left);
        let body = view.follow(&left, &scene);
        let roots = strand_roots(&scene.style);
        let middle = HeadBox::of(&scene.style.scalp).middle.x;
        assert_eq!(view.values.len(), roots.len());
        for (root, value) in roots.iter().zip(&view.values) {
            assert_eq!(*value, f32::from(root.x >= middle), "{root}");
        }
        assert!(view.values.contains(&0.0) && view.values.contains(&1.0));
        // A vertex in the middle of the hair on each side: red on the left, blue on the right.
        let head = head_mesh(&scene.body);
        let mut sides = [0, 0];
        for (i, &vertex) in head.vertex.iter().enumerate().filter(|(i, _)| scene.style.scalp.mask[*i] == 1.0)
        {
            let color = body.mesh.colors[vertex as usize];
            let is_left = scene.style.scalp.positions[i].x >= middle;
            assert_eq!(color, if is_left { Vec3::X } else { Vec3::Z });
            sides[usize::from(is_left)] += 1;
        }
        assert!(sides.iter().all(|count| *count > 10), "{sides:?}");
        // Skin outside the hairline keeps its colour.
        let bald = (0..head.vertex.len()).find(|&i| scene.style.scalp.mask[i] == 0.0).expect("a face");
        let vertex = head.vertex[bald] as usize;
        assert_eq!(body.mesh.colors[vertex], scene.body.mesh.colors[vertex]);
        assert!(Arc::ptr_eq(&body, &view.follow(&left, &scene)), "kept while nothing changes");
        view.follow(&shown(MaskRegion::Right), &scene);
        assert_eq!(view.values[0], f32::from(roots[0].x < middle), "another mask");
    }
}
