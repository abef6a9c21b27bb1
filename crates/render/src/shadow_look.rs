//! What the shadows of hair depend on beside positions, and how both backends store them.

use glam::{Affine3A, Vec3};
use rayon::prelude::*;

use crate::{FrameInput, HairDrawing, Light, MAX_LIGHTS, ShadowMethod, ShadowSettings, UserMethod};

/// What the shadows in an image depend on beside the positions of hair, body and lights.
///
/// Both backends build their maps from these values alone, and the CPU keeps shadows while they are equal. A new field of the look that
/// matters to shadows therefore stands here, and cannot be left out of the comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ShadowLook {
    /// As [`lovelock_shadow::ShadowInput::strand_width`].
    pub strand_width: f32,
    /// As [`lovelock_shadow::ShadowInput::extinction_scale`].
    pub extinction_scale: f32,
    /// The method and its settings.
    pub settings: ShadowSettings,
    /// The version of the user's method, if it is one; 0 otherwise.
    pub version: u64,
    /// The head, at whose origin maps are anchored.
    pub world_from_head: Affine3A,
    /// How far apart fine strands look up shadows, metres: half of the softness of the first light at the head.
    pub reach: f32,
}

impl ShadowLook {
    /// That of an image.
    pub fn of(input: &FrameInput) -> Self {
        let key = Light::enabled(input.lights).next();
        let head = Vec3::from(input.world_from_head.translation);
        Self {
            strand_width: input.look.shadow_width(input.style.strands.count()),
            extinction_scale: input.look.extinction_scale,
            settings: *input.shadow,
            version: match input.shadow.method {
                ShadowMethod::User(_) => UserMethod::revision(),
                _ => 0,
            },
            world_from_head: input.world_from_head,
            reach: key.map_or(0.0, |light| 0.5 * light.softness_at(light.position.distance(head))),
        }
    }

    /// The origin of the lattices of maps, world space.
    pub fn anchor(&self) -> Vec3 {
        self.world_from_head.translation.into()
    }
}

/// Whether the hair's shadow on skin is softened: where hair is as fine as it is in images for the eye, not in comparisons of maps.
/// `has_fine_strands` tells whether strands are drawn by their size.
pub(crate) fn has_soft_skin(input: &FrameInput, has_fine_strands: bool) -> bool {
    let has_clusters = input.picture.draw == HairDrawing::Clusters && input.known.is_none();
    (has_fine_strands || has_clusters) && ShadowLook::of(input).reach > 0.0
}

/// Points that are packed or summed together.
pub(crate) const PIECE: usize = 8192;

/// Packs the values of up to four lights into one word per point, the first light in the lowest byte. Bytes without a light are
/// 255.
pub(crate) fn pack(values: &[&[f32]], count: usize, packed: &mut Vec<u32>) {
    packed.clear();
    packed.resize(count, u32::MAX);
    packed.par_chunks_mut(PIECE).enumerate().for_each(|(piece, words)| {
        for (k, values) in values.iter().enumerate().take(MAX_LIGHTS) {
            let shift = 8 * k as u32;
            for (word, &value) in words.iter_mut().zip(&values[piece * PIECE..]) {
                let byte = (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u32;
                *word = (*word & !(0xff << shift)) | (byte << shift);
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packing_writes_a_byte_a_light_and_fills_the_others() {
        let mut packed = vec![7; 9];
        pack(&[&[1.0, 1.0, 1.0], &[0.0, 0.5, f32::NAN]], 3, &mut packed);
        assert_eq!(packed, [0xffff_00ff, 0xffff_80ff, 0xffff_00ff]);
        pack(&[], 2, &mut packed);
        assert_eq!(packed, [u32::MAX; 2]);
    }
}
