//! Operations that change how hair moves: factors on the settings of the simulation.

mod damping;
mod friction;
mod hold;
mod stiffness;

pub use damping::Damping;
pub use friction::Friction;
pub use hold::Hold;
pub use stiffness::Stiffness;

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use lovelock_groom::{Hairstyle, NoObstacle};

    use super::{Damping, Friction, Hold, Stiffness};
    use crate::operations::testing::straight;
    use crate::{HeadBox, Layer, Mask, MaskPart, MaskRegion, Operation, Ramp, apply_layer};

    fn applied(layer: &Layer, style: &Hairstyle) -> Hairstyle {
        let style = apply_layer(layer, 1.0, style, &NoObstacle).expect("a change");
        style.check().expect("sound");
        style
    }

    #[test]
    fn each_operation_writes_its_own_list_and_moves_no_point() {
        let style = straight(Vec3::NEG_Y);
        let kinds: [Operation; 4] = [
            Stiffness { factor: 3.0 }.into(),
            Hold { factor: 3.0 }.into(),
            Damping { factor: 3.0 }.into(),
            Friction { factor: 3.0 }.into(),
        ];
        for (kind, operation) in kinds.into_iter().enumerate() {
            let made = applied(&Layer::of(operation), &style);
            assert_eq!((&made.guides, &made.strands), (&style.guides, &style.strands));
            for (other, (name, list)) in made.motion.lists().into_iter().enumerate() {
                assert_eq!(list.is_empty(), other != kind, "{name}");
                assert!(list.iter().all(|factor| *factor == 3.0));
            }
        }
    }

    #[test]
    fn factors_follow_weight_mask_and_ramp_and_multiply() {
        let style = straight(Vec3::NEG_Y);
        let mask = Mask::of(MaskPart { softness: 0.0, ..MaskPart::region(MaskRegion::Left) });
        let ramp = Ramp::line(0.0, 1.0);
        let layer = Layer { weight: 0.5, mask: mask.clone(), ramp, ..Layer::of(Stiffness { factor: 3.0 }) };
        let made = applied(&layer, &style);
        let head = HeadBox::of(&style.scalp);
        let points = style.guides.points_per_guide;
        let (mut inside, mut outside) = (0, 0);
        for (guide, factors) in made.motion.stiffness.chunks_exact(points).enumerate() {
            let masked = mask.at(&head, style.guides.point(guide, 0));
            (inside, outside) = (inside + u32::from(masked == 1.0), outside + u32::from(masked == 0.0));
            for (i, factor) in factors.iter().enumerate() {
                let want = 1.0 + 2.0 * 0.5 * masked * i as f32 / (points - 1) as f32;
                assert!((factor - want).abs() < 1e-5, "{factor} against {want}");
            }
        }
        assert!(inside > 3 && outside > 3, "{inside} and {outside}");
        let twice = applied(&layer, &made);
        for (twice, once) in twice.motion.stiffness.iter().zip(&made.motion.stiffness) {
            assert!((twice - once * once).abs() < 1e-4);
        }
    }

    #[test]
    fn factors_stay_in_their_range_and_a_factor_of_one_changes_nothing() {
        let mut style = straight(Vec3::NEG_Y);
        let one = applied(&Layer::of(Hold { factor: 1.0 }), &style);
        assert!(one.motion.is_empty());
        let none = Layer { weight: 2.0, ..Layer::of(Hold { factor: 0.0 }) };
        assert!(applied(&none, &style).motion.hold.iter().all(|factor| *factor == 0.0));
        for _ in 0..20 {
            style = applied(&Layer::of(Friction { factor: 8.0 }), &style);
        }
        assert!(style.motion.friction.iter().all(|factor| *factor == 64.0));
        style.motion.friction[3] = f32::NAN;
        assert!(style.check().is_err(), "control: a factor that is not a number");
    }
}
