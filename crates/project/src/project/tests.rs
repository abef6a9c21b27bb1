use std::path::Path;

use glam::Vec3;
use lovelock_groom::HairShading;
use lovelock_picture::LightKind;
use proptest::prelude::*;

use super::*;
use crate::error::{Place, ProblemKind};
use crate::files::{Access, FileRef};

fn round_trip(project: &Project) -> (Project, Vec<crate::error::Problem>) {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("a project ü.lovelock");
    save_project(&path, project).expect("saved");
    let left: Vec<_> = std::fs::read_dir(dir.path()).expect("a folder").collect();
    assert_eq!(left.len(), 1, "only the project is left");
    load_project(&path).expect("opened")
}

#[test]
fn a_shadow_method_of_the_users_own_is_named_by_its_folder() {
    use lovelock_shadow::{ShadowMethod, UserMethod, new_method};
    let dir = tempfile::tempdir().expect("a folder");
    let folder = dir.path().join("my fog ü");
    new_method(&folder).expect("the template");
    let method = UserMethod::load(&folder).expect("it compiles");
    let mut project = Project::default();
    project.shadow.method = ShadowMethod::User(method);
    let set = lovelock_base::settings::set(&mut project, "shadow.user.slices", "64");
    assert_eq!(set, Ok(()));
    project.compare.panes[0].shadow.method = ShadowMethod::User(method);
    assert_eq!(project.user_methods(), [method]);
    let path = dir.path().join("a.lovelock");
    save_project(&path, &project).expect("saved");
    let (same, problems) = load_project(&path).expect("opened");
    assert_eq!(problems, Vec::new());
    assert_eq!((same.shadow, same.user_methods()), (project.shadow, vec![method]));
    assert_eq!(same.compare.panes[0].shadow.method, ShadowMethod::User(method));
    save_project(&path, &same).expect("saved");
    assert_eq!(load_project(&path).expect("opened"), (same, Vec::new()));

    // Where the folder is gone, the project opens and says so, and names it still.
    std::fs::remove_dir_all(&folder).expect("removed");
    let (same, problems) = load_project(&path).expect("opened");
    assert_eq!(same.shadow.method, project.shadow.method);
    assert_eq!(problems[0].place, Place::Shadow);
    assert!(problems[0].message.contains("method.toml cannot be read"), "{}", problems[0].message);

    // A folder elsewhere is not read before the user has opened it.
    let other = tempfile::tempdir().expect("a folder");
    new_method(&other.path().join("guessed")).expect("the template");
    let text = std::fs::read_to_string(&path).expect("a project");
    let theirs =
        text.replace(&folder.display().to_string(), &other.path().join("guessed").display().to_string());
    assert_ne!(theirs, text);
    std::fs::write(&path, theirs).expect("written");
    let (strange, problems) = load_project(&path).expect("opened");
    assert!(problems[0].message.contains("outside the project's folder"), "{}", problems[0].message);
    let guessed = strange.user_methods()[0];
    assert!(!guessed.works() && guessed.problem().expect("a problem").contains("open the folder yourself"));
    guessed.allow();
    assert!(guessed.works());
}

#[test]
fn the_default_project_comes_back_without_problems() {
    let project = Project::default();
    assert_eq!(project.sanitised(), (project.clone(), Vec::new()), "the defaults lie in their ranges");
    assert_eq!(round_trip(&project), (project, Vec::new()));
}

#[test]
fn simulation_settings_follow_the_style_unless_changed() {
    let mut project = Project::default();
    assert_eq!(project.simulation, project.hair.simulation());
    project.simulation.gravity = 3.0;
    project.set_preset(Preset::Curly);
    let curls = SimulationSettings { gravity: 3.0, ..SimulationSettings::preset(Preset::Curly) };
    assert_eq!(project.simulation, curls, "settings that belong to no style stay");
    project.set_hair_file("/x.hair");
    assert_eq!(project.simulation.stiffness_tip, SimulationSettings::default().stiffness_tip);
    project.set_hair_source(HairSource::Grown);
    assert_eq!(project.simulation, curls, "the same hair again");
    project.simulation.stiffness_root = 40.0;
    project.set_preset(Preset::Long);
    assert_eq!(project.simulation, SimulationSettings { stiffness_root: 40.0, ..curls });
    assert_eq!(round_trip(&project).0.simulation, project.simulation);
}

#[test]
fn missing_fields_take_their_defaults() {
    let (project, problems) =
        parse_project(Path::new("p"), "(version: 1, hair: (preset: curly), motion: (speed: 0.5))")
            .expect("reads");
    assert_eq!(problems, []);
    assert_eq!(project.motion.speed, 0.5);
    assert_eq!(project.lights, Project::default().lights);
}

#[test]
fn lights_of_files_before_lamps_are_directional_and_lamps_are_read_back() {
    let text = "(version: 1, lights: [(name: \"Key\", direction: (0.0, -1.0, 0.5), intensity: 2.0)])";
    let (mut project, problems) = parse_project(Path::new("p"), text).expect("reads");
    assert_eq!(problems, []);
    let light = &project.lights[0];
    assert_eq!((light.kind, light.intensity, light.stands()), (LightKind::Directional, 2.0, false));
    for kind in [LightKind::Spot, LightKind::Point] {
        let light = &mut project.lights[0];
        (light.kind, light.position, light.radius) = (kind, Vec3::new(0.25, 1.75, -0.5), 0.02);
        (light.inner_angle, light.outer_angle) = (0.25, 1.5);
        assert_eq!(round_trip(&project), (project.clone(), Vec::new()));
    }
    // Out of range, and a cone whose inner part is wider than it.
    let light = &mut project.lights[0];
    (light.position, light.radius) = (Vec3::new(1e9, f32::NAN, 0.0), -1.0);
    (light.inner_angle, light.outer_angle) = (2.0, 1.0);
    let (clean, problems) = project.sanitised();
    let light = &clean.lights[0];
    assert_eq!((light.position.x, light.radius, light.inner_angle), (1000.0, 0.001, 1.0));
    assert!(light.position.is_finite() && !problems.is_empty(), "{problems:?}");
}

#[test]
fn unknown_fields_are_named_and_left_out() {
    let text = "(version: 1, sparkle: 3, hair: (glitter: (a: [1, 2])), camera: (distance: 3.0))";
    let (project, problems) = parse_project(Path::new("p"), text).expect("reads");
    assert_eq!(project.camera.distance, 3.0);
    let messages: Vec<_> = problems.iter().map(|p| p.message.as_str()).collect();
    assert!(messages.iter().any(|m| m.contains("`sparkle`")), "{messages:?}");
    assert!(messages.iter().any(|m| m.contains("`hair.glitter`")), "{messages:?}");
    assert_eq!(problems.len(), 2);
    assert!(problems.iter().all(|p| p.kind == ProblemKind::Ignored));
}

#[test]
fn a_newer_version_is_refused_even_if_unreadable() {
    let error = parse_project(Path::new("p.lovelock"), "(version: 7, hair: Wig(3))").expect_err("too new");
    assert_eq!(error.exit_code(), 2);
    assert!(error.to_string().contains("version 7"), "{error}");
    assert_eq!(error.file(), Some(Path::new("p.lovelock")));
}

#[test]
fn shading_by_two_highlights_is_read_by_its_old_name_and_written_by_its_new_one() {
    let text = "(version: 3, look: (shading: r#kajiya-kay), compare: (shading: r#kajiya-kay))";
    let (project, problems) = parse_project(Path::new("p"), text).expect("reads");
    assert_eq!(problems, []);
    assert_eq!([project.look.shading, project.compare.shading], [HairShading::TwoHighlights; 2]);
    let text = text_of_project(Path::new("p"), &project).expect("text");
    assert!(text.contains("shading: r#two-highlights") && !text.contains("kajiya-kay"), "{text}");
    let text = text.replace("two-highlights", "kajiya-kay-published");
    let (project, _) = parse_project(Path::new("p"), &text).expect("reads");
    assert_eq!([project.look.shading, project.compare.shading], [HairShading::KajiyaKayPublished; 2]);
}

#[test]
fn nonsense_is_refused_with_its_beginning_or_a_line() {
    for (text, says) in [
        ("", "p: is empty; must be a Lovelock project"),
        ("hello", "p: begins with “hello”; must be a Lovelock project"),
        ("[1, 2", "p: begins with “[1, 2”; must be a Lovelock project"),
        ("{\"version\": 1", "p: begins with “{\"version\": 1”; must be a Lovelock project"),
        ("(version: 1, motion: (speed: fast))", "line"),
        ("(version: 1", "line"),
    ] {
        let error = parse_project(Path::new("p"), text).expect_err(text);
        assert!(error.to_string().contains(says), "{error}");
    }
    let deep = format!("(version: 1, x: {}{})", "[".repeat(100_000), "]".repeat(100_000));
    parse_project(Path::new("p"), &deep).expect_err("too deep");
}

#[test]
fn values_out_of_range_are_clamped_and_reported() {
    let text = "(version: 1, motion: (speed: NaN), camera: (distance: inf, fov_y: -1.0), \
                simulation: (gravity: -inf), recording: (width: 0, fps: 1e9))";
    let (project, problems) = parse_project(Path::new("p"), text).expect("reads");
    assert_eq!((project.motion.speed, project.camera.distance, project.simulation.gravity), (1.0, 30.0, 0.0));
    assert_eq!((project.camera.fov_y, project.recording.width, project.recording.fps), (0.05, 16, 240.0));
    assert_eq!(problems.len(), 6, "{problems:?}");
    assert!(problems.iter().all(|p| p.kind == ProblemKind::Adjusted));
    assert_eq!(project.sanitised().1, [], "once is enough");
}

#[test]
fn a_light_without_a_direction_shines_down_and_a_fifth_light_is_removed() {
    let mut project = Project::default();
    project.lights.resize(6, Light::default());
    project.lights[0].direction = Vec3::ZERO;
    let (clean, problems) = project.sanitised();
    assert_eq!(clean.lights.len(), lovelock_picture::MAX_LIGHTS);
    assert_eq!(clean.lights[0].direction, Vec3::NEG_Y);
    assert!(problems.len() >= 2, "{problems:?}");
}

#[test]
fn missing_files_are_named_and_the_rest_opens() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("p.lovelock");
    let mut project = Project::default();
    project.set_hair_file(dir.path().join("wigs/gone.hair"));
    project.camera.distance = 4.0;
    save_project(&path, &project).expect("saved");
    let text = std::fs::read_to_string(&path).expect("text");
    assert!(text.contains("wigs/gone.hair") && !text.contains(&dir.path().display().to_string()), "{text}");
    let (opened, problems) = load_project(&path).expect("opened");
    assert_eq!(opened, project);
    assert_eq!(problems.len(), 1);
    assert!(problems[0].is_failure() && problems[0].message.contains("gone.hair"), "{problems:?}");
}

#[test]
fn a_moved_project_finds_its_files() {
    let dir = tempfile::tempdir().expect("a folder");
    let (old, new) = (dir.path().join("old"), dir.path().join("new"));
    std::fs::create_dir(&old).expect("a folder");
    std::fs::write(old.join("x.hair"), b"HAIR").expect("a file");
    let mut project = Project::default();
    project.set_hair_file(old.join("x.hair"));
    save_project(&old.join("p.lovelock"), &project).expect("saved");
    std::fs::rename(&old, &new).expect("moved");
    let (opened, problems) = load_project(&new.join("p.lovelock")).expect("opened");
    assert_eq!(problems, []);
    assert_eq!(opened.hair.file.expect("a file").path, FileRef::new(new.join("x.hair")).path);
}

#[test]
fn a_picture_of_the_surroundings_is_kept_beside_the_project_and_with_a_take() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("p.lovelock");
    let picture = dir.path().join("skies/dusk ü.hdr");
    std::fs::create_dir(dir.path().join("skies")).expect("a folder");
    let mut project = Project::default();
    assert_eq!(project.surroundings.file, None, "a sky above a ground");
    project.set_surroundings_file(&picture);
    project.picture.surroundings_turn = 0.5;
    save_project(&path, &project).expect("saved");
    let text = std::fs::read_to_string(&path).expect("text");
    assert!(text.contains("skies/dusk ü.hdr") && !text.contains(&dir.path().display().to_string()), "{text}");
    let (opened, problems) = load_project(&path).expect("opened");
    assert_eq!(opened, project);
    assert!(problems.len() == 1 && problems[0].place == Place::Surroundings, "{problems:?}");
    assert!(problems[0].is_failure() && problems[0].message.contains("dusk ü.hdr"), "{problems:?}");
    std::fs::write(&picture, b"#?RADIANCE").expect("a file");
    assert_eq!(load_project(&path).expect("opened"), (project.clone(), Vec::new()));

    project.set_take(dir.path().join("a.take"));
    let places: Vec<_> = project.files().into_iter().map(|(place, _)| place).collect();
    assert_eq!(places, [Place::Take, Place::Surroundings], "a take records no light");
}

#[test]
fn a_file_outside_is_not_loaded_until_it_is_picked() {
    let dir = tempfile::tempdir().expect("a folder");
    let folder = dir.path().join("project");
    std::fs::create_dir(&folder).expect("a folder");
    let hair = dir.path().join("x.hair");
    std::fs::write(&hair, b"HAIR").expect("a file");
    let path = folder.join("p.lovelock");
    let mut project = Project::default();
    project.set_hair_file(&hair);
    save_project(&path, &project).expect("saved");
    assert!(std::fs::read_to_string(&path).expect("text").contains("outside: true"));
    let (_, problems) = load_project(&path).expect("opened");
    assert!(
        matches!(&problems[..], [p] if matches!(p.kind, ProblemKind::NeedsPermission(_))),
        "{problems:?}"
    );
    let mut access = Access::new();
    access.pick(&hair);
    let (_, problems) = load_project_with(&path, &mut access).expect("opened");
    assert_eq!(problems, []);
    // Written by hand without `outside`: the same result.
    std::fs::write(&path, "(version: 1, hair: (source: File, file: (path: \"../x.hair\")))")
        .expect("written");
    let (_, problems) = load_project(&path).expect("opened");
    assert!(
        matches!(&problems[..], [p] if matches!(p.kind, ProblemKind::NeedsPermission(_))),
        "{problems:?}"
    );
}

#[test]
fn a_failed_save_keeps_what_was_there() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("folder.lovelock");
    std::fs::create_dir_all(path.join("x")).expect("a folder in the way");
    let error = save_project(&path, &Project::default()).expect_err("in the way");
    assert_eq!(error.exit_code(), 1);
    assert!(path.join("x").is_dir());
    assert!(!dir.path().join("folder.lovelock.partial").exists());
}

#[test]
fn the_values_of_every_shadow_method_are_clamped_and_reported() {
    let text = "(version: 2, shadow: (voxel_map: (resolution: 0), \
                opacity_maps: (resolution: 3, slices: 4000000000), \
                deep_opacity_maps: (layers: 0, depth_share: NaN), density_clustering: (clusters: 99, steps: 0), \
                occupancy_maps: (slices: 4000000000, slabs: 0), exact: (memory_limit_bytes: 1)))";
    let (project, problems) = parse_project(Path::new("p"), text).expect("reads");
    let s = project.shadow;
    assert_eq!(s.voxel_map.resolution, 16);
    assert_eq!((s.opacity_maps.resolution, s.opacity_maps.slices), (64, 256));
    assert_eq!((s.deep_opacity_maps.layers, s.deep_opacity_maps.depth_share), (3, 0.5));
    assert_eq!((s.density_clustering.clusters, s.density_clustering.steps), (8, 1));
    assert_eq!((s.occupancy_maps.slices, s.occupancy_maps.slabs), (512, 4));
    assert_eq!(s.exact.memory_limit_bytes, 16 << 20);
    assert_eq!(problems.len(), 10, "{problems:?}");
    assert!(problems.iter().all(|p| p.kind == ProblemKind::Adjusted && p.place == Place::Shadow));
    assert!(problems.iter().any(|p| p.message.contains("deep_opacity_maps.depth_share")), "{problems:?}");
    assert_eq!(project.sanitised(), (project.clone(), Vec::new()), "once is enough");
}

/// A file that the program wrote before the extinction scale moved to the look of the hair.
#[test]
fn the_extinction_scale_of_version_1_is_that_of_the_hair() {
    let text = "(version: 1, \
        shadow: (method: \"deep-opacity-maps\", extinction_scale: 0.3, deep_opacity_maps: (layers: 6)), \
        compare: (panes: [(shadow: (method: \"voxel-map\", extinction_scale: 0.7)), (shadow: (method: \"exact\"))]), \
        timeline: (tracks: [ \
            (target: \"shadow/extinction_scale\", muted: true, keys: [(secs: 1.0, value: [0.5])]), \
            (target: \"camera/distance\", keys: [(secs: 0.0, value: [1.0])])]))";
    let (project, problems) = parse_project(Path::new("p"), text).expect("reads");
    assert_eq!(problems, []);
    assert_eq!((project.version, project.look.extinction_scale), (PROJECT_VERSION, 0.3));
    assert_eq!(project.shadow.deep_opacity_maps.layers, 6);
    let targets: Vec<_> = project.timeline.tracks.iter().map(|track| track.target.as_str()).collect();
    assert_eq!(targets, ["look/extinction_scale", "camera/distance"]);
    assert!(project.timeline.tracks[0].muted);
    assert_eq!(round_trip(&project), (project, Vec::new()));

    // Without the field it is the default, and out of range it is clamped.
    for (field, expected, changes) in [("", 0.15, 0), ("extinction_scale: 9.0", 4.0, 1)] {
        let text = format!("(version: 1, look: (roughness: 0.5), shadow: ({field}))");
        let (project, problems) = parse_project(Path::new("p"), &text).expect("reads");
        assert_eq!((project.look.extinction_scale, problems.len()), (expected, changes));
        assert_eq!(project.look.roughness, 0.5);
    }
    // Version 2 does not know the field there.
    let text = text.replace("version: 1", "version: 2");
    let (project, problems) = parse_project(Path::new("p"), &text).expect("reads");
    assert_eq!((project.look.extinction_scale, problems.len()), (0.15, 2));
    assert!(problems.iter().all(|p| p.message.contains("shadow.extinction_scale")), "{problems:?}");
}

#[test]
fn old_defaults_of_motion_become_those_of_the_style_and_chosen_values_stay() {
    let read = |version: u32, drag: f32, settle: f32| {
        let text = format!(
            "(version: {version}, hair: (preset: long), simulation: (stiffness_root: 10.0, stiffness_tip: 3.0, hold: 4.0, \
             drag: {drag:?}, settle: {settle:?}))"
        );
        let (project, problems) = parse_project(Path::new("p"), &text).expect("reads");
        assert_eq!(problems, []);
        project
    };
    let mut old = read(2, 0.8, 2.0);
    assert_eq!(old.simulation, SimulationSettings::preset(Preset::Long));
    old.set_preset(Preset::Curly);
    assert_eq!(old.simulation, SimulationSettings::preset(Preset::Curly), "it follows the style again");
    let text = "(version: 2, simulation: (friction: 0.8))";
    let sticky = parse_project(Path::new("p"), text).expect("reads").0.simulation;
    assert_eq!((sticky.friction, sticky.cloth_friction), (0.8, 0.8), "one coefficient was for both");
    let chosen = read(2, 0.9, 7.0).simulation;
    assert_eq!((chosen.drag, chosen.settle), (0.9, 7.0));
    let new = read(3, 0.8, 2.0).simulation;
    assert_eq!((new.drag, new.settle), (0.8, 2.0), "chosen in a new project");
}

#[test]
fn panes_are_limited_in_number_and_range() {
    let text = "(version: 1, compare: (panes: [(scale: 9.0), (scale: NaN, shadow: (method: \"exact\", \
                exact: (resolution: 3))), (), (), (), (), (), (), (), (), ()]))";
    let (project, problems) = parse_project(Path::new("p"), text).expect("reads");
    let panes = &project.compare.panes;
    assert_eq!(panes.len(), CompareSection::MAX_PANES);
    assert_eq!((panes[0].scale, panes[1].scale), (1.0, 1.0));
    assert_eq!(panes[1].shadow.method, lovelock_shadow::ShadowMethod::Exact);
    assert_eq!(panes[1].shadow.exact.resolution, 64);
    assert_eq!(problems.len(), 4, "{problems:?}");
    assert!(problems.iter().all(|p| p.place == Place::Compare));
    assert_eq!(round_trip(&project), (project.clone(), Vec::new()), "once is enough");
    // No panes: the defaults are used.
    let (project, problems) =
        parse_project(Path::new("p"), "(version: 1, compare: (panes: []))").expect("reads");
    assert_eq!((project.compare, problems.len()), (CompareSection::default(), 1));
}

#[test]
fn a_recording_has_a_renderable_size() {
    for (size, kept) in [
        ((8192, 8192), (8192, 4320)),
        ((u32::MAX, u32::MAX), (8192, 4320)),
        ((6000, 8000), (6000, 5898)),
        ((4320, 8192), (4320, 8192)),
        ((1920, 1080), (1920, 1080)),
    ] {
        let mut project = Project::default();
        (project.recording.width, project.recording.height) = size;
        let (clean, problems) = project.sanitised();
        assert_eq!((clean.recording.width, clean.recording.height), kept);
        lovelock_picture::check_size(kept.0, kept.1).expect("a size that is drawn");
        assert_eq!(problems.is_empty(), size == kept, "{problems:?}");
    }
}

/// Shadow settings with arbitrary numbers.
fn any_shadow() -> impl Strategy<Value = ShadowSettings> {
    (prop::array::uniform3(prop::num::f32::ANY), prop::array::uniform16(any::<u32>()), any::<u64>()).prop_map(
        |(floats, counts, bytes)| {
            let mut s = ShadowSettings::default();
            s.voxel_map.head_size = floats[0];
            s.voxel_map.point_extinction = floats[1];
            s.deep_opacity_maps.depth_share = floats[2];
            (s.deep_shadow_maps.tolerance, s.approximate_deep.spacing) = (floats[0], floats[1]);
            (s.moments.bias, s.moments.overestimation) = (floats[2], floats[0]);
            s.voxel_march.step = floats[1];
            let fields = [
                &mut s.voxel_map.resolution,
                &mut s.opacity_maps.resolution,
                &mut s.opacity_maps.slices,
                &mut s.deep_opacity_maps.resolution,
                &mut s.deep_opacity_maps.layers,
                &mut s.density_clustering.resolution,
                &mut s.density_clustering.clusters,
                &mut s.density_clustering.steps,
                &mut s.occupancy_maps.resolution,
                &mut s.occupancy_maps.slices,
                &mut s.occupancy_maps.slabs,
                &mut s.exact.resolution,
                &mut s.deep_shadow_maps.nodes,
                &mut s.fourier.terms,
                &mut s.adaptive.nodes,
                &mut s.moments.bits,
            ];
            for (field, count) in fields.into_iter().zip(counts) {
                *field = count;
            }
            s.exact.memory_limit_bytes = bytes;
            s.voxel_march.memory_limit_bytes = bytes;
            s.ray_traced.memory_limit_bytes = bytes;
            s
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// With any numbers, finite or not, a clamped project is saved and loaded bit for bit.
    #[test]
    fn clamped_projects_come_back_equal(
        speed in prop::num::f32::ANY,
        gravity in prop::num::f32::ANY,
        distance in prop::num::f32::ANY,
        azimuth in prop::num::f32::ANY,
        length in prop::num::f32::ANY,
        melanin in prop::num::f32::ANY,
        exposure in prop::num::f32::ANY,
        shadow in any_shadow(),
        direction in prop::array::uniform3(prop::num::f32::ANY),
        fps in prop::num::f64::ANY,
        first in any::<u64>(),
        end in prop::option::of(any::<u64>()),
        (width, height) in any::<(u32, u32)>(),
        clip in "\\PC{0,12}",
        preset in prop::sample::select(Preset::ALL.to_vec()),
    ) {
        let mut project = Project::default();
        project.set_preset(preset);
        project.motion.speed = speed;
        project.motion.clip = clip;
        project.simulation.gravity = gravity;
        project.camera.distance = distance;
        project.camera.azimuth = azimuth;
        project.hair.groom.length = length;
        project.look.eumelanin = melanin;
        project.picture.exposure_stops = exposure;
        project.shadow = shadow;
        project.lights[0].direction = Vec3::from_array(direction);
        project.recording.fps = fps;
        project.recording.first_frame = first;
        project.recording.end_frame = end;
        project.recording.width = width;
        project.recording.height = height;
        project.compare.panes[1].shadow = shadow;
        project.compare.panes[0].scale = gravity;
        let (clean, _) = project.sanitised();
        prop_assert!(lovelock_picture::check_size(clean.recording.width, clean.recording.height).is_ok());
        prop_assert_eq!(round_trip(&clean), (clean.clone(), Vec::new()));
    }

    /// No text makes the reader panic or hang.
    #[test]
    fn any_text_is_read_or_refused(text in "[(){}\\[\\]:,.a-z0-9\"' \\\\n-]{0,80}") {
        let _ = parse_project(Path::new("p"), &text);
    }
}

#[test]
fn hair_moves_from_one_character_to_another_and_each_keeps_its_scalp() {
    let mut project = Project::default();
    project.hair.groom.length = 0.21;
    project.body.scalp.up = 0.1;
    let hair = project.hair.clone();
    project.set_body_file("/a/one.glb");
    assert_eq!((project.body.scalp.up, project.hair == hair), (0.0, true));
    project.body.scalp.nod = 0.2;
    project.body.switch(BodySource::Dancer, None);
    assert_eq!(
        (project.body.scalp.up, project.body.scalp.nod, project.body.source),
        (0.1, 0.0, BodySource::Dancer)
    );
    project.body.switch(BodySource::File, Some(crate::files::FileRef::new("/a/one.glb")));
    assert_eq!((project.body.scalp.up, project.body.scalp.nod), (0.0, 0.2));
    assert_eq!(project.body.other_scalps.len(), 1);
    let text = ron::to_string(&project.body).expect("text");
    let read: crate::project::BodySection = ron::from_str(&text).expect("a section");
    assert_eq!(read, project.body);
}

#[test]
fn a_body_of_fur_rests_and_has_hair_on_its_whole_skin() {
    use lovelock_motion::ScalpArea;
    let mut project = Project::default();
    project.body.scalp.up = 0.1;
    for source in [BodySource::Animal, BodySource::Lawn, BodySource::Animal] {
        project.show_shipped_body(source);
        assert_eq!((project.body.scalp.area, project.motion.source), (ScalpArea::Skin, MotionSource::Rest));
    }
    project.body.scalp.size = 2.0;
    project.show_shipped_body(BodySource::Dancer);
    assert_eq!(
        (project.body.scalp.area, project.body.scalp.up, project.motion.source),
        (ScalpArea::Head, 0.1, MotionSource::Clip)
    );
    assert_eq!(project.body.other_scalps.len(), 1, "only the changed one is kept");
    project.show_shipped_body(BodySource::Animal);
    assert_eq!((project.body.scalp.area, project.body.scalp.size), (ScalpArea::Skin, 2.0));
    // Kept by files that say nothing about shipped bodies: a scalp without a file is the dancer's.
    let kept: crate::project::KeptScalp = ron::from_str("(scalp: (up: 0.3))").expect("a section");
    assert_eq!((kept.source, kept.scalp.area), (BodySource::Dancer, ScalpArea::Head));
}

#[test]
fn projects_saved_before_the_place_of_the_loop_blend_keep_it_at_the_start() {
    use lovelock_motion::LoopBlend;
    let place = |text: &str| {
        let (project, problems) = parse_project(Path::new("p"), text).expect("a project");
        assert!(problems.is_empty(), "{problems:?}");
        project.motion.loop_blend
    };
    // What an earlier version saved has the duration; what a person wrote has neither.
    assert_eq!(place("(version: 3, motion: (looping: true, loop_blend_secs: 0.5))"), LoopBlend::Start);
    assert_eq!(place("(version: 3, motion: (speed: 0.5))"), LoopBlend::End);
    assert_eq!(place("(version: 3, motion: (loop_blend_secs: 0.5, loop_blend: end))"), LoopBlend::End);
    let mut project = Project::default();
    assert_eq!(project.motion.loop_blend, LoopBlend::End);
    project.motion.loop_blend = LoopBlend::Start;
    let text = text_of_project(Path::new("p"), &project).expect("text");
    assert_eq!(place(&text), LoopBlend::Start);
    // A motion that is imported into an old project plays all its keys.
    project.set_motion_file("other.bvh");
    assert_eq!(project.motion.loop_blend, LoopBlend::End);
}

#[test]
fn changed_settings_are_told_as_they_are_set() {
    assert_eq!(super::changed_settings(&Project::default()), Vec::<String>::new());
    let mut project = Project::default();
    project.set("simulation.wind.speed", "3").expect("a setting");
    let changed = super::changed_settings(&project);
    assert_eq!(changed, ["simulation.wind.speed=3"]);
    let (name, value) = changed[0].split_once('=').expect("an assignment");
    let mut again = Project::default();
    again.set(name, value).expect("what is told can be set");
    assert_eq!(again, project);
}
