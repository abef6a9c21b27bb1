//! The constant properties of the guides of a hairstyle: lengths, directions, bends, and how each guide
//! carries its own weight at rest.

use glam::Vec3;
use lovelock_groom::Guides;

use crate::lanes::{Lane, Lane3, ZERO, ZERO3, at, put};
use crate::packing::{Lanes, mean_of_lock};

/// The rest shape of the guides of one block. Rows are points, root first; head space.
#[derive(Clone, Debug)]
pub(crate) struct RestShape {
    pub(crate) position: Vec<Lane3>,
    /// Unit direction of the link that ends at each point; the first row repeats the second.
    pub(crate) direction: Vec<Lane3>,
    /// Second difference around each point, metres; zero at both ends.
    pub(crate) bend: Vec<Lane3>,
    /// Acceleration by which a guide carries its own weight under a gravity of 1 m/s^2 along -Y.
    pub(crate) support: Vec<Lane3>,
    /// Length of the link that ends at each point, metres.
    pub(crate) length: Vec<Lane>,
    pub(crate) inv_length: Vec<Lane>,
    /// Mean link length of each guide, metres.
    pub(crate) mean_link: Lane,
    /// Distance of each point from the middle of its lock, metres; 0 for a guide that belongs to no lock.
    pub(crate) lock_radius: Vec<Lane>,
}

impl RestShape {
    /// The rest shape of the guides in `lanes`.
    pub(crate) fn new(guides: &Guides, lanes: &Lanes, first_free: usize) -> Self {
        let count = guides.points_per_guide;
        let mut rest = Self {
            position: vec![ZERO3; count],
            direction: vec![ZERO3; count],
            bend: vec![ZERO3; count],
            support: vec![ZERO3; count],
            length: vec![ZERO; count],
            inv_length: vec![ZERO; count],
            mean_link: ZERO,
            lock_radius: vec![ZERO; count],
        };
        for (k, &guide) in lanes.guides.iter().enumerate() {
            let points: Vec<Vec3> = (0..count).map(|i| guides.point(guide as usize, i)).collect();
            let directions = directions(&points);
            // A guide that was cut ends at its last link of non-zero length.
            let links = (1..count).rfind(|&i| points[i] != points[i - 1]).unwrap_or(count - 1);
            for (i, &p) in points.iter().enumerate() {
                put(&mut rest.position[i], k, p);
                put(&mut rest.direction[i], k, directions[i]);
                if i > 0 {
                    let length = (p - points[i - 1]).length();
                    rest.length[i][k] = length;
                    rest.inv_length[i][k] = if length > 1e-9 { 1.0 / length } else { 0.0 };
                    rest.mean_link[k] += length / links as f32;
                    if i + 1 < count {
                        put(&mut rest.bend[i], k, points[i - 1] - 2.0 * p + points[i + 1]);
                    }
                }
            }
            for (i, support) in support(&directions[..=links], first_free).into_iter().enumerate() {
                put(&mut rest.support[i], k, support);
            }
        }
        rest.measure_locks(lanes.locks);
        rest
    }

    /// Measures how wide the locks in the first `3 * locks` lanes are.
    pub(crate) fn measure_locks(&mut self, locks: usize) {
        for (p, radius) in self.position.iter().zip(&mut self.lock_radius) {
            let middle = mean_of_lock(p);
            for k in 0..3 * locks {
                radius[k] = (at(p, k) - at(&middle, k)).length();
            }
        }
    }
}

/// Unit directions of the links; a zero-length link takes the direction of the previous one.
fn directions(points: &[Vec3]) -> Vec<Vec3> {
    let mut last = points.windows(2).find_map(|w| (w[1] - w[0]).try_normalize()).unwrap_or(Vec3::NEG_Y);
    let mut out = vec![last; points.len()];
    for (i, pair) in points.windows(2).enumerate() {
        last = (pair[1] - pair[0]).normalize_or(last);
        out[i + 1] = last;
    }
    out
}

/// The acceleration that must be added to unit gravity so that a guide rests in its given shape.
///
/// Links under tension carry weight as in a hanging chain: their tensions solve the system of the length
/// constraints, and a link under compression carries nothing. The stiffness carries whatever tension does
/// not, as if the guide had been set in this shape while it hung ("sag-free" initial states: the force is
/// that of the unloaded shape's bends, constant in head space). A guide that hangs straight gets nothing; one
/// that stands out from the head is supported fully.
fn support(direction: &[Vec3], first_free: usize) -> Vec<Vec3> {
    let (count, gravity) = (direction.len(), Vec3::NEG_Y);
    let first = first_free.max(1);
    let mut multiplier = vec![0.0_f64; count + 1];
    let mut upper = vec![0.0_f64; count + 1];
    let (mut off, mut above, mut rhs) = (0.0_f64, 0.0_f64, 0.0_f64);
    for i in first..count {
        let diagonal = if i == first_free { 1.0 } else { 2.0 };
        let r = if i == first_free { -f64::from(direction[i].dot(gravity)) } else { 0.0 };
        let pivot = 1.0 / (diagonal - off * above);
        rhs = (r - off * rhs) * pivot;
        off = if i + 1 < count { -f64::from(direction[i].dot(direction[i + 1])) } else { 0.0 };
        above = off * pivot;
        multiplier[i] = rhs;
        upper[i] = above;
    }
    for i in (first..count).rev() {
        multiplier[i] -= upper[i] * multiplier[i + 1];
    }
    // A link under tension has a negative multiplier.
    let pull = |i: usize| multiplier[i].min(0.0) as f32;
    (0..count)
        .map(|i| {
            if i < first_free {
                return Vec3::ZERO;
            }
            let next = if i + 1 < count { direction[i + 1] * pull(i + 1) } else { Vec3::ZERO };
            let here = if i > 0 { direction[i] * pull(i) } else { Vec3::ZERO };
            -gravity - (here - next)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hanging_guides_need_no_support_and_horizontal_ones_need_all() {
        let hanging = support(&[Vec3::NEG_Y; 6], 1);
        assert!(hanging.iter().all(|s| s.length() < 1e-6), "{hanging:?}");
        let level = support(&[Vec3::X; 6], 1);
        assert!(level[1..].iter().all(|s| (*s - Vec3::Y).length() < 1e-6), "{level:?}");
    }

    #[test]
    fn an_upright_guide_does_not_compress_its_links() {
        let standing = support(&[Vec3::Y; 6], 1);
        assert!(standing[1..].iter().all(|s| (*s - Vec3::Y).length() < 1e-6), "{standing:?}");
    }
}
