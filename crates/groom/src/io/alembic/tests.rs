use std::io::Cursor;

use glam::{DMat4, DVec3, Vec3};
use lovelock_alembic::{ArchiveWriter, CompoundTree, DataType, ObjectTree, Pod, Samples, Times};
use lovelock_testkit::fuzz::damaged;

use crate::{HairFile, load_hair_bytes};

const POINT: DataType = DataType::new(Pod::F32, 3);
const FLOAT: DataType = DataType::new(Pod::F32, 1);
const INT: DataType = DataType::new(Pod::I32, 1);

type Writer = ArchiveWriter<Cursor<Vec<u8>>>;

fn array(writer: &mut Writer, ty: DataType, bytes: &[u8]) -> Samples {
    let mut samples = Samples::array(ty, 0);
    samples.push(writer.store(ty, bytes).expect("memory"));
    samples
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

fn ints(values: &[i32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// Schema and parameters of an object of curves.
struct Curves {
    counts: Vec<i32>,
    points: Vec<f32>,
    basis: [u8; 4],
    /// Name, metadata, type and bytes of more properties.
    more: Vec<(&'static str, &'static str, DataType, Vec<u8>)>,
    parameters: Vec<(&'static str, &'static str, DataType, Vec<u8>)>,
}

impl Curves {
    /// Two curves of two and three points.
    fn plain() -> Self {
        let points = vec![0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 1.0, 2.0, 1.0];
        Self { counts: vec![2, 3], points, basis: [1, 0, 0, 0], more: Vec::new(), parameters: Vec::new() }
    }

    fn object(&self, writer: &mut Writer, name: &str) -> ObjectTree {
        let mut schema = CompoundTree::default();
        let points = array(writer, POINT, &floats(&self.points));
        schema.samples("P", "geoScope=vtx", points);
        let counts = array(writer, INT, &ints(&self.counts));
        schema.samples("nVertices", "", counts);
        let mut basis = Samples::scalar(DataType::new(Pod::U8, 4), 0);
        basis.push(writer.store(basis.ty, &self.basis).expect("memory"));
        schema.samples("curveBasisAndType", "", basis);
        for (name, metadata, ty, bytes) in &self.more {
            let samples = array(writer, *ty, bytes);
            schema.samples(name, metadata, samples);
        }
        let mut parameters = CompoundTree::default();
        for (name, metadata, ty, bytes) in &self.parameters {
            let samples = array(writer, *ty, bytes);
            parameters.samples(name, metadata, samples);
        }
        schema.compound(".arbGeomParams", "", parameters);
        let mut properties = CompoundTree::default();
        properties.compound(".geom", "", schema);
        ObjectTree {
            name: name.to_owned(),
            metadata: "schema=AbcGeom_Curve_v2".to_owned(),
            properties,
            children: Vec::new(),
        }
    }
}

/// A transform with these operations and values at two times.
fn transform(
    writer: &mut Writer,
    operations: &[u8],
    values: [&[f64]; 2],
    inherits: bool,
    children: Vec<ObjectTree>,
) -> ObjectTree {
    let times = writer.add_times(Times::uniform(0.0, 1.0));
    let mut kinds = Samples::scalar(DataType::new(Pod::U8, operations.len() as u8), 0);
    kinds.push(writer.store(kinds.ty, operations).expect("memory"));
    let mut channels = Samples::scalar(DataType::new(Pod::F64, values[0].len() as u8), times);
    for values in values {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        channels.push(writer.store(channels.ty, &bytes).expect("memory"));
    }
    let mut inherited = Samples::scalar(DataType::new(Pod::Bool, 1), 0);
    inherited.push(writer.store(inherited.ty, &[u8::from(inherits)]).expect("memory"));
    let mut schema = CompoundTree::default();
    schema.samples(".inherits", "", inherited);
    schema.samples(".ops", "", kinds);
    schema.samples(".vals", "", channels);
    let mut properties = CompoundTree::default();
    properties.compound(".xform", "", schema);
    ObjectTree {
        name: "moved".to_owned(),
        metadata: "schema=AbcGeom_Xform_v3".to_owned(),
        properties,
        children,
    }
}

fn file(make: impl FnOnce(&mut Writer) -> Vec<ObjectTree>) -> Vec<u8> {
    let mut writer = ArchiveWriter::create(Cursor::new(Vec::new())).expect("memory");
    let objects = make(&mut writer);
    writer.finish("", objects).expect("memory").0.into_inner()
}

fn load(make: impl FnOnce(&mut Writer) -> Vec<ObjectTree>) -> HairFile {
    load_hair_bytes("a.abc", &file(make)).expect("hair")
}

fn refusal(bytes: &[u8]) -> String {
    load_hair_bytes("a.abc", bytes).expect_err("refused").to_string()
}

#[test]
fn curves_have_their_points_widths_and_colours() {
    let mut curves = Curves::plain();
    curves.more = vec![("width", "geoScope=vtx", FLOAT, floats(&[0.1, 0.2, 0.3, 0.4, 0.5]))];
    curves.parameters = vec![("Cd", "geoScope=uni", POINT, floats(&[0.2, 0.0, 0.0, 0.0, 1.0, 0.0]))];
    let hair = load(|writer| vec![curves.object(writer, "a")]);
    assert_eq!((hair.first_point.as_slice(), hair.format.as_str()), (&[0, 2, 5][..], "Alembic curves"));
    assert_eq!(hair.points[4], Vec3::new(1.0, 2.0, 1.0));
    assert_eq!(hair.thickness.as_deref(), Some(&[0.1, 0.2, 0.3, 0.4, 0.5][..]));
    let colours = hair.colours.expect("colours");
    assert!((colours[1][0] - 0.484_53).abs() < 1e-3, "{:?} is sRGB of 0.2", colours[1]);
    assert!(colours[2][0] == 0.0 && colours[2][1] > 0.999, "{:?}", colours[2]);
    // Parameter that fit nothing are left out, with a note.
    curves.more[0].3 = floats(&[0.1; 4]);
    let hair = load(|writer| vec![curves.object(writer, "a")]);
    assert!(hair.thickness.is_none() && hair.notes[0].contains("/a: 4 values of width"), "{:?}", hair.notes);
}

#[test]
fn transforms_of_all_ancestors_apply_at_the_first_time() {
    let placed = |inherits: bool| {
        load(|writer| {
            let mut curves = Curves::plain();
            curves.more = vec![("width", "geoScope=con", FLOAT, floats(&[0.1]))];
            let child = curves.object(writer, "a");
            // Scaled by two, then moved.
            let inner = [1 << 4, 0];
            let values = [5.0, 0.0, 0.0, 2.0, 2.0, 2.0];
            let moved = transform(writer, &inner, [&values, &[9.0; 6]], inherits, vec![child]);
            let turned = [[0.0, 1.0, 0.0, 90.0], [0.0, 1.0, 0.0, 0.0]];
            vec![transform(writer, &[2 << 4], [&turned[0], &turned[1]], true, vec![moved])]
        })
    };
    let inner = DMat4::from_translation(DVec3::new(5.0, 0.0, 0.0)) * DMat4::from_scale(DVec3::splat(2.0));
    let turn = DMat4::from_rotation_y(90_f64.to_radians());
    for (inherits, whole) in [(true, turn * inner), (false, inner)] {
        let hair = placed(inherits);
        let wanted = whole.transform_point3(DVec3::new(1.0, 2.0, 1.0)).as_vec3();
        assert!(hair.points[4].abs_diff_eq(wanted, 1e-6), "{} for {wanted}", hair.points[4]);
        assert!((hair.thickness.expect("widths")[0] - 0.2).abs() < 1e-6, "widths are scaled too");
    }
}

#[test]
fn cubic_curves_become_polylines() {
    let bent = |basis: [u8; 4], knots: Option<&[f32]>| {
        let mut curves = Curves::plain();
        (curves.counts, curves.basis) = (vec![5], basis);
        curves.points = (0..5).flat_map(|i| [0.0, i as f32, 0.0]).collect();
        if let Some(knots) = knots {
            curves.more = vec![(".knots", "", FLOAT, floats(knots))];
        }
        let hair = load(|writer| vec![curves.object(writer, "a")]);
        (hair.points.len(), hair.points[0].y, hair.points[hair.points.len() - 1].y)
    };
    assert_eq!(bent([1, 0, 2, 2], None), (5, 0.0, 4.0));
    // Two spans of four pieces, from one third-point to the other.
    assert_eq!(bent([0, 0, 2, 2], None), (9, 1.0, 3.0));
    assert_eq!(bent([0, 0, 3, 3], None), (9, 1.0, 3.0));
    // One span of eight pieces; a fifth point belongs to none.
    assert_eq!(bent([0, 0, 1, 1], None), (9, 0.0, 3.0));
    // Repeated knots: from end to end.
    assert_eq!(bent([0, 0, 2, 2], Some(&[0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 2.0, 2.0, 2.0])), (17, 0.0, 4.0));
    assert_eq!(bent([0, 0, 2, 2], Some(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0])), (9, 1.0, 3.0));
}

#[test]
fn guides_are_left_out_where_they_stand_for_other_curves() {
    let short = DataType::new(Pod::I16, 1);
    let guides = |values: &[u8]| {
        let mut curves = Curves::plain();
        curves.more = vec![("width", "geoScope=vtx", FLOAT, floats(&[0.1, 0.2, 0.3, 0.4, 0.5]))];
        curves.parameters = vec![("groom_guide", "geoScope=uni", short, values.to_vec())];
        load(|writer| vec![curves.object(writer, "a")])
    };
    let hair = guides(&[1, 0, 0, 0]);
    assert_eq!((hair.strands(), hair.points[0]), (1, Vec3::X));
    assert_eq!(hair.thickness.as_deref(), Some(&[0.3, 0.4, 0.5][..]));
    assert!(hair.notes[0].contains("1 guide "), "{:?}", hair.notes);
    assert_eq!(guides(&[1, 0, 1, 0]).strands(), 2, "guides alone are hair");
    assert_eq!(guides(&[1, 0]).strands(), 2, "one value for all");
    assert_eq!(guides(&[0, 0, 0, 0]).strands(), 2);
}

#[test]
fn contradictions_are_refused_in_one_sentence() {
    let wrong = |change: fn(&mut Curves), wanted: &str| {
        let mut curves = Curves::plain();
        change(&mut curves);
        let error = refusal(&file(|writer| vec![curves.object(writer, "a")]));
        assert!(error.starts_with("a.abc: ") && error.contains(wanted), "{error}");
        assert_eq!(error.lines().count(), 1);
    };
    wrong(|curves| curves.counts = vec![2, 2], "5 points in 2 curves");
    wrong(|curves| curves.counts = vec![-1, 6], "a curve of -1 points");
    wrong(|curves| curves.basis = [0, 0, 4, 4], "type 0 and basis 4");
    wrong(|curves| (curves.counts, curves.points) = (vec![], vec![]), "no strand left");
    assert!(refusal(&file(|_| Vec::new())).contains("without curves"));
    assert!(refusal(b"\x89HDF\r\n\x1a\n0123456789").contains("HDF5"));
    let few = file(|writer| {
        let child = Curves::plain().object(writer, "a");
        vec![transform(writer, &[3 << 4], [&[1.0; 15], &[2.0; 15]], true, vec![child])]
    });
    assert!(refusal(&few).contains("other values than its operations"));
}

#[test]
fn objects_that_share_their_points_take_bounded_memory() {
    let shared = file(|writer| {
        let mut curves = Curves::plain();
        curves.counts = vec![3; 20_000];
        curves.points = vec![0.5; 9 * 20_000];
        let object = curves.object(writer, "a");
        (0..40).map(|i| ObjectTree { name: format!("a{i}"), ..object.clone() }).collect()
    });
    assert!(shared.len() < 1 << 20, "{}", shared.len());
    assert!(refusal(&shared).contains("few that are shared"));
}

#[test]
fn damaged_hair_alembic() {
    let whole = file(|writer| {
        let mut curves = Curves::plain();
        curves.more = vec![("width", "geoScope=vtx", FLOAT, floats(&[0.1, 0.2, 0.3, 0.4, 0.5]))];
        curves.parameters = vec![("Cd", "geoScope=uni", POINT, floats(&[0.2, 0.0, 0.0, 0.0, 1.0, 0.0]))];
        let child = curves.object(writer, "a");
        vec![transform(writer, &[1 << 4], [&[1.0; 3], &[2.0; 3]], true, vec![child])]
    });
    for length in 0..whole.len() - 8 {
        assert!(load_hair_bytes("a.abc", &whole[..length]).is_err(), "{length} bytes of it");
    }
    let counts = damaged("abc", &[whole], 3000, |bytes| match load_hair_bytes("a.abc", bytes) {
        Ok(hair) => {
            assert!(hair.points.len() <= 64.max(bytes.len()), "{} points", hair.points.len());
            true
        }
        Err(error) => {
            assert_eq!(error.to_string().lines().count(), 1, "{error}");
            false
        }
    });
    // Measured: 8 % of 20 million.
    counts.assert_mixed(0.02);
}

/// An object with values of `visible` at the times 0 and 1.
fn visible(writer: &mut Writer, values: &[i8], mut object: ObjectTree) -> ObjectTree {
    let times = writer.add_times(Times::uniform(0.0, 1.0));
    let mut samples = Samples::scalar(DataType::new(Pod::I8, 1), times);
    for value in values {
        samples.push(writer.store(samples.ty, &value.to_le_bytes()).expect("memory"));
    }
    object.properties.samples("visible", "", samples);
    object
}

#[test]
fn invisible_objects_are_left_out_as_the_library_decides() {
    // Visibility of the group, of the curves, and whether they are drawn.
    for (group, own, is_drawn) in [
        (None, None, true),
        (None, Some(0), false),
        (None, Some(-1), true),
        (Some(0), None, false),
        (Some(0), Some(-1), false),
        (Some(0), Some(1), true),
        (Some(1), Some(0), false),
        (Some(-1), Some(-1), true),
    ] {
        let hair = load(|writer| {
            let mut curves = Curves::plain().object(writer, "a");
            if let Some(own) = own {
                curves = visible(writer, &[own], curves);
            }
            let mut moved = transform(writer, &[1 << 4], [&[0.0; 3], &[0.0; 3]], true, vec![curves]);
            if let Some(group) = group {
                moved = visible(writer, &[group], moved);
            }
            vec![moved, Curves::plain().object(writer, "b")]
        });
        assert_eq!(hair.strands(), if is_drawn { 4 } else { 2 }, "{group:?} {own:?}");
        let noted = hair.notes.iter().any(|note| note.starts_with("Left out 2 hidden strands"));
        assert_eq!(noted, !is_drawn, "{:?}", hair.notes);
    }
    // Animated: the value at the first time counts, and a note says that it changes.
    for (values, strands) in [([0, -1], 2), ([-1, 0], 4)] {
        let hair = load(|writer| {
            let curves = Curves::plain().object(writer, "a");
            vec![visible(writer, &values, curves), Curves::plain().object(writer, "b")]
        });
        assert_eq!(hair.strands(), strands);
        assert!(hair.notes.iter().any(|note| note.contains("/a: visibility changes")), "{:?}", hair.notes);
    }
}

#[test]
fn every_scope_with_and_without_indices_gives_each_point_its_width() {
    let index = DataType::new(Pod::U32, 1);
    for (scope, values, picks, wanted) in [
        ("con", vec![7.0], None, [7.0; 5]),
        ("uni", vec![1.0, 2.0], None, [1.0, 1.0, 2.0, 2.0, 2.0]),
        ("var", vec![1.0, 2.0, 3.0, 4.0, 5.0], None, [1.0, 2.0, 3.0, 4.0, 5.0]),
        ("vtx", vec![1.0, 2.0, 3.0, 4.0, 5.0], None, [1.0, 2.0, 3.0, 4.0, 5.0]),
        ("fvr", vec![1.0, 2.0, 3.0, 4.0, 5.0], None, [1.0, 2.0, 3.0, 4.0, 5.0]),
        ("uni", vec![1.0, 2.0, 9.0], Some(vec![2, 0]), [9.0, 9.0, 1.0, 1.0, 1.0]),
        ("vtx", vec![1.0, 2.0], Some(vec![0, 1, 1, 1, 0]), [1.0, 2.0, 2.0, 2.0, 1.0]),
        ("con", vec![1.0, 2.0], Some(vec![1]), [2.0; 5]),
    ] {
        let hair = load(|writer| {
            let mut curves = Curves::plain().object(writer, "a");
            let metadata = format!("geoScope={scope};isGeomParam=true");
            let samples = array(writer, FLOAT, &floats(&values));
            let mut parameters = CompoundTree::default();
            match &picks {
                None => parameters.samples("groom_width", &metadata, samples),
                Some(picks) => {
                    let mut parameter = CompoundTree::default();
                    parameter.samples(".vals", "", samples);
                    let picks = array(writer, index, &ints(picks));
                    parameter.samples(".indices", "", picks);
                    parameters.compound("groom_width", &metadata, parameter);
                }
            }
            // In place of the empty parameters of the plain curves.
            curves.properties = plain_geometry(writer, parameters);
            vec![curves]
        });
        assert_eq!(hair.thickness.as_deref(), Some(&wanted[..]), "{scope} {picks:?}: {:?}", hair.notes);
    }
}

/// The properties of the plain curves with parameters.
fn plain_geometry(writer: &mut Writer, parameters: CompoundTree) -> CompoundTree {
    let curves = Curves::plain();
    let mut schema = CompoundTree::default();
    let points = array(writer, POINT, &floats(&curves.points));
    schema.samples("P", "geoScope=vtx", points);
    let counts = array(writer, INT, &ints(&curves.counts));
    schema.samples("nVertices", "", counts);
    schema.compound(".arbGeomParams", "", parameters);
    let mut properties = CompoundTree::default();
    properties.compound(".geom", "", schema);
    properties
}

#[test]
fn objects_without_widths_get_the_mean_of_the_others() {
    let hair = load(|writer| {
        let mut curves = Curves::plain();
        curves.more = vec![("width", "geoScope=con", FLOAT, floats(&[0.5]))];
        vec![curves.object(writer, "a"), Curves::plain().object(writer, "b")]
    });
    assert_eq!(hair.thickness, Some(vec![0.5; 10]));
    assert!(hair.notes.iter().any(|note| note.contains("without a width")), "{:?}", hair.notes);
}
