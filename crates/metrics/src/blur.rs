//! Separable filters.

use rayon::prelude::*;

/// Filters a plane with rows of `width` values horizontally and then vertically. Values at the border are repeated beyond it.
pub(crate) fn blurred(plane: &[f32], width: usize, across: &[f32], down: &[f32]) -> Vec<f32> {
    let height = plane.len() / width;
    let mut rows = vec![0.0; plane.len()];
    rows.par_chunks_mut(width).zip(plane.par_chunks(width)).with_min_len(8).for_each_init(
        Vec::new,
        |padded, (out, row)| {
            let radius = across.len() / 2;
            padded.clear();
            padded.extend(std::iter::repeat_n(row[0], radius));
            padded.extend_from_slice(row);
            padded.extend(std::iter::repeat_n(row[width - 1], radius));
            for (&weight, from) in across.iter().zip(padded.windows(width)) {
                for (sum, value) in out.iter_mut().zip(from) {
                    *sum += weight * value;
                }
            }
        },
    );
    let mut columns = vec![0.0; plane.len()];
    columns.par_chunks_mut(width).enumerate().with_min_len(8).for_each(|(y, out)| {
        let radius = down.len() / 2;
        for (tap, &weight) in down.iter().enumerate() {
            let from = (y + tap).saturating_sub(radius).min(height - 1) * width;
            for (sum, value) in out.iter_mut().zip(&rows[from..from + width]) {
                *sum += weight * value;
            }
        }
    });
    columns
}

#[cfg(test)]
mod tests {
    use super::blurred;

    #[test]
    fn a_single_point_becomes_the_filter_in_both_directions() {
        let across = [1.0, 2.0, 4.0];
        let down = [10.0, 20.0, 40.0];
        let mut point = vec![0.0; 25];
        point[12] = 1.0;
        let out = blurred(&point, 5, &across, &down);
        // A pixel to the left of the point is multiplied by the last weight.
        assert_eq!(out[11], 4.0 * 20.0);
        assert_eq!(out[7], 2.0 * 40.0);
        assert_eq!(out[18], 1.0 * 10.0);
        assert_eq!(out[0], 0.0);
    }
}
