//! Winding numbers, which separate inside from outside even where triangles fold over, overlap, intersect or
//! leave holes; the normal of the closest point fails there.

use std::f32::consts::TAU;

use glam::Vec3;

use super::closest::{LANES, Pack};
use super::tree::Tree;

/// A range of triangles is approximated by one dipole beyond this many of its radii. Integer winding numbers
/// are then off by less than 0.1 (see the tests), and the threshold is 0.5.
const FAR: f32 = 2.0;

/// Far-field approximation of a range of triangles.
#[derive(Clone, Copy, Debug, Default)]
struct Dipole {
    /// Area-weighted mean of the triangles' centres.
    centre: Vec3,
    /// Sum of the triangles' normals times their areas.
    area: Vec3,
    /// Radius of the ball around the centre that contains the triangles.
    radius: f32,
    total_area: f32,
}

/// One dipole per node of the tree.
#[derive(Clone, Debug, Default)]
pub(super) struct Winding {
    dipoles: Vec<Dipole>,
}

impl Winding {
    pub(super) fn new(tree: &Tree) -> Self {
        let mut dipoles = vec![Dipole::default(); tree.nodes.len()];
        // Children come after their parents.
        for (i, node) in tree.nodes.iter().enumerate().rev() {
            let mut dipole = Dipole::default();
            let mut moment = Vec3::ZERO;
            if node.count == 0 {
                let children = [dipoles[i + 1], dipoles[node.at as usize]];
                for child in &children {
                    dipole.area += child.area;
                    dipole.total_area += child.total_area;
                    moment += child.centre * child.total_area;
                }
                dipole.centre = (moment / dipole.total_area).max(node.low).min(node.high);
                for child in &children {
                    dipole.radius = dipole.radius.max(child.centre.distance(dipole.centre) + child.radius);
                }
            } else {
                let run = &tree.corners[node.at as usize..(node.at + node.count) as usize];
                for &[a, b, c] in run {
                    let area = 0.5 * (b - a).cross(c - a);
                    dipole.area += area;
                    dipole.total_area += area.length();
                    moment += (a + b + c) / 3.0 * area.length();
                }
                dipole.centre = (moment / dipole.total_area).max(node.low).min(node.high);
                for corner in run.iter().flatten() {
                    dipole.radius = dipole.radius.max(corner.distance(dipole.centre));
                }
            }
            // The diagonal of the box bounds the radius too, and more tightly than the sum over the levels.
            let corner = (dipole.centre - node.low).max(node.high - dipole.centre);
            dipole.radius = dipole.radius.min(corner.length());
            dipoles[i] = dipole;
        }
        Self { dipoles }
    }

    /// The generalised winding number (Jacobson et al. 2013, "Robust inside-outside segmentation using
    /// generalized winding numbers"; far triangles as in Barill et al. 2018, "Fast winding numbers for soups
    /// and clouds"): 1 inside a closed surface, 0 outside, in between near holes.
    pub(super) fn number(&self, tree: &Tree, p: Vec3) -> f32 {
        let mut solid_angle = 0.0;
        let mut near = Angles::default();
        let mut stack = [0_u32; 64];
        let mut count = usize::from(!self.dipoles.is_empty());
        while count > 0 {
            count -= 1;
            let index = stack[count] as usize;
            let dipole = &self.dipoles[index];
            let away = dipole.centre - p;
            let squared = away.length_squared();
            if squared > (FAR * dipole.radius).powi(2) {
                solid_angle += dipole.area.dot(away) / (squared * squared.sqrt());
                continue;
            }
            let node = &tree.nodes[index];
            if node.count == 0 {
                (stack[count], stack[count + 1]) = (index as u32 + 1, node.at);
                count += 2;
                continue;
            }
            near.add(tree.pack(node), node.count as usize, p);
        }
        (solid_angle + near.solid_angle()) / (2.0 * TAU)
    }

    /// Whether the surface winds around a point in either direction; in some files all triangles are inside
    /// out.
    pub(super) fn inside(&self, tree: &Tree, p: Vec3) -> bool {
        self.number(tree, p).abs() >= 0.5
    }
}

/// Sums of angles as products of complex numbers, so that a single arc tangent is needed: eight sums in
/// lanes.
#[derive(Clone, Copy, Debug)]
struct Angles {
    re: [f32; LANES],
    im: [f32; LANES],
    /// Full turns of each sum in addition to its complex number.
    turns: [f32; LANES],
}

impl Default for Angles {
    fn default() -> Self {
        Self { re: [1.0; LANES], im: [0.0; LANES], turns: [0.0; LANES] }
    }
}

impl Angles {
    /// Adds the half solid angles of the first `used` triangles of a pack, seen from a point.
    #[inline]
    #[expect(
        clippy::needless_bitwise_bool,
        reason = "a short circuit is a branch, which prevents vectorisation"
    )]
    fn add(&mut self, pack: &Pack, used: usize, p: Vec3) {
        let (re, im) = pack.half_solid_angles(p);
        let (mut unit_re, mut unit_im) = ([1.0; LANES], [0.0; LANES]);
        for k in 0..LANES {
            let size = re[k].abs() + im[k].abs();
            // In the plane of the triangle the sign is a rounding error; triangles without size are ignored
            // too.
            let flat = (re[k] < 0.0) & (im[k].abs() <= f32::EPSILON * size);
            let counts = (k < used) & (size > 0.0) & (size < f32::INFINITY) & !flat;
            let inverse = 1.0 / size;
            unit_re[k] = if counts { re[k] * inverse } else { 1.0 };
            unit_im[k] = if counts { im[k] * inverse } else { 0.0 };
        }
        let Self { re: all_re, im: all_im, turns } = self;
        for k in 0..LANES {
            let (re, im, turn) = sum([all_re[k], all_im[k]], [unit_re[k], unit_im[k]]);
            (all_re[k], all_im[k], turns[k]) = (re, im, turns[k] + turn);
        }
    }

    /// Twice the sum of the half angles.
    fn solid_angle(&self) -> f32 {
        let (mut re, mut im, mut turns) = (1.0, 0.0, 0.0);
        for k in 0..LANES {
            let turn;
            (re, im, turn) = sum([re, im], [self.re[k], self.im[k]]);
            turns += self.turns[k] + turn;
        }
        // Adding 0 removes the sign of a negative zero, which would add half a turn.
        2.0 * ((im + 0.0).atan2(re) + TAU * turns)
    }
}

/// The sum of two angles between minus and plus half a turn, as complex numbers of size about one, and the
/// full turns by which it exceeds that range.
#[inline]
#[expect(clippy::needless_bitwise_bool, reason = "a short circuit is a branch, which prevents vectorisation")]
fn sum([ar, ai]: [f32; 2], [br, bi]: [f32; 2]) -> (f32, f32, f32) {
    let (re, im) = (ar * br - ai * bi, ar * bi + ai * br);
    let up = if (ai >= 0.0) & (bi >= 0.0) & (im < 0.0) { 1.0 } else { 0.0 };
    let down = if (ai < 0.0) & (bi < 0.0) & (im >= 0.0) { 1.0 } else { 0.0 };
    // The summands have size one, so the sum has at least size one half.
    let inverse = 1.0 / (re.abs() + im.abs());
    (re * inverse, im * inverse, up - down)
}

#[cfg(test)]
mod tests {
    use std::f32::consts::PI;

    use super::*;

    /// The solid angle of a triangle seen from the origin, positive from behind (Van Oosterom and Strackee 1983, "The
    /// solid angle of a plane triangle", equation 8).
    fn solid_angle_of([a, b, c]: [Vec3; 3]) -> f64 {
        let [a, b, c] = [a, b, c].map(Vec3::as_dvec3);
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        let angle = a.dot(b.cross(c)).atan2(la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
        if (angle.abs() as f32) < PI { 2.0 * angle } else { 0.0 }
    }

    /// A number from -1 to 1.
    fn random(seed: &mut u64) -> f32 {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((*seed >> 40) as f32 / (1 << 23) as f32) - 1.0
    }

    /// An open soup of overlapping triangles, and a surface that winds around its inside many times.
    fn soups(seed: &mut u64) -> [Vec<[Vec3; 3]>; 2] {
        let mut at = |size: f32| Vec3::new(random(seed), random(seed), random(seed)) * size;
        let soup = (0..300)
            .map(|_| {
                let a = at(1.0);
                [a, a + at(0.4), a + at(0.4)]
            })
            .collect();
        let corners = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z];
        let faces = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
        let shells = (0..7).flat_map(|_| faces.map(|face| face.map(|corner: usize| corners[corner])));
        [soup, shells.collect()]
    }

    #[test]
    fn complex_products_sum_the_angles() {
        let mut seed = 5;
        for soup in soups(&mut seed) {
            let tree = Tree::new(&soup);
            let mut all = Angles::default();
            let mut most = 0.0_f64;
            for _ in 0..2000 {
                let p = Vec3::new(random(&mut seed), random(&mut seed), random(&mut seed)) * 1.2;
                all = Angles::default();
                for node in tree.nodes.iter().filter(|node| node.count > 0) {
                    all.add(tree.pack(node), node.count as usize, p);
                }
                let wanted: f64 = soup.iter().map(|t| solid_angle_of(t.map(|corner| corner - p))).sum();
                let off = (f64::from(all.solid_angle()) - wanted).abs();
                most = most.max(wanted.abs());
                // Measured: 4e-5. A lost turn would be 12.6.
                assert!(off < 1e-3, "{p}: {} for {wanted}", all.solid_angle());
            }
            assert!(most > 6.0, "control: the sum exceeds a full turn, {most}");
            assert!(all.turns.iter().all(|turns| turns.abs() < 20.0));
        }
    }

    #[test]
    fn points_in_the_plane_of_a_triangle_or_on_its_corners_have_winding_number_zero() {
        let tree = Tree::new(&[[Vec3::ZERO, Vec3::X, Vec3::Y]]);
        let winding = Winding::new(&tree);
        for p in [Vec3::new(0.2, 0.2, 0.0), Vec3::ZERO, Vec3::X, Vec3::new(0.5, 0.5, 0.0)] {
            assert_eq!(winding.number(&tree, p), 0.0, "{p}");
        }
    }
}
