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

#[test]
fn the_up_axis_of_shipped_styles_is_right_or_in_doubt_in_six_rotations() {
    let turns = [
        (UpAxis::X, Mat3::from_cols(Vec3::Y, Vec3::X, Vec3::NEG_Z)),
        (UpAxis::MinusX, Mat3::from_cols(Vec3::Y, Vec3::NEG_X, Vec3::Z)),
        (UpAxis::Y, Mat3::IDENTITY),
        (UpAxis::MinusY, Mat3::from_cols(Vec3::X, Vec3::NEG_Y, Vec3::NEG_Z)),
        (UpAxis::Z, Mat3::from_cols(Vec3::NEG_X, Vec3::Z, Vec3::Y)),
        (UpAxis::MinusZ, Mat3::from_cols(Vec3::X, Vec3::NEG_Z, Vec3::Y)),
    ];
    let (mut right, mut doubted) = (0, Vec::new());
    for shipped in shipped() {
        let mut project = small_project();
        project.apply_style(&shipped.style, StyleParts::ALL);
        (project.hair.groom.wisps, project.hair.groom.strands_per_wisp) = (60, 1);
        let style = &load(&project).0.style;
        for (up, rotation) in turns {
            let guess = guess_units(&load_hair_bytes("a.data", &data(style, rotation)).expect("hair"));
            if guess.is_up_in_doubt() {
                doubted.push((shipped.id, up));
            } else {
                assert_eq!(guess.up, up, "{}: {guess:?}", shipped.id);
                right += 1;
            }
        }
    }
    let all = 6 * shipped().len();
    println!("{right} of {all} right, {} in doubt: {doubted:?}", doubted.len());
    assert!(all >= 48 && right + doubted.len() == all && 3 * right >= 2 * all, "{right} of {all}");
}
