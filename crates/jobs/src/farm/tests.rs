use std::fs;
use std::ops::ControlFlow;

use lovelock_project::project::load_project;
use lovelock_session::testing::small_project;

use super::*;

fn make(project: &Project, request: &FarmRequest) -> Result<FarmReport, ProjectError> {
    farm(project, request, &mut |_| ControlFlow::Continue(()))
}

#[test]
fn the_folder_holds_the_project_its_files_and_a_job_of_three_steps() {
    let dir = tempfile::tempdir().expect("a folder");
    let hair = dir.path().join("my hair.usda");
    fs::write(&hair, HAIR).expect("a file");
    let mut project = small_project();
    project.set_hair_file(&hair);
    let mut access = Access::new();
    access.pick(&hair);
    let out = dir.path().join("job ü");
    let request = FarmRequest {
        out: out.clone(),
        frames: Some(4..25),
        size: Some((64, 48)),
        chunk: Some(8),
        access,
        ..FarmRequest::default()
    };
    let report = make(&project, &request).expect("a job");
    assert_eq!((report.tasks, report.chunk, report.first_frame), (3, 8, 4));
    assert_eq!(report.copied, [("assets/hair/my hair.usda".to_owned(), HAIR.len() as u64)]);
    // The project is self-contained: it opens from its folder and refers to the copy.
    let (copy, problems) = load_project(&out.join("project.lovelock")).expect("a project");
    assert_eq!((problems.len(), copy.recording.width), (0, 64), "{problems:?}");
    let named = copy.hair.file.expect("a file").path;
    assert!(named.ends_with("job ü/assets/hair/my hair.usda") && named.is_file(), "{}", named.display());
    let template: serde_json::Value =
        serde_json::from_slice(&fs::read(out.join(FARM_TEMPLATE)).expect("a job")).expect("JSON");
    assert_eq!(template["specificationVersion"], "jobtemplate-2023-09");
    let draw = &template["steps"][1];
    let ranges = &draw["parameterSpace"]["taskParameterDefinitions"][0]["range"];
    assert_eq!(*ranges, serde_json::json!(["4..12", "12..20", "20..25"]));
    assert_eq!(draw["dependencies"][0]["dependsOn"], "Simulate");
    // Simulated from its first frame on, and rendered by frame numbers of the original motion.
    let arguments = |step: &serde_json::Value| step["script"]["actions"]["onRun"]["args"].to_string();
    assert!(arguments(&template["steps"][0]).contains("\"4..25\""), "{template}");
    assert!(arguments(draw).contains("--dance-time"), "{template}");
    assert_eq!(fs::read_dir(dir.path()).expect("a folder").count(), 2, "nothing beside the job and the hair");
    // Existing contents are kept.
    let error = make(&project, &request).expect_err("not empty").to_string();
    assert!(error.contains("is not empty"), "{error}");
}

#[test]
fn a_project_with_a_sound_gives_a_note_because_frames_have_none() {
    let dir = tempfile::tempdir().expect("a folder");
    let file = dir.path().join("clicks.wav");
    lovelock_testkit::click_track(&file, 1);
    let notes = |name: &str, project: &Project| {
        let request =
            FarmRequest { out: dir.path().join(name), frames: Some(0..2), ..FarmRequest::default() };
        make(project, &request).expect("a job").notes
    };
    let mut project = small_project();
    project.set_sound_file(&file);
    let heard = notes("heard", &project);
    assert!(heard.iter().any(|note| note.contains("the frames of a farm have no sound")), "{heard:?}");
    // The control: a muted sound is not missed.
    project.sound.muted = true;
    assert!(notes("muted", &project).iter().all(|note| !note.contains("sound")));
}

#[test]
fn wrong_requests_are_refused_and_leave_nothing() {
    let dir = tempfile::tempdir().expect("a folder");
    let at = |name: &str| dir.path().join(name);
    let request = || FarmRequest { out: at("job"), frames: Some(0..4), ..FarmRequest::default() };
    let mut lost = small_project();
    lost.set_hair_file(at("gone.hair"));
    let mut seamless = small_project();
    seamless.recording.seamless = true;
    // A list on the heap: projects are large.
    #[allow(clippy::useless_vec)]
    let cases = vec![
        (seamless, request(), "a seamless loop"),
        (small_project(), FarmRequest { frames: Some(4..4), ..request() }, "an empty range"),
        (small_project(), FarmRequest { chunk: Some(0), ..request() }, "--chunk: found 0"),
        (
            small_project(),
            FarmRequest { chunk: Some(1), frames: Some(0..5000), ..request() },
            "5000 tasks for 5000 frames",
        ),
        (small_project(), FarmRequest { fps: Some(0.0), ..request() }, "frames per second"),
        (small_project(), FarmRequest { size: Some((0, 9)), ..request() }, "0x9"),
        (lost, request(), "gone.hair"),
    ];
    for (project, request, wanted) in cases {
        let error = make(&project, &request).expect_err(wanted);
        assert!(error.to_string().contains(wanted) && error.exit_code() == 2, "{wanted}: {error}");
    }
    assert_eq!(fs::read_dir(dir.path()).expect("a folder").count(), 0, "nothing is left");
}

/// Four curves for a hairstyle.
const HAIR: &str = r#"#usda 1.0
(
    metersPerUnit = 1
    upAxis = "Y"
)
def BasisCurves "hair"
{
    uniform token type = "linear"
    int[] curveVertexCounts = [2, 2, 2, 2]
    point3f[] points = [(0, 0.1, 0), (0, 0.3, 0), (0.1, 0, 0), (0.2, -0.1, 0), (-0.1, 0, 0), (-0.2, -0.1, 0), (0, 0, -0.1), (0, -0.2, -0.2)]
}
"#;
