//! The Pareto front.

/// For points of (cost, error), whether each is on the Pareto front: no other point is at least as good in both and better in
/// one. Points with numbers that are not finite are ignored.
pub fn pareto(points: &[(f64, f64)]) -> Vec<bool> {
    let mut order: Vec<usize> =
        (0..points.len()).filter(|&i| points[i].0.is_finite() && points[i].1.is_finite()).collect();
    let by = |i: &usize| points[*i];
    order.sort_unstable_by(|a, b| by(a).0.total_cmp(&by(b).0).then(by(a).1.total_cmp(&by(b).1)));
    let mut front = vec![false; points.len()];
    let mut best: Option<(f64, f64)> = None;
    for index in order {
        // Cheapest first: a point is on the front if its error is below all before it, or if it equals the last one on the front.
        let point = points[index];
        if best.is_none_or(|best| point.1 < best.1 || point == best) {
            front[index] = true;
            best = Some(point);
        }
    }
    front
}

#[cfg(test)]
mod tests {
    use super::pareto;

    /// The definition: compares every point with every other.
    fn plain(points: &[(f64, f64)]) -> Vec<bool> {
        let beats = |a: &(f64, f64), b: &(f64, f64)| a.0 <= b.0 && a.1 <= b.1 && a != b;
        points.iter().map(|point| !points.iter().any(|other| beats(other, point))).collect()
    }

    #[test]
    fn the_front_matches_the_definition() {
        let points = [(1.0, 9.0), (2.0, 5.0), (2.0, 6.0), (3.0, 5.0), (4.0, 1.0), (4.0, 1.0), (9.0, 2.0)];
        let expected = [true, true, false, false, true, true, false];
        assert_eq!(pareto(&points), expected);
        assert_eq!(plain(&points), expected);
        let mut state = 1_u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 28)
        };
        for _ in 0..200 {
            let points: Vec<_> = (0..12).map(|_| (next(), next())).collect();
            assert_eq!(pareto(&points), plain(&points), "{points:?}");
        }
    }

    #[test]
    fn points_that_are_not_finite_are_never_on_the_front() {
        assert_eq!(pareto(&[(f64::NAN, 0.0), (1.0, f64::INFINITY), (5.0, 5.0)]), [false, false, true]);
        assert_eq!(pareto(&[]), Vec::<bool>::new());
    }
}
