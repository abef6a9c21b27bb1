//! The volume that hair fills.

/// The volume of hair whose mass lies in `cells` of `cell` metres: `V = sum(min(m / m_full, 1))` cells.
///
/// `full` is the mass of a cell that is as dense as hair at rest, on the average over the hair, finds the hair around
/// itself: `m_full = sum m^2 / sum m` at rest. A cell that is fuller counts once, one that is emptier by its fullness.
/// So hair that is pressed together loses volume, and hair that flies apart gains none beyond what it would have if
/// it were nowhere denser than that. The sum is of integers: the order does not matter.
pub(super) fn volume(masses: impl Iterator<Item = i32>, full: f32, cell: f32) -> f32 {
    let most = full.clamp(1.0, 2e9) as i32;
    let sum: i64 = masses.map(|m| i64::from(m.min(most))).sum();
    (sum as f64 / f64::from(most) * f64::from(cell).powi(3)) as f32
}
