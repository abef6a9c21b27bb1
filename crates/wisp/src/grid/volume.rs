//! The volume that hair fills.

/// The volume of hair whose mass lies in `cells` of `cell` metres: `V = (sum m)^2 / sum m^2` cells.
///
/// That is the volume it would fill if it were everywhere as dense as it is, on the average over the hair, where the
/// hair is. It needs no threshold, does not change with the number of guides, and halves where hair is pressed into
/// half the room. Masses are summed exactly, so the order does not matter.
pub(super) fn volume(masses: impl Iterator<Item = i32>, cell: f32) -> f32 {
    let (mut sum, mut squares) = (0_i64, 0_u128);
    for m in masses {
        sum += i64::from(m);
        squares += u128::from(m.unsigned_abs()).pow(2);
    }
    if squares == 0 {
        return 0.0;
    }
    let cells = (sum as f64) * (sum as f64) / squares as f64;
    (cells * f64::from(cell).powi(3)) as f32
}
