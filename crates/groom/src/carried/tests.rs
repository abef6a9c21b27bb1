use glam::{Mat3, Quat, Vec3};

use super::*;
use crate::Strands;

/// A band across the upper half of a face that bulges toward +Z, with masks of brows and of a lid.
struct Face {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    brow: Vec<f32>,
    lid: Vec<f32>,
}

const COLUMNS: usize = 41;
const ROWS: usize = 21;

fn face() -> Face {
    let mut face = Face {
        positions: Vec::new(),
        normals: Vec::new(),
        triangles: Vec::new(),
        brow: Vec::new(),
        lid: Vec::new(),
    };
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            let (x, y) = ((column as f32 - 20.0) * 0.003, (row as f32 - 10.0) * 0.002);
            let p = Vec3::new(x, 1.6 + y, 0.1 - 5.0 * x * x);
            face.positions.push(p);
            face.normals.push(Vec3::new(10.0 * x, 0.0, 1.0).normalize_or_zero());
            let sideways = x.abs() > 0.014 && x.abs() < 0.046;
            face.brow.push(if sideways && (3..=5).contains(&(row as i32 - 10)) { 1.0 } else { 0.0 });
            // The rim is the lowest row of a band.
            face.lid.push(if sideways && (6..=7).contains(&row) { 1.0 } else { 0.0 });
        }
    }
    for row in 0..ROWS - 1 {
        for column in 0..COLUMNS - 1 {
            let a = (row * COLUMNS + column) as u32;
            let b = a + COLUMNS as u32;
            face.triangles.extend([[a, a + 1, b], [a + 1, b + 1, b]]);
        }
    }
    face
}

impl Face {
    fn surface(&self) -> SkinSurface<'_> {
        SkinSurface { positions: &self.positions, normals: &self.normals, triangles: &self.triangles }
    }

    fn hair(&self, grooms: &[SkinGroom]) -> Option<SkinHair> {
        let mask = |name: &str| match name {
            "_BROW" => Some(&self.brow[..]),
            "_LASH_UPPER" => Some(&self.lid[..]),
            _ => None,
        };
        SkinHair::grow(&self.surface(), grooms, mask, 1.0)
    }

    /// The distance of a point from the surface with other positions.
    fn distance(&self, positions: &[Vec3], p: Vec3) -> f32 {
        let to = |triangle: &[u32; 3]| {
            let corners = triangle.map(|i| positions[i as usize]);
            let weights = lovelock_base::triangle::closest_barycentric(p, &corners);
            (0..3).map(|k| corners[k] * weights[k]).sum::<Vec3>().distance(p)
        };
        self.triangles.iter().map(to).fold(f32::INFINITY, f32::min)
    }
}

fn roots(strands: &Strands) -> Vec<Vec3> {
    strands.first_point[..strands.count()].iter().map(|&first| strands.point(first as usize)).collect()
}

#[test]
fn hair_stays_on_the_skin_that_moves_it_and_keeps_its_length() {
    let face = face();
    let hair = face.hair(&[BROWS, UPPER_LASHES, LOWER_LASHES]).expect("hair");
    let mut rest = Strands::default();
    hair.place(&face.positions, &mut rest);
    let turn = Quat::from_rotation_y(0.7) * Quat::from_rotation_x(0.4);
    // A turn, a shift, and what a morph target does to the lid.
    let moved: Vec<Vec3> = face
        .positions
        .iter()
        .zip(&face.lid)
        .map(|(p, lid)| turn * (*p - Vec3::Y * 0.006 * lid) + Vec3::new(0.3, -0.2, 1.0))
        .collect();
    let mut strands = Strands::default();
    hair.place(&moved, &mut strands);
    for (root, before) in roots(&strands).into_iter().zip(roots(&rest)) {
        assert!(face.distance(&moved, root) < 1e-6, "{root}");
        assert!(face.distance(&face.positions, before) < 1e-6, "{before}");
        assert!(face.distance(&face.positions, root) > 0.1, "the control: it has moved");
    }
    for ends in strands.first_point.windows(2) {
        for i in ends[0] as usize..ends[1] as usize - 1 {
            let link = |of: &Strands| of.point(i).distance(of.point(i + 1));
            assert!((link(&strands) - link(&rest)).abs() < 1e-6);
        }
    }
}

#[test]
fn a_rigid_motion_carries_every_point() {
    let face = face();
    let hair = face.hair(&[BROWS, UPPER_LASHES]).expect("hair");
    let (turn, shift) = (Mat3::from_rotation_z(1.1) * Mat3::from_rotation_y(0.4), Vec3::new(0.1, 2.0, -0.5));
    let moved: Vec<Vec3> = face.positions.iter().map(|p| turn * *p + shift).collect();
    let (mut rest, mut strands) = (Strands::default(), Strands::default());
    hair.place(&face.positions, &mut rest);
    hair.place(&moved, &mut strands);
    for i in 0..rest.points() {
        assert!(strands.point(i).distance(turn * rest.point(i) + shift) < 2e-6);
    }
}

#[test]
fn a_lid_that_closes_takes_its_lashes_along() {
    let face = face();
    let hair = face.hair(&[BROWS, UPPER_LASHES]).expect("hair");
    let closed: Vec<Vec3> =
        face.positions.iter().zip(&face.lid).map(|(p, lid)| *p - Vec3::Y * 0.008 * lid).collect();
    let (mut open, mut shut) = (Strands::default(), Strands::default());
    hair.place(&face.positions, &mut open);
    hair.place(&closed, &mut shut);
    let brows = BROWS.strands as usize;
    let (before, after) = (roots(&open), roots(&shut));
    assert_eq!(before[..brows], after[..brows], "brows are elsewhere");
    for (a, b) in before[brows..].iter().zip(&after[brows..]) {
        assert!((*a - *b).abs_diff_eq(Vec3::Y * 0.008, 1e-6), "{a} {b}");
    }
}

#[test]
fn the_count_is_that_of_the_groom_and_more_hair_begins_with_the_same() {
    let face = face();
    let of = |strands: f32| {
        let hair = face.hair(&[SkinGroom { strands, ..BROWS }]);
        let mut out = Strands::default();
        if let Some(hair) = &hair {
            assert_eq!(hair.count(), strands as usize);
            hair.place(&face.positions, &mut out);
        }
        out
    };
    let (few, many) = (of(200.0), of(500.0));
    assert_eq!((few.count(), many.count()), (200, 500));
    assert_eq!(few.x[..], many.x[..few.points()]);
    assert_eq!(many.y, of(500.0).y, "seeded");
    assert!(face.hair(&[SkinGroom { strands: 0.0, ..BROWS }]).is_none());
    assert!(face.hair(&[SkinGroom { strands: f32::NAN, ..BROWS }]).is_none());
    assert!(face.hair(&[LOWER_LASHES]).is_none(), "without a mask");
    assert!(face.hair(&[]).is_none());
    let everywhere = Face { brow: vec![1.0; face.brow.len()], ..face };
    assert!(everywhere.hair(&[BROWS]).is_none(), "a mask of the whole body");
}

#[test]
fn brows_lie_toward_the_temples_and_lashes_curve_up() {
    let face = face();
    let hair = face.hair(&[BROWS, UPPER_LASHES]).expect("hair");
    let mut strands = Strands::default();
    hair.place(&face.positions, &mut strands);
    let ends = |s: usize| {
        let first = strands.first_point[s] as usize;
        (strands.point(first), strands.point(strands.first_point[s + 1] as usize - 1))
    };
    let brows = BROWS.strands as usize;
    let (mut outward, mut left) = (0, 0);
    for s in 0..brows {
        let (root, tip) = ends(s);
        outward += usize::from((tip.x - root.x) * root.x.signum() > 0.0);
        left += usize::from(root.x < 0.0);
        let above = tip.z - (0.1 - 5.0 * tip.x * tip.x);
        assert!((-0.0003..0.003).contains(&above), "{above} above the skin");
        let length: f32 = (0..6)
            .map(|k| strands.first_point[s] as usize + k)
            .map(|i| strands.point(i).distance(strands.point(i + 1)))
            .sum();
        assert!((0.0054..0.0091).contains(&length), "{length}");
        assert!(root.x.abs() > 0.011 && root.x.abs() < 0.049 && root.y > 1.603, "{root}");
    }
    assert!(outward > brows * 9 / 10, "{outward}");
    assert!(left.abs_diff(brows / 2) < brows / 10, "{left} of {brows}");
    for s in brows..hair.count() {
        let (root, tip) = ends(s);
        assert!(tip.z > root.z + 0.002 && tip.y > root.y, "{root} {tip}");
        assert!((root.y - 1.592).abs() < 1e-5, "on the rim of the lid: {root}");
    }
    // Roots fill the rim evenly.
    let mut rim: Vec<f32> = roots(&strands)[brows..].iter().map(|p| p.x).filter(|x| *x > 0.0).collect();
    rim.sort_by(f32::total_cmp);
    let widest = rim.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f32::max);
    assert!(widest < 0.0012, "a gap of {widest}");
}

#[test]
fn surfaces_that_are_broken_grow_nothing_that_is() {
    let mut face = face();
    face.positions[5 * COLUMNS + 3] = Vec3::NAN;
    let brow = face.positions.len() - 7 * COLUMNS;
    for p in &mut face.positions[brow..brow + 5] {
        *p = Vec3::splat(f32::INFINITY);
    }
    face.triangles.push([0, 1, 9_999_999]);
    face.brow.truncate(600);
    if let Some(hair) = face.hair(&[BROWS, UPPER_LASHES]) {
        let mut strands = Strands::default();
        hair.place(&face.positions, &mut strands);
        assert!(strands.x.iter().all(|x| x.is_finite()));
        // Fewer vertices, and a face that has shrunk to a point.
        hair.place(&face.positions[..4], &mut strands);
        hair.place(&vec![Vec3::ONE; face.positions.len()], &mut strands);
        assert!(strands.x.iter().all(|x| (*x - 1.0).abs() < 1e-6));
    }
}
