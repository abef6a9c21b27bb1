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

/// Twelve strands of eight points on a patch of roots, 1 m above zero. Strand `s` has `points(s)` points before the filling.
fn filled(points: impl Fn(usize) -> usize, filling: [f32; 3]) -> Vec<[f32; 3]> {
    let place = |s: usize, k: usize| [0.05 * (s % 4) as f32, 1.0 - 0.02 * k as f32, 0.05 * (s / 4) as f32];
    let strand = |s: usize| (0..8).map(move |k| (s, k));
    (0..12).flat_map(strand).map(|(s, k)| if k < points(s) { place(s, k) } else { filling }).collect()
}

fn floats(numbers: impl IntoIterator<Item = [f32; 3]>) -> Vec<u8> {
    numbers.into_iter().flatten().flat_map(f32::to_le_bytes).collect()
}

#[test]
fn shorter_strands_end_before_copies_of_one_point() {
    let read = |numbers| {
        load_hair_bytes("a.npy", &array(1, "'<f4'", false, "(12, 8, 3)", &floats(numbers))).expect("hair")
    };
    for filling in
        [[0.0, 0.0, 0.0], [-0.0, 0.0, -0.0], [-1.0, -1.0, -1.0], [1e6, 1e6, 1e6], [f32::NAN, 0.0, 0.0]]
    {
        for (what, points) in [("one point", [8, 7]), ("two points", [8, 6]), ("most points", [2, 5])] {
            let hair = read(filled(|s| points[s % 2], filling));
            let counts: Vec<usize> = (0..12).map(|s| hair.strand(s).len()).collect();
            assert_eq!(counts, (0..12).map(|s| points[s % 2]).collect::<Vec<_>>(), "{what} of {filling:?}");
            assert!(hair.points.iter().all(|p| p.y > 0.8), "{what} of {filling:?}");
            let is_said = hair.notes.iter().any(|note| note.contains("copies of one point"));
            assert_eq!(is_said, !filling[0].is_nan(), "{what} of {filling:?}: {:?}", hair.notes);
        }
    }
    let none = read(filled(|s| if s == 3 { 0 } else { 8 }, [0.0; 3]));
    assert_eq!((none.strands(), none.dropped["one_point_strands"]), (11, 1));
    // Negative controls: strands that lead to zero, and to a tie that they share, are whole.
    for tie in [Vec3::ZERO, Vec3::new(0.3, 2.0, 0.1)] {
        let lead = (0..12).flat_map(|s| (0..8).map(move |k| (s, k))).map(|(s, k)| {
            let root = tie + Vec3::new(0.1, 0.03 * s as f32, 0.02);
            (if k == 7 { tie } else { root.lerp(tie, k as f32 / 7.0) }).to_array()
        });
        let hair = read(lead.collect());
        assert_eq!((hair.strands(), hair.points.len()), (12, 96), "{tie}");
    }
}

#[test]
fn coordinates_may_run_along_any_side() {
    let points = filled(|_| 8, [0.0; 3]);
    let coordinate = |axis: usize, i: usize| points[i][axis];
    let first: Vec<f32> =
        (0..3).flat_map(|axis| (0..96).map(move |i| (axis, i))).map(|(a, i)| coordinate(a, i)).collect();
    let middle: Vec<f32> = (0..12)
        .flat_map(|s| (0..3).flat_map(move |axis| (0..8).map(move |k| (axis, 8 * s + k))))
        .map(|(a, i)| coordinate(a, i))
        .collect();
    let bytes = |numbers: &[f32]| numbers.iter().flat_map(|number| number.to_le_bytes()).collect::<Vec<u8>>();
    for (shape, data) in [
        ("(12, 8, 3)", floats(points.clone())),
        ("(3, 12, 8)", bytes(&first)),
        ("(12, 3, 8)", bytes(&middle)),
    ] {
        let hair = load_hair_bytes("a.npy", &array(1, "'<f4'", false, shape, &data)).expect(shape);
        assert_eq!((hair.strands(), hair.points.len()), (12, 96), "{shape}");
        assert_eq!(hair.points, points.iter().copied().map(Vec3::from).collect::<Vec<_>>(), "{shape}");
        let is_said = hair.notes.iter().any(|note| note.contains("another side"));
        assert_eq!(is_said, shape != "(12, 8, 3)", "{shape}");
    }
}

#[test]
fn strands_relative_to_their_roots_are_moved_there() {
    let points = filled(|_| 8, [0.0; 3]);
    let roots: Vec<[f32; 3]> = points.iter().copied().step_by(8).collect();
    let relative = |from: usize| {
        let own = points.iter().enumerate().filter(move |(i, _)| i % 8 >= from);
        floats(own.map(|(i, &point)| (Vec3::from(point) - Vec3::from(roots[i / 8])).to_array()))
    };
    let whole = array(1, "'<f4'", false, "(12, 8, 3)", &relative(0));
    let behind = array(1, "'<f4'", false, "(12, 7, 3)", &relative(1));
    let absolute = array(1, "'<f4'", false, "(12, 8, 3)", &floats(points.clone()));
    let roots = array(1, "'<f4'", false, "(12, 3)", &floats(roots.clone()));
    for (what, strands, is_said) in [
        ("with their roots", &whole, true),
        ("behind their roots", &behind, true),
        // Negative control: places stay places.
        ("places", &absolute, false),
    ] {
        let bytes = zip(&[("strands.npy", strands), ("roots.npy", &roots)], CompressionMethod::Stored);
        let hair = load_hair_bytes("a.npz", &bytes).expect(what);
        assert_eq!((hair.strands(), hair.points.len()), (12, 96), "{what}");
        let off = hair.points.iter().zip(&points).map(|(a, &b)| a.distance(b.into())).fold(0.0, f32::max);
        assert!(off < 1e-6, "{what}: {off}");
        let moved =
            hair.notes.iter().any(|note| note.contains("relative to their roots, which the array roots"));
        assert_eq!(moved, is_said, "{what}: {:?}", hair.notes);
    }
    // Without their roots, a note says what is missing.
    let hair = load_hair_bytes("a.npy", &whole).expect("hair");
    assert!(hair.notes.iter().any(|note| note.contains("begin in one place")), "{:?}", hair.notes);
    let hair = load_hair_bytes("a.npy", &absolute).expect("hair");
    assert!(!hair.notes.iter().any(|note| note.contains("begin in one place")), "{:?}", hair.notes);
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
