//! Fewer strands in views in which they are narrower than a pixel, with their width made up.

use std::sync::Arc;

use lovelock_groom::{HairLook, Hairstyle};
use lovelock_render::Camera;

/// The width of a strand that is aimed at, pixels: thinner ones cost as much and cannot be told apart.
const AIM_PIXELS: f32 = 0.7;
/// Shares of the strands, from which one is chosen. Each has its own hairstyle, so they are few.
const SHARES: [f32; 5] = [1.0, 0.75, 0.55, 0.4, 0.3];
/// How far the wanted share must be beyond one in use before another one is chosen.
const HOLD: f32 = 1.12;

/// The thinned forms of one hairstyle.
#[derive(Debug, Default)]
pub struct Thinning {
    of: Option<Arc<Hairstyle>>,
    made: [Option<Arc<Hairstyle>>; SHARES.len()],
    level: usize,
}

impl Thinning {
    /// The form of `style` for an image `height` pixels high, in which the hair is near `at` (world space, metres).
    pub fn choose(
        &mut self,
        style: &Arc<Hairstyle>,
        look: &HairLook,
        (camera, height, at): (&Camera, u32, glam::Vec3),
    ) -> Arc<Hairstyle> {
        if !self.of.as_ref().is_some_and(|of| Arc::ptr_eq(of, style)) {
            *self = Self { of: Some(Arc::clone(style)), ..Self::default() };
        }
        let width = look.shadow_width(style.strands.count()) * look.width_scale;
        let distance = camera.eye.distance(at).max(0.05);
        let pixels = width * camera.pixels_per_metre_at_one_metre(height) / distance;
        self.level = level(self.level, pixels / AIM_PIXELS);
        if self.level == 0 {
            return Arc::clone(style);
        }
        let form = &mut self.made[self.level];
        Arc::clone(form.get_or_insert_with(|| Arc::new(style.thinned(SHARES[self.level]))))
    }
}

/// The index of the share to use after `level`, if strands are `wanted` times as wide as aimed at.
fn level(level: usize, wanted: f32) -> usize {
    if !wanted.is_finite() {
        return 0;
    }
    // Not fewer than wanted: the first share from the least on that is at least as large.
    let of = |wanted: f32| (0..SHARES.len()).rev().find(|&k| SHARES[k] >= wanted).unwrap_or(0);
    let (least, most) = (of(wanted * HOLD), of(wanted / HOLD));
    level.clamp(least.min(most), most.max(least))
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use lovelock_groom::StrandSet;

    use super::*;

    #[test]
    fn far_hair_is_thinned_and_near_hair_is_not() {
        // 3,000 strands that stand for 100,000 hairs are 2.3 mm wide.
        let strands = StrandSet {
            wisp: vec![0; 3000],
            weights: vec![[1.0, 0.0, 0.0]; 3000],
            shade: vec![0.5; 3000],
            first_point: (0..=3000).map(|i| 2 * i).collect(),
            guide_param: vec![0.0; 6000],
            offset_normal: vec![0.0; 6000],
            offset_binormal: vec![0.0; 6000],
            offset_tangent: vec![0.0; 6000],
            taper: vec![1.0; 6000],
        };
        let style = Arc::new(Hairstyle { strands, ..Hairstyle::default() });
        let look = HairLook { width_scale: 0.4, ..HairLook::default() };
        let at = |metres: f32| Camera { eye: Vec3::Z * metres, target: Vec3::ZERO, fov_y: 0.5 };
        let mut thinning = Thinning::default();
        let mut share = |metres: f32| {
            let chosen = thinning.choose(&style, &look, (&at(metres), 720, Vec3::ZERO));
            (chosen.strands.count() as f32 / 3000.0, Arc::ptr_eq(&chosen, &style))
        };
        assert_eq!(share(0.4), (1.0, true), "near");
        let (far, farther) = (share(4.0).0, share(20.0).0);
        assert!(far < 0.95 && farther < far && (farther - 0.3).abs() < 1e-3, "{far} {farther}");
        assert_eq!(share(0.4), (1.0, true), "near again");
    }

    #[test]
    fn the_share_follows_the_width_and_does_not_flicker() {
        for (wanted, expected) in
            [(2.0, 0), (1.2, 0), (0.65, 1), (0.48, 2), (0.35, 3), (0.1, 4), (f32::NAN, 0)]
        {
            for from in [0, SHARES.len() - 1] {
                assert_eq!(level(from, wanted), expected, "{wanted} from {from}");
            }
        }
        // A width that sways by 5 % around a bound keeps its share.
        let mut now = level(0, 0.55);
        let first = now;
        for step in 0..50 {
            now = level(now, if step % 2 == 0 { 0.52 } else { 0.58 });
            assert_eq!(now, first);
        }
        assert!(level(now, 0.9) < first && level(now, 0.2) > first, "control: larger changes are followed");
    }
}
