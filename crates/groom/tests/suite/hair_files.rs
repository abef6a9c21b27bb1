//! Reading hair files: constructed, real and broken ones.

use std::collections::BTreeMap;

use crate::common::{YukselFile, data_dir, hanging, tressfx};
use glam::Vec3;
use lovelock_groom::{
    Facing, ImportSettings, Unit, UpAxis, guess_units, hair_info, load_hair, load_hair_bytes,
};

#[test]
fn every_combination_of_yuksel_arrays_comes_back() {
    for bits in 0..32_u32 {
        let mut written = YukselFile::new(hanging(&[4, 4, 4]));
        written.segments = bits & 1 != 0;
        written.thickness = (bits & 2 != 0).then_some(|i| i as f32);
        written.transparency = (bits & 4 != 0).then_some(|i| i as f32 / 100.0);
        written.colours = (bits & 8 != 0).then_some(|i| [i as f32, 0.5, 0.25]);
        written.uvs = bits & 16 != 0;
        let file = load_hair_bytes("by hand", &written.bytes()).expect("a sound file");
        assert_eq!(file.first_point, [0, 4, 8, 12], "bits {bits}");
        let points: Vec<Vec3> = written.strands.iter().flatten().copied().map(Vec3::from).collect();
        assert_eq!(file.points, points);
        let floats = |of: fn(usize) -> f32| (0..12).map(of).collect::<Vec<_>>();
        assert_eq!(file.thickness, written.thickness.map(floats));
        assert_eq!(file.transparency, written.transparency.map(floats));
        assert_eq!(file.colours, written.colours.map(|of| (0..12).map(of).collect()));
        assert_eq!(file.default_colour, Some([0.4, 0.3, 0.2]));
        assert_eq!((file.default_thickness, file.default_transparency), (Some(0.1), Some(0.25)));
        assert!(file.dropped.is_empty());
    }
}

#[test]
fn strands_of_different_lengths_and_odd_numbers_come_back() {
    // With seven strands, the points begin at byte 142, where no float is aligned.
    let counts = [2, 300, 3, 65, 17, 2, 9];
    let written = YukselFile::new(hanging(&counts));
    let file = load_hair_bytes("by hand", &written.bytes()).expect("a sound file");
    for (strand, points) in written.strands.iter().enumerate() {
        let read: Vec<[f32; 3]> = file.strand(strand).iter().map(Vec3::to_array).collect();
        assert_eq!(&read, points);
    }
    assert_eq!(file.segments(), counts.iter().sum::<usize>() - counts.len());
}

#[test]
fn tressfx_of_both_versions_comes_back() {
    for (version, format) in [(3.0, "TressFX .tfx 3.0"), (4.0, "TressFX .tfx 4.0")] {
        let file = load_hair_bytes("by hand", &tressfx(version, 3, 5)).expect("a sound file");
        assert_eq!((file.format.as_str(), file.strands(), file.points.len()), (format, 3, 15));
        assert_eq!(file.strand(2)[4], Vec3::new(2.0, -4.0, 2.0));
        assert!(file.dropped.is_empty() && file.notes.is_empty() && !file.both_ends_pinned);
    }
    // Version 3.1 has the layout of 3.0.
    assert!(load_hair_bytes("by hand", &tressfx(3.1, 3, 5)).is_ok());
}

#[test]
fn tressfx_offsets_are_tested() {
    let mut bytes = tressfx(4.0, 3, 5);
    bytes[12..16].copy_from_slice(&100_u32.to_le_bytes());
    assert!(refusal(&bytes).contains("byte 12: found positions at byte 100"));
    bytes[12..16].copy_from_slice(&100_000_u32.to_le_bytes());
    assert!(refusal(&bytes).contains("; must be a place inside the file"));
    bytes[12..16].copy_from_slice(&161_u32.to_le_bytes());
    assert!(refusal(&bytes).contains("byte 161: found a file of 400 bytes; must be 401 bytes or more"));
    // Texture coordinates past the end are harmless, because they are not needed.
    let mut bytes = tressfx(4.0, 3, 5);
    bytes[16..20].copy_from_slice(&4_000_000_000_u32.to_le_bytes());
    let file = load_hair_bytes("by hand", &bytes).expect("the strands are sound");
    assert_eq!(file.notes.len(), 1, "{:?}", file.notes);
}

#[test]
fn held_tips_are_recognised() {
    let mut bytes = tressfx(3.0, 2, 4);
    bytes[16] = 1;
    assert!(load_hair_bytes("by hand", &bytes).expect("sound").both_ends_pinned);
    let mut bytes = tressfx(4.0, 2, 4);
    for strand in 0..2 {
        let last_w = 160 + (strand * 4 + 3) * 16 + 12;
        bytes[last_w..last_w + 4].copy_from_slice(&0_f32.to_le_bytes());
    }
    assert!(load_hair_bytes("by hand", &bytes).expect("sound").both_ends_pinned);
}

#[test]
fn values_that_are_not_numbers_become_the_default() {
    let mut written = YukselFile::new(hanging(&[3]));
    written.thickness = Some(|i| if i == 1 { f32::NAN } else { 0.5 });
    written.colours = Some(|i| if i == 2 { [f32::INFINITY, 0.1, 0.1] } else { [1.0; 3] });
    let file = load_hair_bytes("by hand", &written.bytes()).expect("a sound file");
    assert_eq!(file.thickness, Some(vec![0.5, 0.1, 0.5]));
    assert_eq!(file.colours.expect("colours")[2], [0.4, 0.1, 0.1]);
    assert_eq!(file.dropped, counts(&[("non_finite_values", 2)]));
}

#[test]
fn strands_of_no_size_beside_the_groom_are_dropped() {
    let mut strands = hanging(&[4, 4, 4]);
    strands.push(vec![[1.0, 0.5, 0.0], [1.0, 0.5, 1e-7]]);
    strands.push(vec![[1.0, 0.5, 0.0], [1.0, 0.5, 1e5]]);
    let file = load_hair_bytes("by hand", &YukselFile::new(strands).bytes()).expect("a sound file");
    assert_eq!(file.dropped, counts(&[("distant_strands", 1), ("zero_length_strands", 1)]));
    assert_eq!(file.strands(), 3);
}

#[test]
fn a_header_without_the_number_of_points_has_those_of_the_strands() {
    let strand = |points: usize| (0..points).map(|i| [i as f32, 0.0, 0.0]).collect();
    let bytes = YukselFile::new(vec![strand(3), strand(4)]).bytes();
    for number in [0, u32::MAX] {
        let mut bytes = bytes.clone();
        bytes[8..12].copy_from_slice(&number.to_le_bytes());
        let file = load_hair_bytes("by hand", &bytes).expect("hair");
        assert_eq!((file.first_point.as_slice(), file.notes.len()), (&[0, 3, 7][..], 1), "{:?}", file.notes);
        // Where the points are not there, the file is refused.
        bytes.truncate(bytes.len() - 1);
        assert!(refusal(&bytes).contains("7 points"), "{}", refusal(&bytes));
    }
    // Negative control: another number contradicts the strands.
    let mut bytes = bytes;
    bytes[8] = 8;
    assert!(refusal(&bytes).contains("found 8 points; must be 7"), "{}", refusal(&bytes));
}

#[test]
fn a_header_without_numbers_has_those_that_the_length_of_the_file_shows() {
    let strand = |points: usize| (0..points).map(|i| [i as f32, 0.0, 0.0]).collect::<Vec<_>>();
    for (segments, strands) in
        [(false, vec![strand(3), strand(3)]), (true, vec![strand(3), strand(4), strand(2)])]
    {
        let mut written = YukselFile { segments, ..YukselFile::new(strands) };
        for extras in [false, true] {
            if extras {
                written.thickness = Some(|_| 0.5);
                written.colours = Some(|_| [0.1; 3]);
            }
            let usual = load_hair_bytes("by hand", &written.bytes()).expect("hair");
            for number in [0, u32::MAX] {
                // The points, and both.
                for from in [8, 4] {
                    let mut bytes = written.bytes();
                    for at in (from..12).step_by(4) {
                        bytes[at..at + 4].copy_from_slice(&u32::to_le_bytes(number));
                    }
                    let file = load_hair_bytes("by hand", &bytes).expect("hair");
                    assert_eq!((&file.first_point, &file.points), (&usual.first_point, &usual.points));
                    assert!(file.notes[0].contains("The header states"), "{:?}", file.notes);
                    // Negative control: where bytes are missing, nothing is guessed.
                    bytes.pop();
                    assert!(load_hair_bytes("by hand", &bytes).is_err(), "{number} from byte {from}");
                }
            }
        }
    }
}

#[test]
fn other_files_are_refused() {
    for (bytes, found) in [
        (b"".as_slice(), "a file of 0 bytes"),
        (b"HA", "a file of 2 bytes"),
        (b"\x89PNG\r\n\x1a\n", r"`\x89PNG`"),
        (b"glTF\x02\x00\x00\x00", "a file of 8 bytes; must be the header of a chunk"),
        (b"GIF89a..", "`GIF8`; must be `HAIR` (Yuksel)"),
        (b"HAIR", "a file of 4 bytes; must be 128 bytes"),
    ] {
        assert!(refusal(bytes).contains(found), "{}", refusal(bytes));
    }
    // 5.0 and 2.9 are unknown versions.
    let unnamed = load_hair_bytes("unnamed", &tressfx(5.0, 1, 4)).expect_err("another version").to_string();
    let all = "; must be `HAIR` (Yuksel), a version from 3.0 to 4.9 as a float (TressFX), `#usda`";
    assert!(unnamed.contains(all), "{unnamed}");
    assert!(refusal(&tressfx(2.9, 1, 4)).contains("; must be"));
    let missing = load_hair(std::path::Path::new("no/such/file.hair")).expect_err("no such file");
    assert!(missing.to_string().starts_with("no/such/file.hair: cannot be read: "));
}

fn refusal(bytes: &[u8]) -> String {
    load_hair_bytes("by hand", bytes).expect_err("a broken file").to_string()
}

fn counts(of: &[(&str, u64)]) -> BTreeMap<String, u64> {
    of.iter().map(|&(key, count)| (key.to_owned(), count)).collect()
}

/// Strands, points and drops, or the error message.
type Outcome = Result<(usize, usize, &'static [(&'static str, u64)]), &'static str>;

#[test]
fn broken_files_load_with_counts_or_are_refused_in_one_line() {
    let Some(data) = data_dir() else { return };
    let table: [(&str, Outcome); 17] = [
        ("allflags.hair", Ok((7, 56, &[]))),
        ("allonepoint.hair", Err("no strand left to draw (one_point_strands: 5)")),
        ("badmagic.hair", Err("byte 0: found `")),
        ("countlie.hair", Err("byte 8: found 1000 points; must be 56")),
        ("dseg0.hair", Err("byte 8: found 56 points; must be 7")),
        ("hugecount.hair", Ok((7, 56, &[]))),
        ("nan_inf.hair", Ok((4, 32, &[("distant_strands", 1), ("non_finite_strands", 2)]))),
        ("nopoints.hair", Err("byte 12: found flags 0x1; must be bit 1 set")),
        ("nosegs.hair", Ok((7, 56, &[]))),
        ("onepoint.hair", Ok((2, 7, &[("one_point_strands", 2)]))),
        ("tfx_6verts.tfx", Ok((5, 30, &[]))),
        ("tfx_badoffset.tfx", Err("byte 12: found positions at byte 4294967040 of a file of 640 bytes")),
        ("tiny_units.hair", Ok((7, 56, &[]))),
        ("trailing.hair", Ok((7, 56, &[("trailing_bytes", 37)]))),
        (
            "truncated.hair",
            Err("byte 142: found a file of 300 bytes; must be 814 bytes or more for 56 points"),
        ),
        ("variable_odd.hair", Ok((7, 456, &[]))),
        ("zerolen.hair", Ok((2, 14, &[("repeated_points", 2), ("zero_length_strands", 1)]))),
    ];
    let folder = data.join("hair/broken");
    let files = std::fs::read_dir(&folder).expect("the folder of broken files").count();
    assert_eq!(files, table.len(), "a file that this table does not know");
    for (name, outcome) in table {
        let path = folder.join(name);
        match (load_hair(&path), outcome) {
            (Ok(file), Ok((strands, points, dropped))) => {
                assert_eq!((file.strands(), file.points.len()), (strands, points), "{name}");
                assert_eq!(file.dropped, counts(dropped), "{name}");
            }
            (Err(error), Err(wanted)) => {
                let line = error.to_string();
                assert!(line.contains(wanted), "{name}: {line}");
                assert!(line.starts_with(&path.display().to_string()) && !line.contains('\n'), "{line}");
            }
            (found, _) => panic!("{name}: {found:?}"),
        }
    }
}

#[test]
fn real_files_contain_the_documented_counts() {
    let Some(data) = data_dir() else { return };
    for (name, strands, points) in [
        ("yuksel/straight.hair", 10_000, 160_000),
        ("tressfx/Ratboy_mohawk.tfx", 2228, 2228 * 32),
        ("tressfx/Ratboy_mohawk_v40.tfx", 2226, 2226 * 32),
        ("tressfx/TestHair1.tfx", 10_027, 10_027 * 4),
        ("tressfx/back.tfx", 517, 517 * 16),
        ("tressfx/front_top.tfx", 876, 876 * 16),
        ("tressfx/side.tfx", 3066, 3066 * 16),
        ("tressfx/sintel_16pt.tfx", 11_400, 182_400),
        ("tressfx/sintel_vk.tfx", 228, 228 * 32),
    ] {
        let file = load_hair(&data.join("hair").join(name)).expect(name);
        assert_eq!((file.strands(), file.points.len()), (strands, points), "{name} {:?}", file.dropped);
        assert!(file.dropped.is_empty(), "{name} {:?}", file.dropped);
        assert_eq!(file.both_ends_pinned, name.ends_with("back.tfx"), "{name}");
    }
}

#[test]
fn units_and_axes_of_real_files_are_guessed() {
    let Some(data) = data_dir() else { return };
    let (m, cm, mm) = (Some(Unit::Metre), Some(Unit::Centimetre), Some(Unit::Millimetre));
    for (name, unit, up, facing) in [
        ("yuksel/straight.hair", None, UpAxis::Z, Facing::PlusY),
        ("tressfx/Ratboy_mohawk.tfx", m, UpAxis::Y, Facing::PlusZ),
        ("tressfx/Ratboy_mohawk_v40.tfx", cm, UpAxis::Y, Facing::PlusZ),
        ("tressfx/TestHair1.tfx", mm, UpAxis::Y, Facing::PlusZ),
        ("tressfx/back.tfx", None, UpAxis::Y, Facing::MinusZ),
        ("tressfx/front_top.tfx", None, UpAxis::Y, Facing::MinusZ),
        ("tressfx/side.tfx", None, UpAxis::Y, Facing::MinusZ),
        ("tressfx/sintel_16pt.tfx", m, UpAxis::Y, Facing::PlusZ),
        ("tressfx/sintel_vk.tfx", cm, UpAxis::Y, Facing::PlusZ),
    ] {
        let file = load_hair(&data.join("hair").join(name)).expect(name);
        let guess = guess_units(&file);
        println!("{name}: {guess:?}");
        assert_eq!((guess.unit, guess.up, guess.facing), (unit, up, facing), "{name}: {guess:?}");
        if name.ends_with("straight.hair") {
            // 43 units of roots across a scalp of 0.15 m: 3.5 mm per unit. The span ignores outliers and is measured
            // from front to back, which differs by a few per cent.
            assert!((guess.metres_per_unit / 0.0035 - 1.0).abs() < 0.06, "{guess:?}");
        }
    }
}

#[test]
fn groups_of_any_size_give_a_finite_guess() {
    for scale in [1e-9_f32, 1e-4, 1.0, 1e6, 1e11] {
        let mut strands = hanging(&[4, 4, 4, 4]);
        strands.iter_mut().flatten().flatten().for_each(|v| *v *= scale);
        let file = load_hair_bytes("by hand", &YukselFile::new(strands).bytes()).expect("a sound file");
        let guess = guess_units(&file);
        assert!((0.05..0.5).contains(&guess.size_m.max_element()), "{scale}: {guess:?}");
    }
    // Roots that are apart by the smallest number.
    let mut strands = hanging(&[4, 4]);
    strands.iter_mut().flatten().for_each(|point| point[0] *= f32::from_bits(1));
    let file = load_hair_bytes("by hand", &YukselFile::new(strands).bytes()).expect("a sound file");
    assert!(guess_units(&file).size_m.is_finite());
    let one = YukselFile::new(hanging(&[2])).bytes();
    let guess = guess_units(&load_hair_bytes("by hand", &one).expect("a sound file"));
    assert!(guess.metres_per_unit.is_finite() && guess.metres_per_unit > 0.0);
}

#[test]
fn info_turns_the_box_with_the_axes() {
    let bytes = YukselFile::new(hanging(&[4, 4])).bytes();
    let file = load_hair_bytes("by hand", &bytes).expect("a sound file");
    let settings = ImportSettings {
        unit: Unit::Centimetre,
        up: UpAxis::Z,
        facing: Facing::PlusY,
        ..ImportSettings::default()
    };
    let info = hair_info(&file, &settings);
    assert_eq!((info.strands, info.points, info.segments), (2, 8, 6));
    // The strands hang from x = 0 and 1, y = 0.5 down to z = -1: X points left, Z up, Y to the front.
    assert!(info.bounds_m.min.distance(Vec3::new(-0.01, -0.01, 0.005)) < 1e-6, "{:?}", info.bounds_m);
    assert!(info.bounds_m.max.distance(Vec3::new(0.0, 0.0, 0.005)) < 1e-6, "{:?}", info.bounds_m);
    assert_eq!((info.unit.as_str(), info.up.as_str(), info.unit_guessed), ("cm", "z", false));
    let json = serde_json::to_value(&info).expect("plain data");
    assert_eq!(json["bounds_m"]["min"].as_array().map(Vec::len), Some(3));
    assert!(hair_info(&file, &ImportSettings::default()).unit_guessed);
}

#[test]
fn names_of_units_and_axes_come_back() {
    for unit in Unit::NAMED.into_iter().chain([Unit::Auto]) {
        assert_eq!(Unit::from_id(unit.id()), Some(unit));
    }
    for up in UpAxis::AXES.into_iter().chain([UpAxis::Auto]) {
        assert_eq!(UpAxis::from_id(up.id()), Some(up));
    }
    for facing in Facing::AXES.into_iter().chain([Facing::Auto]) {
        assert_eq!(Facing::from_id(facing.id()), Some(facing));
    }
    assert_eq!((Unit::from_id("furlong"), UpAxis::from_id("w"), Facing::from_id("")), (None, None, None));
    assert_eq!(Unit::Custom(f32::NAN).metres(), None);
}
