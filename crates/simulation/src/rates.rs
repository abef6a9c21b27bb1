//! Rates that change along a guide.

use crate::SimulationSettings;

/// The acceleration with which surrounding hair presses on a point inside the hair, for friction: its weight,
/// metres per second squared.
const PRESSURE: f32 = 9.81;

/// What changes along a guide: fractions of a difference that vanish in a substep, at one row of points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct RowRates {
    /// Of the distance beyond the bound of a lock.
    pub(crate) cohesion: f32,
    /// Of the velocity relative to the lock.
    pub(crate) lock_friction: f32,
    /// The drag of slow air times the substep.
    pub(crate) drag: f32,
    /// The largest change of velocity by friction on other hair, metres per second.
    pub(crate) hair_friction: f32,
}

impl RowRates {
    /// The rates at the fraction `along` of a guide, 0 at the root and 1 at the tip, in a substep of `h` seconds.
    pub(crate) fn at(along: f32, settings: &SimulationSettings, h: f32) -> Self {
        let taken = |rate: f32| 1.0 - (-rate * h).exp();
        let toward = |tip: f32| 1.0 + (tip - 1.0) * along;
        let locks = &settings.locks;
        Self {
            cohesion: taken(locks.cohesion * toward(locks.cohesion_tip)),
            lock_friction: taken(locks.friction),
            drag: settings.drag * toward(settings.drag_tip) / settings.weight_at(along) * h,
            hair_friction: settings.hair_friction * toward(settings.hair_friction_tip) * PRESSURE * h,
        }
    }
}
