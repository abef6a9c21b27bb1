//! Scenes written by hand: transforms, objects, other files, and what is left out.

use std::io::Write;

use glam::Vec3;

use crate::{HairFile, load_hair, load_hair_bytes};

const CURVE: &str = "Shape \"curve\" \"point3 P\" [ 0 0 0  0 1 0  0 2 0  0 3 0 ]\n";

fn load(text: &str) -> HairFile {
    load_hair_bytes("a.pbrt", text.as_bytes()).unwrap_or_else(|error| panic!("{error}"))
}

fn is_at(point: Vec3, wanted: [f32; 3]) {
    assert!(point.distance(Vec3::from(wanted)) < 1e-5, "{point} for {wanted:?}");
}

#[test]
fn the_transforms_in_scope_apply() {
    for (before, tip) in [
        ("", [0.0, 3.0, 0.0]),
        ("Translate 1 0 0 Scale 2 2 2", [1.0, 6.0, 0.0]),
        ("Scale 2 2 2 Translate 1 0 0", [2.0, 6.0, 0.0]),
        ("Rotate 90 0 0 1", [-3.0, 0.0, 0.0]),
        // Sixteen numbers, column after column: x to y, y to z, z to x, then one along x.
        ("Transform [ 0 1 0 0  0 0 1 0  1 0 0 0  1 0 0 1 ]", [1.0, 0.0, 3.0]),
        ("Translate 0 0 5 ConcatTransform [ 1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1 ]", [0.0, 3.0, 6.0]),
        ("Translate 9 9 9 Identity", [0.0, 3.0, 0.0]),
        ("Translate 9 9 9 WorldBegin", [0.0, 3.0, 0.0]),
        ("AttributeBegin Translate 9 9 9 AttributeEnd", [0.0, 3.0, 0.0]),
        ("TransformBegin Translate 9 9 9 TransformEnd Translate 0 1 0", [0.0, 4.0, 0.0]),
        ("Translate 1 2 3 CoordinateSystem \"a\" Identity CoordSysTransform \"a\"", [1.0, 5.0, 3.0]),
        ("ActiveTransform EndTime Translate 5 0 0 ActiveTransform All", [0.0, 3.0, 0.0]),
        // The eye is at z = -2 and looks along +z: the world moves two ahead.
        ("LookAt 0 0 -2  0 0 0  0 1 0", [0.0, 3.0, 2.0]),
        ("Camera \"perspective\" \"float fov\" [ 30 ] \"bool x\" true", [0.0, 3.0, 0.0]),
    ] {
        let file = load(&format!("{before}\n{CURVE}"));
        assert_eq!(file.points.len(), 2, "{before}");
        is_at(file.points[1], tip);
    }
}

#[test]
fn widths_run_along_the_curve_and_scale() {
    let file = load(&format!(
        "Scale 2 2 2 Shape \"curve\" \"float width0\" .3 \"float width1\" [ .1 ] \"point P\" [ 0 0 0 0 1 0 0 2 0 0 3 0 0 4 0 \
         0 5 0 0 6 0 ]\n{CURVE}"
    ));
    let widths = file.thickness.expect("widths");
    for (width, wanted) in widths.iter().zip([0.6, 0.4, 0.2, 2.0, 2.0]) {
        assert!((width - wanted).abs() < 1e-6, "{widths:?}");
    }
    assert!(load(CURVE).thickness.is_none(), "no curve states a width");
}

#[test]
fn objects_are_repeated_where_they_are_placed() {
    let file = load(&format!(
        "ObjectBegin \"tuft\" Translate 1 0 0 {CURVE} {CURVE} ObjectEnd\n\
         AttributeBegin Translate 0 10 0 ObjectInstance \"tuft\" AttributeEnd\n\
         Scale 2 2 2 ObjectInstance \"tuft\" ObjectInstance \"gone\""
    ));
    assert_eq!(file.strands(), 4);
    is_at(file.strand(0)[1], [1.0, 13.0, 0.0]);
    is_at(file.strand(3)[1], [2.0, 6.0, 0.0]);
    assert_eq!(file.notes, ["The object `gone` is not defined."]);
}

#[test]
fn other_files_are_included_once_each_way() {
    let dir = tempfile::tempdir().expect("a folder");
    let at = |name: &str| dir.path().join(name);
    std::fs::create_dir(at("geometry")).expect("a folder");
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packed.write_all(format!("Translate 1 0 0 {CURVE}").as_bytes()).expect("memory");
    std::fs::write(at("geometry/hair.pbrt.gz"), packed.finish().expect("memory")).expect("a file");
    let main = format!(
        "Include \"geometry/hair.pbrt.gz\"\n{CURVE}Identity Import \"geometry/hair.pbrt.gz\"\n{CURVE}\
         Include \"../outside.pbrt\" Include \"/etc/hostname\" Include \"gone.pbrt\""
    );
    std::fs::write(at("main.pbrt"), main).expect("a file");
    let file = load_hair(&at("main.pbrt")).expect("hair");
    // Included files share the state, imported ones do not.
    let x: Vec<f32> = (0..4).map(|strand| file.strand(strand)[0].x).collect();
    assert_eq!(x, [1.0, 1.0, 1.0, 0.0]);
    assert_eq!(file.notes.len(), 3, "{:?}", file.notes);
    // A compressed file is also opened by itself.
    assert_eq!(load_hair(&at("geometry/hair.pbrt.gz")).expect("hair").strands(), 1);
    // A file that includes itself, twice over, ends.
    std::fs::write(at("again.pbrt"), format!("{CURVE}Include \"again.pbrt\" Include \"again.pbrt\""))
        .expect("a file");
    let error = load_hair(&at("again.pbrt")).expect_err("endless").to_string();
    assert!(error.contains("32 within each other"), "{error}");
}

#[test]
fn broken_scenes_are_refused_in_one_line() {
    for (text, found) in [
        ("Shape \"sphere\"", "found no curve; must be a directive `Shape \"curve\"`"),
        ("Shape \"curve\" \"point3 P\" [ 0 0 0 ]", "found 1 curve, none"),
        ("Translate 1 two 3", "byte 12: found `two`; must be three numbers after Translate"),
        ("Transform [ 1 0 0 0 ]", "must be sixteen numbers"),
        ("Shape curve", "the kind of a shape in quotes"),
        ("Shape \"curve\" \"point3 P\" [ 0 0 0", "truncated"),
        ("Shape \"curve", "ends inside a string"),
        ("ObjectBegin 3", "a name in quotes"),
    ] {
        let error = load_hair_bytes("a.pbrt", text.as_bytes()).expect_err(text).to_string();
        assert!(error.starts_with("a.pbrt: ") && error.contains(found) && !error.contains('\n'), "{error}");
    }
    let deep = "AttributeBegin ".repeat(20_000);
    assert!(
        load_hair_bytes("a", deep.as_bytes()).is_err_and(|error| error.to_string().contains("10000 open"))
    );
    // An object of a few curves, repeated very often.
    let many = format!(
        "ObjectBegin \"a\" {} ObjectEnd {}",
        CURVE.repeat(1000),
        "ObjectInstance \"a\" ".repeat(20_000)
    );
    let error = load_hair_bytes("a.pbrt", many.as_bytes()).expect_err("too many").to_string();
    assert!(error.contains("repeated objects"), "{error}");
}

/// The widths at root and tip of each strand.
fn ends(file: &HairFile) -> Vec<[f32; 2]> {
    let widths = file.thickness.as_ref().expect("widths");
    let span = |&[start, end]: &[u32; 2]| [widths[start as usize], widths[end as usize - 1]];
    file.first_point.array_windows().map(span).collect()
}

/// Whether widths are those wanted, up to rounding.
fn are_near(found: &[[f32; 2]], wanted: &[[f32; 2]]) {
    assert_eq!(found.len(), wanted.len(), "{found:?}");
    for (found, wanted) in found.as_flattened().iter().zip(wanted.as_flattened()) {
        assert!((found - wanted).abs() <= 1e-5 * wanted, "{found} for {wanted}");
    }
}

#[test]
fn numbers_without_a_blank_are_divided_and_curves_that_lack_one_are_left_out() {
    let curve = |points: &str| format!("Shape \"curve\" \"point3 P\" [ {points} ]\n");
    let usual = "1 -1 0  1 0 -0.5  1 1 -0.5  1 2 -0.25";
    let glued = "1-1 0  1 0-0.5  1+1-0.5 1 2-0.25";
    assert_eq!(load(&curve(glued)).points, load(&curve(usual)).points);
    // One number less, one that is two, and one more: the curves around it stay what they are.
    for wrong in [
        "1-1 0  1 0-0.5  1+1-0.5 1 2",
        "1-1 0  1 0-0.5  1+1-0.5 1 20.25",
        "1-1 0  1 0-0.5  1+1-0.5 1 2-0.25 9",
    ] {
        let file = load(&[curve(usual), curve(wrong), curve(usual)].concat());
        assert_eq!((file.strands(), file.dropped["unfit_curves"]), (2, 1), "{wrong}");
        assert_eq!(file.strand(0), file.strand(1), "{wrong}");
    }
}

#[test]
fn attributes_of_shapes_are_the_defaults_of_what_follows_in_their_block() {
    let own = |words: &str| CURVE.replace('\n', &format!(" {words}\n"));
    let text = format!(
        "{CURVE}\
         AttributeBegin\n\
         Attribute \"shape\" \"float width0\" .4 \"float width1\" [ .1 ] ReverseOrientation\n\
         Attribute \"light\" \"float width0\" 9 \"bool twosided\" true\n\
         Attribute \"material\" \"float width\" [ 9 ] Attribute \"medium\" \"string basis\" \"other\"\n\
         {CURVE}{of_one}\
         TransformBegin Attribute \"shape\" \"float width0\" .8\n{CURVE}TransformEnd\n\
         {CURVE}{of_both}\
         ObjectBegin \"a\" Attribute \"shape\" \"float width1\" .3 {CURVE} ObjectEnd\n\
         {CURVE} ObjectInstance \"a\"\n\
         AttributeEnd\n{CURVE}{after}",
        of_one = own("\"float width1\" .2"),
        of_both = own("\"float width\" 5"),
        after = own("\"float width\" .5"),
    );
    let wanted = [
        [1.0, 1.0],
        [0.4, 0.1],
        [0.4, 0.2],
        [0.8, 0.1],
        [0.4, 0.1],
        // width0 and width1 of the block come before the width of the curve, as in pbrt.
        [0.4, 0.1],
        [0.4, 0.1],
        [0.4, 0.3],
        [1.0, 1.0],
        [0.5, 0.5],
    ];
    are_near(&ends(&load(&text)), &wanted);
}

#[test]
fn attributes_set_degree_basis_and_points_and_end_with_an_imported_file() {
    let curve = "Shape \"curve\" \"point3 P\" [ 0 0 0  0 1 0  0 2 0  0 3 0  0 4 0 ]\n";
    // Five points fit a chain of parabolas and a B-spline, but no cubic bezier.
    for (words, fits) in [
        ("\"integer degree\" [ 2 ]", true),
        ("\"string basis\" [ \"bspline\" ]", true),
        ("\"integer degree\" [ 3 ] \"string basis\" \"bezier\"", false),
    ] {
        let text = format!("{CURVE}Attribute \"shape\" {words}\n{curve}");
        assert_eq!(load(&text).strands(), if fits { 2 } else { 1 }, "{words}");
    }
    let text =
        "Attribute \"shape\" \"point3 P\" [ 0 0 0  0 1 0  0 2 0  0 3 0 ]\nShape \"curve\"\nShape \"curve\"\n";
    assert_eq!(
        load(&format!("{text}{CURVE}")).strands(),
        3,
        "points as a default, and own ones in their place"
    );
    let dir = tempfile::tempdir().expect("a folder");
    let at = |name: &str| dir.path().join(name);
    std::fs::write(at("sets.pbrt"), "Attribute \"shape\" \"float width\" .25\n").expect("a file");
    for (word, width) in [("Include", 0.25), ("Import", 1.0)] {
        let own = CURVE.replace('\n', " \"float width1\" 1\n");
        std::fs::write(at("main.pbrt"), format!("{word} \"sets.pbrt\"\n{own}")).expect("a file");
        assert_eq!(ends(&load_hair(&at("main.pbrt")).expect("hair")), [[width, 1.0]], "{word}");
    }
    let error = load_hair_bytes("a.pbrt", b"Attribute 3").expect_err("no target").to_string();
    assert!(error.contains("a target in quotes after Attribute"), "{error}");
}

#[test]
fn curves_that_alpha_cuts_out_are_hidden() {
    let file = load(&format!(
        "{CURVE}AttributeBegin Attribute \"shape\" \"float alpha\" 0\n{CURVE}AttributeEnd {CURVE}"
    ));
    assert_eq!(file.strands(), 2);
    assert!(file.notes.iter().any(|note| note.contains("1 hidden strand")), "{:?}", file.notes);
}

#[test]
fn the_report_on_attributes_gives_its_widths() {
    let Some(data) = lovelock_testkit::data_dir() else { return };
    let ends = ends(&load_hair(&data.join("reports/attribute.pbrt")).expect("hair"));
    assert_eq!(ends.len(), 60);
    for (strands, wanted) in [
        (0..30, [0.0004, 0.0001]),
        (30..40, [0.0008, 0.0002]),
        (40..50, [0.0006, 0.0006]),
        (50..60, [0.0003, 0.0003]),
    ] {
        are_near(&ends[strands.clone()], &vec![wanted; strands.len()]);
    }
}
