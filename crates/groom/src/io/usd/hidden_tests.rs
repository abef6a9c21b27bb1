//! Hidden curves, and the precedence and interpolation of primvars.

use lovelock_base::watch::Watch;
use lovelock_testkit::data_dir;

use super::super::{CurveCache, HairFile, HairFileError, Unit, UpAxis, load_hair_bytes, load_hair_watched};

fn load(text: &str) -> Result<HairFile, HairFileError> {
    load_hair_bytes("a.usda", text.as_bytes())
}

/// Curves of two points each along X at a height, with lines of their prim.
fn curves(name: &str, count: usize, lines: &str) -> String {
    let counts = vec!["2"; count].join(", ");
    let points: Vec<String> = (0..count).map(|i| format!("({i}, 0, 0), ({i}, 0.1, 0)")).collect();
    let points = points.join(", ");
    format!(
        "def BasisCurves \"{name}\"\n{{\nuniform token type = \"linear\"\nint[] curveVertexCounts = [{counts}]\n\
         point3f[] points = [{points}]\n{lines}\n}}\n"
    )
}

fn stage(prims: &[String]) -> String {
    format!("#usda 1.0\n(\n metersPerUnit = 1\n upAxis = \"Y\"\n)\n{}", prims.concat())
}

const INVISIBLE: &str = "token visibility = \"invisible\"";
const GUIDE: &str = "uniform token purpose = \"guide\"";

#[test]
fn hidden_curves_are_left_out_counted_and_selectable() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("a.usda");
    let widths = "float[] widths = [0.25] (\n interpolation = \"constant\"\n)";
    let text = stage(&[curves("a", 4, widths), curves("b", 3, GUIDE), curves("c", 2, INVISIBLE)]);
    std::fs::write(&path, &text).expect("a file");
    let load = |include| load_hair_watched(&path, include, &Watch::default()).expect("hair");
    let shown = load(false);
    assert_eq!(shown.strands(), 4);
    assert_eq!(shown.thickness, Some(vec![0.25; 8]), "widths are not lost by hidden curves without any");
    let note = "Left out 3 guides and proxies and 2 hidden strands";
    assert!(shown.notes.iter().any(|text| text.starts_with(note)), "{:?}", shown.notes);
    let all = load(true);
    assert_eq!(all.strands(), 9);
    assert_eq!(all.thickness, Some(vec![0.25; 18]));
    assert!(all.notes.iter().any(|text| text.starts_with("Includes 3 guides")), "{:?}", all.notes);
}

#[test]
fn guides_alone_are_hair_and_invisible_curves_alone_are_not() {
    let guides = load(&stage(&[curves("b", 3, GUIDE), curves("c", 2, INVISIBLE)])).expect("hair");
    assert_eq!(guides.strands(), 3);
    assert_eq!(guides.notes.len(), 2, "{:?}", guides.notes);
    let error = load(&stage(&[curves("c", 2, INVISIBLE)])).expect_err("nothing visible").to_string();
    assert!(error.contains("2 hidden strands") && error.contains("*Include hidden*"), "{error}");
}

#[test]
fn curves_that_are_not_on_the_stage_are_mentioned() {
    let class = curves("b", 3, "").replace("def ", "class ");
    let hair = load(&stage(&[curves("a", 4, ""), class])).expect("hair");
    assert_eq!(hair.strands(), 4);
    assert!(hair.notes.iter().any(|note| note.starts_with("1 prim of curves is not")), "{:?}", hair.notes);
}

#[test]
fn classes_hide_what_inherits_from_them() {
    let inherits = |name: &str, count, arc: &str| {
        curves(name, count, "").replacen("\"\n{", &format!("\" (\n {arc} = </_kind>\n)\n{{"), 1)
    };
    let class = |lines: &str| format!("class \"_kind\"\n{{\n{lines}\n}}\n");
    for arc in ["inherits", "prepend specializes"] {
        for (lines, note) in
            [(GUIDE, "Left out 2 guides and proxies"), (INVISIBLE, "Left out 2 hidden strands")]
        {
            let text = stage(&[class(lines), curves("a", 4, ""), inherits("b", 2, arc)]);
            let hair = load(&text).expect("hair");
            assert_eq!(hair.strands(), 4, "{arc}");
            assert!(hair.notes.iter().any(|text| text.starts_with(note)), "{:?}", hair.notes);
            assert!(
                hair.notes
                    .iter()
                    .any(|note| note.contains("of the file were left out, except the visibility"))
            );
        }
        // The control: a class that says nothing about it.
        let hair = load(&stage(&[class(""), curves("a", 4, ""), inherits("b", 2, arc)])).expect("hair");
        assert_eq!(hair.strands(), 6, "{arc}");
    }
}

#[test]
fn prototypes_of_an_instancer_are_left_out_and_variants_are_mentioned() {
    let instancer = |inner: &str| {
        format!(
            "def PointInstancer \"i\"\n{{\nrel prototypes = </i/p/b>\ndef Scope \"p\"\n{{\n{inner}}}\n}}\n"
        )
    };
    let hair = load(&stage(&[curves("a", 4, ""), instancer(&curves("b", 2, ""))])).expect("hair");
    assert_eq!(hair.strands(), 4);
    let note = "Left out 2 strands of prototypes; the setting *Include hidden* imports them.";
    assert!(hair.notes.iter().any(|text| text == note), "{:?}", hair.notes);
    let alone = load(&stage(&[instancer(&curves("b", 1, ""))])).expect("hair");
    assert!(alone.strands() == 1 && alone.notes.iter().any(|text| text.contains("are prototypes")));
    let one = load(&stage(&[curves("a", 4, ""), curves("b", 1, INVISIBLE)])).expect("hair");
    assert!(one.notes.iter().any(|text| text.ends_with("imports it.")), "{:?}", one.notes);
    let variant = format!(
        "def Xform \"w\" (\nvariants = {{ string v = \"x\" }}\nprepend variantSets = \"v\"\n)\n{{\nvariantSet \"v\" = {{\n\"x\" {{\n{}}}\n}}\n}}\n",
        curves("b", 2, "")
    );
    let hair = load(&stage(&[curves("a", 4, ""), variant.clone()])).expect("hair");
    assert_eq!(hair.strands(), 4);
    assert!(hair.notes.iter().any(|text| text == "Variants of the file were left out."), "{:?}", hair.notes);
    assert!(!hair.notes.iter().any(|text| text.contains("not on the stage")), "{:?}", hair.notes);
    let error = load(&stage(&[variant])).expect_err("no curves").to_string();
    assert!(error.contains("variants of the file were left out"), "{error}");
}

#[test]
fn hidden_curves_stay_hidden_while_the_others_play() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("a.usda");
    let moved = curves(
        "z",
        1,
        "point3f[] points.timeSamples = {\n0: [(0, 0, 0), (0, 1, 0)],\n24: [(9, 0, 0), (9, 1, 0)],\n}",
    );
    std::fs::write(&path, stage(&[curves("a", 2, INVISIBLE), moved])).expect("a file");
    let mut points = Vec::new();
    for (include, count) in [(false, 2), (true, 6)] {
        let mut cache = CurveCache::open(&path, Unit::Auto, UpAxis::Auto, include).expect("curves");
        cache.points_at(1.0, &mut points).expect("a time");
        assert_eq!(points.len(), count);
        assert_eq!(points[count - 1].x, 9.0);
    }
}

#[test]
fn the_report_on_hidden_prims_gives_forty_strands() {
    let Some(data) = data_dir() else { return };
    let path = data.join("reports/hidden_prims.usda");
    let load = |include| load_hair_watched(&path, include, &Watch::default()).expect("hair");
    let shown = load(false);
    assert_eq!((shown.strands(), load(true).strands()), (40, 100));
    let note = "Left out 30 guides and proxies and 30 hidden strands";
    assert!(shown.notes.iter().any(|text| text.starts_with(note)), "{:?}", shown.notes);
}

#[test]
fn the_report_on_widths_gives_those_of_the_primvar() {
    let Some(data) = data_dir() else { return };
    let path = data.join("reports/primvar_widths.usda");
    let text = std::fs::read_to_string(&path).expect("a file");
    let value = |name: &str| -> f32 {
        let line = text.lines().find(|line| line.trim().starts_with(name)).expect(name);
        let inner = line.split('[').nth(2).and_then(|rest| rest.split([',', ']']).next());
        inner.expect("a list").trim().parse().expect("a number")
    };
    let widths = load_hair_watched(&path, false, &Watch::default()).expect("hair").thickness;
    let (of_primvar, plain) = (value("float[] primvars:widths"), value("float[] widths"));
    assert_eq!(widths.expect("widths")[0], of_primvar);
    assert_ne!(of_primvar, plain, "the control");
}

#[test]
fn every_interpolation_gives_each_point_its_width() {
    for (said, values, wanted) in [
        ("constant", "[1]", [1.0, 1.0, 1.0, 1.0]),
        ("uniform", "[1, 2]", [1.0, 1.0, 2.0, 2.0]),
        ("vertex", "[1, 2, 3, 4]", [1.0, 2.0, 3.0, 4.0]),
        ("varying", "[1, 2, 3, 4]", [1.0, 2.0, 3.0, 4.0]),
        ("faceVarying", "[1, 2, 3, 4]", [1.0, 2.0, 3.0, 4.0]),
    ] {
        for name in ["widths", "primvars:widths"] {
            let lines = format!("float[] {name} = {values} (\n interpolation = \"{said}\"\n)");
            let hair = load(&stage(&[curves("a", 2, &lines)])).expect("hair");
            assert_eq!(hair.thickness.as_deref(), Some(&wanted[..]), "{name} {said}");
        }
    }
    let indexed = "float[] primvars:widths = [7, 8] (\n interpolation = \"uniform\"\n)\n\
                   int[] primvars:widths:indices = [1, 0]";
    let hair = load(&stage(&[curves("a", 2, indexed)])).expect("hair");
    assert_eq!(hair.thickness.as_deref(), Some(&[8.0, 8.0, 7.0, 7.0][..]));
    let group = format!(
        "def Xform \"g\"\n{{\nfloat[] primvars:widths = [6]\n{}{}}}\n",
        curves("a", 1, ""),
        curves("b", 1, "float[] widths = [2]")
    );
    let hair = load(&stage(&[group])).expect("hair");
    assert_eq!(hair.thickness.as_deref(), Some(&[6.0, 6.0, 2.0, 2.0][..]), "inherited, and the own one");
}

#[test]
fn curves_without_widths_or_colours_get_the_mean_of_the_others() {
    let some = "float[] widths = [1, 3] (\n interpolation = \"uniform\"\n)\n\
                color3f[] primvars:displayColor = [(1, 0, 0)]";
    let hair = load(&stage(&[curves("a", 2, some), curves("b", 1, "")])).expect("hair");
    assert_eq!(hair.thickness.as_deref(), Some(&[1.0, 1.0, 3.0, 3.0, 2.0, 2.0][..]));
    let colours = hair.colours.expect("colours");
    assert!(colours.iter().all(|colour| (colour[0] - 1.0).abs() < 1e-5 && colour[1] == 0.0), "{colours:?}");
    assert_eq!(hair.notes.len(), 2, "{:?}", hair.notes);
    assert!(load(&stage(&[curves("b", 1, "")])).expect("hair").thickness.is_none(), "the control");
}
