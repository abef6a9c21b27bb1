use std::{collections::HashMap, path::Path};

use glam::{Quat, Vec3};
use lovelock_base::random::SplitMix64;
use lovelock_testkit::suite::sample;

use super::*;
use crate::{Character, load_character};

/// Uniform in the box from `low` to `high`.
fn within(random: &mut SplitMix64, low: Vec3, high: Vec3) -> Vec3 {
    low + (high - low) * Vec3::new(random.unit(), random.unit(), random.unit())
}

type Surface = (Vec<Vec3>, Vec<[u32; 3]>);

/// Maps a grid of `n` by `n` parameters on each side of a cube by `at`; the surface is split along the cube's
/// edges.
fn from_cube(n: u32, at: impl Fn(Vec3) -> Vec3) -> Surface {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let first = positions.len() as u32;
            for i in 0..=n {
                for j in 0..=n {
                    let [u, v] = [i, j].map(|k| 2.0 * k as f32 / n as f32 - 1.0);
                    let mut p = [0.0; 3];
                    (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (side, u, v);
                    positions.push(at(Vec3::from(p)));
                }
            }
            for i in 0..n {
                for j in 0..n {
                    let [a, b] = [first + i * (n + 1) + j, first + (i + 1) * (n + 1) + j];
                    let quad = if side > 0.0 { [a, b, b + 1, a + 1] } else { [a, a + 1, b + 1, b] };
                    triangles.extend([[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]);
                }
            }
        }
    }
    (positions, triangles)
}

/// The same surface with separate vertices for every triangle.
fn split((positions, triangles): &Surface) -> Surface {
    let corners = triangles.iter().flatten().map(|&v| positions[v as usize]).collect();
    (corners, (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect())
}

fn sphere(centre: Vec3, radius: f32) -> Surface {
    from_cube(48, |p| centre + radius * p.normalize_or(Vec3::Y))
}

/// A capsule along Y with half the distance `half` between the centres of its caps.
fn capsule(half: f32, radius: f32) -> Surface {
    from_cube(48, |p| {
        // The middle half of the sides is the cylinder.
        let cap = p.y.signum() * (2.0 * p.y.abs() - 1.0).max(0.0);
        let along = (2.0 * p.y).clamp(-1.0, 1.0) * half;
        radius * p.with_y(cap).normalize_or(Vec3::Y) + Vec3::Y * along
    })
}

/// Largest errors of distance within `near` of the surface and overall, compared with the formula `truth`.
fn errors(surface: &Surface, near: f32, truth: impl Fn(Vec3) -> f32) -> (f32, f32) {
    let distance = RestDistance::of_triangles(&surface.0, &surface.1);
    let mut random = SplitMix64::new(1);
    let mut worst = (0.0_f32, 0.0_f32);
    for _ in 0..100_000 {
        let p = within(&mut random, Vec3::splat(-0.3), Vec3::splat(0.3));
        let error = (distance.distance(p).0 - truth(p)).abs();
        worst.1 = worst.1.max(error);
        if truth(p).abs() < near {
            worst.0 = worst.0.max(error);
        }
    }
    worst
}

#[test]
fn simple_solids_long_suite() {
    // The triangles lie inside the sphere by r (1 - cos(angle / 2)), up to 0.06 mm, and interpolation between
    // corners 7 mm apart is off by cell^2 / 4r, 0.15 mm; over the centre by less than half a cell.
    let ball = sphere(Vec3::ZERO, 0.1);
    for surface in [&ball, &split(&ball)] {
        let (near, far) = errors(surface, 0.02, |p| p.length() - 0.1);
        assert!(near < 2.5e-4 && far < 3.5e-3, "{near} {far}");
    }
    let half = Vec3::new(0.08, 0.1, 0.12);
    let turn = Quat::from_rotation_y(0.4) * Quat::from_rotation_x(0.3);
    let block = from_cube(2, |p| turn * (p * half));
    for surface in [&block, &split(&block)] {
        let truth = |p: Vec3| {
            let out = (turn.inverse() * p).abs() - half;
            out.max(Vec3::ZERO).length() + out.max_element().min(0.0)
        };
        // Fine cells of 2 mm at an edge cut its corner by less than a third of their side, and coarse ones of
        // 7 mm the ridges in the middle by less than a third of theirs.
        let (near, far) = errors(surface, 0.003, truth);
        assert!(near < 7e-4 && far < 5e-3, "{near} {far}");
    }
    // As for the sphere, with 4 cm around the axis 2 cm deep: 0.3 mm.
    let pill = capsule(0.08, 0.06);
    for surface in [&pill, &split(&pill)] {
        let truth = |p: Vec3| (p - Vec3::Y * p.y.clamp(-0.08, 0.08)).length() - 0.06;
        let (near, far) = errors(surface, 0.02, truth);
        assert!(near < 4e-4 && far < 4e-3, "{near} {far}");
    }
}

#[test]
fn a_closed_surface_is_recognised_with_split_vertices() {
    let (positions, mut triangles) = split(&from_cube(2, |p| p));
    assert!(surface::is_closed(&surface::corners(&positions, &triangles)));
    // A flipped or missing triangle leaves a border.
    triangles[3].swap(0, 1);
    assert!(!surface::is_closed(&surface::corners(&positions, &triangles)));
    triangles.remove(3);
    assert!(!surface::is_closed(&surface::corners(&positions, &triangles)));
}

#[test]
fn inside_of_imperfect_surfaces() {
    let ball = sphere(Vec3::ZERO, 0.1);
    // Inside out.
    let turned: Vec<_> = ball.1.iter().map(|&[a, b, c]| [a, c, b]).collect();
    // A hole of 3 cm, as for an eye.
    let holed: Vec<_> =
        (ball.1.iter().copied()).filter(|t| ball.0[t[0] as usize].distance(Vec3::Z * 0.1) > 0.015).collect();
    // A second ball through the side, which leaves walls inside.
    let (mut positions, mut crossed) = ball.clone();
    let other = sphere(Vec3::X * 0.09, 0.05);
    crossed.extend(other.1.iter().map(|t| t.map(|v| v + positions.len() as u32)));
    positions.extend(other.0);
    let names = ["turned", "holed", "crossed"];
    let surfaces = [(&ball.0, &turned), (&ball.0, &holed), (&positions, &crossed)];
    for (name, (positions, triangles)) in names.into_iter().zip(surfaces) {
        let distance = RestDistance::of_triangles(positions, triangles);
        let mut random = SplitMix64::new(2);
        for _ in 0..5000 {
            let p = within(&mut random, Vec3::splat(-0.15), Vec3::splat(0.15));
            let mut truth = p.length() - 0.1;
            if name == "crossed" {
                truth = truth.min(p.distance(Vec3::X * 0.09) - 0.05);
            }
            // Over the hole the surface is where half of the ball is visible; 2 mm are a few cells.
            let over_hole = name == "holed" && p.z > 0.0 && p.truncate().length() < 0.03;
            if truth.abs() > 0.002 && !over_hole {
                assert_eq!(distance.distance(p).0 < 0.0, truth < 0.0, "{name} {p}");
            }
        }
    }
}

#[test]
fn winding_numbers_are_whole() {
    let (positions, triangles) = sphere(Vec3::ZERO, 0.1);
    let exact = Exact::new(&surface::corners(&positions, &triangles));
    let mut random = SplitMix64::new(3);
    for _ in 0..20_000 {
        let p = within(&mut random, Vec3::splat(-0.2), Vec3::splat(0.2));
        let truth = f32::from(p.length() < 0.1);
        if (p.length() - 0.1).abs() > 1e-4 {
            let number = exact.winding.number(&exact.tree, p);
            assert!((number - truth).abs() < 0.1, "{number} at {p}");
        }
    }
}

/// Counts pairs of points, one of them within `near` of the surface, whose distances differ by more than the
/// distance between the points plus `tolerance` metres.
fn steep_pairs(
    distance: impl Fn(Vec3) -> f32,
    [low, high]: [Vec3; 2],
    pairs: usize,
    tolerance: f32,
    near: f32,
) -> usize {
    let mut random = SplitMix64::new(4);
    let pair = |_| {
        let p = within(&mut random, low, high);
        let apart = 0.03 * random.unit().powi(2);
        let q = p + apart * within(&mut random, Vec3::NEG_ONE, Vec3::ONE).normalize_or(Vec3::X);
        let q = q.clamp(low, high);
        let [from, to] = [p, q].map(&distance);
        usize::from(from.abs().min(to.abs()) < near && (from - to).abs() > p.distance(q) + tolerance)
    };
    (0..pairs).map(pair).sum()
}

/// The sign by the angle-weighted normal of the closest vertex alone, which is wrong at folded triangles.
fn signed_by_normals(positions: &[Vec3], triangles: &[[u32; 3]]) -> impl Fn(Vec3) -> f32 {
    let corners = surface::corners(positions, triangles);
    let mut normals: HashMap<[u32; 3], Vec3> = HashMap::new();
    for [a, b, c] in &corners {
        let normal = (b - a).cross(c - a).normalize_or_zero();
        for (p, q, r) in [(a, b, c), (b, c, a), (c, a, b)] {
            let angle = (q - p).angle_between(r - p);
            *normals.entry(p.to_array().map(f32::to_bits)).or_default() += normal * angle;
        }
    }
    let tree = Tree::new(&corners);
    move |p| {
        let hit = tree.closest(p, None).unwrap();
        let nearest = tree.corners[hit.triangle as usize].into_iter();
        let vertex = nearest.min_by(|a, b| a.distance(hit.at).total_cmp(&b.distance(hit.at))).unwrap();
        (p - hit.at).length().copysign((p - hit.at).dot(normals[&vertex.to_array().map(f32::to_bits)]))
    }
}

/// Head and torso, within the grid.
const REACH_OF_PAIRS: [Vec3; 2] = [Vec3::new(-0.3, -0.7, -0.3), Vec3::splat(0.3)];

fn is_lipschitz(file: &Path) -> Option<Character> {
    let Ok(character) = load_character(file) else {
        println!("skipped: no {}", file.display());
        return None;
    };
    let body = &character.body;
    let distance = RestDistance::new(body);
    let grid = distance.grid.as_ref().unwrap();
    assert!(grid.bytes() < 10_000_000, "{}", grid.bytes());
    // Interpolated distances have a gradient up to a tenth above 1 in cells with an edge or halfway between
    // two parts of the body: at most 0.9 mm on these bodies in the coarse cells of 20 mm, and 0.6 mm for
    // pairs with a point near the surface.
    let interpolated = |p| distance.distance(p).0;
    assert_eq!(steep_pairs(interpolated, REACH_OF_PAIRS, 100_000, 1.5e-3, f32::MAX), 0, "{}", file.display());
    assert_eq!(steep_pairs(interpolated, REACH_OF_PAIRS, 100_000, 8e-4, 0.01), 0, "near: {}", file.display());
    // A hundredth of a millimetre allows for rounding.
    assert_eq!(
        steep_pairs(|p| distance.exact.distance(p).0, REACH_OF_PAIRS, 10_000, 1e-5, f32::MAX),
        0,
        "{}",
        file.display()
    );
    Some(character)
}

#[test]
fn neighbours_agree_on_the_dancer() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let Some(Character { body, .. }) = is_lipschitz(&root.join("assets/dancer.glb")) else { return };
    let head = body.skeleton.rest_position(body.head_joint);
    let positions: Vec<Vec3> = body.mesh.positions.iter().map(|&p| p - head).collect();
    let by_normals = signed_by_normals(&positions, &body.mesh.triangles);
    assert!(steep_pairs(by_normals, REACH_OF_PAIRS, 50_000, 1.5e-3, f32::MAX) > 0, "negative control");
}

#[test]
fn neighbours_agree_on_a_body() {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data");
    let data = std::env::var_os("LOVELOCK_DATA").map_or_else(|| beside.into(), std::path::PathBuf::from);
    is_lipschitz(&data.join("characters/mh_body.glb"));
}

#[test]
fn folded_slivers_do_not_change_the_sign() {
    // A point behind the shoulder, outside, closest to a sliver that folds over its neighbour.
    let Ok(character) =
        load_character(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/dancer.glb"))
    else {
        println!("skipped: no assets/dancer.glb");
        return;
    };
    let distance = RestDistance::new(&character.body);
    let p = Vec3::new(0.123, -0.106, -0.190);
    for (d, normal) in [distance.distance(p), distance.exact.distance(p)] {
        assert!(d > 0.1 && normal.z < -0.5, "{d} {normal}");
    }
}

#[test]
fn the_grid_is_the_same_for_any_number_of_threads() {
    let (positions, triangles) = sphere(Vec3::ZERO, 0.1);
    let [one, three] = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| RestDistance::of_triangles(&positions, &triangles))
    });
    assert_eq!(format!("{:?}", one.grid), format!("{:?}", three.grid));
}

#[test]
fn degenerate_and_huge_surfaces() {
    let nothing = RestDistance::of_triangles(&[], &[]);
    assert_eq!(nothing.distance(Vec3::ZERO), (f32::INFINITY, Vec3::Y));
    let points = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::NAN];
    // No area; a corner that is not finite; a corner that does not exist.
    let none = RestDistance::of_triangles(&points, &[[0, 1, 1], [0, 1, 3], [0, 1, 9]]);
    assert!(none.exact.tree.nodes.is_empty());
    let flat = RestDistance::of_triangles(&points, &[[0, 1, 2]]);
    assert!((flat.distance(Vec3::new(0.2, 0.2, 0.05)).0 - 0.05).abs() < 0.01);
    for scale in sample([1e-9, 1e-4, 1e12, 1e8, 1e37, 1e3], 2) {
        let (positions, triangles) = sphere(Vec3::ONE, 1.0);
        let positions: Vec<Vec3> = positions.iter().map(|p| p * scale).collect();
        let distance = RestDistance::of_triangles(&positions, &triangles);
        assert!(distance.grid.as_ref().is_none_or(|grid| grid.bytes() < 30_000_000));
        for p in [Vec3::ZERO, Vec3::ONE * scale, Vec3::X, Vec3::NAN, Vec3::INFINITY] {
            let (_, normal) = distance.distance(p);
            assert!(normal.is_finite(), "{scale} {p}");
        }
    }
    let mut random = SplitMix64::new(5);
    // A cloud of triangles that fills its volume makes the cells larger, not more numerous.
    let positions: Vec<Vec3> = (0..12_000).map(|_| within(&mut random, Vec3::NEG_ONE, Vec3::ONE)).collect();
    let cloud: Vec<Vec3> =
        positions.chunks(3).flat_map(|c| [c[0], c[0].lerp(c[1], 0.02), c[0].lerp(c[2], 0.02)]).collect();
    let triangles: Vec<[u32; 3]> = (0..4000).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let distance = RestDistance::of_triangles(&cloud, &triangles);
    assert!(distance.grid.unwrap().bytes() < 30_000_000);
}

#[test]
fn points_outside_the_bounds_are_outside_a_repeated_surface() {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];
    let sheets: Vec<[u32; 3]> = (0..5).flat_map(|_| [[0, 1, 2], [0, 2, 3]]).collect();
    let exact = Exact::new(&surface::corners(&corners, &sheets));
    let p = Vec3::new(0.5, 0.5, -0.01);
    let number = exact.winding.number(&exact.tree, p);
    assert!(number.abs() > 2.0, "control: five nearby sheets wind twice around a point, {number}");
    assert!(exact.distance(p).0 > 0.0);
}
