//! How often a surface winds around a point: what tells inside from outside even where triangles fold over, overlap,
//! intersect or leave holes, which mislead the normal of the closest point.

use std::f32::consts::{PI, TAU};

use glam::Vec3;

use super::tree::Tree;

/// A run of triangles is one dipole from farther away than so many of its radii; whole windings are then off by
/// less than 0.1 (see the tests), and a half is what tells.
const FAR: f32 = 2.0;

/// What a run of triangles looks like from afar.
#[derive(Clone, Copy, Debug, Default)]
struct Dipole {
    /// Mean of the triangles' centres by area.
    centre: Vec3,
    /// Sum of the triangles' normals by area.
    area: Vec3,
    /// Of the ball around the centre that holds the triangles.
    radius: f32,
    total_area: f32,
}

/// One dipole for each node of the tree.
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
            // A box's own diagonal bounds the radius too, and is less than what adds up over the levels.
            let corner = (dipole.centre - node.low).max(node.high - dipole.centre);
            dipole.radius = dipole.radius.min(corner.length());
            dipoles[i] = dipole;
        }
        Self { dipoles }
    }

    /// The generalised winding number (Jacobson et al. 2013, "Robust inside-outside segmentation using generalized
    /// winding numbers"; far triangles as in Barill et al. 2018, "Fast winding numbers for soups and clouds"):
    /// 1 inside a closed surface, 0 outside, between them near holes.
    pub(super) fn number(&self, tree: &Tree, p: Vec3) -> f32 {
        let mut solid_angle = 0.0;
        let mut waiting = [0_u32; 64];
        let mut count = usize::from(!self.dipoles.is_empty());
        while count > 0 {
            count -= 1;
            let index = waiting[count] as usize;
            let dipole = &self.dipoles[index];
            let away = dipole.centre - p;
            let squared = away.length_squared();
            if squared > (FAR * dipole.radius).powi(2) {
                solid_angle += dipole.area.dot(away) / (squared * squared.sqrt());
                continue;
            }
            let node = &tree.nodes[index];
            if node.count == 0 {
                (waiting[count], waiting[count + 1]) = (index as u32 + 1, node.at);
                count += 2;
                continue;
            }
            for corners in &tree.corners[node.at as usize..(node.at + node.count) as usize] {
                solid_angle += solid_angle_of(corners.map(|corner| corner - p));
            }
        }
        solid_angle / (2.0 * TAU)
    }

    /// Whether the surface winds around a point, either way: some files turn all their triangles inside out.
    pub(super) fn inside(&self, tree: &Tree, p: Vec3) -> bool {
        self.number(tree, p).abs() >= 0.5
    }
}

/// The solid angle of a triangle seen from the origin, positive from behind (Van Oosterom and Strackee 1983, "The
/// solid angle of a plane triangle", equation 8).
fn solid_angle_of([a, b, c]: [Vec3; 3]) -> f32 {
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let volume = a.dot(b.cross(c));
    let angle = volume.atan2(la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
    // In the plane of the triangle the sign is that of rounding.
    if angle.abs() < PI { 2.0 * angle } else { 0.0 }
}
