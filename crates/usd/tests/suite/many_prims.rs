//! Stages with thousands of prims: the CPU time of a look-up does not grow with the number of prims.

use std::fmt::Write;

use lovelock_testkit::clock::thread_time;
use lovelock_usd::{Layer, Source, Value, open, to_stage, transform_times};

/// Curves of four points in a group that moves, each with a place and times of its own.
fn stage(prims: usize) -> String {
    let mut text = "#usda 1.0\n(\n metersPerUnit = 1\n)\ndef Xform \"w\"\n{\n".to_owned();
    text += "double3 xformOp:translate = (1, 2, 3)\nuniform token[] xformOpOrder = [\"xformOp:translate\"]\n";
    for i in 0..prims {
        let _ = write!(
            text,
            "def BasisCurves \"c{i}\"\n{{\ndouble3 xformOp:translate = ({i}, 0, 0)\n\
             uniform token[] xformOpOrder = [\"xformOp:translate\"]\nfloat primvars:own{i} = {i}\n\
             point3f[] points.timeSamples = {{\n 0: [(0, 0, 0), (0, 1, 0)],\n {}: [(1, 0, 0), ({i}, 1, 0)],\n}}\n}}\n",
            i + 1
        );
    }
    text + "}\n"
}

pub fn crate_of(text: &str) -> Vec<u8> {
    let data = openusd::usda::parse(text).expect("a stage");
    let mut bytes = std::io::Cursor::new(Vec::new());
    openusd::usdc::CrateWriter::write(&data, &mut bytes).expect("a crate");
    bytes.into_inner()
}

/// What the readers of hair and characters ask of each prim, checked. Returns the CPU time that it took, seconds.
fn look_up(layer: &mut dyn Layer, count: usize) -> f64 {
    let start = thread_time();
    let prims = layer.prims(&["BasisCurves"]).expect("prims");
    assert_eq!(prims.len(), count);
    for (prim, _) in prims {
        let path = layer.path(prim);
        let i: usize = path.strip_prefix("/w/c").expect("a path").parse().expect("a number");
        assert_eq!(layer.prim_at(&path), Some(prim));
        assert_eq!(layer.prim_at(&format!("{path}x")), None);
        let own = layer.attribute(prim, &format!("primvars:own{i}"), 1).expect("a value");
        assert_eq!(own, Some(Value::Numbers(vec![i as f64])));
        for missing in ["widths", "primvars:widths", "primvars:displayColor", "visibility"] {
            assert_eq!(layer.attribute(prim, missing, 1).expect("nothing"), None);
        }
        assert_eq!(to_stage(layer, prim).expect("a place").w_axis.x, 1.0 + i as f64);
        assert!(transform_times(layer, prim).expect("none").is_empty());
        assert_eq!(layer.sample_times(prim, "points").expect("times"), [0.0, i as f64 + 1.0]);
    }
    thread_time().saturating_sub(start).as_secs_f64()
}

/// The quickest of some runs, seconds of CPU time; of more runs where each is short.
fn quickest(bytes: &[u8], is_crate: bool, count: usize) -> f64 {
    let mut layer = open("a.usd", Source::Memory(bytes), is_crate).expect("a stage");
    (0..runs(count)).map(|_| look_up(&mut *layer, count)).fold(f64::MAX, f64::min)
}

const FEW: usize = 200;
const MANY: usize = 4000;

fn runs(count: usize) -> usize {
    if count == FEW { 20 } else { 3 }
}

/// The most that the time grows. Measured: 22 and 25. A search of all names makes it over 400.
const MAX: f64 = 120.0;

#[test]
fn twenty_times_the_prims_take_about_twenty_times_as_long() {
    let (few, many) = (stage(FEW), stage(MANY));
    for (name, few, many, is_crate) in [
        ("text", few.clone().into_bytes(), many.clone().into_bytes(), false),
        ("crate", crate_of(&few), crate_of(&many), true),
    ] {
        let (short, long) = (quickest(&few, is_crate, FEW), quickest(&many, is_crate, MANY));
        println!("{name}: {FEW} prims in {:.2} ms, {MANY} in {:.2} ms", 1e3 * short, 1e3 * long);
        assert!(long < MAX * short, "{name}: {short} s and {long} s");
    }
    // The control: a search of all names for each of them.
    let search = |count: usize| {
        let names: Vec<String> = (0..count).map(|i| format!("primvars:own{i}")).collect();
        let start = thread_time();
        let found: usize = names.iter().filter_map(|name| names.iter().position(|known| known == name)).sum();
        assert_eq!(found, count * (count - 1) / 2);
        thread_time().saturating_sub(start).as_secs_f64()
    };
    let quickest = |count| (0..runs(count)).map(|_| search(count)).fold(f64::MAX, f64::min);
    let (short, long) = (quickest(FEW), quickest(MANY));
    println!("a search: {FEW} names in {:.2} ms, {MANY} in {:.2} ms", 1e3 * short, 1e3 * long);
    assert!(long > MAX * short, "the control: {short} s and {long} s");
}

#[test]
fn points_between_two_samples_are_interpolated_and_integers_are_held() {
    let own = "float primvars:own2 = 2\n";
    let text = stage(3);
    assert!(text.contains(own));
    let text = text.replace(own, &format!("{own}int count.timeSamples = {{ 0: 0, 3: 1 }}\n"));
    let times = [-1.0, 0.0, 2.9, 3.0, 9.0, -1.0, 0.0, 2.9, 3.0, 9.0];
    for (bytes, is_crate) in [(text.clone().into_bytes(), false), (crate_of(&text), true)] {
        let mut layer = open("a.usd", Source::Memory(&bytes), is_crate).expect("a stage");
        let prim = layer.prim_at("/w/c2").expect("a prim");
        // Twice each: the second time from memory.
        let found = times.map(|time| {
            layer.set_time(time);
            let points = layer.attribute(prim, "points", 4).expect("points").expect("points").into_vectors();
            let count = layer.attribute(prim, "count", 1).expect("a count").expect("a count");
            (f64::from(points[0].x), count)
        });
        for (time, (x, count)) in times.into_iter().zip(found) {
            let (part, held) = ((time / 3.0).clamp(0.0, 1.0), if time < 3.0 { 0.0 } else { 1.0 });
            assert!((x - part).abs() < 1e-6, "{time}: {x}, not {part}");
            // The control: integers have no values between their samples.
            assert_eq!(count, Value::Numbers(vec![held]), "{time}");
        }
    }
}
