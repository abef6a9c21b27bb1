use std::io::{Cursor, Write as _};

use glam::Vec3;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::array::MAGIC;
use crate::load_hair_bytes;

/// An array with this description and these bytes.
fn array(version: u8, descr: &str, fortran: bool, shape: &str, data: &[u8]) -> Vec<u8> {
    let fortran = if fortran { "True" } else { "False" };
    let text = format!("{{'descr': {descr}, 'fortran_order': {fortran}, 'shape': {shape}, }}\n");
    let length: Vec<u8> = match version {
        1 => (text.len() as u16).to_le_bytes().to_vec(),
        _ => (text.len() as u32).to_le_bytes().to_vec(),
    };
    [MAGIC, &[version, 0], &length, text.as_bytes(), data].concat()
}

/// Two strands of three points: the numbers 0 to 17, quartered.
fn numbers() -> impl Iterator<Item = f32> {
    (0..18).map(|number| number as f32 / 4.0)
}

fn singles() -> Vec<u8> {
    numbers().flat_map(f32::to_le_bytes).collect()
}

fn zip(arrays: &[(&str, &[u8])], method: CompressionMethod) -> Vec<u8> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, data) in arrays {
        writer.start_file(*name, SimpleFileOptions::default().compression_method(method)).expect("an entry");
        writer.write_all(data).expect("memory");
    }
    writer.finish().expect("memory").into_inner()
}

#[test]
fn arrays_of_every_precision_order_and_version_are_the_same_hair() {
    let shape = "(2, 3, 3)";
    // Numbers along the first index first.
    let order = (0..18).map(|i| (i % 2) * 9 + (i / 2 % 3) * 3 + i / 6);
    let fortran: Vec<u8> = order.flat_map(|at| (at as f32 / 4.0).to_le_bytes()).collect();
    let halves: Vec<u8> = numbers().flat_map(|number| half::f16::from_f32(number).to_le_bytes()).collect();
    let doubles: Vec<u8> = numbers().flat_map(|number| f64::from(number).to_be_bytes()).collect();
    let big: Vec<u8> = numbers().flat_map(f32::to_be_bytes).collect();
    let wide: Vec<u8> = numbers()
        .collect::<Vec<_>>()
        .chunks(3)
        .flat_map(|point| [point[0], point[1], point[2], 9.0])
        .flat_map(f32::to_le_bytes)
        .collect();
    for (what, bytes) in [
        ("single", array(1, "'<f4'", false, shape, &singles())),
        ("version 2", array(2, "\"<f4\"", false, shape, &singles())),
        ("version 3", array(3, "'<f4'", false, "( 2L,3L, 3L)", &singles())),
        ("half", array(1, "'<f2'", false, shape, &halves)),
        ("double", array(1, "'>f8'", false, shape, &doubles)),
        ("big-endian", array(1, "'>f4'", false, shape, &big)),
        ("Fortran", array(1, "'<f4'", true, shape, &fortran)),
        ("a batch", array(1, "'<f4'", false, "(1, 2, 3, 3)", &singles())),
        ("four numbers", array(1, "'<f4'", false, "(2, 3, 4)", &wide)),
    ] {
        let hair = load_hair_bytes("a.npy", &bytes).unwrap_or_else(|error| panic!("{what}: {error}"));
        assert_eq!(hair.first_point, [0, 3, 6], "{what}");
        assert_eq!(hair.points[1], Vec3::new(0.75, 1.0, 1.25), "{what}");
        assert_eq!(hair.points[5], Vec3::new(3.75, 4.0, 4.25), "{what}");
    }
    // Negative control: Fortran's order taken for the other one.
    let wrong = load_hair_bytes("a.npy", &array(1, "'<f4'", false, shape, &fortran)).expect("hair");
    assert!(wrong.points[1] != Vec3::new(0.75, 1.0, 1.25));
}

#[test]
fn shorter_strands_end_where_no_numbers_follow() {
    let mut values: Vec<f32> = numbers().collect();
    values[15..].fill(f32::NAN);
    let data: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    let hair = load_hair_bytes("a.npy", &array(1, "'<f4'", false, "(2, 3, 3)", &data)).expect("hair");
    assert_eq!(hair.first_point, [0, 3, 5]);
}

#[test]
fn an_archive_has_its_strands_where_shape_and_name_say() {
    let strands = array(1, "'<f4'", false, "(2, 3, 3)", &singles());
    let flat = array(1, "'<f4'", false, "(6, 3)", &singles());
    let larger = array(1, "'<f4'", false, "(3, 3, 3)", &[singles(), vec![1; 36]].concat());
    let integers = |descr: &str, values: &[i64], size: usize| {
        let data: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()[..size].to_vec()).collect();
        array(1, descr, false, &format!("({},)", values.len()), &data)
    };
    let (counts, firsts) = (integers("'<i8'", &[2, 4], 8), integers("'<u2'", &[0, 2], 2));
    let of_points = integers("'<i4'", &[0, 0, 1, 1, 1, 1], 4);
    for method in [CompressionMethod::Stored, CompressionMethod::Deflated] {
        for (what, arrays, expected) in [
            ("DiffLocks", vec![("positions.npy", &strands), ("normals.npy", &larger)], vec![0, 3, 6]),
            ("without a known name", vec![("x/own.npy", &strands), ("seed.npy", &counts)], vec![0, 3, 6]),
            ("numbers of points", vec![("points.npy", &flat), ("lengths.npy", &counts)], vec![0, 2, 6]),
            ("first points", vec![("points.npy", &flat), ("first.npy", &firsts)], vec![0, 2, 6]),
            (
                "strand of each point",
                vec![("points.npy", &flat), ("strand_id.npy", &of_points)],
                vec![0, 2, 6],
            ),
        ] {
            let arrays: Vec<(&str, &[u8])> = arrays.iter().map(|(name, data)| (*name, &data[..])).collect();
            let bytes = zip(&[&arrays[..], &[("readme.txt", b"text")]].concat(), method);
            let hair = load_hair_bytes("a.npz", &bytes).unwrap_or_else(|error| panic!("{what}: {error}"));
            assert_eq!((&hair.first_point, hair.points[5].x), (&expected, 3.75), "{what}");
        }
    }
    let named = zip(&[("positions.npy", &strands), ("normals.npy", &larger)], CompressionMethod::Stored);
    let notes = load_hair_bytes("a.npz", &named).expect("hair").notes;
    assert!(
        notes.iter().any(|note| note.contains("Read the array positions; left out: normals (f4 (3, 3, 3))")),
        "{notes:?}"
    );
    let none =
        zip(&[("points.npy", &flat), ("seed.npy", &integers("'<i8'", &[9], 8))], CompressionMethod::Stored);
    let error = load_hair_bytes("a.npz", &none).expect_err("no strands").to_string();
    assert!(error.contains("the arrays points (f4 (6, 3)), seed (i8 (1))"), "{error}");
}

#[test]
fn what_does_not_fit_is_refused_in_a_sentence() {
    let of = |descr: &str, shape: &str| array(1, descr, false, shape, &singles());
    for (bytes, words) in [
        (of("'<f4'", "(2, 3, 3, 2)"), "f4 (2, 3, 3, 2)"),
        (of("'<f4'", "(4294967295, 4294967295, 3)"), "f4 (4294967295"),
        (of("'<f4'", "(2, 99, 3)"), "f4 (2, 99, 3) in"),
        (of("'<i4'", "(2, 3, 3)"), "i4 (2, 3, 3)"),
        (of("'<f0'", "(2, 3, 3)"), "f0"),
        (of("'|O'", "(2, 3, 3)"), "the description"),
        (of("[('x', '<f4')]", "(2, 3, 3)"), "f4"),
        (of("'<f4'", "(-2, 3, 3)"), "the description"),
        (of("'<f4'", "2"), "the description"),
        (MAGIC.to_vec(), "array"),
        ([MAGIC, &[9, 0, 0, 0, 0, 0]].concat(), "version 9"),
        ([MAGIC, &[2, 0, 255, 255, 255, 255]].concat(), "4294967295 bytes"),
    ] {
        let error = load_hair_bytes("a.npy", &bytes).expect_err(words).to_string();
        assert!(error.contains(words), "{words}: {error}");
    }
    // An archive that would unpack to far more than its size.
    let bomb = array(1, "'<f4'", false, "(8000, 1000, 3)", &vec![0; 12_000]);
    let packed = zip(&[("positions.npy", &bomb)], CompressionMethod::Deflated);
    let error = load_hair_bytes("a.npz", &packed).expect_err("too much").to_string();
    assert!(error.contains("for an archive of this size"), "{error}");
    assert!(
        load_hair_bytes("a.npz", b"PK\x03\x04 and nothing")
            .is_err_and(|error| error.to_string().contains("ZIP"))
    );
}
