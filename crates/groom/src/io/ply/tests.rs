use glam::Vec3;

use crate::{HairFile, HairFormat, load_hair_bytes};

/// Strands of these numbers of points: the strand is x, the point y.
fn points(counts: &[usize]) -> Vec<[f32; 3]> {
    let strand = |(x, &count): (usize, &usize)| (0..count).map(move |y| [x as f32, 0.1 * y as f32, 0.5]);
    counts.iter().enumerate().flat_map(strand).collect()
}

fn text(head: &str, rows: &[String]) -> Vec<u8> {
    format!("ply\nformat ascii 1.0\n{head}end_header\n{}\n", rows.join("\n")).into_bytes()
}

const PLACE: &str = "property float x\nproperty float y\nproperty float z\n";

fn rows(points: &[[f32; 3]]) -> Vec<String> {
    points.iter().map(|[x, y, z]| format!("{x} {y} {z}")).collect()
}

fn read(what: &str, bytes: &[u8]) -> HairFile {
    load_hair_bytes("a.ply", bytes).unwrap_or_else(|error| panic!("{what}: {error}"))
}

#[test]
fn strands_are_found_in_whatever_way_a_file_says_them() {
    let counts = [3, 2, 4];
    let points = points(&counts);
    let vertices = format!("comment by hand\nelement vertex 9\n{PLACE}");
    let ids = ["7", "7", "7", "2", "2", "5", "5", "5", "5"];
    let with_ids: Vec<String> =
        rows(&points).iter().zip(ids).map(|(row, id)| format!("{row} {id}")).collect();
    // The order of the points of all strands is mixed, and the last column restores it.
    let mut mixed: Vec<String> = with_ids.iter().enumerate().map(|(i, row)| format!("{row} {i}")).collect();
    mixed.rotate_left(4);
    mixed.swap(0, 2);
    let add = |more: &[&str]| {
        rows(&points).into_iter().chain(more.iter().map(|row| (*row).to_owned())).collect::<Vec<_>>()
    };
    for (what, bytes) in [
        (
            "segments",
            text(&format!("{vertices}element strand 3\nproperty ushort nsegs\n"), &add(&["2", "1", "3"])),
        ),
        ("points", text(&format!("{vertices}element curve 3\nproperty int count\n"), &add(&["3", "2", "4"]))),
        (
            "lists",
            text(
                &format!("{vertices}element line 3\nproperty list uchar int vertex_indices\n"),
                &add(&["3 0 1 2", "2 3 4", "4 5 6 7 8"]),
            ),
        ),
        (
            "edges",
            text(
                &format!(
                    "{vertices}element edge 6\nproperty int vertex1\nproperty int vertex2\nproperty uchar red\n"
                ),
                &add(&["0 1 9", "1 2 9", "3 4 9", "5 6 9", "6 7 9", "7 8 9"]),
            ),
        ),
        ("ids", text(&format!("{vertices}property int strand_id\n"), &with_ids)),
        ("mixed", text(&format!("{vertices}property int Strand_ID\nproperty int point_id\n"), &mixed)),
    ] {
        let hair = read(what, &bytes);
        let mut found: Vec<Vec<Vec3>> =
            (0..hair.strands()).map(|strand| hair.strand(strand).to_vec()).collect();
        found.sort_by(|a, b| a[0].x.total_cmp(&b[0].x));
        let expected =
            [0..3, 3..5, 5..9].map(|range| points[range].iter().copied().map(Vec3::from).collect::<Vec<_>>());
        assert_eq!(found, expected, "{what}");
    }
}

/// A binary file as hairutil writes it: bytes of colour, widths, and the numbers of segments.
fn binary(big_endian: bool, x: &str) -> Vec<u8> {
    let (form, counts) = (if big_endian { "big" } else { "little" }, [3, 2]);
    let mut out = format!(
        "ply\r\nformat binary_{form}_endian 1.0\r\nelement vertex 5\r\nproperty {x} x\r\nproperty float y\r\nproperty float z\r\n\
         property uchar red\r\nproperty uchar green\r\nproperty uchar blue\r\nproperty float thickness\r\n\
         element strand 2\r\nproperty ushort nsegs\r\nend_header\r\n"
    )
    .into_bytes();
    let mut put = |low_first: &[u8]| {
        let mut bytes = low_first.to_vec();
        if big_endian {
            bytes.reverse();
        }
        out.extend(bytes);
    };
    for [x_place, y, z] in points(&counts) {
        if x == "double" {
            put(&f64::from(x_place).to_le_bytes());
        } else {
            put(&x_place.to_le_bytes());
        }
        put(&y.to_le_bytes());
        put(&z.to_le_bytes());
        for byte in [255_u8, 0, 51] {
            put(&[byte]);
        }
        put(&0.25_f32.to_le_bytes());
    }
    put(&2_u16.to_le_bytes());
    put(&1_u16.to_le_bytes());
    out
}

#[test]
fn binary_files_of_both_byte_orders_have_colours_and_widths() {
    for (big_endian, x) in [(false, "float"), (true, "float"), (false, "double"), (true, "double")] {
        let hair = read(x, &binary(big_endian, x));
        assert_eq!(hair.first_point, [0, 3, 5], "{big_endian} {x}");
        assert_eq!(hair.strand(1)[1], Vec3::new(1.0, 0.1, 0.5));
        assert_eq!(hair.colours.as_deref(), Some(&[[1.0, 0.0, 0.2]; 5][..]));
        assert_eq!(hair.thickness.as_deref(), Some(&[0.25; 5][..]));
    }
    // Negative control: the other byte order is not the same hair.
    let mut wrong = binary(true, "float");
    let at = wrong.windows(3).position(|three| three == b"big").expect("the form");
    wrong.splice(at..at + 3, *b"little");
    assert!(load_hair_bytes("a.ply", &wrong).is_err());
}

#[test]
fn points_strand_after_strand_are_divided_where_they_jump() {
    // As GaussianHaircut and NeuralHaircut write: 100 points per strand, and nothing that says so.
    let strand =
        |s: usize| (0..100).map(move |i| [(s % 10) as f32 * 0.02, i as f32 * 0.002, (s / 10) as f32 * 0.02]);
    let all: Vec<[f32; 3]> = (0..50).flat_map(strand).collect();
    let head = format!("element vertex {}\n{PLACE}property float nx\n", all.len());
    let with_normals: Vec<String> = rows(&all).iter().map(|row| format!("{row} 0")).collect();
    let hair = read("regular", &text(&head, &with_normals));
    assert_eq!((hair.strands(), hair.points.len()), (50, 5000));
    assert!(hair.notes.iter().any(|note| note.contains("each has 100")), "{:?}", hair.notes);
    // Negative controls: points of a surface, and a mesh.
    let cloud: Vec<[f32; 3]> =
        (0..5000_u32).map(|i| [(i * 7919 % 1000) as f32, (i * 104_729 % 997) as f32, 0.0]).collect();
    let bytes = text(&format!("element vertex 5000\n{PLACE}"), &rows(&cloud));
    let error = load_hair_bytes("a.ply", &bytes).expect_err("a cloud").to_string();
    assert!(error.contains("5000 vertices") && error.contains("strand_id"), "{error}");
    let face = format!("element vertex 3\n{PLACE}element face 1\nproperty list uchar int vertex_indices\n");
    let bytes = text(&face, &["0 0 0".into(), "0 1 0".into(), "1 1 0".into(), "3 0 1 2".into()]);
    let error = load_hair_bytes("a.ply", &bytes).expect_err("a mesh").to_string();
    assert!(error.contains("3 vertices and 1 face without"), "{error}");
}

/// Four strands of three points, of which a row is changed.
fn with_row(row: usize, changed: &str) -> Vec<u8> {
    let head = format!("comment by hand\nelement vertex 12\n{PLACE}property int strand_id\n");
    let place = |i: usize| format!("0.{i} -0.5 {} {}", i % 3, i / 3);
    let mut rows: Vec<String> = (0..12).map(place).collect();
    if !changed.is_empty() {
        changed.clone_into(&mut rows[row]);
    }
    text(&head, &rows)
}

#[test]
fn rows_of_a_text_are_divided_or_refused_by_line() {
    let usual = read("usual", &with_row(0, "")).points;
    // The header has nine lines, so row 5 is line 15.
    for row in ["0.5-0.5 2 1", "0.5-0.5+2+1", "0.5 -.5  2 1"] {
        assert_eq!(read(row, &with_row(5, row)).points, usual, "{row}");
    }
    for row in ["0.5 -0.5 2 1 7", "0.5 -0.5 2", "0.5-0.52 1", "0.5 -0.5 2 one", "0,5 -0,5 2 1"] {
        let error = load_hair_bytes("a.ply", &with_row(5, row)).expect_err(row).to_string();
        assert!(error.starts_with("a.ply: line 15: found"), "{row}: {error}");
    }
    // One number too many, and one too few in the next row: together as many as there must be.
    let shifted =
        String::from_utf8(with_row(5, "0.5 -0.5 2 1 7")).expect("text").replace("0.6 -0.5 0 2", "0.6 -0.5 0");
    let error = load_hair_bytes("a.ply", shifted.as_bytes()).expect_err("shifted").to_string();
    assert!(error.contains("line 15: found 5 numbers in `0.5 -0.5 2 1 7`; must be 4"), "{error}");
    // Lines too few are an error, and lines too many a note.
    let all = String::from_utf8(with_row(0, "")).expect("text");
    let short = all.replace("0.9 -0.5 0 3\n", "");
    let error = load_hair_bytes("a.ply", short.as_bytes()).expect_err("short").to_string();
    assert!(
        error.contains("line 20: found the end of the file after 11 rows of `vertex`; must be 12"),
        "{error}"
    );
    let long = read("long", format!("{all}1 2 3 4\n").as_bytes());
    assert!(long.notes.iter().any(|note| note.contains("Left out 1 line after")), "{:?}", long.notes);
}

#[test]
fn rows_over_several_lines_are_read_and_refused_where_one_is_missing() {
    let usual = with_row(0, "");
    let all = String::from_utf8(usual.clone()).expect("text");
    let (head, rows) = all.split_once("end_header\n").expect("a header");
    let words: Vec<&str> = rows.split_ascii_whitespace().collect();
    let lines = |lengths: &[usize]| {
        let (mut left, mut lines) = (&words[..], Vec::new());
        for &length in lengths.iter().cycle() {
            let (line, rest) = left.split_at(length.min(left.len()));
            lines.push(line.join(" "));
            left = rest;
            if left.is_empty() {
                break;
            }
        }
        lines
    };
    let file = |lines: &[String]| format!("{head}end_header\n{}\n", lines.join("\n"));
    // Halves of rows, uneven parts of rows, and lines of one length.
    for lengths in [&[2][..], &[3, 1], &[1], &[9], &[48]] {
        let lines = lines(lengths);
        assert_eq!(
            read("wrapped", file(&lines).as_bytes()).points,
            read("usual", &usual).points,
            "{lengths:?}"
        );
        // A number that is lost in one line and added in the next is refused.
        if lines.len() > 4 && lengths != [1] {
            let mut shifted = lines.clone();
            let end = shifted[1].rfind(' ').unwrap_or(0);
            shifted[1].truncate(end);
            shifted[2].push_str(" 7");
            let error = load_hair_bytes("a.ply", file(&shifted).as_bytes()).expect_err("shifted").to_string();
            assert!(error.starts_with("a.ply: line "), "{lengths:?}: {error}");
        }
    }
    // Lists end where lines do.
    let lists = |rows: [&str; 2]| {
        let head = format!("element vertex 4\n{PLACE}element line 2\nproperty list int int points\n");
        let points = ["0 0 0", "0 1 0", "1 0 0", "1 1 0"];
        text(&head, &points.iter().chain(&rows).map(|row| (*row).to_owned()).collect::<Vec<_>>())
    };
    assert_eq!(read("lists", &lists(["2 0 1", "2 2 3"])).strands(), 2);
    assert_eq!(read("wrapped lists", &lists(["2\n0 1", "2\n2 3"])).strands(), 2);
    for rows in [["2 0", "1 2 2 3"], ["2 0 1 2", "2 3"], ["3 0 1", "2 2 3"]] {
        let error = load_hair_bytes("a.ply", &lists(rows)).expect_err("shifted lists").to_string();
        assert!(error.starts_with("a.ply: line 1"), "{rows:?}: {error}");
    }
}

#[test]
fn written_strands_come_back_in_metres() {
    let hair = read("binary", &binary(false, "float")).in_metres(&crate::ImportSettings {
        unit: crate::Unit::Metre,
        up: crate::UpAxis::Y,
        facing: crate::Facing::PlusZ,
        ..crate::ImportSettings::default()
    });
    let format = HairFormat::of_path(std::path::Path::new("a.PLY")).expect("PLY");
    let back = read("written", &format.write.expect("it is written")(&hair).expect("bytes"));
    assert!(back.is_in_metres);
    assert_eq!((&back.first_point, &back.points), (&hair.first_point, &hair.points));
    assert_eq!((&back.thickness, &back.colours), (&hair.thickness, &hair.colours));
}

#[test]
fn what_does_not_fit_is_refused_in_a_sentence() {
    let points = rows(&points(&[3]));
    let head = |more: &str| format!("element vertex 3\n{PLACE}{more}");
    for (bytes, words) in [
        (b"ply\nformat ascii 1.0\nelement vertex 3\n".to_vec(), "end_header"),
        (text("element vertex many\n", &[]), "`element vertex many`"),
        (
            text("element vertex 900000000000\nproperty float x\n", &points),
            "as many rows as the file has room for",
        ),
        (text(&head("property half w\n"), &points), "`property half w`"),
        (
            text(&head("element strand 1\nproperty int nsegs\n"), &[&points[..], &["7".into()]].concat()),
            "strands of 8 points",
        ),
        (
            text(
                &head("element edge 1\nproperty int vertex1\nproperty int vertex2\n"),
                &[&points[..], &["0 3".into()]].concat(),
            ),
            "an edge to vertex 3; must be 0 to 2",
        ),
        (
            text(
                &head("element line 1\nproperty list int int points\n"),
                &[&points[..], &["2 0 -1".into()]].concat(),
            ),
            "vertex -1 of a strand; must be 0 to 2",
        ),
        (
            text(
                &head("element line 1\nproperty list int int points\n"),
                &[&points[..], &["-2 0".into()]].concat(),
            ),
            "a list of -2",
        ),
        (text(&head(""), &points[..2]), "the end of the file"),
        (text(&head(""), &["0 0 zero".into(), String::new(), "0 0 0 0 0 0".into()]), "`zero`"),
        (b"ply\nend_header\n".to_vec(), "format"),
    ] {
        let error = load_hair_bytes("a.ply", &bytes).expect_err(words).to_string();
        assert!(
            error.contains(words) && (error.starts_with("a.ply: byte") || error.starts_with("a.ply: line")),
            "{words}: {error}"
        );
    }
}
