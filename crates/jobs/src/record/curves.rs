//! Exports hair and body as animated curves for other programs: USD, glTF and Alembic.

use std::ops::ControlFlow;
use std::path::Path;
use std::str::FromStr;
use std::sync::Arc;

use glam::{Affine3A, Vec3};
use lovelock_base::clock::Stopwatch;
use lovelock_base::settings::Settings;
use lovelock_groom::fine::lock_numbers;
use lovelock_groom::{
    ColourSamples, HairLook, Hairstyle, PigmentVariation, StrandMarks, StrandSet, Strands, colour_along,
};
use lovelock_motion::Body;
use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_record::{
    BodyFrame, CurveBody, CurveFormat, CurveFrame, CurveScene, CurveWriter, FrameRate, RecordError,
};
use lovelock_session::dance::Dance;
use lovelock_session::new_folders::NewFolders;
use lovelock_session::prepare::check_frames;
use lovelock_session::progress::{Progress, report_progress};
use lovelock_session::snapshot::FrameSnapshot;
use serde::Serialize;

use super::request::RecordRequest;

/// Which curves are exported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveSource {
    /// The simulated guides, a few hundred.
    Guides,
    /// All rendered strands.
    Strands,
}

impl CurveSource {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Guides, Self::Strands];

    /// Stable name for command lines and reports.
    pub fn id(self) -> &'static str {
        match self {
            Self::Guides => "guides",
            Self::Strands => "strands",
        }
    }
}

impl FromStr for CurveSource {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = Self::ALL.into_iter().find(|source| source.id() == text);
        known.ok_or_else(|| format!("unknown curves `{text}`: must be guides or strands"))
    }
}

/// The result, as `record --json` prints it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CurveRecordReport {
    /// The file.
    pub out: String,
    /// `usda`, `usdc`, `glb` or `abc`.
    pub format: String,
    /// `guides` or `strands`.
    pub curves: String,
    /// Number of curves.
    pub strands: u64,
    /// Total number of points.
    pub points: u64,
    /// Vertices of the body; 0 without a body.
    pub vertices: u64,
    /// Number of frames.
    pub frames: u64,
    /// Number of the first one.
    pub first_frame: u64,
    /// Frames per second.
    pub fps: f64,
    /// Bytes written.
    pub bytes: u64,
    /// Total time without loading, milliseconds.
    pub ms: f64,
    /// Hash of the last simulated state, 16 hexadecimal digits; empty for a take.
    pub state_hash: String,
    /// Notes, such as parts that could not be loaded, as sentences.
    pub notes: Vec<String>,
}

/// Whether an output name has the extension of a curve format.
pub fn is_curves(path: &Path) -> bool {
    CurveFormat::of(path).is_some()
}

/// Simulates a project, or plays its take, and writes the curves of its hair and body frame by frame.
///
/// # Errors
/// As [`super::record`]; also if the strands change during the range, or the file would be too large.
pub fn record_curves(
    project: &Project,
    request: &RecordRequest,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<CurveRecordReport, ProjectError> {
    let (project, _) = project.sanitised();
    let out = &request.out;
    let format = CurveFormat::of(out).ok_or_else(|| {
        ProjectError::option(format!("{}: must end in .usdc, .usd, .usda, .glb or .abc", out.display()))
    })?;
    refuse_options_of_pictures(request)?;
    let fps = request.fps.unwrap_or(project.recording.fps);
    let rate = FrameRate::from_fps(fps).map_err(ProjectError::option)?;
    if let Some(frames) = &request.frames {
        check_frames(frames)?;
    }
    // All strands in every frame are too much for glTF viewers.
    let usual = if format == CurveFormat::Glb { CurveSource::Guides } else { CurveSource::Strands };
    let source = request.curves.unwrap_or(usual);

    let (mut dance, mut problems) = Dance::open(&project, &request.access, fps, progress)?;
    let seamless = request.seamless || project.recording.seamless;
    let whole = if seamless { dance.frames_of_round() } else { dance.frames() };
    let frames = request.frames.clone().unwrap_or_else(|| project.recording.frame_range(whole));
    check_frames(&frames)?;
    dance.check(&frames)?;
    if seamless {
        dance.close(&frames)?;
    } else {
        dance.play_once(&frames, &mut problems);
    }
    report_progress(progress, Progress::Loaded { problems: problems.clone() })?;
    dance.begin(frames.start, dance.secs_of(frames.start), progress)?;

    let watch = Stopwatch::start();
    let first = dance.snapshot(frames.start)?;
    let body = (!request.no_body).then(|| body_of(&first));
    let mut scene = curves_of(source, &first.scene.style, &first.look(&project));
    if let (CurveSource::Strands, Some(hair)) = (source, &first.scene.skin_hair) {
        add_strands(&mut scene, &hair.style.strands, &first.skin_look(&project, hair));
        scene.marks.add_group("brows and lashes", hair.count());
    }
    (scene.rate, scene.first_frame, scene.frames) = (rate, frames.start, frames.end - frames.start);
    scene.body = body;
    let (strands, points) = (scene.curves() as u64, scene.points() as u64);
    let vertices = scene.body.as_ref().map_or(0, |body| body.bind_positions.len() as u64);
    // Created before the writer, so that it is dropped after it.
    let _new_folders = NewFolders::missing_on(out);
    let refused = |error: RecordError| refused(out, &error);
    let mut writer = CurveWriter::create(out, scene).map_err(refused)?;
    let mut moved = Moved::default();
    for frame in frames.clone() {
        let snapshot = if frame == frames.start { Arc::clone(&first) } else { dance.snapshot(frame)? };
        check_same(&first, &snapshot, source, frame)?;
        writer.push(&moved.frame(source, &snapshot, vertices > 0)).map_err(refused)?;
        let (done, total) = (frame + 1 - frames.start, frames.end - frames.start);
        report_progress(progress, Progress::Frame { done, total, steps_per_frame: dance.steps_per_frame() })?;
    }
    report_progress(progress, Progress::Finishing)?;
    let written = writer.finish().map_err(refused)?;
    problems.extend(dance.notices());
    let notes: Vec<String> = problems.iter().map(ToString::to_string).collect();
    Ok(CurveRecordReport {
        out: out.display().to_string(),
        format: format.id().to_owned(),
        curves: source.id().to_owned(),
        strands,
        points,
        vertices,
        frames: written.frames,
        first_frame: frames.start,
        fps,
        bytes: written.bytes,
        ms: watch.ms(),
        state_hash: dance.state_hash().map_or_else(String::new, |hash| format!("{hash:016x}")),
        notes,
    })
}

fn refuse_options_of_pictures(request: &RecordRequest) -> Result<(), ProjectError> {
    match request.option_of_pictures() {
        Some(option) => {
            Err(ProjectError::option(format!("{option}: {} holds curves, not images", request.out.display())))
        }
        None => Ok(()),
    }
}

fn refused(out: &Path, error: &RecordError) -> ProjectError {
    let file = Some(error.path().unwrap_or(out).to_owned());
    let message = error.to_string();
    if error.is_request() {
        ProjectError::Request { file, message }
    } else {
        ProjectError::Work { file, message }
    }
}

/// Rejects hair or a body whose topology differs from the first frame.
fn check_same(
    first: &FrameSnapshot,
    now: &FrameSnapshot,
    source: CurveSource,
    frame: u64,
) -> Result<(), ProjectError> {
    if Arc::ptr_eq(&first.scene, &now.scene) {
        return Ok(());
    }
    let (old, new) = (&first.scene.style, &now.scene.style);
    let same_hair = match source {
        CurveSource::Guides => {
            (old.guides.points_per_guide, old.guides.x.len())
                == (new.guides.points_per_guide, new.guides.x.len())
        }
        CurveSource::Strands => {
            let of_skin = [first, now].map(|snapshot| snapshot.skin_strands.points());
            old.strands.first_point == new.strands.first_point && of_skin[0] == of_skin[1]
        }
    };
    let (old_body, new_body) = (&first.scene.body, &now.scene.body);
    let same_body = Arc::ptr_eq(old_body, new_body)
        || old_body.mesh.triangles == new_body.mesh.triangles
            && old_body.skin.palette == new_body.skin.palette;
    if same_hair && same_body {
        return Ok(());
    }
    let what = if same_hair { "the body" } else { "the hair" };
    Err(ProjectError::option(format!(
        "frame {frame}: the structure of {what} changes here, and a file can hold only one: write the frames before it and \
         from it on to separate files, with --frames"
    )))
}

/// The curves with their rendered widths and colours.
fn curves_of(source: CurveSource, style: &Hairstyle, look: &HairLook) -> CurveScene {
    let mut scene = CurveScene {
        rate: FrameRate { num: 30, den: 1 },
        first_frame: 0,
        frames: 1,
        first_point: Vec::new(),
        widths: Vec::new(),
        colors: Vec::new(),
        are_guides: source == CurveSource::Guides,
        marks: StrandMarks::default(),
        body: None,
    };
    let look = look.clamped();
    match source {
        CurveSource::Guides => {
            let (count, per) = (style.guides.count(), style.guides.points_per_guide);
            // As wide as a strand. If they were as wide as all hair together, they would hide its shape.
            let width = look.shadow_width(style.strands.count()) * look.width_scale;
            scene.first_point = (0..=count as u32).map(|guide| guide * per as u32).collect();
            scene.widths = vec![width; count * per];
            // A guide stands for several locks, and has the colour of most of them.
            let look = HairLook { grey: 0.0, highlights: 0.0, ..look };
            scene.marks = marks_of_guides(style);
            let colours = colours_of_guides(style);
            for guide in 0..count {
                let own = colours.get(guide);
                scene.colors.extend((0..per).map(|p| color(&look, p as f32 / (per - 1) as f32, 0.5, 0, own)));
            }
        }
        CurveSource::Strands => {
            scene.first_point = vec![0];
            scene.marks.clone_from(&style.strands.marks);
            add_strands(&mut scene, &style.strands, &look);
        }
    }
    scene
}

/// Adds strands with their rendered widths and colours.
fn add_strands(scene: &mut CurveScene, set: &StrandSet, look: &HairLook) {
    let width = look.shadow_width(set.count()) * look.width_scale;
    let before = scene.widths.len() as u32;
    scene.first_point.extend(set.first_point.iter().skip(1).map(|first| before + first));
    scene.widths.extend(set.taper.iter().map(|taper| taper * width));
    let locks = lock_numbers(set);
    let strands = set.first_point.array_windows().zip(&set.shade).zip(locks).enumerate();
    for (strand, ((&[start, end], &shade), lock)) in strands {
        let last = (end - start - 1).max(1) as f32;
        let own = set.colours.strands().get(strand);
        scene.colors.extend((0..end - start).map(|p| color(look, p as f32 / last, shade, lock, own)));
    }
}

/// Colour at the fraction `along` of a strand with that shade, of a lock with that number; linear sRGB, as rendered in uniform light.
/// `own` are the colours that layers gave the strand.
fn color(look: &HairLook, along: f32, shade: f32, lock: u8, own: Option<&ColourSamples>) -> Vec3 {
    let variation = PigmentVariation::of(look);
    let absorption = look.absorption() * variation.factor(along, shade, i32::from(lock));
    let absorption = own.map_or(absorption, |own| {
        let [kept, added @ ..] = colour_along(own, along);
        kept * absorption + Vec3::from(added) * variation.varied(shade)
    });
    HairLook::body_color(absorption)
}

/// For each guide the colours of the strand that follows it most closely; empty if strands have no colours of their own.
fn colours_of_guides(style: &Hairstyle) -> Vec<ColourSamples> {
    let set = &style.strands;
    if set.colours.is_empty() {
        return Vec::new();
    }
    let mut nearest = vec![(f32::NEG_INFINITY, ColourSamples::default()); style.guides.count()];
    for ((wisp, weights), samples) in set.wisp.iter().zip(&set.weights).zip(set.colours.strands()) {
        for (guide, weight) in style.wisps[*wisp as usize].guides.into_iter().zip(weights) {
            let found = &mut nearest[guide as usize];
            if *weight <= 1.0 && *weight > found.0 {
                *found = (*weight, *samples);
            }
        }
    }
    nearest.into_iter().map(|(_, samples)| samples).collect()
}

/// The groups of the guides: those of the first strands of their wisps. A guide that follows no strand is in group 0.
fn marks_of_guides(style: &Hairstyle) -> StrandMarks {
    let marks = &style.strands.marks;
    if marks.groups.is_empty() {
        return StrandMarks::default();
    }
    let mut groups = vec![0; style.guides.count()];
    for wisp in style.wisps.iter().filter(|wisp| wisp.strand_count > 0) {
        for guide in wisp.guides {
            groups[guide as usize] = marks.group(wisp.first_strand as usize);
        }
    }
    StrandMarks { groups, group_names: marks.group_names.clone(), root_uvs: Vec::new() }
}

fn body_of(snapshot: &FrameSnapshot) -> CurveBody {
    let body: &Body = &snapshot.scene.body;
    CurveBody {
        triangles: body.mesh.triangles.clone(),
        colors: body.mesh.colors.clone(),
        opacity: body.mesh.opacity.clone(),
        coordinates: body.mesh.coordinates.clone(),
        materials: body.materials.clone(),
        of_triangles: body.mesh.materials.clone(),
        images: body.images.clone(),
        bind_positions: body.skin.positions.clone(),
        bind_normals: body.skin.normals.clone(),
        joints: body.skin.binds.clone(),
        weights: body.mesh.weights.clone(),
        joint_from_bind: body.skin.palette.iter().map(|bind| bind.joint_from_bind).collect(),
        morphs: body.skin.morphs.clone(),
    }
}

/// Buffers of one frame.
#[derive(Default)]
struct Moved {
    strands: Strands,
    joints: Vec<Affine3A>,
}

impl Moved {
    fn frame<'a>(
        &'a mut self,
        source: CurveSource,
        snapshot: &'a FrameSnapshot,
        with_body: bool,
    ) -> CurveFrame<'a> {
        let points = match source {
            CurveSource::Guides => {
                let guides = &snapshot.guides.guides;
                [&guides.x[..], &guides.y, &guides.z]
            }
            CurveSource::Strands => {
                let (strands, more) = (&mut self.strands, &snapshot.skin_strands);
                snapshot.interpolate(strands);
                strands.x.extend_from_slice(&more.x);
                strands.y.extend_from_slice(&more.y);
                strands.z.extend_from_slice(&more.z);
                [&self.strands.x[..], &self.strands.y, &self.strands.z]
            }
        };
        let world = &snapshot.pose.world_from_joint;
        self.joints.clear();
        self.joints.extend(
            snapshot
                .scene
                .body
                .skin
                .palette
                .iter()
                .map(|bind| world.get(usize::from(bind.joint)).copied().unwrap_or(Affine3A::IDENTITY)),
        );
        let body = with_body.then(|| BodyFrame {
            positions: &snapshot.skin.positions,
            normals: &snapshot.skin.normals,
            joints: &self.joints,
            morph_weights: &snapshot.pose.morph_weights,
        });
        CurveFrame { points, body }
    }
}

#[cfg(test)]
mod tests {
    use lovelock_groom::{GroomSettings, PlainHead, StrandColour, StrandColours, UNPIGMENTED, grow};

    use super::*;

    #[test]
    fn colours_of_layers_are_written() {
        let settings = GroomSettings { wisps: 40, strands_per_wisp: 20, ..GroomSettings::default() };
        let mut style = grow(&settings, &PlainHead.scalp(32), &PlainHead).expect("hair");
        let look = HairLook { variation: 0.0, ..HairLook::default() };
        let before = curves_of(CurveSource::Strands, &style, &look);
        let red = Vec3::new(0.02, 1.5, 2.0);
        let mut tips = ColourSamples::default();
        tips[1..].fill(StrandColour::BELOW.toward(red, 1.0));
        style.strands.colours = StrandColours::new(vec![tips; style.strands.count()]);
        for source in [CurveSource::Strands, CurveSource::Guides] {
            let scene = curves_of(source, &style, &look);
            for ends in scene.first_point.windows(2) {
                let of = &scene.colors[ends[0] as usize..ends[1] as usize];
                assert!(of[of.len() - 1].abs_diff_eq(HairLook::body_color(red), 1e-6));
                assert_eq!(of[0], before.colors[0], "roots stay");
            }
        }
    }

    #[test]
    fn groups_of_an_imported_file_are_those_of_the_written_curves() {
        // 60 strands, of which every third is in group 7.
        let list = |of: &dyn Fn(usize) -> String| (0..60).map(of).collect::<Vec<_>>().join(", ");
        let points = |i: usize| {
            let (out, y) =
                (Vec3::new((i as f32 * 2.4).cos(), 0.0, (i as f32 * 2.4).sin()), 0.1 - 0.0005 * i as f32);
            let [a, b] = [0.08, 0.12].map(|radius| radius * out);
            format!("({}, {y}, {}), ({}, {y}, {})", a.x, a.z, b.x, b.z)
        };
        let group = |i: usize| if i.is_multiple_of(3) { "7".to_owned() } else { "2".to_owned() };
        let text = format!(
            "#usda 1.0\n(\n metersPerUnit = 1\n upAxis = \"Y\"\n)\ndef BasisCurves \"a\"\n{{\nuniform token type = \"linear\"\n\
             int[] curveVertexCounts = [{}]\npoint3f[] points = [{}]\n\
             int[] primvars:groom_group_id = [{}] (\n interpolation = \"uniform\"\n)\n}}\n",
            list(&|_| "2".to_owned()),
            list(&points),
            list(&group)
        );
        let file = lovelock_groom::load_hair_bytes("a.usda", text.as_bytes()).expect("hair");
        let settings = lovelock_groom::ImportSettings::default();
        let style = lovelock_groom::import(&file, &settings, &PlainHead.scalp(24)).expect("a style");
        let strands = curves_of(CurveSource::Strands, &style, &HairLook::default());
        let in_7 = |scene: &CurveScene| scene.marks.groups.iter().filter(|group| **group == 7).count();
        assert_eq!((strands.marks.groups.len(), in_7(&strands)), (60, 20));
        let guides = curves_of(CurveSource::Guides, &style, &HairLook::default());
        assert_eq!(guides.marks.groups.len(), guides.curves());
        assert!(in_7(&guides) > 0 && guides.marks.groups.iter().all(|group| [2, 7].contains(group)));
        // Negative control: grown hair has no groups.
        let grown = GroomSettings { wisps: 40, strands_per_wisp: 20, ..GroomSettings::default() };
        let grown = grow(&grown, &PlainHead.scalp(32), &PlainHead).expect("hair");
        assert!(curves_of(CurveSource::Strands, &grown, &HairLook::default()).marks.groups.is_empty());
    }

    #[test]
    fn strands_have_the_colours_that_they_are_rendered_with() {
        let settings = GroomSettings { wisps: 40, strands_per_wisp: 20, ..GroomSettings::default() };
        let style = grow(&settings, &PlainHead.scalp(32), &PlainHead).expect("hair");
        let plain = HairLook { variation: 0.0, tip_lightening: 0.0, ..HairLook::default() };
        let brown = HairLook::body_color(plain.absorption());
        // The colour of each strand's tip.
        let tips = |source, look: &HairLook| {
            let scene = curves_of(source, &style, look);
            let ends = scene.first_point.iter().skip(1);
            ends.map(|&end| scene.colors[end as usize - 1]).collect::<Vec<_>>()
        };
        assert!(tips(CurveSource::Strands, &plain).iter().all(|&tip| tip == brown));
        for (name, look, white, share) in [
            ("grey", HairLook { grey: 0.4, ..plain }, UNPIGMENTED, 0.4),
            ("lightened locks", HairLook { highlights: 0.25, highlight_lightening: 0.5, ..plain }, 0.5, 0.25),
        ] {
            let light = HairLook::body_color(look.absorption() * white);
            let tips = tips(CurveSource::Strands, &look);
            let lighter = tips.iter().filter(|&&tip| tip.abs_diff_eq(light, 1e-5)).count();
            let others = tips.iter().filter(|&&tip| tip == brown).count();
            assert_eq!(lighter + others, tips.len(), "{name}");
            let found = lighter as f32 / tips.len() as f32;
            println!("{name}: {found} of the strands");
            assert!((found - share).abs() < 0.1, "{name}: {found}");
        }
        let look = HairLook { grey: 1.0, highlights: 1.0, ..plain };
        assert!(tips(CurveSource::Guides, &look).iter().all(|&tip| tip == brown), "guides stand for all");
    }
}
