//! The nearest of many points.

use glam::Vec3;

/// A k-d tree over points, which have the numbers of their order. Points that are not finite are left out.
pub(super) struct Nearest<'a> {
    points: &'a [Vec3],
    /// The points with the axis along which each divides its part: lower ones are before it, others behind it.
    order: Vec<(u32, u8)>,
}

/// Parts of at most so many points are searched whole.
const LEAF: usize = 8;

impl<'a> Nearest<'a> {
    /// The tree of `points`.
    pub fn new(points: &'a [Vec3]) -> Self {
        let finite = (0..points.len() as u32).filter(|&i| points[i as usize].is_finite());
        let mut order: Vec<(u32, u8)> = finite.map(|i| (i, 0)).collect();
        divide(points, &mut order);
        Self { points, order }
    }

    /// The `N` points nearest to `at` that `accept` takes, nearest first.
    pub fn of<const N: usize>(&self, at: Vec3, accept: impl Fn(u32) -> bool) -> NearestFew<N> {
        let mut found = NearestFew { count: 0, near: [(f32::INFINITY, u32::MAX); N] };
        if at.is_finite() {
            self.search(&self.order, at, &accept, &mut found);
        }
        found
    }

    fn search<const N: usize>(
        &self,
        part: &[(u32, u8)],
        at: Vec3,
        accept: &impl Fn(u32) -> bool,
        found: &mut NearestFew<N>,
    ) {
        let compare = |i: u32, found: &mut NearestFew<N>| {
            let square = at.distance_squared(self.points[i as usize]);
            if square < found.furthest() && accept(i) {
                found.insert(square, i);
            }
        };
        if part.len() <= LEAF {
            for &(i, _) in part {
                compare(i, found);
            }
            return;
        }
        let middle = part.len() / 2;
        let (dividing, axis) = part[middle];
        let beyond = at[usize::from(axis)] - self.points[dividing as usize][usize::from(axis)];
        let (low, high) = (&part[..middle], &part[middle + 1..]);
        let (near, far) = if beyond < 0.0 { (low, high) } else { (high, low) };
        self.search(near, at, accept, found);
        compare(dividing, found);
        if beyond * beyond < found.furthest() {
            self.search(far, at, accept, found);
        }
    }
}

/// Sorts a part into a tree.
fn divide(points: &[Vec3], part: &mut [(u32, u8)]) {
    if part.len() <= LEAF {
        return;
    }
    let (low, high) = part.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), &(i, _)| {
        (low.min(points[i as usize]), high.max(points[i as usize]))
    });
    let axis = (high - low).max_position();
    let middle = part.len() / 2;
    part.select_nth_unstable_by(middle, |a, b| {
        points[a.0 as usize][axis].total_cmp(&points[b.0 as usize][axis]).then(a.0.cmp(&b.0))
    });
    part[middle].1 = axis as u8;
    let (before, behind) = part.split_at_mut(middle);
    divide(points, before);
    divide(points, &mut behind[1..]);
}

/// The nearest points found so far, sorted by distance.
pub(super) struct NearestFew<const N: usize> {
    count: usize,
    near: [(f32, u32); N],
}

impl<const N: usize> NearestFew<N> {
    /// The numbers of the points.
    pub fn points(&self) -> impl ExactSizeIterator<Item = u32> {
        self.near[..self.count].iter().map(|&(_, i)| i)
    }

    /// The square of the distance below which a further point belongs to them.
    fn furthest(&self) -> f32 {
        self.near[N - 1].0
    }

    fn insert(&mut self, square: f32, i: u32) {
        let mut k = self.count.min(N - 1);
        while k > 0 && self.near[k - 1].0 > square {
            self.near[k] = self.near[k - 1];
            k -= 1;
        }
        self.near[k] = (square, i);
        self.count = (self.count + 1).min(N);
    }
}

#[cfg(test)]
mod tests {
    use lovelock_base::random::SplitMix64;

    use super::*;

    #[test]
    fn the_nearest_points_are_those_of_a_search_through_all() {
        let mut random = SplitMix64::new(5);
        for (name, flat, count) in [("few", 1.0, 5), ("a cloud", 1.0, 700), ("a sheet", 0.0, 700)] {
            let points: Vec<Vec3> =
                (0..count).map(|_| random.signed_vec3() * Vec3::new(1.0, 0.1, flat)).collect();
            let tree = Nearest::new(&points);
            for (i, &at) in points.iter().enumerate() {
                let accept = |other: u32| other as usize != i && !other.is_multiple_of(3);
                let found: Vec<f32> = tree
                    .of::<7>(at, accept)
                    .points()
                    .map(|other| at.distance_squared(points[other as usize]))
                    .collect();
                let mut all: Vec<f32> = (0..points.len() as u32)
                    .filter(|&other| accept(other))
                    .map(|other| at.distance_squared(points[other as usize]))
                    .collect();
                all.sort_unstable_by(f32::total_cmp);
                all.truncate(7);
                assert_eq!(found, all, "{name}, {i}");
            }
        }
        let odd = [Vec3::NAN, Vec3::ZERO, Vec3::INFINITY];
        let tree = Nearest::new(&odd);
        assert_eq!(tree.of::<2>(Vec3::X, |_| true).points().collect::<Vec<_>>(), [1]);
        assert_eq!(tree.of::<2>(Vec3::NAN, |_| true).points().len(), 0);
    }
}
