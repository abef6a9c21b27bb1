//! The arguments of the command line.

use std::ops::Range;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use lovelock_groom::{HairFormat, Unit, UpAxis};
use lovelock_jobs::convert::written_extensions;
use lovelock_jobs::papers::figure_ids;
use lovelock_project::project::{Assignment, RecordingSection};
use lovelock_record::{FilmQuality, SequenceFormat};
use lovelock_render::{Backend, HairDrawing, LightRig, ShadowMethod, Transparency, UserMethod};

use super::values::{
    Backends, BenchTarget, Methods, assignment, backends, degrees, format, frames, methods, pixel, quality,
    rate, size, turn, unit, up_axis, up_axis_help, user_method,
};

/// Styles, simulates, shadows and compares hair interactively. Opens the window if no command is given.
#[derive(Debug, Parser)]
#[command(name = "lovelock", version = env!("LOVELOCK_VERSION"), subcommand_precedence_over_arg = true)]
pub(crate) struct Arguments {
    /// A project, take, strokes, hair, character, motion, surroundings or sound file to open in the window.
    pub(crate) project: Option<PathBuf>,
    /// Print one JSON object on standard output and nothing else there.
    #[arg(long, global = true)]
    pub(crate) json: bool,
    /// Change a setting of the project, such as simulation.wind.speed=3; may be given several times. `lovelock settings` lists all.
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = assignment)]
    pub(crate) set: Vec<Assignment>,
    /// Save a screenshot of the window as a PNG file and exit.
    #[arg(long, value_name = "FILE")]
    pub(crate) screenshot: Option<PathBuf>,
    /// Replace an existing file of the screenshot's name even if it is no image of this program.
    #[arg(long, requires = "screenshot")]
    pub(crate) force: bool,
    /// Open the window with a shadow method of your own: a folder with method.toml and its shader. With --panes it is added to the panes.
    #[arg(long, value_name = "FOLDER", value_parser = user_method)]
    pub(crate) method: Option<UserMethod>,
    /// Open the window with the comparison of the project's panes, like key C.
    #[arg(long)]
    pub(crate) panes: bool,
    /// Open the window with the mask of this layer shown: its position in the list, from 1.
    #[arg(long, value_name = "LAYER", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) mask: Option<u32>,
    /// Seconds to wait for the screenshot after hair first appears on the screen.
    #[arg(long, value_name = "SECONDS", default_value_t = 6.0, requires = "screenshot")]
    pub(crate) after: f64,
    #[command(subcommand)]
    pub(crate) task: Option<Task>,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Task {
    /// Simulates and renders the dance to a film or a folder of images.
    Record(Record),
    /// Renders one instant by several shadow methods, and writes images, errors and costs as a page and tables.
    Compare(Compare),
    /// Measures frames of known scenes, stage by stage, on each backend, beside published figures.
    Bench(Bench),
    /// Draws and measures the figures and tables of the papers that the methods come from, beside the published ones, as a page.
    Papers(Papers),
    /// Describes the contents of a hair, character, motion, project, take, strokes, surroundings or sound file.
    Info(Info),
    /// Converts a hair file to another format.
    Convert(Convert),
    /// Writes a job that renders the frames on many machines, for any scheduler that supports Open Job Description.
    Farm(Farm),
    /// Lists the shipped hairstyles and your own, and draws contact sheets of them.
    Presets(Presets),
    /// Lists every setting of a project: name, label, range, default, and what it changes.
    Settings(SettingsTask),
    /// Joins the parts that a farm has rendered into one image sequence.
    Assemble(Assemble),
    /// Builds the database for drawing hair as clusters.
    Satf(super::satf::Satf),
    /// Plays recorded brush strokes on the hair of a project and writes the result as a new project.
    Style(StyleTask),
    /// Writes a shadow method of your own to begin with, or checks one.
    Method(super::method::MethodCommand),
    /// Prints the completions of a shell, for its folder of completions.
    Completions(Completions),
    /// Writes the pages of the manual for `man`; packages contain them.
    #[command(hide = true)]
    Man(Man),
}

#[derive(Debug, Args)]
pub(crate) struct Completions {
    /// The shell.
    pub(crate) shell: clap_complete::Shell,
}

#[derive(Debug, Args)]
pub(crate) struct Man {
    /// The folder to write to.
    pub(crate) folder: PathBuf,
}

/// The project, with changes.
#[derive(Debug, Args)]
pub(crate) struct SourceArguments {
    /// Project or take; the default project if none is given.
    pub(crate) project: Option<PathBuf>,
    /// Hairstyle to use instead of the project's: the id of a shipped style, the name of one of yours, or a .lovelockstyle file.
    /// `lovelock presets` lists all.
    #[arg(long, value_name = "ID", conflicts_with = "hair")]
    pub(crate) preset: Option<String>,
    /// Second hairstyle to morph into, named as for --preset. `--set hair.morph.amount=0.5` or a track sets the amount.
    #[arg(long, value_name = "ID")]
    pub(crate) morph: Option<String>,
    /// Hair file to use instead of the project's hairstyle.
    #[arg(long, value_name = "FILE")]
    pub(crate) hair: Option<PathBuf>,
    /// Unit of the hair file: auto, m, cm, mm or in.
    #[arg(long, value_parser = unit)]
    pub(crate) unit: Option<Unit>,
    #[arg(
        long, value_name = "AXIS", allow_hyphen_values = true, value_parser = up_axis,
        help = up_axis_help("the hair file")
    )]
    pub(crate) up: Option<UpAxis>,
    /// Character file to use instead of the project's body, or the name of a shipped one: dancer, man, woman, elder, animal, lawn.
    #[arg(long, value_name = "FILE")]
    pub(crate) body: Option<PathBuf>,
    /// Motion file (BVH, VRM animation, or another character with a clip) to use instead of the project's motion.
    #[arg(long, value_name = "FILE")]
    pub(crate) motion: Option<PathBuf>,
    /// Picture of the surroundings (Radiance .hdr or `OpenEXR` .exr) that lights the scene from all directions.
    #[arg(long, value_name = "FILE")]
    pub(crate) surroundings: Option<PathBuf>,
    /// Picture behind the figure (PNG, JPEG, Radiance .hdr or `OpenEXR` .exr). `--set picture.background_fit=fit` shows all of it.
    #[arg(long, value_name = "FILE")]
    pub(crate) background: Option<PathBuf>,
    /// Light rig to use instead of the project's lights: soft-beauty, three-point, rim-at-night or flat. It sets the ambient light, the
    /// exposure and the background too.
    #[arg(long, value_name = "NAME")]
    pub(crate) lights: Option<LightRig>,
    /// Sound file (WAV, MP3, Ogg Vorbis or FLAC) to play with the dance and in films. `--set sound.offset_secs=1.5` shifts it.
    #[arg(long, value_name = "FILE")]
    pub(crate) sound: Option<PathBuf>,
    /// File outside the folder of the project or take that it may read; may be given several times. Files that were named when a take was
    /// recorded on this machine are allowed already.
    #[arg(long, value_name = "FILE")]
    pub(crate) allow: Vec<PathBuf>,
    /// Change a setting of the project, such as simulation.wind.speed=3; may be given several times. `lovelock settings` lists all.
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = assignment)]
    pub(crate) set: Vec<Assignment>,
}

/// Size and rate of images.
#[derive(Debug, Args)]
pub(crate) struct PictureArguments {
    /// Frames per second.
    #[arg(long, value_parser = rate)]
    pub(crate) fps: Option<f64>,
    /// Size in pixels, such as 1280x720.
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub(crate) size: Option<(u32, u32)>,
}

/// Frames, size and rate.
#[derive(Debug, Args)]
pub(crate) struct FilmArguments {
    /// Frames, half open, such as 0..240; the whole clip if none are given.
    #[arg(long, value_name = "A..B", value_parser = frames)]
    pub(crate) frames: Option<Range<u64>>,
    #[command(flatten)]
    pub(crate) picture: PictureArguments,
}

#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch by itself")]
pub(crate) struct Record {
    #[command(flatten)]
    pub(crate) source: SourceArguments,
    /// Output. A name that ends in `.mp4` is a film, in `.apng` a small animated preview, in `.take` the simulation alone, in `.usdc`,
    /// `.usd`, `.usda`, `.abc` or `.glb` the hair as animated curves with the body; any other name is a folder of PNG or EXR files with a
    /// manifest.
    #[arg(short, long, value_name = "OUT")]
    pub(crate) out: PathBuf,
    /// Replace an existing take, or a file that this program did not make. Its own films, curves and images are always replaced.
    #[arg(long)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) film: FilmArguments,
    /// Shadow method.
    #[arg(long, value_name = "ID")]
    pub(crate) shadow: Option<ShadowMethod>,
    /// Shadow method of your own: a folder with method.toml and its shader, as `lovelock method new` writes it.
    #[arg(long, value_name = "FOLDER", value_parser = user_method, conflicts_with = "shadow")]
    pub(crate) method: Option<UserMethod>,
    /// What hair is drawn as: strands, clusters (lock by lock, from a database of rendered sectors) or auto (clusters where hair is small
    /// in the image); the project's choice if none is given.
    #[arg(long, value_name = "ID")]
    pub(crate) draw: Option<HairDrawing>,
    /// How overlapping strands are blended.
    #[arg(long, value_name = "ID")]
    pub(crate) transparency: Option<Transparency>,
    /// Backend: auto (the graphics card if there is a real one), gpu (any wgpu adapter, including a software one) or cpu (without any
    /// driver); the project's choice if none is given.
    #[arg(long, value_name = "BACKEND")]
    pub(crate) backend: Option<Backend>,
    /// What simulates the hair: cpu, gpu (any wgpu adapter, including a software one) or auto (the graphics card if there is a real one
    /// and the hair has at least 2,000 guides); the project's choice if none is given.
    #[arg(long, value_name = "BACKEND")]
    pub(crate) simulate: Option<Backend>,
    /// Quality of a film: draft, good, high or best; the project's choice if none is given.
    #[arg(long, value_name = "ID", value_parser = quality)]
    pub(crate) quality: Option<FilmQuality>,
    /// Write the shadow method, the transparency and the frame number into each image.
    #[arg(long)]
    pub(crate) label: bool,
    /// Move the camera once round the figure in this many seconds, 0.5 to 600. Without --frames the film is one turn.
    #[arg(long, value_name = "SECONDS", value_parser = turn)]
    pub(crate) turntable: Option<f32>,
    /// Blend the end of the loop into its start, so that a film of one cycle of a looping dance repeats without a jump.
    #[arg(long = "loop")]
    pub(crate) seamless: bool,
    /// Take to show beside the project at the same time; may be given up to five times.
    #[arg(long, value_name = "TAKE")]
    pub(crate) beside: Vec<PathBuf>,
    /// File format in a folder: png (as the screen shows it) or exr (linear half floats with depth and the light that reaches the
    /// hair); the project's choice if none is given.
    #[arg(long, value_name = "ID", value_parser = format)]
    pub(crate) format: Option<SequenceFormat>,
    /// Leave out background and ground; alpha is the coverage of hair and body. Not for a film (.mp4), which has no alpha.
    #[arg(long)]
    pub(crate) transparent: bool,
    /// Samples per frame for motion blur while the shutter is open, 1 (no blur) to 64.
    #[arg(long, value_name = "N",
        value_parser = clap::value_parser!(u32).range(1..=i64::from(RecordingSection::MAX_SUBFRAMES)))]
    pub(crate) motion_blur: Option<u32>,
    /// Shutter angle for motion blur in degrees, centred on the frame; 360 is the whole frame.
    #[arg(long, value_name = "DEGREES", value_parser = degrees)]
    pub(crate) shutter: Option<f32>,
    /// Continue the sequence in the folder: complete frames are kept and the rest is rendered. Refused if the project, its files, the
    /// size or another setting has changed since.
    #[arg(long)]
    pub(crate) resume: bool,
    /// Number the frames of a take on the timeline of the dance from which it was recorded: frame 40 is frame 40 of the dance, even if
    /// the take begins there.
    #[arg(long, conflicts_with = "seamless")]
    pub(crate) dance_time: bool,
    /// Curves in a .usdc, .usda, .abc or .glb file: guides or strands; strands in USD and Alembic and guides in glTF if none is given.
    #[arg(long, value_name = "ID")]
    pub(crate) curves: Option<lovelock_jobs::record::CurveSource>,
    /// Leave the body out of a .usdc, .usda, .abc or .glb file.
    #[arg(long)]
    pub(crate) no_body: bool,
}

#[derive(Debug, Args)]
pub(crate) struct Compare {
    #[command(flatten)]
    pub(crate) source: SourceArguments,
    /// Folder for the report: report.html, report.csv, report.json and images.
    #[arg(short, long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Frame to compare; the project's first frame if none is given.
    #[arg(long, value_name = "N", conflicts_with = "frames")]
    pub(crate) frame: Option<u64>,
    /// Frames to compare, half open, such as 30..40: images, errors and times of the first one; swimming, popping and flicker of all.
    #[arg(long, value_name = "A..B", value_parser = frames)]
    pub(crate) frames: Option<Range<u64>>,
    #[command(flatten)]
    pub(crate) picture: PictureArguments,
    /// Shadow methods, separated by commas, or `all`.
    #[arg(long, value_name = "ID,ID|all", default_value = "all", value_parser = methods)]
    pub(crate) methods: Methods,
    /// Shadow method of your own to compare with them: a folder with method.toml and its shader, as `lovelock method new` writes it; may
    /// be given several times.
    #[arg(long, value_name = "FOLDER", value_parser = user_method)]
    pub(crate) method: Vec<UserMethod>,
    /// What hair is drawn as: strands, clusters or auto, separated by commas; the project's choice if none is given. Only strands have
    /// errors of transmittance.
    #[arg(long, value_name = "ID,ID", value_delimiter = ',')]
    pub(crate) draw: Vec<HairDrawing>,
    /// How overlapping strands are blended, separated by commas; the project's choice if none is given.
    #[arg(long, value_name = "ID,ID", value_delimiter = ',')]
    pub(crate) transparency: Vec<Transparency>,
    /// Backend: auto (the graphics card if there is a real one), gpu, cpu, or both; the project's choice if none is given.
    #[arg(long, value_name = "BACKEND", value_parser = backends)]
    pub(crate) backend: Option<Backends>,
    /// Setting of shadow methods to vary, such as resolution=64,128,256; may be given several times.
    #[arg(long, value_name = "SETTING=V,V")]
    pub(crate) sweep: Vec<lovelock_study::batch::Sweep>,
    /// Pixel whose hair is probed; may be given several times. Some are chosen if none is given.
    #[arg(long, value_name = "X,Y", value_parser = pixel)]
    pub(crate) probe: Vec<[u32; 2]>,
    /// Number of draws per time measurement, 1 to 1000; 30, or 5 with --quick. Times of fewer than 30 draws are rough.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) draws: Option<u32>,
    /// Leave out swim, banding, the turning light and the stray hair, and time fewer draws.
    #[arg(long)]
    pub(crate) quick: bool,
    /// Leave out the films of several frames (pictures.mp4, errors.mp4) and the error map of every frame.
    #[arg(long)]
    pub(crate) no_film: bool,
    /// Replace files named report.html, report.csv and report.json that this program did not make. Its own are always replaced.
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct Bench {
    /// Scenes: smooth, curly, smooth-500k, smooth-1m, smooth-2m, woman-300k, dog-2m, fur-400k (fur on a whole body), lawn (grass), far,
    /// middle, near and still (fine strands that scatter, from a whole figure to a head of 100,000 strands), clusters and clusters-far (40
    /// locks drawn as clusters, near and with a head of 24 pixels), clusters-strands and clusters-far-strands (the same locks drawn as
    /// 21,000 strands), clusters-crowd and clusters-crowd-strands (20 such heads in one image), and simulate-402 and simulate-20k, which
    /// are simulated by each integrator and not rendered; simulate-1k, simulate-10k and simulate-100k, simulated by the default one; all
    /// but crowds and simulate-100k if none is named. `locks` measures how well the locks of each
    /// shipped hairstyle and of hair of 10 to 90 cm hold together in the shipped dance; `locks-long`, for example, measures only that
    /// style.
    /// `voxel-map` times the voxel map against the loop as published, and `occupancy-order` times blending by occupancy order against
    /// sorting exactly. `reference` writes scenes for a path tracer and our images of them; `reference-curly` and
    /// `reference-curly-red-side`, for example, write only some or one of them.
    pub(crate) scenes: Vec<BenchTarget>,
    /// Change a setting of every scene, such as simulation.gravity=12; may be given several times.
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = assignment)]
    pub(crate) set: Vec<Assignment>,
    /// File for the numbers as comma-separated values; for reference scenes their folder.
    #[arg(short, long, value_name = "FILE.csv")]
    pub(crate) out: Option<PathBuf>,
    /// Replace a file of that name that this program did not make. Its own are always replaced.
    #[arg(long, requires = "out")]
    pub(crate) force: bool,
    /// Number of strands in reference scenes, 100 to 120000; 12000 if none is given. Fewer strands are wider.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(100..=120_000))]
    pub(crate) strands: Option<u32>,
    /// Earlier run to compare with: the output of `lovelock bench --json`. Stages are compared by their multiples of the machine's
    /// yardstick, so the earlier run may come from another machine; those that slowed by over 10 % are marked.
    #[arg(long, value_name = "FILE.json", conflicts_with = "threads")]
    pub(crate) baseline: Option<PathBuf>,
    /// Measure the scenes with each of these numbers of threads, 1 to 256, such as 1,2,4, on the CPU backend. Prints the time and the
    /// speed-up of every stage.
    #[arg(long, value_name = "N,N", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..=256))]
    pub(crate) threads: Vec<u32>,
    /// Frames to measure, 1 to 1000; steps of 1/60 s in scenes that are not rendered.
    #[arg(long, default_value_t = 15, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) frames: u32,
    /// Size in pixels; that of the scene if none is given: 1280x720, 800x600 for woman-300k and dog-2m, and 384x384 for reference
    /// scenes.
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub(crate) size: Option<(u32, u32)>,
    /// Shadow method; that of the scene if none is given.
    #[arg(long, value_name = "ID")]
    pub(crate) shadow: Option<ShadowMethod>,
    /// Shadow method of your own: a folder with method.toml and its shader.
    #[arg(long, value_name = "FOLDER", value_parser = user_method, conflicts_with = "shadow")]
    pub(crate) method: Option<UserMethod>,
    /// What hair is drawn as: strands, clusters or auto; the choice of the scene if none is given.
    #[arg(long, value_name = "ID")]
    pub(crate) draw: Option<HairDrawing>,
    /// How overlapping strands are blended; the choice of the scene if none is given.
    #[arg(long, value_name = "ID")]
    pub(crate) transparency: Option<Transparency>,
    /// Backend to measure; both if none is given.
    #[arg(long, value_name = "BACKEND")]
    pub(crate) backend: Option<Backend>,
    /// What simulates the hair of scenes that are not rendered: cpu, gpu (any wgpu adapter, including a software one) or auto; that of
    /// the setting picture.simulate if none is given, which is cpu.
    #[arg(long, value_name = "BACKEND")]
    pub(crate) simulate: Option<Backend>,
}

#[derive(Debug, Args)]
pub(crate) struct Papers {
    #[arg(help = format!("Figures, or the beginnings of their names before a dash, such as mertens; all if none is given: {}", figure_ids().join(", ")))]
    pub(crate) figures: Vec<String>,
    /// Folder for the page papers.html, its data and its images. Other figures that it holds stay on the page.
    #[arg(short, long, value_name = "DIR", default_value = "papers")]
    pub(crate) out: PathBuf,
    /// Replace files named papers.html and papers.json that this program did not make. Its own, and the images and projects beside them,
    /// are always replaced.
    #[arg(long)]
    pub(crate) force: bool,
    /// Size of each image in pixels.
    #[arg(long, value_name = "WxH", value_parser = size, default_value = "480x480")]
    pub(crate) size: (u32, u32),
    /// Frames of each measured time, 1 to 1000.
    #[arg(long, default_value_t = 9, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) frames: u32,
    /// Backend: auto (the graphics card if there is a real one), gpu or cpu.
    #[arg(long, value_name = "BACKEND", default_value = "auto")]
    pub(crate) backend: Backend,
}

#[derive(Debug, Args)]
pub(crate) struct Presets {
    /// Hairstyle to list or draw, as --preset of `lovelock record`; may be given several times. All if none is given.
    #[arg(long, value_name = "ID")]
    pub(crate) preset: Vec<String>,
    /// Draw a contact sheet with names as this PNG file: each hairstyle at rest.
    #[arg(long, value_name = "PNG")]
    pub(crate) sheet: Option<PathBuf>,
    /// Give each hairstyle a row of the sheet with this many instants of the dance.
    #[arg(long, value_name = "N", requires = "sheet", num_args = 0..=1, default_missing_value = "6",
        value_parser = clap::value_parser!(u32).range(1..=60))]
    pub(crate) dance: Option<u32>,
    /// Give each hairstyle a row of the sheet with views of it at rest from this many sides.
    #[arg(long, value_name = "N", requires = "sheet", conflicts_with = "dance", num_args = 0..=1, default_missing_value = "4",
        value_parser = clap::value_parser!(u32).range(1..=60))]
    pub(crate) sides: Option<u32>,
    /// Size of each picture of the sheet in pixels.
    #[arg(long, value_name = "WxH", requires = "sheet", value_parser = size)]
    pub(crate) size: Option<(u32, u32)>,
    /// Hairstyles side by side in the sheet.
    #[arg(long, value_name = "N", requires = "sheet", value_parser = clap::value_parser!(u32).range(1..=100))]
    pub(crate) columns: Option<u32>,
    /// Replace an existing file of the name of the sheet or of a thumbnail even if it is no image of this program.
    #[arg(long)]
    pub(crate) force: bool,
    /// Write the thumbnails of the window's browser into this folder, as ID.jpg; the program's own are in assets/styles.
    #[arg(long, value_name = "DIR", conflicts_with = "sheet")]
    pub(crate) thumbnails: Option<PathBuf>,
    /// Change a setting of each hairstyle in the sheet, such as camera.azimuth=90; may be given several times.
    #[arg(long = "set", value_name = "NAME=VALUE", requires = "sheet", value_parser = assignment)]
    pub(crate) set: Vec<Assignment>,
    /// Backend: auto (the graphics card if there is a real one), gpu or cpu. Thumbnails are always drawn by cpu.
    #[arg(long, value_name = "BACKEND", requires = "sheet")]
    pub(crate) backend: Option<Backend>,
}

#[derive(Debug, Args)]
pub(crate) struct SettingsTask {
    /// Only settings whose names begin with this, such as simulation.wind.
    pub(crate) section: Option<String>,
    /// Print tables in Markdown, as in the documents.
    #[arg(long, conflicts_with = "json")]
    pub(crate) markdown: bool,
}

#[derive(Debug, Args)]
pub(crate) struct Info {
    /// The file.
    pub(crate) file: PathBuf,
    /// Unit of a hair file: auto, m, cm, mm or in.
    #[arg(long, default_value = "auto", value_parser = unit)]
    pub(crate) unit: Unit,
    #[arg(
        long, value_name = "AXIS", default_value = "auto", allow_hyphen_values = true, value_parser = up_axis,
        help = up_axis_help("a hair file")
    )]
    pub(crate) up: UpAxis,
}

#[derive(Debug, Args)]
pub(crate) struct Convert {
    #[arg(value_name = "IN", help = format!("The hair file: .{}", HairFormat::all_extensions().join(", .")))]
    pub(crate) input: PathBuf,
    #[arg(help = format!("The new file, in the format of its extension: .{}", written_extensions().join(", .")))]
    pub(crate) out: PathBuf,
    /// Replace the new file if it already exists.
    #[arg(long)]
    pub(crate) force: bool,
    /// Unit of IN: auto, m, cm, mm or in.
    #[arg(long, default_value = "auto", value_parser = unit)]
    pub(crate) unit: Unit,
    #[arg(
        long, value_name = "AXIS", default_value = "auto", allow_hyphen_values = true, value_parser = up_axis,
        help = up_axis_help("IN")
    )]
    pub(crate) up: UpAxis,
    /// Include strands that IN hides, and guides or proxies that stand for other strands.
    #[arg(long)]
    pub(crate) include_hidden: bool,
}

#[derive(Debug, Args)]
pub(crate) struct StyleTask {
    #[command(flatten)]
    pub(crate) source: SourceArguments,
    /// Recorded strokes, a .lovelockstrokes file. Each is played at its time of the dance.
    #[arg(long, value_name = "FILE")]
    pub(crate) strokes: PathBuf,
    /// Play only this many strokes, from the first; all by default.
    #[arg(long, value_name = "N")]
    pub(crate) count: Option<usize>,
    /// Play strokes that were made on the body at rest one after another, starting at this second of the dance; they move with the head.
    #[arg(long, value_name = "SECONDS")]
    pub(crate) on_dance: Option<f64>,
    /// The new project.
    #[arg(short, long, value_name = "OUT")]
    pub(crate) out: PathBuf,
    /// Replace the new project if it already exists.
    #[arg(long)]
    pub(crate) force: bool,
    /// Record the strokes as a film (.mp4), with the size and rate of the project's recordings. A circle shows the brush.
    #[arg(long, value_name = "FILE")]
    pub(crate) film: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct Farm {
    #[command(flatten)]
    pub(crate) source: SourceArguments,
    /// Folder for the job, new or empty: template.json and the project with its files.
    #[arg(short, long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    #[command(flatten)]
    pub(crate) film: FilmArguments,
    /// Frames per task; 10, or more if that would make more than 1024 tasks.
    #[arg(long, value_name = "N")]
    pub(crate) chunk: Option<u64>,
}

#[derive(Debug, Args)]
pub(crate) struct Assemble {
    /// Folder whose subfolders contain the parts.
    pub(crate) parts: PathBuf,
    /// Folder for the joined sequence.
    #[arg(short, long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Frames of the whole sequence, half open.
    #[arg(long, value_name = "A..B", value_parser = frames)]
    pub(crate) frames: Range<u64>,
    /// Replace images that this program did not make.
    #[arg(long)]
    pub(crate) force: bool,
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn unknown_methods_are_refused_with_the_known_ones() {
        let error = Arguments::try_parse_from(["lovelock", "record", "-o", "x.mp4", "--shadow", "magic"])
            .expect_err("no such method")
            .to_string();
        assert!(error.contains("voxel-map") && error.contains("magic"), "{error}");
        assert!(Arguments::try_parse_from(["lovelock", "record"]).is_err(), "no output");
        let window = Arguments::try_parse_from(["lovelock", "my project.ron"]).expect("a project");
        assert_eq!(window.project, Some(PathBuf::from("my project.ron")));
    }
}
