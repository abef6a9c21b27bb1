//! The same hair on a head of another size.

use crate::{Guides, Hairstyle, Scalp};

impl Scalp {
    /// The scalp with every length multiplied by `scale`.
    #[must_use]
    pub fn scaled(&self, scale: f32) -> Self {
        let mut out = self.clone();
        out.positions.iter_mut().for_each(|p| *p *= scale);
        out
    }
}

impl Guides {
    fn scale(&mut self, scale: f32) {
        for axis in [&mut self.x, &mut self.y, &mut self.z] {
            axis.iter_mut().for_each(|v| *v *= scale);
        }
    }
}

impl Hairstyle {
    /// The hairstyle on a head that is `scale` times as large: every length is multiplied. The width of strands is that of a
    /// [`crate::HairLook`], which is not a part of it.
    #[must_use]
    pub fn scaled(&self, scale: f32) -> Self {
        let mut out = self.clone();
        out.scalp.positions.iter_mut().for_each(|p| *p *= scale);
        out.guides.scale(scale);
        out.widest.iter_mut().for_each(|v| *v = (*v * scale).min(f32::MAX));
        let set = &mut out.strands;
        for lengths in [&mut set.offset_normal, &mut set.offset_binormal, &mut set.offset_tangent] {
            lengths.iter_mut().for_each(|v| *v *= scale);
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use crate::{GroomSettings, PlainHead, Preset, Strands, grow, interpolate};

    #[test]
    fn strands_of_a_larger_head_are_those_of_the_smaller_one_enlarged() {
        let settings =
            GroomSettings { wisps: 40, strands_per_wisp: 5, ..GroomSettings::preset(Preset::Curly) };
        let style = grow(&settings, &PlainHead.scalp(24), &PlainHead).expect("it grows");
        let larger = style.scaled(3.0);
        larger.check().expect("whole");
        let strands = |style: &crate::Hairstyle| {
            let mut out = Strands::default();
            let frame = crate::GuideFrame::at_rest(&style.guides, glam::Affine3A::IDENTITY, 0.0);
            interpolate(style, &frame, &mut out);
            out
        };
        let (small, large) = (strands(&style), strands(&larger));
        assert_eq!(small.points(), large.points());
        let farthest = (0..small.points())
            .map(|i| {
                let [a, b] = [&small, &large].map(|s| glam::Vec3::new(s.x[i], s.y[i], s.z[i]));
                (a * 3.0).distance(b)
            })
            .fold(0.0, f32::max);
        assert!(farthest < 1e-4, "{farthest}");
    }
}
