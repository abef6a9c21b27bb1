//! The engine: project, session, commands, events, clock and the headless loop.
//!
//! It knows no window and no command line; both are leaves on it. There are three kinds of state, kept apart:
//! a [`Project`] is what is saved and undone, a session ([`Scene`], [`Engine`], [`Worker`]) is what runs, and the
//! state of the interface lives in the interface.

mod bench;
mod clock;
mod command;
mod compare;
mod convert;
mod desk;
mod error;
mod farm;
mod filmstrip;
mod headless;
mod health;
mod history;
mod info;
mod painter;
mod priority;
mod project;
mod session;
mod slot;
mod stats;
mod take;
mod tracks;

pub use bench::{BenchReport, BenchRequest, BenchScene, SceneReport, StageReport, bench};
pub use clock::{Due, FrameClock, MAX_STEPS_PER_TICK, Pace, Playback, STEP_SECS, Stopwatch};
pub use command::{COMMANDS, Command, CommandGroup, CommandInfo, Shortcut};
pub use compare::{
    BandingReport, ChangeReport, CompareReport, CompareRequest, Contender, FlipError, FootprintTruth, Legend,
    Live, LiveError, LivePane, LiveProbe, LiveRequest, LiveShows, LiveTimes, LiveView, MethodFiles,
    MethodReport, NamedTruth, PointTruth, ProbeCurve, ProbeMark, ProbePlace, ProbeReport, ProbedHair,
    Reference, SceneFacts, Sheet, SheetPane, StabilityReport, StageMs, Sweep, TimeSpread, TransmittanceError,
    bytes_label, compare, pane_columns,
};
pub use convert::{ConvertReport, convert};
pub use error::{Place, Problem, ProblemKind, StudioError};
pub use farm::{FARM_TEMPLATE, FarmReport, FarmRequest, assemble, farm};
pub use filmstrip::{Filmstrip, FilmstripPicture, FilmstripRequest};
pub use headless::{
    CurveRecordReport, CurveSource, Progress, RecordJob, RecordReport, RecordRequest, Recorded, StageMedians,
    TakeRecordReport, is_curves, is_take, record, record_curves, record_take,
};
pub use health::{Gauge, GaugeKind, HealthLevel, health};
pub use history::{GestureId, History};
pub use info::{Content, FileKind, Info, ProjectInfo, RegrownInfo, TakeInfo, info};
pub use painter::{Adapter, PaintRequest, Painted, Painter};
pub(crate) use priority::give_way;
pub use project::{
    Access, BodySection, BodySource, CameraMode, CameraSection, CompareSection, FileRef, HairSection,
    HairSource, Marker, MotionSection, MotionSource, PROJECT_EXTENSION, PROJECT_VERSION, Project,
    RecordingSection, TakeSection, TimelineSection, load_project, load_project_with, parse_project,
    save_project, write_whole,
};
pub use session::{
    BodyObstacle, Engine, Event, Found, FrameSnapshot, HeadPath, LoadControl, LoadProgress, Preroll,
    PrerollProgress, Scene, SceneLoader, Totals, Wake, Worker, camera_at, dancer, frame_points,
};
pub use slot::Slot;
pub use stats::{PassHistory, Stage, StageHistory, StageTimes, median};
pub use take::{TakePlayer, TakeProgress, TakeRecording, project_of_take};
pub use tracks::{Animation, Key, Moment, Overdub, Track};

/// Gives the threads that share parallel work their names; without it they bear that of whoever came first.
///
/// Their number is that of the processor's threads, or `RAYON_NUM_THREADS`.
pub fn name_workers() {
    // An error says that the threads are there already, which changes nothing but their names.
    let _ = rayon::ThreadPoolBuilder::new().thread_name(|i| format!("worker {i}")).build_global();
}

// What the interface edits and shows, so that it needs no other crate of the engine.
pub use lovelock_groom as groom;
pub use lovelock_metrics as metrics;
pub use lovelock_motion as motion;
pub use lovelock_record as recording;
pub use lovelock_render as render;
pub use lovelock_simulation as simulation;
