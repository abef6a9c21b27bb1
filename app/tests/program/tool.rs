//! Runs the program and looks at what it left.

use std::ffi::OsStr;
use std::fs::File;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use lovelock_studio::groom::Preset;
use lovelock_studio::{Project, Stopwatch, save_project};
use serde_json::Value;

/// No run of these tests takes a tenth of it; what takes longer hangs.
const HANGS_SECS: f64 = 120.0;

/// How a run of the program ended.
#[derive(Debug)]
pub struct Ran {
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
    pub took_secs: f64,
}

impl Ran {
    /// The one JSON object on standard output.
    #[track_caller]
    pub fn json(&self) -> Value {
        let value: Value = serde_json::from_str(&self.stdout)
            .unwrap_or_else(|error| panic!("no single JSON value on standard output ({error}): {self:?}"));
        assert!(value.is_object(), "{self:?}");
        value
    }

    /// The one line on standard error of a run that must end with `code`.
    #[track_caller]
    pub fn refused(&self, code: i32) -> &str {
        assert_eq!(self.code, Some(code), "{self:?}");
        let line = self.stderr.trim_end_matches('\n');
        assert!(!line.is_empty() && line.lines().count() == 1, "one line: {self:?}");
        assert!(line.len() < 700, "a sentence: {self:?}");
        assert!(!line.contains("panicked"), "{self:?}");
        line
    }

    /// Whether it ended well.
    #[track_caller]
    pub fn done(&self) -> &Self {
        assert_eq!(self.code, Some(0), "{self:?}");
        self
    }
}

/// The program, with nothing of a display.
pub fn lovelock() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lovelock"));
    command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").env_remove("LOVELOCK_LOG");
    command
}

/// Runs it to its end.
#[track_caller]
pub fn run<A: AsRef<OsStr>>(folder: &Path, args: impl IntoIterator<Item = A>) -> Ran {
    run_command(lovelock().current_dir(folder).args(args))
}

/// Runs a command to its end, and kills it where it hangs.
#[track_caller]
pub fn run_command(command: &mut Command) -> Ran {
    // Files rather than pipes: nothing waits for a reader.
    let dir = tempfile::tempdir().expect("a folder");
    let (out, err) = (dir.path().join("out"), dir.path().join("err"));
    let watch = Stopwatch::start();
    let mut child = command
        .stdin(Stdio::null())
        .stdout(File::create(&out).expect("a file"))
        .stderr(File::create(&err).expect("a file"))
        .spawn()
        .expect("the program starts");
    let status = loop {
        if let Some(status) = child.try_wait().expect("its state") {
            break status;
        }
        if watch.secs() > HANGS_SECS {
            let _ = child.kill();
            let _ = child.wait();
            panic!("hangs: {command:?}");
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    let read = |path| String::from_utf8(std::fs::read(path).expect("a file")).expect("UTF-8");
    Ran { code: status.code(), stdout: read(out), stderr: read(err), took_secs: watch.secs() }
}

/// A project with few strands and small maps, so that a frame of it is soon drawn.
pub fn small_project() -> Project {
    let mut project = Project::default();
    project.set_preset(Preset::Smooth);
    project.hair.groom.wisps = 16;
    project.hair.groom.strands_per_wisp = 8;
    project.hair.groom.segments_per_strand = 10;
    project.shadow.voxel_map.resolution = 32;
    (project.recording.width, project.recording.height) = (96, 64);
    project
}

/// Saves a project and names it.
pub fn saved(folder: &Path, name: &str, project: &Project) -> std::path::PathBuf {
    let path = folder.join(name);
    save_project(&path, project).expect("the project is saved");
    path
}

/// Names of everything in a folder, sorted.
pub fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}
