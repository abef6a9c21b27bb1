//! Runs the program and reads its output and files.

use std::ffi::OsStr;
use std::fs::File;
use std::path::Path;
use std::process::{Command, Stdio};

use lovelock_base::clock::Stopwatch;
use lovelock_groom::Preset;
use lovelock_project::Project;
use lovelock_project::project::save_project;
use lovelock_render::{Backend, StrandCount};
use lovelock_testkit::wait::{HANG, wait_for};
use serde_json::Value;

/// The result of one run of the program.
#[derive(Debug)]
pub struct Outcome {
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl Outcome {
    /// The JSON object on standard output; fails if there is anything else.
    #[track_caller]
    pub fn json(&self) -> Value {
        let value: Value = serde_json::from_str(&self.stdout)
            .unwrap_or_else(|error| panic!("no single JSON value on standard output ({error}): {self:?}"));
        assert!(value.is_object(), "{self:?}");
        value
    }

    /// The only line on standard error of a run that must end with `code`.
    #[track_caller]
    pub fn refused(&self, code: i32) -> &str {
        assert_eq!(self.code, Some(code), "{self:?}");
        let line = self.stderr.trim_end_matches('\n');
        assert!(!line.is_empty() && line.lines().count() == 1, "not one line: {self:?}");
        assert!(line.len() < 700, "longer than a sentence: {self:?}");
        assert!(!line.contains("panicked"), "{self:?}");
        line
    }

    /// Fails unless the run succeeded.
    #[track_caller]
    pub fn done(&self) -> &Self {
        assert_eq!(self.code, Some(0), "{self:?}");
        self
    }
}

/// The program, without a display.
pub fn lovelock() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lovelock"));
    for name in ["DISPLAY", "WAYLAND_DISPLAY", "XDG_RUNTIME_DIR", "NODEVICE_SELECT", "LOVELOCK_LOG"] {
        command.env_remove(name);
    }
    // What the program remembers between runs stays out of the user's folder.
    command.env("LOVELOCK_STATE", Path::new(env!("CARGO_TARGET_TMPDIR")).join("state"));
    command
}

/// Runs the program until it exits.
#[track_caller]
pub fn run<A: AsRef<OsStr>>(folder: &Path, args: impl IntoIterator<Item = A>) -> Outcome {
    run_command(lovelock().current_dir(folder).args(args))
}

/// Runs a command until it exits; kills it and fails if it hangs.
#[track_caller]
pub fn run_command(command: &mut Command) -> Outcome {
    // Files instead of pipes, so that the program never blocks on a full pipe.
    let dir = tempfile::tempdir().expect("a folder");
    let (out, err) = (dir.path().join("out"), dir.path().join("err"));
    let mut child = command
        .stdin(Stdio::null())
        .stdout(File::create(&out).expect("a file"))
        .stderr(File::create(&err).expect("a file"))
        .spawn()
        .expect("the program starts");
    let watch = Stopwatch::start();
    let status = wait_for("the program", || {
        if watch.elapsed() > HANG / 2 {
            let _ = child.kill();
            let _ = child.wait();
            panic!("hangs: {command:?}");
        }
        child.try_wait().expect("the state of the process")
    });
    let read = |path| String::from_utf8(std::fs::read(path).expect("a file")).expect("UTF-8");
    Outcome { code: status.code(), stdout: read(out), stderr: read(err) }
}

/// A project with few strands and small maps, of which a frame is drawn quickly.
pub fn small_project() -> Project {
    let mut project = Project::default();
    project.set_preset(Preset::Smooth);
    project.hair.groom.wisps = 16;
    project.hair.groom.strands_per_wisp = 8;
    project.hair.groom.segments_per_strand = 10;
    project.shadow.voxel_map.resolution = 32;
    project.picture.strands = StrandCount::Stored;
    // A software adapter takes seconds to start.
    project.picture.backend = Backend::Cpu;
    project.timeline.preroll_secs = 0.1;
    (project.recording.width, project.recording.height) = (96, 64);
    project
}

/// Saves a project and returns its path.
pub fn saved(folder: &Path, name: &str, project: &Project) -> std::path::PathBuf {
    let path = folder.join(name);
    save_project(&path, project).expect("the project is saved");
    path
}

/// The names of all entries of a folder, sorted.
pub fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}
