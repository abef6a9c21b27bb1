//! Hair with fewer strands, for views in which a strand is narrower than a pixel.

use crate::{Hairstyle, StrandSet, Wisp};

impl Hairstyle {
    /// The hairstyle with this share of its strands, 0 to 1, evenly from every part; at least one strand of a style that has any.
    ///
    /// [`HairLook::shadow_width`](crate::HairLook::shadow_width) grows as the number of strands falls, so the sum of widths, and with it
    /// coverage and shadow, stays the same. Guides and wisps stay too.
    #[must_use]
    pub fn thinned(&self, share: f32) -> Self {
        let share = f64::from(if share.is_finite() { share.clamp(0.0, 1.0) } else { 1.0 });
        let old = &self.strands;
        let share = share.max(1.0 / old.count().max(1) as f64);
        // Whole numbers that a line of this slope passes.
        let is_kept = |i: usize| ((i + 1) as f64 * share + 1e-9).floor() > (i as f64 * share + 1e-9).floor();
        let kept: Vec<usize> = (0..old.count()).filter(|&i| is_kept(i)).collect();
        let mut strands = StrandSet { first_point: vec![0], ..StrandSet::default() };
        for &i in &kept {
            strands.wisp.push(old.wisp[i]);
            strands.weights.push(old.weights[i]);
            strands.shade.push(old.shade[i]);
            let points = old.first_point[i] as usize..old.first_point[i + 1] as usize;
            for (new, old) in [
                (&mut strands.guide_param, &old.guide_param),
                (&mut strands.offset_normal, &old.offset_normal),
                (&mut strands.offset_binormal, &old.offset_binormal),
                (&mut strands.offset_tangent, &old.offset_tangent),
                (&mut strands.taper, &old.taper),
            ] {
                new.extend_from_slice(&old[points.clone()]);
            }
            strands.first_point.push(strands.guide_param.len() as u32);
        }
        let wisps = self.wisps.iter().map(|wisp| {
            let end = wisp.first_strand + wisp.strand_count;
            let [first, last] =
                [wisp.first_strand, end].map(|at| kept.partition_point(|&i| i < at as usize) as u32);
            Wisp { first_strand: first, strand_count: last - first, ..*wisp }
        });
        Self { wisps: wisps.collect(), strands, ..self.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{GroomSettings, PlainHead, grow};

    fn small_style() -> Hairstyle {
        let settings = GroomSettings { wisps: 30, strands_per_wisp: 23, ..GroomSettings::default() };
        grow(&settings, &PlainHead.scalp(32), &PlainHead).expect("hair")
    }

    #[test]
    fn every_part_keeps_its_share_and_the_widths_keep_their_sum() {
        let style = small_style();
        let whole = style.strands.count();
        for share in [0.75, 0.5, 0.3, 0.25] {
            let thin = style.thinned(share);
            thin.check().expect("a hairstyle");
            let count = thin.strands.count();
            assert!((count as f32 - share * whole as f32).abs() <= 1.0, "{share}: {count} of {whole}");
            for (thin, all) in thin.wisps.iter().zip(&style.wisps) {
                let wanted = share * all.strand_count as f32;
                assert!((thin.strand_count as f32 - wanted).abs() <= 1.0, "{share}: {}", thin.strand_count);
            }
            let width = |style: &Hairstyle| {
                style.look.shadow_width(style.strands.count()) * style.strands.count() as f32
            };
            assert!((width(&thin) / width(&style) - 1.0).abs() < 1e-5);
        }
    }

    #[test]
    fn strands_that_stay_are_what_they_were() {
        let style = small_style();
        let thin = style.thinned(0.5);
        let shapes = |style: &Hairstyle| -> Vec<Vec<f32>> {
            let set = &style.strands;
            let ends = set.first_point.windows(2);
            ends.map(|ends| set.offset_normal[ends[0] as usize..ends[1] as usize].to_vec()).collect()
        };
        let all = shapes(&style);
        let mut left = all.iter();
        assert!(shapes(&thin).iter().all(|shape| left.any(|known| known == shape)), "in the same order");
        assert_eq!(style.thinned(1.0).strands, style.strands);
        for share in [f32::NAN, f32::INFINITY] {
            assert_eq!(style.thinned(share).strands, style.strands);
        }
        for share in [0.0, -3.0] {
            assert_eq!(style.thinned(share).strands.count(), 1);
        }
        assert_eq!(Hairstyle::default().thinned(0.5).strands.count(), 0);
    }
}
