//! The comparison in the whole window: adding, changing, swapping, using and removing panes, each as one undo step.

use std::sync::Arc;

use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use lovelock_panes::request::LiveError;
use lovelock_panes::view::LiveShows;
use lovelock_project::project::CompareSection;
use lovelock_render::{Gpu, ShadowMethod, new_method};

use super::whole::{CTRL, Dropped, Whole, go, key, of, press_button, project, wait, window};
use super::{control, drag};
use crate::window::Window;

/// The window with all its panes drawn.
fn comparing() -> Whole {
    let mut harness = window();
    key(&mut harness, Modifiers::NONE, Key::C);
    wait(&mut harness, "the panes", |window| drawn(window, 4));
    harness
}

/// Whether that many panes are drawn with the project's current settings.
fn drawn(window: &Window, panes: usize) -> bool {
    let wanted = &window.document.project().compare.panes;
    wanted.len() == panes
        && wanted.iter().enumerate().all(|(index, wanted)| {
            window
                .pages
                .compare
                .pane(index)
                .is_some_and(|pane| pane.contender == *wanted && pane.problem.is_none())
        })
}

fn methods(harness: &Whole) -> Vec<ShadowMethod> {
    project(harness).compare.panes.iter().map(|pane| pane.shadow.method).collect()
}

#[test]
fn panes_are_drawn_with_their_cost_and_error() {
    let mut harness = comparing();
    harness.check_accessibility();
    let panes = methods(&harness);
    for (index, method) in panes.iter().enumerate() {
        let pane = of(&harness).pages.compare.pane(index).expect("a pane");
        assert_eq!(pane.contender.shadow.method, *method);
        assert!(pane.times.whole > 0.0 && !pane.image.is_empty());
        // On the GPU the exact method has an error too.
        let by_processor = pane.adapter.backend == lovelock_render::Backend::Cpu;
        match &pane.error {
            LiveError::Reference => assert!(*method == ShadowMethod::Exact && by_processor),
            LiveError::Measured { rmse, .. } => {
                assert!(
                    rmse.is_finite() && (*rmse > 1e-4 || *method == ShadowMethod::Exact),
                    "{method}: {rmse}"
                );
            }
            other => panic!("{method}: {other:?}"),
        }
    }
    // Hidden panes are not drawn.
    key(&mut harness, Modifiers::NONE, Key::C);
    assert!(harness.query_by_role_and_label(Role::Image, "Pane 1").is_none());
    assert!(harness.query_by_role_and_label(Role::Image, "Viewport").is_some());
}

#[test]
fn adding_swapping_using_and_removing_a_pane_are_one_undo_step_each() {
    let mut harness = comparing();
    let before = methods(&harness);
    assert_eq!(before.len(), 4);
    press_button(&mut harness, "Swap pane 1");
    assert_eq!(methods(&harness)[..2], [before[1], before[0]]);
    assert_eq!(of(&harness).document.history().undo_len(), 1);
    press_button(&mut harness, "Remove pane 4");
    assert_eq!(methods(&harness).len(), 3);
    press_button(&mut harness, "Add pane");
    let added = methods(&harness)[3];
    assert!(!methods(&harness)[..3].contains(&added), "a method that no pane shows");
    wait(&mut harness, "the new pane", |window| drawn(window, 4));
    assert_eq!(of(&harness).document.history().undo_len(), 3);
    for _ in 4..CompareSection::MAX_PANES {
        press_button(&mut harness, "Add pane");
    }
    assert_eq!(methods(&harness).len(), CompareSection::MAX_PANES);
    wait(&mut harness, "all panes", |window| drawn(window, CompareSection::MAX_PANES));
    for _ in 0..3 + CompareSection::MAX_PANES - 4 {
        key(&mut harness, CTRL, Key::Z);
    }
    assert_eq!(methods(&harness), before);
    assert_eq!(of(&harness).document.history().undo_len(), 0);

    let (shadow, look) = (project(&harness).shadow, project(&harness).look);
    press_button(&mut harness, "Use pane 3");
    let used = project(&harness);
    assert_eq!(used.shadow.method, before[2]);
    assert_eq!(used.look, look);
    assert_eq!(used.compare.panes.len(), 4);
    assert_eq!(of(&harness).document.history().undo_len(), 1);
    key(&mut harness, CTRL, Key::Z);
    assert_eq!(project(&harness).shadow, shadow);
}

#[test]
fn a_dropped_method_is_a_pane_that_follows_its_files_long_suite() {
    if let Err(error) = Gpu::open() {
        lovelock_testkit::skip_without_adapter(&error);
        return;
    }
    let mut harness = comparing();
    let dir = tempfile::tempdir().expect("a folder");
    let folder = dir.path().join("my fog");
    new_method(&folder).expect("the template");
    harness.input_mut().dropped_files.push(Arc::new(Dropped(folder.clone())));
    go(&mut harness);
    wait(&mut harness, "its pane", |window| drawn(window, 5));
    let [user] = project(&harness).user_methods()[..] else { panic!("one method") };
    assert_eq!((user.id(), user.problem()), ("my-fog", None));
    let pixels = |window: &Window| {
        let pane = window.pages.compare.pane(4).expect("a pane");
        pane.image.picture().map(|picture| picture.rgba.clone()).unwrap_or_default()
    };
    let first = pixels(of(&harness));

    // Broken: the last version stays, with the problem.
    let shader = folder.join("method.wgsl");
    let text = std::fs::read_to_string(&shader).expect("the shader");
    std::fs::write(&shader, text.replace("sum += record_load", "sum += record_lode")).expect("written");
    wait(&mut harness, "the problem", |window| {
        window.document.project().user_methods()[0].problem().is_some()
    });
    assert!(user.works() && user.problem().expect("a problem").contains("method.wgsl, line 26"));

    // Mended, and another one: it is drawn anew.
    std::fs::write(&shader, text.replace("weight);", "weight / 8u);")).expect("written");
    wait(&mut harness, "the mended method", |window| {
        window.document.project().user_methods()[0].problem().is_none() && pixels(window) != first
    });
    key(&mut harness, CTRL, Key::Z);
    assert_eq!(project(&harness).compare.panes.len(), 4, "one undo step");
}

#[test]
fn a_wipe_shows_two_panes_and_its_line_can_be_dragged() {
    let mut harness = comparing();
    press_button(&mut harness, "Wipe");
    let page = control(&harness, Role::Image, "Wipe").rect();
    assert!(harness.query_by_role_and_label(Role::Image, "Pane 2").is_none());
    let camera = project(&harness).camera;
    let (from, to) = (page.center(), page.lerp_inside(egui::vec2(0.25, 0.5)));
    drag(&mut harness, from, to);
    go(&mut harness);
    let split = of(&harness).layout.compare.split;
    assert!((split - 0.25).abs() < 0.02, "{split}");
    assert_eq!(project(&harness).camera, camera, "the line was dragged and not the camera");
    assert_eq!(of(&harness).document.history().undo_len(), 0, "a line is no part of the project");
    // A drag beside the line turns the camera of both panes.
    drag(&mut harness, page.lerp_inside(egui::vec2(0.7, 0.5)), page.lerp_inside(egui::vec2(0.8, 0.5)));
    go(&mut harness);
    assert_ne!(project(&harness).camera, camera);
    assert_eq!(of(&harness).layout.compare.split.to_bits(), split.to_bits());
}

#[test]
fn errors_are_shown_in_colour_and_a_click_probes_hair() {
    let mut harness = comparing();
    of_mut(&mut harness).layout.compare.shows = LiveShows::TransmittanceBias;
    go(&mut harness);
    wait(&mut harness, "colours", |window| {
        window.pages.compare.pane(0).is_some_and(|pane| pane.shows == LiveShows::TransmittanceBias)
    });
    assert!(harness.query_by_role_and_label(Role::Image, "Scale of transmittance - exact").is_some());
    // There is hair at the guides, although the head hides some of it.
    for point in (0..400).step_by(23) {
        let pane = control(&harness, Role::Image, "Pane 1").rect();
        let window = of(&harness);
        let frame = window.session.frame.as_ref().expect("a frame");
        let guides = &frame.guides.guides;
        let Some(&x) = guides.x.get(point) else { break };
        let at = glam::Vec3::new(x, guides.y[point], guides.z[point]).extend(1.0);
        let camera = frame.camera(&window.document.project().camera);
        let clip = camera.clip_from_world(pane.width() / pane.height()) * at;
        let share = egui::vec2(0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w);
        if !(0.0..=1.0).contains(&share.x) || !(0.0..=1.0).contains(&share.y) {
            continue;
        }
        super::click_at(&mut harness, pane.lerp_inside(share));
        wait(&mut harness, "an answer", |window| {
            let [probed, asked] = window.pages.compare.probed_and_asked();
            probed == asked
        });
        if of(&harness).pages.compare.probed_hair().is_some() {
            break;
        }
    }
    let hair = of(&harness).pages.compare.probed_hair().expect("hair where guides are");
    assert_eq!(hair.curves.len(), 4);
    for (index, curve) in &hair.curves {
        assert!((0.0..=1.0).contains(&curve.value), "pane {index}");
        let first = curve.curve.first().expect("points").1;
        let last = curve.curve.last().expect("points").1;
        assert!(first > 0.99 && last < first, "light comes in at {first} and leaves at {last}");
    }
    assert!(of(&harness).layout.compare.probe, "a click opens the plot");
}

fn of_mut(harness: &mut Whole) -> &mut Window {
    harness.state_mut().state.as_mut().expect("a window")
}

#[test]
fn holding_v_shows_the_other_pane() {
    let mut harness = comparing();
    let name =
        |harness: &Whole, text: &str| super::texts(harness).iter().any(|(said, ..)| said.starts_with(text));
    let pane = control(&harness, Role::Image, "Pane 1").rect();
    harness.hover_at(pane.center());
    go(&mut harness);
    let second = of(&harness).pages.compare.pane(1).expect("a pane").label();
    assert!(second.ends_with("CPU") || second.ends_with("GPU"), "what drew it: {second}");
    let second = format!("2 · {second}");
    assert!(!name(&harness, &second));
    harness.key_down(Key::V);
    go(&mut harness);
    assert!(name(&harness, &second), "the second pane in the place of the first");
    harness.key_up(Key::V);
    go(&mut harness);
    assert!(!name(&harness, &second));
}

#[test]
fn all_panes_are_magnified_without_moving_the_camera() {
    let mut harness = comparing();
    let camera = project(&harness).camera;
    let pane = control(&harness, Role::Image, "Pane 2").rect();
    harness.hover_at(pane.center());
    harness.event(egui::Event::Zoom(3.0));
    go(&mut harness);
    assert!(harness.query_by_label("3.0×").is_some());
    assert_eq!(project(&harness).camera, camera);
    press_button(&mut harness, "3.0×");
    assert!(harness.query_by_label("3.0×").is_none());
}

#[test]
fn panes_are_saved_as_an_image_and_recorded_as_a_film() {
    let mut harness = comparing();
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("a comparison.png");
    press_button(&mut harness, "Save comparison");
    super::whole::answer(&mut harness, &path);
    wait(&mut harness, "the file", |_| path.is_file());
    let bytes = std::fs::read(&path).expect("a file");
    assert_eq!(&bytes[1..4], b"PNG");
    let side = |at: usize| u32::from_be_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
    let pane = of(&harness).pages.compare.pane(0).expect("a pane").image.picture().expect("pixels");
    assert!(side(16) >= 2 * pane.width && side(20) >= 2 * pane.height, "four panes and their labels");

    let window = of_mut(&mut harness);
    let mut changed = (**window.document.project()).clone();
    (changed.recording.width, changed.recording.height, changed.recording.end_frame) = (320, 240, Some(2));
    window.document.edit("recording", changed);
    go(&mut harness);
    let film = dir.path().join("film.mp4");
    press_button(&mut harness, "Record comparison");
    super::whole::answer(&mut harness, &film);
    wait(&mut harness, "the film", |window| !window.media.recorder.is_running() && film.is_file());
    assert!(std::fs::metadata(&film).expect("a file").len() > 500);
}

#[test]
fn a_click_that_closes_a_menu_does_not_probe() {
    let mut harness = comparing();
    press_button(&mut harness, "Settings of pane 1");
    assert!(harness.query_by_label("Transparency").is_some());
    let pane = control(&harness, Role::Image, "Pane 3").rect();
    super::click_at(&mut harness, pane.center());
    go(&mut harness);
    assert!(harness.query_by_label("Transparency").is_none(), "the menu is closed");
    assert_eq!(of(&harness).pages.compare.probed_and_asked()[1], 0);
    // The next click probes.
    super::click_at(&mut harness, pane.center());
    go(&mut harness);
    assert_eq!(of(&harness).pages.compare.probed_and_asked()[1], 1);
}

#[test]
fn the_right_panel_edits_the_pane_that_is_selected() {
    let mut harness = comparing();
    let before = project(&harness);
    let image = control(&harness, Role::Image, "Pane 2").rect();
    // The swatch in its title bar.
    super::click_at(&mut harness, image.left_top() + egui::vec2(11.0, -13.0));
    assert!(super::is_on(&control(&harness, Role::RadioButton, "Edit pane 2")));
    control(&harness, Role::ComboBox, "Method").click();
    go(&mut harness);
    control(&harness, Role::Button, ShadowMethod::OpacityMaps.label()).click();
    go(&mut harness);
    let after = project(&harness);
    assert_eq!(after.compare.panes[1].shadow.method, ShadowMethod::OpacityMaps);
    assert_eq!((&after.shadow, &after.picture), (&before.shadow, &before.picture), "not the project's own");
    assert_eq!(of(&harness).document.history().undo_len(), 1);
    wait(&mut harness, "the pane", |window| drawn(window, 4));
    go(&mut harness);
    let shown = super::texts(&harness);
    let said = |text: &str| shown.iter().any(|(said, ..)| said.contains(text));
    assert!(said("Shared by all panes") && said("MiB for the maps") && !said("0.0 MiB for the maps"));
    // The panel selects panes as well, and without panes it edits the project.
    control(&harness, Role::RadioButton, "Edit pane 4").click();
    go(&mut harness);
    assert!(super::is_on(&control(&harness, Role::RadioButton, "Edit pane 4")));
    key(&mut harness, Modifiers::NONE, Key::C);
    assert!(harness.query_by_role_and_label(Role::RadioButton, "Edit pane 4").is_none());
}

#[test]
fn a_tick_that_changes_nothing_says_so() {
    let mut harness = comparing();
    let said = |harness: &Whole| {
        super::texts(harness).iter().any(|(text, ..)| text.contains("already has the settings of pane 3"))
    };
    press_button(&mut harness, "Use pane 3");
    assert!(!said(&harness));
    press_button(&mut harness, "Use pane 3");
    assert!(said(&harness));
    assert_eq!(of(&harness).document.history().undo_len(), 1, "no step that changes nothing");
}

#[test]
fn a_report_is_written_in_the_background_with_its_options() {
    let mut harness = window();
    let dir = tempfile::tempdir().expect("a folder");
    let open = |harness: &mut Whole| {
        of_mut(harness).open_report_dialog();
        go(harness);
    };
    open(&mut harness);
    press_button(&mut harness, "Clear");
    assert!(harness.query_by_label("Choose a method.").is_some());
    for method in [ShadowMethod::None, ShadowMethod::VoxelMap] {
        control(&harness, Role::CheckBox, method.label()).click();
        go(&mut harness);
    }
    let options = of_mut(&mut harness).pages.compare.reporting.options.as_mut().expect("options");
    assert_eq!(options.methods, [ShadowMethod::None, ShadowMethod::VoxelMap]);
    (options.size, options.backends) = ([64, 64], vec![lovelock_render::Backend::Cpu]);
    press_button(&mut harness, "Choose folder…");
    let out = dir.path().join("a report");
    super::whole::answer(&mut harness, &out);
    assert!(of(&harness).pages.compare.reporting.is_running());
    wait(&mut harness, "the report", |window| !window.pages.compare.reporting.is_running());
    let json = std::fs::read_to_string(out.join("report.json")).expect("a report");
    let report: lovelock_study::report::CompareReport = serde_json::from_str(&json).expect("JSON");
    let ids: Vec<_> = report.methods.iter().map(|method| method.id.as_str()).collect();
    assert_eq!((ids, report.complete, report.scene.width), (vec!["none", "voxel-map"], true, 64));
    assert!(super::texts(&harness).iter().any(|(text, ..)| text.contains("report.html")));

    // The options stay for the next one, which is stopped.
    open(&mut harness);
    assert!(super::is_on(&control(&harness, Role::CheckBox, ShadowMethod::VoxelMap.label())));
    press_button(&mut harness, "All");
    press_button(&mut harness, "Choose folder…");
    super::whole::answer(&mut harness, &dir.path().join("stopped"));
    of_mut(&mut harness).pages.compare.reporting.cancel();
    wait(&mut harness, "the end", |window| !window.pages.compare.reporting.is_running());
    assert!(super::texts(&harness).iter().any(|(text, ..)| text.contains("stopped")));
}
