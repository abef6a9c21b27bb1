//! Where light enters clusters: there the map of the hair is looked up if layers shadow each other, so that a cluster is not shadowed
//! twice by itself.

use std::sync::Arc;

use glam::{Vec2, Vec3};
use lovelock_groom::Strands;
use lovelock_satf::ClusterHair;
use rayon::prelude::*;

/// Moves the points of the ribs toward a light, to the surface of their cluster: the ellipse of their section.
pub(super) fn place(hair: &ClusterHair, ribs: &Strands, to_light: Vec3, out: &mut Strands) {
    let (around, points) = (hair.grid.around, hair.grid.points());
    out.first_point = Arc::clone(&ribs.first_point);
    let of_cluster = hair.grid.rib_points();
    let [x, y, z] = [&mut out.x, &mut out.y, &mut out.z].map(|axis| {
        axis.resize(ribs.points(), 0.0);
        &mut axis[..]
    });
    let axes = x.par_iter_mut().zip(y).zip(z).with_min_len(of_cluster).enumerate();
    axes.for_each(|(at, ((x, y), z))| {
        let (cluster, k) = (at / of_cluster, at % of_cluster);
        let outer = cluster * of_cluster + around * points;
        let (rib, i) = (k / points, k % points);
        let radius = if rib < around { hair.core } else { 1.0 };
        let rim = |rib: usize| ribs.point(outer + rib * points + i);
        let moved = ribs.point(at) + to_light * way_out(rim, around, (rib % around, radius), to_light);
        [*x, *y, *z] = moved.to_array();
    });
}

/// Light along the hair would go a long way in it: at most so far, metres.
const FARTHEST: f32 = 0.1;

/// How far it is in a direction from the point of rib `rib` at `radius` of its section to the surface, metres.
fn way_out(rim: impl Fn(usize) -> Vec3, around: usize, (rib, radius): (usize, f32), direction: Vec3) -> f32 {
    let angle = |k: usize| Vec2::from_angle(std::f32::consts::TAU * k as f32 / around as f32);
    // The axes of the ellipse to which the disk's axes are mapped.
    let scale = 2.0 / around as f32;
    let x: Vec3 = (0..around).map(|k| rim(k) * (angle(k).x * scale)).sum();
    let y: Vec3 = (0..around).map(|k| rim(k) * (angle(k).y * scale)).sum();
    // The direction in the disk, by least squares: what is along the hair leaves the place in the disk as it is.
    let (xx, xy, yy) = (x.dot(x), x.dot(y), y.dot(y));
    let determinant = xx * yy - xy * xy;
    let (dx, dy) = (x.dot(direction), y.dot(direction));
    let d = Vec2::new(yy * dx - xy * dy, xx * dy - xy * dx) / determinant;
    let from = angle(rib) * radius;
    // |from + way d| = 1.
    let (a, b, c) = (d.length_squared(), from.dot(d), radius * radius - 1.0);
    let way = ((b * b - a * c).max(0.0).sqrt() - b) / a;
    // False for NaN.
    if way > 0.0 { way.min(FARTHEST) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_out_of_a_circle_and_of_an_ellipse_is_that_on_paper() {
        let rim = |a: f32, b: f32| {
            move |k: usize| {
                let angle = std::f32::consts::TAU * k as f32 / 8.0;
                Vec3::new(1.0 + a * angle.cos(), 2.0, b * angle.sin())
            }
        };
        let way = |a, b, from, direction: Vec3| way_out(rim(a, b), 8, from, direction);
        // From the rim outward, and across the whole circle.
        assert!(way(0.01, 0.01, (0, 1.0), Vec3::X).abs() < 1e-6);
        assert!((way(0.01, 0.01, (0, 1.0), Vec3::NEG_X) - 0.02).abs() < 1e-6);
        // From the core: 0.35 of the axis, then across it.
        assert!((way(0.02, 0.01, (0, 0.35), Vec3::X) - 0.65 * 0.02).abs() < 1e-6);
        let across = 0.01 * (1.0_f32 - 0.35 * 0.35).sqrt();
        assert!((way(0.02, 0.01, (0, 0.35), Vec3::Z) - across).abs() < 1e-6);
        // Along the hair it is as far as is allowed, or not defined, and without a section it is nothing.
        assert!((0.0..=FARTHEST).contains(&way(0.02, 0.01, (0, 0.35), Vec3::Y)));
        assert_eq!(way(0.0, 0.0, (0, 1.0), Vec3::X), 0.0);
    }
}
