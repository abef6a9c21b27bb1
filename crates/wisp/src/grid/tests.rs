use lovelock_groom::Guides;

use super::*;
use crate::lanes::Map;
use crate::rest::blocks_of;

/// Straight guides of 20 cm on a square lattice of `side` by `side`, `gap` metres apart.
fn lattice(side: usize, gap: f32) -> Vec<Block> {
    let mut guides = Guides { points_per_guide: 21, ..Guides::default() };
    for n in 0..side * side {
        let root = gap * Vec3::new((n % side) as f32, 0.0, (n / side) as f32);
        let points: Vec<Vec3> = (0..21).map(|i| root + Vec3::NEG_Y * (0.01 * i as f32)).collect();
        guides.push(&points);
    }
    let mut blocks: Vec<Block> =
        blocks_of(&guides).into_iter().map(|(l, u)| Block::new(&guides, l, u, 1)).collect();
    for block in &mut blocks {
        block.place_at_rest(&Map::IDENTITY);
    }
    blocks
}

#[test]
fn all_the_hair_is_in_the_grid() {
    let blocks = lattice(5, 0.02);
    let grid = DensityGrid::new(&blocks);
    let mass: f64 = grid.cells.iter().map(|c| f64::from(c[0])).sum();
    // 25 guides of 20 cm; each of the eight shares of a point loses at most one unit in rounding.
    let want = 25.0 * 0.2 * f64::from(grid.units);
    assert!((mass / want - 1.0).abs() < 0.06, "{mass} against {want}");
}

#[test]
fn at_rest_nothing_is_over_dense_and_squeezed_it_is() {
    let mut blocks = lattice(5, 0.02);
    let mut grid = DensityGrid::new(&blocks);
    assert_eq!(grid.update(&blocks, &Map::IDENTITY, Repulsion::default()), 0);
    let squeeze = Map { turn: Mat3::from_diagonal(Vec3::new(0.3, 1.0, 0.3)), shift: Vec3::ZERO };
    assert!(grid.update(&blocks, &squeeze, Repulsion::default()) > 0);
    // Order does not matter.
    let forward = grid.cells.clone();
    blocks.reverse();
    grid.update(&blocks, &squeeze, Repulsion::default());
    assert!(forward == grid.cells);
}

#[test]
fn crowded_hair_is_pushed_apart() {
    for mode in [RepulsionMode::Pressure, RepulsionMode::Centre] {
        let blocks = lattice(5, 0.02);
        let mut grid = DensityGrid::new(&blocks);
        let squeeze = Map { turn: Mat3::from_diagonal(Vec3::new(0.3, 1.0, 0.3)), shift: Vec3::ZERO };
        grid.update(&blocks, &squeeze, Repulsion { mode, ..Repulsion::default() });
        // The bundle now spans 0 to 24 mm in x and z around 12 mm.
        let mut outward = 0.0;
        for block in &blocks {
            for k in 0..block.used {
                let p = squeeze.apply(at(&block.position[10], k));
                let sample = grid.sample(p).expect("hair");
                let from_axis = p - Vec3::new(0.012, p.y, 0.012);
                outward += sample.push.dot(from_axis);
            }
        }
        assert!(outward > 0.0, "{mode:?} pulls: {outward}");
    }
}

#[test]
fn the_mean_velocity_is_that_of_the_hair_around() {
    let mut blocks = lattice(4, 0.01);
    let mut grid = DensityGrid::new(&blocks);
    for block in &mut blocks {
        for row in &mut block.velocity {
            for k in 0..LANES {
                put(row, k, Vec3::new(1.0, -2.0, 0.5));
            }
        }
    }
    grid.update(&blocks, &Map::IDENTITY, Repulsion::default());
    let sample = grid.sample(Vec3::new(0.015, -0.1, 0.015)).expect("hair");
    // Momentum is rounded down to about a thousandth.
    assert!((sample.mean_velocity - Vec3::new(1.0, -2.0, 0.5)).length() < 0.01, "{sample:?}");
    assert!(grid.sample(Vec3::splat(0.25)).is_none(), "where no hair is there is no mean");
}

#[test]
fn hair_outside_the_grid_and_nonsense_are_left_out() {
    let blocks = lattice(2, 0.01);
    let mut grid = DensityGrid::new(&blocks);
    let away = Map { turn: Mat3::IDENTITY, shift: Vec3::splat(100.0) };
    assert_eq!(grid.update(&blocks, &away, Repulsion::default()), 0);
    let nonsense = Map { turn: Mat3::IDENTITY, shift: Vec3::splat(f32::NAN) };
    assert_eq!(grid.update(&blocks, &nonsense, Repulsion::default()), 0);
    assert!(grid.cells.iter().all(|c| c[0] == 0));
}
