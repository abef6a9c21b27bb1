//! Factors of a hairstyle on the settings, for the guides of one block.

use lovelock_groom::{Hairstyle, MotionFactors};

use crate::lanes::{LANES, Lane, ZERO};

/// [`MotionFactors`] of the guides of a block. Rows are points, root first.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FactorRows {
    pub(crate) stiffness: Vec<Lane>,
    pub(crate) hold: Vec<Lane>,
    pub(crate) damping: Vec<Lane>,
    pub(crate) friction: Vec<Lane>,
    /// Fraction of the velocity relative to the head that vanishes in a substep.
    pub(crate) settle: Vec<Lane>,
    /// The rate of settling and the substep for which `settle` was computed.
    settle_of: Option<[f32; 2]>,
}

impl FactorRows {
    /// The factors of the guides in `lanes`; `None` if all are 1.
    pub(crate) fn of(style: &Hairstyle, lanes: &[u32; LANES]) -> Option<Box<Self>> {
        let motion = &style.motion;
        let points = style.guides.points_per_guide;
        let [low, high] = MotionFactors::RANGE;
        let rows = |list: &[f32]| -> Vec<Lane> {
            let of = |guide: u32, i: usize| {
                let factor = list.get(guide as usize * points + i).copied().unwrap_or(1.0);
                // NaN changes nothing.
                if factor.is_nan() { 1.0 } else { factor.clamp(low, high) }
            };
            (0..points).map(|i| Lane(std::array::from_fn(|k| of(lanes[k], i)))).collect()
        };
        if motion.is_empty() {
            return None;
        }
        let [stiffness, hold, damping, friction] = motion.lists().map(|(_, list)| rows(list));
        let even = [&stiffness, &hold, &damping, &friction]
            .into_iter()
            .flatten()
            .all(|row| *row == Lane::splat(1.0));
        let new = Self { stiffness, hold, damping, friction, settle: vec![ZERO; points], settle_of: None };
        (!even).then(|| Box::new(new))
    }

    /// Computes `settle` for a rate of settling, 1/s, and a substep of `h` seconds, unless it is known.
    pub(crate) fn prepare(&mut self, rate: f32, h: f32) {
        if self.settle_of == Some([rate, h]) {
            return;
        }
        self.settle_of = Some([rate, h]);
        for (settle, damping) in self.settle.iter_mut().zip(&self.damping) {
            *settle = Lane(std::array::from_fn(|k| 1.0 - (-rate * damping[k] * h).exp()));
        }
    }
}
