//! Whole comparisons with little hair, on the CPU. No test here needs a graphics adapter.

use std::ops::ControlFlow;
use std::path::Path;

use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_render::{Backend, ShadowMethod};
use lovelock_session::progress::Progress;
use lovelock_session::testing::small_project;

use super::*;
use crate::report::{CompareReport, MethodReport};

fn request(out: &Path, methods: &[ShadowMethod]) -> CompareRequest {
    CompareRequest {
        out: out.to_owned(),
        frames: Some(2..3),
        size: Some((48, 40)),
        methods: methods.to_vec(),
        backends: vec![Backend::Cpu],
        draws: 2,
        ..CompareRequest::default()
    }
}

/// Few strands, so that tests are fast, but a few millimetres wide for the light: as dense as full hair.
fn little_hair() -> Project {
    let mut project = small_project();
    project.look.real_hairs *= 0.04;
    project.look.extinction_scale = 0.5;
    project
}

fn run(project: &Project, request: &CompareRequest) -> Result<CompareReport, ProjectError> {
    compare(project, request, &mut |_| ControlFlow::Continue(()))
}

fn method<'a>(report: &'a CompareReport, id: &str) -> &'a MethodReport {
    report.methods.iter().find(|method| method.id == id).expect(id)
}

fn rmse(method: &MethodReport) -> f64 {
    method.transmittance.map_or(f64::NAN, |error| error.rmse)
}

#[test]
fn every_method_is_drawn_measured_and_written() {
    let dir = tempfile::tempdir().expect("a folder");
    let out = dir.path().join("a report ü");
    let wanted = CompareRequest { frames: Some(2..4), ..request(&out, &[]) };
    let report = run(&little_hair(), &wanted).expect("a report");
    assert!(report.complete && report.reference.converged, "{:?}", report.reference);
    assert_eq!(report.frames, [2, 4]);
    let ids: Vec<_> = report.methods.iter().map(|method| method.id.as_str()).collect();
    assert_eq!(ids, ShadowMethod::ALL.iter().map(|method| method.id()).collect::<Vec<_>>());
    assert_eq!(report.reference.refused, [""; 0]);
    let others: Vec<&str> = report.reference.others.iter().map(|truth| truth.name.as_str()).collect();
    assert_eq!(
        others,
        ["reference picture, light 2", "reference picture, light 3", "frame 3", "light that turns"]
    );
    assert_eq!(report.swim_frames, [2, 3]);
    assert_eq!(report.reference.probes.len(), report.probes.len());
    for method in &report.methods {
        assert_eq!(method.refused, None, "{}", method.id);
        let (error, flip) = (method.transmittance.expect("errors"), method.flip.expect("FLIP"));
        assert_eq!(error.count, report.scene.points);
        assert!(error.rmse <= error.max && error.bias.abs() <= error.rmse && flip.mean <= 1.0);
        assert!(
            method.ssim.is_some_and(|ssim| ssim <= 1.0) && method.ms.is_some_and(|ms| ms.build.is_some())
        );
        assert!(method.times.iter().all(|time| time.low <= time.median && time.median <= time.high));
        let stability = method.stability.expect("stability");
        assert!(stability.pop.is_some() && stability.flicker.is_some());
        let files = &method.files;
        for file in [
            &files.picture,
            &files.transmittance_error,
            &files.picture_error,
            &files.swim,
            &files.pop,
            &files.flicker,
        ] {
            let file = file.as_ref().expect("a name");
            assert!(out.join(file).is_file(), "{file}");
        }
    }
    // Control: without shadow, hair is far too bright, does not change, and differs most from the reference.
    let none = method(&report, "none");
    assert!(none.transmittance.is_some_and(|error| error.bias > 0.05), "{:?}", none.transmittance);
    assert_eq!(none.stability.map(|stability| (stability.swim, stability.pop)), Some((Some(0.0), Some(0.0))));
    for other in report.methods.iter().filter(|other| other.id != "none") {
        // The march takes every strand as the mean of all directions: measured 0.56 in this thin hair.
        let most = if other.id == "voxel-march" { 0.65 } else { 0.5 };
        assert!(rmse(other) < most * rmse(none), "{}: {} of {}", other.id, rmse(other), rmse(none));
        assert!(other.flip.map(|flip| flip.mean) < none.flip.map(|flip| flip.mean), "{}", other.id);
        // Rays have no texels across which hair could move.
        let swims = other.stability.is_some_and(|stability| stability.swim > Some(0.0));
        assert_eq!(swims, other.id != "ray-traced", "{}", other.id);
    }
    // A turning light changes the ground truth slightly, and nothing without shadow.
    let turned = |id: &str| method(&report, id).light_sweep.expect("a light that turns");
    let still = turned("none");
    assert_eq!((still.pop, still.excess, still.jitter), (0.0, still.truth_pop, still.truth_rms));
    assert!(
        still.truth_pop.is_some_and(|pop| pop > 0.0) && still.points > 0 && still.steps == 8,
        "{still:?}"
    );
    assert_eq!(turned("exact").truth_pop, still.truth_pop, "one truth for one size of texel");
    for other in report.methods.iter().filter(|other| other.id != "none") {
        assert!(other.light_sweep.is_some_and(|found| found.pop > 0.0), "{}", other.id);
    }
    // One ground truth ranks all methods, and for methods with its texels it equals their own.
    let common = |id: &str| method(&report, id).transmittance_common;
    assert_eq!(common("exact"), method(&report, "exact").transmittance);
    assert_ne!(common("voxel-map"), method(&report, "voxel-map").transmittance);
    // The ground truth at points is not compared with itself; the voxel map is.
    assert_eq!(method(&report, "exact").transmittance_at_points, None);
    assert!(method(&report, "voxel-map").transmittance_at_points.is_some());
    assert!(report.methods.iter().any(|method| method.front_of_time));
    assert!(report.methods.iter().any(|method| method.front_of_memory));
    // Every probe has every method.
    assert!(!report.probes.is_empty());
    for probe in &report.probes {
        assert_eq!(probe.methods.len(), report.methods.len());
        assert!(!probe.reference.is_empty());
    }
    // A point at the edge of its texel may have no fragment there.
    assert!(report.probes.iter().any(|probe| !probe.steps.is_empty()));

    let written = std::fs::read_to_string(out.join("report.json")).expect("JSON");
    let read: CompareReport = serde_json::from_str(&written).expect("a report");
    assert_eq!(read.methods.len(), report.methods.len());
    let csv = std::fs::read_to_string(out.join("report.csv")).expect("a table");
    assert_eq!(csv.lines().count(), 1 + report.methods.len());
    let page = std::fs::read_to_string(out.join("report.html")).expect("a page");
    assert!(page.contains("Occupancy maps") && page.contains("occupancy-maps.png"));
}

#[test]
fn the_truth_of_every_light_counts() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut project = little_hair();
    project.lights.truncate(1);
    project.lights[0].enabled = true;
    project.lights.push(project.lights[0].clone());
    let wanted = CompareRequest { quick: true, ..request(dir.path(), &[ShadowMethod::None]) };
    let report = run(&project, &wanted).expect("a report");
    let of_second = report.reference.others.iter().find(|truth| truth.name == "reference picture, light 2");
    let of_second = of_second.unwrap_or_else(|| panic!("{:?}", report.reference.others));
    assert!(of_second.samples > 1 && of_second.change <= report.reference.change);
    // The same light has the same ground truth.
    assert_eq!(of_second.change, report.reference.footprints[0].change);
    // Negative control: one light has no second.
    project.lights.truncate(1);
    let report = run(&project, &wanted).expect("a report");
    assert!(report.reference.others.iter().all(|truth| !truth.name.contains("light 2")));
}

#[test]
fn images_are_compared_with_the_reference_of_their_own_backend() {
    let dir = tempfile::tempdir().expect("a folder");
    let both = vec![Backend::Cpu, Backend::Gpu];
    let methods = [ShadowMethod::Exact, ShadowMethod::None];
    let mut project = little_hair();
    project.lights.truncate(1);
    project.lights[0].enabled = true;
    let wanted = CompareRequest { backends: both, quick: true, ..request(dir.path(), &methods) };
    let report = run(&project, &wanted).expect("a report");
    let drawn: Vec<_> = report.reference.pictures.iter().map(|of| of.backend.as_str()).collect();
    assert!(report.reference.pictures.iter().all(|of| dir.path().join(&of.file).is_file()));
    assert_eq!(report.reference.picture.as_ref(), Some(&report.reference.pictures[0].file));
    let Some(between) = report.reference.gpu_from_cpu else {
        assert_eq!(drawn, ["cpu"], "without an adapter");
        return;
    };
    assert_eq!(drawn, ["cpu", "gpu"]);
    let flip = |id: &str, backend: &str| {
        let of = report.methods.iter().find(|method| method.id == id && method.backend == backend);
        of.and_then(|method| method.flip).map_or(f64::NAN, |flip| flip.mean)
    };
    // Both backends judge alike: they differ by less than the two backends do.
    for id in ["exact", "none"] {
        let apart = (flip(id, "cpu") - flip(id, "gpu")).abs();
        assert!(apart < between.flip.mean, "{id}: {apart} of {}", between.flip.mean);
    }
    assert!(flip("exact", "gpu") < between.flip.mean && flip("exact", "gpu") < 0.5 * flip("none", "gpu"));

    let backends = vec![Backend::Gpu];
    let wanted = CompareRequest { backends, quick: true, ..request(dir.path(), &[ShadowMethod::None]) };
    let alone = run(&project, &wanted).expect("a report").reference;
    assert_eq!((alone.pictures.len(), alone.pictures[0].backend.as_str()), (1, "gpu"));
    assert!(alone.gpu_from_cpu.is_some());
}

#[test]
fn sweeps_run_a_method_over_its_settings() {
    let dir = tempfile::tempdir().expect("a folder");
    let sweeps = vec!["slices=8,128".parse().expect("a sweep")];
    let wanted = CompareRequest {
        sweeps,
        quick: true,
        ..request(dir.path(), &[ShadowMethod::OpacityMaps, ShadowMethod::None])
    };
    // Spread hair, because for sparse hair close to the head, more slices make no difference.
    let mut project = little_hair();
    project.simulation.stiffness_root = 14.0;
    let report = run(&project, &wanted).expect("a report");
    let names: Vec<_> = report.methods.iter().map(|method| method.name.as_str()).collect();
    assert_eq!(names, ["opacity-maps slices=8", "opacity-maps slices=128", "none"]);
    let [few, many] = [&report.methods[0], &report.methods[1]];
    assert!(rmse(few) > rmse(many), "{} and {}", rmse(few), rmse(many));
    assert!(few.memory_bytes < many.memory_bytes, "{:?} and {:?}", few.memory_bytes, many.memory_bytes);
    // All have the same texels and therefore the same ground truth.
    assert_eq!(report.reference.footprints[0].methods.len(), 3);
}

#[test]
fn a_reference_that_does_not_fit_is_refused_with_the_number_and_the_rest_is_made_long_suite() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut project = little_hair();
    // The smallest possible limit is 16 MiB; this hair needs more.
    (project.hair.groom.wisps, project.hair.groom.strands_per_wisp) = (300, 40);
    project.shadow.exact.memory_limit_bytes = 0;
    // Few cells, so that their ground truth is fast.
    project.shadow.voxel_map.resolution = 32;
    let methods = [ShadowMethod::VoxelMap, ShadowMethod::Exact];
    let report = run(&project, &request(dir.path(), &methods)).expect("a report");
    assert!(report.complete);
    let refused = report.reference.refused.join("\n");
    assert!(refused.contains("the truth at points: exact needs") && refused.contains("MiB"), "{refused}");
    let exact = method(&report, "exact");
    assert!(exact.refused.as_ref().is_some_and(|why| why.contains("exact needs")), "{:?}", exact.refused);
    let voxels = method(&report, "voxel-map");
    assert!(voxels.refused.is_none() && voxels.files.picture.is_some());
    assert!(voxels.transmittance.is_some() && voxels.transmittance_at_points.is_none());
}

#[test]
fn what_is_finished_stays_when_it_is_stopped() {
    let dir = tempfile::tempdir().expect("a folder");
    let methods = [ShadowMethod::None, ShadowMethod::VoxelMap, ShadowMethod::OpacityMaps];
    // Called once at the start and then before each draw: this stops between two draws.
    let mut asked = 0;
    let mut stop = |progress| match progress {
        Progress::Comparing { what, .. } if what == "opacity-maps" => {
            asked += 1;
            if asked < 4 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        }
        _ => ControlFlow::Continue(()),
    };
    let quick = CompareRequest { quick: true, ..request(dir.path(), &methods) };
    let report = compare(&little_hair(), &quick, &mut stop).expect("a report");
    assert!(!report.complete && report.notes.iter().any(|note| note.contains("Stopped")));
    assert_eq!(report.methods.len(), 2);
    let written = std::fs::read_to_string(dir.path().join("report.json")).expect("JSON");
    let read: CompareReport = serde_json::from_str(&written).expect("a report");
    assert!(!read.complete && read.methods.len() == 2);
    assert!(dir.path().join("pictures/voxel-map.png").is_file());
    assert!(!dir.path().join("pictures/opacity-maps.png").exists());

    // Stopped while the map is shifted, after the image was written: 3 warm-up draws and 2 measured ones.
    let mut asked = 0;
    let mut stop = |progress| match progress {
        Progress::Comparing { what, .. } if what == "voxel-map" => {
            asked += 1;
            if asked < 9 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        }
        _ => ControlFlow::Continue(()),
    };
    let report = compare(&little_hair(), &request(dir.path(), &methods), &mut stop).expect("a report");
    assert!(!report.complete && report.methods.len() == 1);
    let pictures = dir.path().join("pictures");
    assert!(pictures.join("none.png").is_file());
    assert!(!pictures.join("voxel-map.png").exists(), "neither of this run nor of the one before");
}

#[test]
fn wrong_requests_are_refused_before_any_work() {
    let dir = tempfile::tempdir().expect("a folder");
    let file = dir.path().join("a file");
    std::fs::write(&file, b"x").expect("a file");
    let good = request(&dir.path().join("report"), &[ShadowMethod::None]);
    let mut dark = little_hair();
    dark.lights.iter_mut().for_each(|light| light.enabled = false);
    let wrong = vec![
        ("no name", little_hair(), CompareRequest { out: "".into(), ..good.clone() }, 2),
        ("a file", little_hair(), CompareRequest { out: file.clone(), ..good.clone() }, 2),
        ("in a file", little_hair(), CompareRequest { out: file.join("x"), ..good.clone() }, 1),
        ("no frames", little_hair(), CompareRequest { frames: Some(5..5), ..good.clone() }, 2),
        ("no rate", little_hair(), CompareRequest { fps: Some(0.0), ..good.clone() }, 2),
        ("too large", little_hair(), CompareRequest { size: Some((9000, 9)), ..good.clone() }, 2),
        ("beside it", little_hair(), CompareRequest { probes: vec![[72, 0]], ..good.clone() }, 2),
        ("no light", dark, good.clone(), 2),
    ];
    for (what, project, request, code) in wrong {
        let mut told = 0;
        let error = compare(&project, &request, &mut |_| {
            told += 1;
            ControlFlow::Continue(())
        })
        .expect_err(what);
        assert_eq!((error.exit_code(), told), (code, 0), "{what}: {error}");
        assert_eq!(error.to_string().lines().count(), 1, "{what}: {error}");
    }
    // The clip's length is known when it is loaded.
    let late = CompareRequest { frames: Some(100_000..100_001), ..good };
    let error = run(&little_hair(), &late).expect_err("outside the clip");
    assert!(error.exit_code() == 2 && error.to_string().contains("100000"), "{error}");
    let left: Vec<_> = std::fs::read_dir(dir.path()).expect("a folder").collect();
    assert_eq!(left.len(), 1, "nothing but the file: {left:?}");
}

#[test]
fn several_frames_become_films_with_the_error_of_every_frame() {
    let dir = tempfile::tempdir().expect("a folder");
    let methods = [ShadowMethod::None, ShadowMethod::VoxelMap];
    let wanted =
        CompareRequest { frames: Some(2..5), quick: true, film: true, ..request(dir.path(), &methods) };
    let report = run(&little_hair(), &wanted).expect("a report");
    assert_eq!(report.films.len(), 2);
    for film in &report.films {
        assert_eq!(film.methods, ["none", "voxel-map"]);
        let info = lovelock_record::read_film(&dir.path().join(&film.file)).expect("a film");
        assert_eq!(info.frames, 3, "{}", film.file);
    }
    for found in &report.methods {
        assert_eq!(found.frame_errors.len(), 3);
        // Images and tables are those of the first frame.
        assert!((found.frame_errors[0].rmse - rmse(found)).abs() < 1e-9, "{}", found.id);
        let film = found.stability.and_then(|stability| stability.film_rmse).expect("an error");
        assert!(film > 0.0 && found.stability.is_some_and(|stability| stability.flicker.is_some()));
        let folder = found.files.error_frames.as_ref().expect("a folder");
        for frame in 2..5 {
            let file = dir.path().join(folder).join(format!("error.{frame:04}.png"));
            assert!(file.is_file(), "{}", file.display());
        }
    }
    let film = |id: &str| method(&report, id).stability.and_then(|stability| stability.film_rmse);
    assert!(film("none") > film("voxel-map"), "control: no shadow errs more in every frame");
    let page = std::fs::read_to_string(dir.path().join("report.html")).expect("a page");
    assert!(page.contains("errors.mp4") && page.contains("RMSE of the film"));

    let other = dir.path().join("without");
    let wanted = CompareRequest { film: false, out: other.clone(), ..wanted };
    let report = run(&little_hair(), &wanted).expect("a report");
    assert!(report.films.is_empty() && !other.join("errors.mp4").exists() && !other.join("frames").exists());
    assert_eq!(method(&report, "voxel-map").frame_errors.len(), 3);
}

#[test]
fn few_samples_of_a_large_light_are_an_error_long_suite() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut project = little_hair();
    project.lights.truncate(1);
    let of = |samples: u32| {
        let mut project = project.clone();
        (project.lights[0].enabled, project.lights[0].angular_radius) = (true, 0.4);
        project.lights[0].shadow_samples = samples;
        let wanted = CompareRequest { quick: true, ..request(dir.path(), &[ShadowMethod::Exact]) };
        let report = run(&project, &wanted).expect("a report");
        assert_eq!(report.methods[0].refused, None);
        (rmse(&report.methods[0]), report.methods[0].memory_bytes.unwrap_or(0))
    };
    let [few, many] = [2, 32].map(of);
    assert!(many.0 < 0.7 * few.0, "{few:?} {many:?}");
    assert!(many.1 > 8 * few.1, "each sample has a map");
}
