//! Shadow methods of the user's own: the template, bad input, and shaders that loop or write where they must not.

use std::fs;
use std::path::Path;

use glam::Vec3;
use lovelock_base::clock::Stopwatch;
use lovelock_base::settings::Value;
use lovelock_groom::Strands;
use lovelock_shadow::{
    LightFrame, LightSource, ShadowMethod, ShadowSettings, TexelFilter, UserMethod, cpu_shadow, new_method,
};
use tempfile::TempDir;

use crate::common::{HEAD, Style, grow, lit, strands};
use crate::gpu::{Built, device};

const SMALL: Style = Style { wisps: 20, strands_per_wisp: 10, segments: 12, length: 0.3, curl: 0.01 };

fn hair() -> Strands {
    strands(&grow(SMALL, 7))
}

/// The template in a folder, with changes to the shader and to the description.
fn method(changes: &[(&str, &str)]) -> TempDir {
    let dir = tempfile::tempdir().expect("a folder");
    new_method(dir.path()).expect("the template");
    change(dir.path(), changes);
    dir
}

fn change(folder: &Path, changes: &[(&str, &str)]) {
    for (from, to) in changes {
        let has = |name: &&&str| fs::read_to_string(folder.join(name)).expect("a file").contains(from);
        let name = ["method.wgsl", "method.toml"].iter().find(has).expect(from).to_owned();
        let text = fs::read_to_string(folder.join(name)).expect("a file");
        fs::write(folder.join(name), text.replacen(from, to, 1)).expect("written");
    }
}

fn settings(method: UserMethod) -> ShadowSettings {
    ShadowSettings { method: ShadowMethod::User(method), ..ShadowSettings::default() }
}

fn set(settings: &mut ShadowSettings, name: &str, value: Value) {
    settings.of_method_mut(settings.method).expect("settings").assign(name, value);
}

/// Points in and around the hair.
fn points(strands: &Strands) -> Vec<Vec3> {
    let inside = (0..strands.points()).step_by(3).map(|i| strands.point(i));
    let around =
        (0..200).map(|i| HEAD + Vec3::new((i % 10) as f32, (i / 10 % 10) as f32, (i / 100) as f32) * 0.05);
    inside.chain(around).collect()
}

fn largest(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[test]
fn the_template_is_opacity_maps() {
    let Some(gpu) = device() else { return };
    let dir = method(&[]);
    let user = UserMethod::load(dir.path()).expect("the template compiles");
    let (strands, mut own) = (hair(), settings(user));
    let asked = points(&strands);
    let mut known = ShadowSettings { method: ShadowMethod::OpacityMaps, ..ShadowSettings::default() };
    for (slices, filter) in
        [(128, TexelFilter::Bilinear), (32, TexelFilter::Nearest), (64, TexelFilter::Jitter)]
    {
        set(&mut own, "slices", Value::Count(slices));
        (own.user.filter, known.opacity_maps.filter) = (filter, filter);
        (own.user.resolution, known.opacity_maps.resolution) = (256, 256);
        known.opacity_maps.slices = slices as u32;
        let mut map = Built::new(gpu, own.method, &lit(&strands), &own);
        let mut reference = Built::new(gpu, known.method, &lit(&strands), &known);
        assert_eq!(map.words(), reference.words(), "{slices} slices");
        let difference = largest(&map.look_up(&asked), &reference.look_up(&asked));
        assert!(difference <= 1.0 / 255.0, "{slices} slices, {filter:?}: {difference}");
        // Negative control: other slices are seen.
        known.opacity_maps.slices = 8;
        let mut coarse = Built::new(gpu, known.method, &lit(&strands), &known);
        let difference = largest(&map.look_up(&asked), &coarse.look_up(&asked));
        assert!(difference > 10.0 / 255.0, "{difference}");
        let report = map.shadow.report(0);
        assert_eq!(report.needed_bytes, 4 * report.cells_total * slices);
        assert!(own.map_bytes() >= report.needed_bytes);
    }
}

#[test]
fn the_cpu_backend_runs_it_on_a_device_of_its_own() {
    let Some(gpu) = device() else { return };
    let dir = method(&[]);
    let own = settings(UserMethod::load(dir.path()).expect("the template"));
    let strands = hair();
    let asked = points(&strands);
    let axis = |of: fn(&Vec3) -> f32| asked.iter().map(of).collect::<Vec<f32>>();
    let standing = LightFrame::new(Vec3::NEG_Y)
        .standing(LightSource { position: HEAD + Vec3::new(0.0, 0.6, 0.2), radius: 0.0 }, HEAD);
    for light in [lit(&strands).light, standing] {
        let input = lovelock_shadow::ShadowInput { light, ..lit(&strands) };
        let mut map = cpu_shadow(own.method);
        assert!(map.column_map().is_none() && map.transmittance(HEAD) == 1.0, "lit before it is built");
        map.build(&input, &own).expect("a map");
        let mut found = vec![0.0; asked.len()];
        map.transmittance_at(&axis(|p| p.x), &axis(|p| p.y), &axis(|p| p.z), &mut found);
        let mut on_gpu = Built::new(gpu, own.method, &input, &own);
        assert_eq!(found, on_gpu.look_up(&asked));
        assert!(found.iter().any(|light| *light < 0.5) && found.contains(&1.0));
        assert_eq!(map.transmittance(asked[5]), found[5]);
        assert_eq!(map.transmittance(Vec3::NAN), 1.0);
        let columns = map.column_map().expect("columns");
        assert_eq!(columns.transmittance.len(), (columns.size * columns.size) as usize);
        assert!(columns.transmittance.iter().any(|light| *light < 0.5) && columns.transmittance[0] == 1.0);
        assert!(map.report().memory_bytes > 0);
    }
}

#[test]
fn problems_of_the_files_are_one_sentence_with_file_and_line() {
    let cases: &[(&str, &str, &str)] = &[
        ("sum += record_load", "sum += record_lode", "method.wgsl, line 26: no definition in scope"),
        ("return vec2f(slice, at - slice);", "return slice;", "method.wgsl, line 1"),
        ("    var sum = 0u;\n", "    var sum = 0u\n", "method.wgsl, line 2"),
        (
            "fn sum_slices(texel: u32)",
            "fn sum_slices(texel: u32, more: f32)",
            "line 23: fn sum_slices must have the parameters (texel: u32)",
        ),
        ("fn optical_depth", "fn thickness", "there is no fn optical_depth(texel: u32, depth: f32) -> f32"),
        (
            "function = \"sum_slices\"",
            "function = \"add_slices\"",
            "line 19: there is no function add_slices",
        ),
        ("// The second pass", "fn put(depth: f32) {}\n// ", "line 22: redefinition of `put`"),
        (
            "// The second pass",
            "@group(0) @binding(77) var<storage, read> more: array<u32>;\n// ",
            "`more` needs a resource of its own",
        ),
        (
            "// The second pass",
            "var<workgroup> shared_words: array<u32, 64>;\n// ",
            "`shared_words` needs a resource",
        ),
        (
            "// The second pass",
            "fn again() { turns = 0u; }\n// ",
            "line 22: `turns` is a variable of the program",
        ),
        ("// The second pass", "var<private> big: array<u32, 100000>;\n// ", "400012 bytes in each thread"),
        ("// The second pass", "fn f(a: f32) -> f32 { return f(a); }\n// ", "method.wgsl, line"),
        ("scratch = 0", "scratches = 0", "method.toml, line 11: unknown field `scratches`"),
        ("record = \"slices\"", "record = 3000000000", "method.toml, line 8: record: found 3000000000 words"),
        ("# The passes", "shader = \"other.wgsl\"\n#", "other.wgsl: cannot be read"),
    ];
    for (from, to, says) in cases {
        let dir = method(&[(from, to)]);
        let problem = UserMethod::load(dir.path()).expect_err(to);
        assert!(problem.contains(says), "{to}: {problem}");
        assert!(!problem.contains('\n') && problem.len() < 500, "{problem}");
        let user = UserMethod::of_folder(dir.path());
        assert_eq!((user.problem(), user.works()), (Some(problem), false));
    }
    let nowhere = std::env::temp_dir().join("there is no such method");
    assert!(UserMethod::load(&nowhere).expect_err("nothing").contains("method.toml: cannot be read"));
    let deep = method(&[("// The second pass", &format!("const A: f32 = {}1.0;\n//", "(".repeat(500)))]);
    assert!(UserMethod::load(deep.path()).is_err());
    let long = method(&[]);
    fs::write(long.path().join("method.wgsl"), "// long\n".repeat(10_000)).expect("written");
    assert!(UserMethod::load(long.path()).expect_err("long").contains("longer than 64 KiB"));
    fs::write(long.path().join("method.wgsl"), [b'f', b'n', 0xff]).expect("written");
    assert!(UserMethod::load(long.path()).expect_err("bytes").contains("byte 2 is not UTF-8"));
    // Negative control.
    UserMethod::load(method(&[]).path()).expect("the template");
}

#[test]
fn endless_loops_end_and_name_their_line() {
    let Some(gpu) = device() else { return };
    let strands = hair();
    let input = lit(&strands);
    let in_passes: [(&str, &str, usize); 2] = [
        ("    record_add(texel, u32(", "    while true { }\n    record_add(texel, u32(", 19),
        ("slice < slices(); slice++", "slice >= 0u; slice += 0u", 25),
    ];
    for (from, to, line) in in_passes {
        let dir = method(&[(from, to)]);
        let own = settings(UserMethod::load(dir.path()).expect("it compiles"));
        let watch = Stopwatch::start();
        let error = Built::try_new(gpu, own.method, &input, &own).err().expect("endless").to_string();
        assert!(error.contains(&format!("method.wgsl, line {line}: this loop did not end")), "{error}");
        assert!(watch.secs() < 10.0);
        // It stays out of use.
        assert!(Built::try_new(gpu, own.method, &input, &own).is_err());
        let mut map = cpu_shadow(own.method);
        assert_eq!(map.build(&input, &own).expect_err("endless").to_string(), error);
        assert_eq!(map.transmittance(HEAD), 1.0);
    }
    let in_query = method(&[(
        "    let place = slice_of(depth);",
        "    loop { if (depth > 9.0) { break; } }\n    let place = slice_of(depth);",
    )]);
    let own = settings(UserMethod::load(in_query.path()).expect("it compiles"));
    let mut map = Built::try_new(gpu, own.method, &input, &own).expect("a map");
    map.look_up(&points(&strands));
    assert!(map.settle().expect_err("endless").to_string().contains("line 34: this loop"));
    gpu.check().expect("the device is there");
    // Negative control: a loop of many turns is no fault.
    let long = method(&[(
        "    let place = slice_of(depth);",
        "    for (var i = 0u; i < 16000u; i++) { }\n    let place = slice_of(depth);",
    )]);
    let own = settings(UserMethod::load(long.path()).expect("it compiles"));
    let mut map = Built::try_new(gpu, own.method, &input, &own).expect("a map");
    map.look_up(&points(&strands)[..50]);
    assert_eq!(map.settle(), Ok(false));
}

#[test]
fn wild_writes_change_nothing_else() {
    let Some(gpu) = device() else { return };
    let strands = hair();
    let (input, asked) = (lit(&strands), points(&strands));
    let plain = method(&[]);
    let own = settings(UserMethod::load(plain.path()).expect("the template"));
    let expected = Built::new(gpu, own.method, &input, &own).words();
    let wild = "    record_store(texel + 100000000u, 0u, 7u);\n    record_add(texel, slices(), 7u);\n    \
        record_max(texel, 4000000000u, 7u);\n    scratch_store(texel, 5u, 7u);\n    var few: array<u32, 4>;\n    \
        few[texel * 77777777u] = 7u;\n    record_add(";
    let dir = method(&[("    record_add(", wild)]);
    let own = settings(UserMethod::load(dir.path()).expect("it compiles"));
    let mut map = Built::new(gpu, own.method, &input, &own);
    assert_eq!(map.words(), expected);
    assert!(map.look_up(&asked).iter().any(|light| *light < 0.5));
    // Negative control: a write within the record is seen.
    let dir = method(&[("    record_add(", "    record_add(texel, 0u, 7u);\n    record_add(")]);
    let own = settings(UserMethod::load(dir.path()).expect("it compiles"));
    assert_ne!(Built::new(gpu, own.method, &input, &own).words(), expected);
}

#[test]
fn the_last_version_that_worked_stays() {
    let Some(gpu) = device() else { return };
    let strands = hair();
    let (input, asked) = (lit(&strands), points(&strands));
    let dir = method(&[]);
    let user = UserMethod::load(dir.path()).expect("the template");
    let own = settings(user);
    let mut map = Built::new(gpu, own.method, &input, &own);
    let first = map.look_up(&asked);
    assert!(!user.follow(), "nothing was saved");

    // A shader that does not compile.
    change(dir.path(), &[("record_add(texel, ", "record_ad(texel, ")]);
    let before = UserMethod::revision();
    assert!(user.follow() && user.works());
    assert!(user.problem().expect("a problem").contains("method.wgsl, line 19"));
    map.build(0, &input, &own).expect("the version before");
    assert_eq!(map.look_up(&asked), first);

    // One that never ends is drawn once more with the version before it.
    change(dir.path(), &[("record_ad(texel, ", "loop { }\n record_add(texel, ")]);
    assert!(user.follow());
    assert_eq!(user.problem(), None, "it compiles");
    assert_eq!(map.build(0, &input, &own), Ok(2));
    assert!(user.problem().expect("a problem").contains("line 19: this loop did not end"));
    assert_eq!(map.look_up(&asked), first);

    // Mended, and another one.
    change(dir.path(), &[("loop { }\n record_add(texel, ", "record_add(texel, 2u * ")]);
    assert!(user.follow() && user.problem().is_none() && UserMethod::revision() > before);
    assert_eq!(map.build(0, &input, &own), Ok(1));
    assert_ne!(map.look_up(&asked), first);
}

#[test]
fn a_method_that_lost_the_device_is_drawn_again_once_it_is_saved() {
    let dir = method(&[]);
    let user = UserMethod::load(dir.path()).expect("the template");
    user.distrust();
    assert!(!user.works() && user.problem().is_some_and(|problem| problem.contains("was lost while")));
    change(dir.path(), &[("record_add(texel, ", "record_add(texel, 2u * ")]);
    assert!(user.follow() && user.works() && user.problem().is_none());
    // With a version before it, that one is drawn.
    change(dir.path(), &[("2u * ", "3u * ")]);
    assert!(user.follow() && user.problem().is_none());
    user.distrust();
    assert!(user.works() && user.problem().is_some());
}

#[test]
fn methods_are_named_by_their_folders() {
    let dir = tempfile::tempdir().expect("a folder");
    let folders =
        [dir.path().join("My Fog"), dir.path().join("other").join("my-fog"), dir.path().join("exact")];
    let ids = folders.each_ref().map(|folder| {
        new_method(folder).expect("written");
        let method = UserMethod::load(folder).expect("the template");
        let text = String::from(ShadowMethod::User(method));
        assert_eq!(text.parse(), Ok(ShadowMethod::User(method)), "{text}");
        assert_eq!(method.id().parse(), Ok(ShadowMethod::User(method)));
        assert_eq!(UserMethod::of_folder(folder), method);
        method.id()
    });
    assert_eq!(ids, ["my-fog", "my-fog-2", "exact-2"]);
    assert!(new_method(&folders[0]).expect_err("taken").contains("is there already"));
    // A folder that is gone is still a method, with a sentence in place of a map.
    let gone: ShadowMethod = "folder:/no/such/folder".parse().expect("a method");
    let (strands, own) = (hair(), ShadowSettings { method: gone, ..ShadowSettings::default() });
    let error = cpu_shadow(gone).build(&lit(&strands), &own).expect_err("no files").to_string();
    assert!(error.contains("/no/such/folder/method.toml: cannot be read"), "{error}");
    assert_eq!((own.map_bytes(), gone.label()), (0, "folder"));
}

#[test]
fn settings_keep_their_ranges_and_belong_to_one_method() {
    let text =
        "[[settings]]\nname = \"gain\"\nrange = [0.5, 2]\ndefault = 1.0\n\n[[settings]]\nname = \"slices\"";
    let (a, b) = (method(&[("[[settings]]\nname = \"slices\"", text)]), method(&[]));
    let [a, b] = [&a, &b].map(|dir| UserMethod::load(dir.path()).expect("it compiles"));
    let mut settings = settings(a);
    let names = |settings: &ShadowSettings, method| -> Vec<&str> {
        let own = settings.of_method(ShadowMethod::User(method)).expect("settings");
        own.infos().iter().map(|info| info.name).collect()
    };
    assert_eq!(names(&settings, a), ["resolution", "filter", "gain", "slices"]);
    assert_eq!(names(&settings, b), ["resolution", "filter", "slices"]);
    set(&mut settings, "gain", Value::Number(9.0));
    set(&mut settings, "slices", Value::Count(3));
    let value = |settings: &ShadowSettings, name| {
        settings.of_method(settings.method).and_then(|own| own.value(name)).map(|(_, value)| value)
    };
    assert_eq!(value(&settings, "gain"), Some(Value::Number(9.0)));
    lovelock_base::settings::AnySettings::clamp(&mut settings);
    assert_eq!(value(&settings, "gain"), Some(Value::Number(2.0)));
    assert_eq!(value(&settings, "slices"), Some(Value::Count(8)));
    settings.method = ShadowMethod::User(b);
    assert_eq!(value(&settings, "slices"), Some(Value::Count(128)), "its own default");
}
