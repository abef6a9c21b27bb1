//! The up axis of shipped hairstyles, written as hair files in all rotations.

use glam::{Mat3, Vec3};
use lovelock_groom::{Hairstyle, UpAxis, guess_units, load_hair_bytes};
use lovelock_project::styles::{StyleParts, shipped};

use crate::testing::{load, small_project};

/// The guides as a file of USC-HairSalon, rotated.
fn data(style: &Hairstyle, rotation: Mat3) -> Vec<u8> {
    let (count, per) = (style.guides.count(), style.guides.points_per_guide);
    let mut bytes = (count as i32).to_le_bytes().to_vec();
    for guide in 0..count {
        bytes.extend((per as i32).to_le_bytes());
        let points = (0..per).map(|k| rotation * style.guides.point(guide, k));
        bytes.extend(points.flat_map(|point| point.to_array()).flat_map(f32::to_le_bytes));
    }
    bytes
}

/// The same as Yuksel's `.hair`, in which Z up is usual.
fn dot_hair(style: &Hairstyle, rotation: Mat3) -> Vec<u8> {
    let (count, per) = (style.guides.count() as u32, style.guides.points_per_guide as u32);
    let mut bytes = b"HAIR".to_vec();
    bytes.extend([count, count * per, 2, per - 1].into_iter().flat_map(u32::to_le_bytes));
    bytes.resize(128, 0);
    for guide in 0..style.guides.count() {
        let points = (0..per as usize).map(|k| rotation * style.guides.point(guide, k));
        bytes.extend(points.flat_map(|point| point.to_array()).flat_map(f32::to_le_bytes));
    }
    bytes
}

/// The 24 rotations that map axes to axes, and the axis that each turns up to.
fn turns() -> Vec<(UpAxis, Mat3)> {
    let directions = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
    let axes: Vec<(UpAxis, Vec3)> = UpAxis::AXES.into_iter().zip(directions).collect();
    let pairs = axes.iter().flat_map(|&(up, y)| axes.iter().map(move |&(_, x)| (up, x, y)));
    let square = pairs.filter(|(_, x, y)| x.dot(*y) == 0.0);
    square.map(|(up, x, y)| (up, Mat3::from_cols(x, y, x.cross(y)))).collect()
}

#[test]
fn the_up_axis_of_shipped_styles_is_right_or_in_doubt_in_every_rotation() {
    let turns = turns();
    assert_eq!(turns.len(), 24);
    let (mut right, mut all) = (0, 0);
    for shipped in shipped() {
        let mut project = small_project();
        project.apply_style(&shipped.style, StyleParts::ALL);
        (project.hair.groom.wisps, project.hair.groom.strands_per_wisp) = (60, 1);
        let style = &load(&project).0.style;
        let (mut of_style, mut doubted) = (0, 0);
        for (up, rotation) in turns.iter().copied() {
            for (name, bytes) in [("a.data", data(style, rotation)), ("a.hair", dot_hair(style, rotation))] {
                let guess = guess_units(&load_hair_bytes(name, &bytes).expect("hair"));
                if guess.is_up_in_doubt() {
                    doubted += 1;
                } else {
                    assert_eq!(guess.up, up, "{} in {name}: {guess:?}", shipped.id);
                    of_style += 1;
                }
            }
        }
        println!("{}: {of_style} right, {doubted} in doubt", shipped.id);
        right += of_style;
        all += of_style + doubted;
    }
    println!("{right} of {all} right");
    assert!(all >= 48 * 8 && 3 * right >= 2 * all, "{right} of {all}");
}
