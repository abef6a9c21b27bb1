use lovelock_project::files::Access;
use lovelock_project::styles::{StyleParts, shipped};
use lovelock_render::Backend;
use lovelock_session::scene::SceneLoader;

use super::*;

#[test]
fn styles_are_found_by_id_and_by_path() {
    assert_eq!(style_named("curly").expect("shipped").style.name, "Red curls");
    let error = style_named("curley").expect_err("unknown");
    assert_eq!(error.exit_code(), 2);
    assert!(error.to_string().contains("`curly`"), "{error}");
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("a b ü.lovelockstyle");
    let name = path.display().to_string();
    assert_eq!(style_named(&name).expect_err("missing").exit_code(), 2);
    Style { name: "Mine".to_owned(), ..Style::default() }.save(&path).expect("saved");
    let listed = style_named(&name).expect("a style");
    assert_eq!((listed.id.as_str(), listed.style.name.as_str()), ("own/a b ü", "Mine"));
}

#[test]
fn every_shipped_style_has_a_thumbnail_of_its_size() {
    for shipped in shipped() {
        let file = thumbnail::of_shipped(shipped.id);
        let file = file
            .unwrap_or_else(|| panic!("{}: run `lovelock presets --thumbnails assets/styles`", shipped.id));
        assert!(file.len() <= thumbnail::MAX_BYTES, "{}: {} bytes", shipped.id, file.len());
        let (width, height, _) = lovelock_record::read_jpeg(file, 1000).expect("an image");
        assert_eq!([width, height], thumbnail::SIZE, "{}", shipped.id);
    }
}

#[test]
fn thumbnails_are_kept_by_what_they_show() {
    let folder = Path::new("/cache");
    let style = Style::default();
    let path = thumbnail::path_in(folder, &style);
    let renamed = Style { name: "Other".to_owned(), ..style.clone() };
    assert_eq!(thumbnail::path_in(folder, &renamed), path);
    let mut longer = style;
    longer.hair.groom.length += 0.01;
    assert_ne!(thumbnail::path_in(folder, &longer), path);
}

/// A style with so little hair that it is drawn in a moment.
fn small(name: &str) -> Listed {
    let mut style = Style { name: name.to_owned(), ..Style::default() };
    let groom = &mut style.hair.groom;
    (groom.wisps, groom.strands_per_wisp, groom.segments_per_strand) = (30, 4, 8);
    Listed { id: name.to_lowercase(), style, file: None }
}

#[test]
fn a_sheet_shows_each_style_and_its_name() {
    let red = {
        let mut red = small("Red");
        (red.style.look.eumelanin, red.style.look.pheomelanin) = (0.0, 2.0);
        red
    };
    let request = SheetRequest {
        size: [48, 60],
        columns: None,
        rows: SheetRows::Sides(2),
        backend: Backend::Cpu,
        change: &|_| Ok(()),
    };
    let mut parts = Vec::new();
    let picture = sheet(&[small("Brown"), red], &request, &mut |progress| {
        if let lovelock_session::progress::Progress::Comparing { what, .. } = progress {
            parts.push(what);
        }
        std::ops::ControlFlow::Continue(())
    })
    .expect("a sheet");
    parts.dedup();
    assert_eq!(parts, ["Brown", "Red"]);
    let cell = |column: u32, row: u32| -> Vec<u8> {
        let rows = (0..60).map(|y| 6 + row * 90 + y);
        let row = |y: u32| {
            let at = ((y * picture.width + 6 + column * 54) * 4) as usize;
            picture.rgba[at..at + 48 * 4].to_vec()
        };
        rows.flat_map(row).collect()
    };
    let cells = [cell(0, 0), cell(1, 0), cell(0, 1), cell(1, 1)];
    for i in 0..4 {
        for j in 0..i {
            assert_ne!(cells[i], cells[j], "{i} {j}");
        }
    }
}

#[test]
fn a_cancelled_sheet_says_so() {
    let request = SheetRequest {
        size: [16, 16],
        columns: Some(1),
        rows: SheetRows::Rest,
        backend: Backend::Cpu,
        change: &|_| Ok(()),
    };
    let cancelled = sheet(&[small("A")], &request, &mut |_| std::ops::ControlFlow::Break(()));
    assert!(matches!(cancelled, Err(ProjectError::Cancelled)));
}

#[test]
fn every_shipped_style_grows_and_takes_all_of_its_layers() {
    let mut loader = SceneLoader::new();
    for shipped in lovelock_testkit::suite::sample(shipped(), 3) {
        let mut project = lovelock_project::Project::default();
        project.apply_style(&shipped.style, StyleParts::ALL);
        let (scene, problems) = loader.load_now(&project, &Access::new()).expect("a scene");
        assert_eq!(problems, [], "{}: a layer is skipped or not known", shipped.id);
        let found = scene.style.strands.count() as u64;
        assert!(found > 300, "{}: {found} strands", shipped.id);
        let counted = shipped.style.strands().expect("grown");
        assert!(found <= counted && 2 * found > counted, "{}: {found} of {counted} strands", shipped.id);
        let points = &scene.style.guides;
        let finite = points.x.iter().chain(&points.y).chain(&points.z).all(|v| v.is_finite());
        assert!(finite, "{}: a guide without a place", shipped.id);
    }
}
