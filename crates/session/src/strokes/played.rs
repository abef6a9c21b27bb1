//! Playing recorded strokes on the hair of a project.

use std::ops::ControlFlow;
use std::path::Path;

use glam::{Affine3A, Vec3};
use lovelock_brush::{RecordedStroke, StrokeFile, Tool};
use lovelock_motion::{Pose, pose_at};
use lovelock_project::Project;
use lovelock_project::error::{Problem, ProjectError};
use lovelock_project::files::Access;
use lovelock_project::project::{read_text, refuse_foreign};
use lovelock_style::hand::HandEdits;
use lovelock_style::operations::Hand;
use lovelock_style::{Layer, StyleStack};
use serde::Serialize;

use crate::clock::STEP_SECS;
use crate::engine::{BrushLayers, Engine};
use crate::prepare::load;
use crate::progress::{Progress, report_progress};

/// A stroke that begins later than this is not simulated up to, but the hair is settled there, seconds.
const LONGEST_WAY_SECS: f64 = 10.0;
/// Time between strokes that are played one after another, seconds.
const PAUSE_SECS: f64 = 0.35;
/// How long the hair is followed after the last stroke, seconds.
const AFTER_SECS: f64 = 1.5;

/// What playing strokes did.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct StrokesReport {
    /// Number of strokes.
    pub strokes: usize,
    /// Number of strokes that touched no hair.
    pub missed: usize,
    /// Number of guides that the layer changes, those beside them included.
    pub places: usize,
    /// The number of the layer with the edits.
    pub layer: u32,
}

/// The brush of the stroke that is being played.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlayedBrush {
    /// Where it is, world space.
    pub position: Vec3,
    /// Radius, metres.
    pub radius: f32,
}

/// Follows the hair while strokes are played: called once after each step, and once for each sample that comes without one, with the project
/// as it is by then.
pub type SeeStrokes<'a> =
    &'a mut dyn FnMut(&mut Engine, &Project, Option<PlayedBrush>) -> Result<(), ProjectError>;

/// How strokes are played.
#[derive(Default)]
pub struct PlayStrokes<'a> {
    /// The strokes were made on the body at rest. They are played one after another from this time of the dance on, seconds, and carried along
    /// with the head.
    pub dance_from_secs: Option<f64>,
    /// Follows the hair; then it is simulated for a while after the last stroke, too.
    pub see: Option<SeeStrokes<'a>>,
}

/// The extension of files of recorded strokes, without the dot.
pub const STROKES_EXTENSION: &str = StrokeFile::EXTENSION;

/// Reads recorded strokes.
///
/// # Errors
/// The file cannot be read, or holds something else.
pub fn read_strokes(path: &Path) -> Result<StrokeFile, ProjectError> {
    let what = "stroke recording";
    let text = read_text(path, what, StrokeFile::LONGEST as u64)?;
    refuse_foreign(path, &text, what)?;
    let wrong = |error| ProjectError::input(path, format!("{}: {error}", path.display()));
    StrokeFile::from_text(&text).map_err(wrong)
}

/// How many samples of the strokes were played. Reported between two steps, so that a long stroke can be cancelled.
struct PlayProgress<'a> {
    progress: &'a mut dyn FnMut(Progress) -> ControlFlow<()>,
    done: u64,
    total: u64,
}

impl PlayProgress<'_> {
    fn report(&mut self) -> Result<(), ProjectError> {
        let (done, total) = (self.done, self.total);
        report_progress(self.progress, Progress::Simulating { done, total })
    }

    fn add(&mut self, samples: usize) -> Result<(), ProjectError> {
        self.done += samples as u64;
        self.report()
    }
}

/// Plays strokes at their times and returns the project with what they did, in its last layer of edits by hand or in a new one.
///
/// Strokes that follow each other within a few seconds are played on the same dance. Before any other stroke the hair is settled at the
/// time of the stroke.
///
/// # Errors
/// A take, a morph, a stack without room for a layer, what cannot be loaded, an error of `see`, or [`ProjectError::Cancelled`].
pub fn play_strokes(
    project: &Project,
    access: &Access,
    file: &StrokeFile,
    PlayStrokes { dance_from_secs, see }: PlayStrokes<'_>,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<(Project, StrokesReport, Vec<Problem>), ProjectError> {
    if project.take.file.is_some() {
        return Err(ProjectError::option(
            "--strokes: found a take, which plays as recorded; must be a project",
        ));
    }
    if project.hair.morph.to.is_some() {
        let why = "--strokes: found hair between two styles, which cannot be brushed; must be a project without a morph";
        return Err(ProjectError::option(why));
    }
    let mut project = project.clone();
    let layer = layer_of(&mut project.hair.stack)?;
    let (watched, nobody) = (see.is_some(), &mut |_: &mut Engine, _: &Project, _| Ok(()));
    let see = see.unwrap_or(nobody);
    let (scene, problems) = load(&project, access, progress)?;
    let mut engine = Engine::at_rest(scene, project.simulation, STEP_SECS);
    engine.follow(&project);
    let on_dance = dance_from_secs.map(|from| (one_after_another(file, from), head_from_rest(&engine)));
    let (strokes, carried) = match &on_dance {
        Some((strokes, head_from_rest)) => (strokes, Some(head_from_rest)),
        None => (&file.strokes, None),
    };
    let mut report = StrokesReport { strokes: file.strokes.len(), layer, ..StrokesReport::default() };
    let mut layers = BrushLayers::default();
    let mut frozen = Vec::new();
    let total = strokes.iter().map(|stroke| stroke.samples.len() as u64).sum();
    let mut played = PlayProgress { progress, done: 0, total };
    for (i, stroke) in strokes.iter().enumerate() {
        let Some(first) = stroke.samples.first() else {
            report.missed += 1;
            continue;
        };
        reach(&mut engine, first.time_secs, i == 0, &mut played, &mut |engine| see(engine, &project, None))?;
        let stroke_on = (stroke, carried);
        let show = &mut |engine: &mut Engine, brush| see(engine, &project, Some(brush));
        let (touched, stack) =
            play(&mut engine, &mut layers, stroke_on, layer, &mut frozen, &mut played, show)?;
        report.missed += usize::from(touched == 0 && stroke.tool != Tool::Freeze);
        project.hair.stack = stack.unwrap_or(project.hair.stack);
    }
    if watched {
        let end = engine.time_secs() + AFTER_SECS;
        reach(&mut engine, end, false, &mut played, &mut |engine| see(engine, &project, None))?;
    }
    report.places = project.hair.stack.hand(layer).map_or(0, HandEdits::count);
    Ok((project, report, problems))
}

/// The layer that takes the edits.
fn layer_of(stack: &mut StyleStack) -> Result<u32, ProjectError> {
    stack.hand_layer(None).or_else(|| stack.push(Layer::of(Hand::default()))).ok_or_else(|| {
        let most = StyleStack::MAX_LAYERS;
        ProjectError::option(format!(
            "--strokes: found a style of {most} layers; must have fewer, because a layer is added"
        ))
    })
}

/// The strokes one after another from a time on: a sample per step, and a pause between strokes.
fn one_after_another(file: &StrokeFile, from_secs: f64) -> Vec<RecordedStroke> {
    let mut strokes = file.strokes.clone();
    let mut time_secs = from_secs;
    for stroke in &mut strokes {
        for sample in &mut stroke.samples {
            sample.time_secs = time_secs;
            time_secs += STEP_SECS;
        }
        time_secs += PAUSE_SECS;
    }
    strokes
}

/// Carries the world of the body at rest to the space of its head.
fn head_from_rest(engine: &Engine) -> Affine3A {
    let mut rest = Pose::default();
    pose_at(&engine.scene().body, None, 0.0, &mut rest);
    rest.world_from_head.inverse()
}

/// Brings the engine to a time, by simulation if it is near.
fn reach(
    engine: &mut Engine,
    time_secs: f64,
    afresh: bool,
    played: &mut PlayProgress<'_>,
    see: &mut dyn FnMut(&mut Engine) -> Result<(), ProjectError>,
) -> Result<(), ProjectError> {
    let step = (time_secs.max(0.0) / engine.step_secs()).round() as i64;
    let ahead = (step - engine.at_step()) as f64 * engine.step_secs();
    if afresh || !(0.0..=LONGEST_WAY_SECS).contains(&ahead) {
        engine.seek(time_secs);
        let mut preroll = engine.preroll();
        while !preroll.advance() {
            played.report()?;
        }
        engine.take_settled(preroll);
    }
    while engine.at_step() < step {
        engine.step();
        see(engine)?;
        played.report()?;
    }
    Ok(())
}

/// Plays one stroke. Returns how often it changed a guide, and the layers with it.
fn play(
    engine: &mut Engine,
    layers: &mut BrushLayers,
    (stroke, head_from_rest): (&RecordedStroke, Option<&Affine3A>),
    layer: u32,
    frozen: &mut Vec<bool>,
    played: &mut PlayProgress<'_>,
    see: &mut dyn FnMut(&mut Engine, PlayedBrush) -> Result<(), ProjectError>,
) -> Result<(usize, Option<StyleStack>), ProjectError> {
    let tool = (stroke.tool, stroke.inverted);
    let Some(mut brush) = engine.begin_stroke(layers, tool, &stroke.settings, layer, frozen) else {
        played.add(stroke.samples.len())?;
        return Ok((0, None));
    };
    let mut touched = 0;
    for sample in &stroke.samples {
        let sample_at = |engine: &Engine| match head_from_rest {
            Some(head_from_rest) => sample.placed(&(engine.world_from_head() * *head_from_rest)),
            None => *sample,
        };
        let radius = stroke.settings.radius;
        let mut show = |engine: &mut Engine| {
            let position = sample_at(engine).position;
            see(engine, PlayedBrush { position, radius })
        };
        let step = engine.at_step();
        reach(engine, sample.time_secs, false, played, &mut show)?;
        if engine.at_step() == step {
            show(engine)?;
        }
        let sample = sample_at(engine);
        touched += engine.comb(&mut brush, &sample).len();
        played.add(1)?;
    }
    engine.let_go(&mut brush, head_from_rest.is_none());
    *frozen = brush.frozen().to_vec();
    Ok((touched, Some(engine.end_stroke(layers, &brush, layer))))
}

#[cfg(test)]
mod tests {
    use lovelock_brush::{BrushSettings, StrokeSample};

    use super::*;
    use crate::testing::small_project;

    /// A stroke around the wearer's left ear, at some seconds of the dance.
    fn stroke(engine: &mut Engine, tool: Tool, from_secs: f64) -> RecordedStroke {
        let at = |i: usize| Vec3::new(0.1, 0.06, 0.04 - 0.006 * i as f32);
        let mut samples = Vec::new();
        for i in 0..20 {
            let time_secs = from_secs + i as f64 / 60.0;
            engine.seek(time_secs);
            let pose = engine.snapshot().guides.world_from_head;
            samples.push(StrokeSample {
                position: pose.transform_point3(at(i)),
                view: pose.transform_vector3(Vec3::NEG_X),
                drag: if i > 0 { pose.transform_vector3(at(i) - at(i - 1)) } else { Vec3::ZERO },
                pressure: 1.0,
                time_secs,
            });
        }
        let settings = BrushSettings { radius: 0.06, ..BrushSettings::default() };
        RecordedStroke { tool, inverted: false, settings, samples }
    }

    #[test]
    fn strokes_are_played_at_their_times_into_one_layer() {
        let mut project = small_project();
        project.timeline.preroll_secs = 0.25;
        let go_on = &mut |_| ControlFlow::Continue(());
        let (scene, _) = load(&project, &Access::new(), go_on).expect("a scene");
        let mut engine = Engine::at_rest(scene, project.simulation, STEP_SECS);
        let far = RecordedStroke {
            samples: vec![StrokeSample { position: Vec3::splat(9.0), ..StrokeSample::default() }],
            ..RecordedStroke::default()
        };
        let file = StrokeFile::new(vec![
            stroke(&mut engine, Tool::Comb, 0.5),
            stroke(&mut engine, Tool::Curl, 1.0),
            far,
            RecordedStroke::default(),
        ]);
        let (made, report, _) =
            play_strokes(&project, &Access::new(), &file, PlayStrokes::default(), go_on).expect("a project");
        println!("{report:?}");
        assert_eq!((report.strokes, report.missed), (4, 2));
        assert!(report.places > 3);
        assert_eq!(made.hair.stack.layers.len(), project.hair.stack.layers.len() + 1);
        // The same strokes give the same bytes, and further ones go into the same layer.
        let (again, ..) =
            play_strokes(&project, &Access::new(), &file, PlayStrokes::default(), go_on).expect("a project");
        assert_eq!(again, made);
        let (more, next, _) =
            play_strokes(&made, &Access::new(), &file, PlayStrokes::default(), go_on).expect("a project");
        assert_eq!(next.layer, report.layer);
        assert_ne!(more, made);
        let mut between = project.clone();
        between.start_morph(&lovelock_project::styles::Style::default());
        let mut taken = project.clone();
        taken.take.file = Some(lovelock_project::files::FileRef::new("a.take"));
        for refused in [between, taken] {
            assert!(play_strokes(&refused, &Access::new(), &file, PlayStrokes::default(), go_on).is_err());
        }
        let cancelled = play_strokes(&project, &Access::new(), &file, PlayStrokes::default(), &mut |_| {
            ControlFlow::Break(())
        });
        assert!(matches!(cancelled, Err(ProjectError::Cancelled)));
    }

    #[test]
    fn a_long_stroke_is_cancelled_between_two_steps() {
        let mut project = small_project();
        project.timeline.preroll_secs = 0.25;
        let sample = |time_secs: f64| StrokeSample {
            position: Vec3::new(0.1, 0.06, 0.04),
            view: Vec3::NEG_X,
            pressure: 1.0,
            time_secs,
            ..StrokeSample::default()
        };
        let file_of = |times: &[f64]| {
            let samples = times.iter().copied().map(sample).collect();
            StrokeFile::new(vec![RecordedStroke { samples, ..RecordedStroke::default() }])
        };
        // Returns the steps and samples that were seen, and the last progress.
        let play = |times: &[f64], goes_on: &dyn Fn(u64, u64) -> bool| {
            let (mut seen, mut asked, mut last) = (0_u64, 0_u64, (0_u64, 0_u64));
            let mut see = |_: &mut Engine, _: &Project, _: Option<PlayedBrush>| {
                seen += 1;
                Ok(())
            };
            let how = PlayStrokes { dance_from_secs: None, see: Some(&mut see) };
            let mut follow = |progress: Progress| {
                if let Progress::Simulating { done, total } = progress {
                    (asked, last) = (asked + 1, (done, total));
                    if !goes_on(done, asked) {
                        return ControlFlow::Break(());
                    }
                }
                ControlFlow::Continue(())
            };
            let played = play_strokes(&project, &Access::new(), &file_of(times), how, &mut follow);
            let is_cancelled = matches!(played, Err(ProjectError::Cancelled));
            assert!(is_cancelled || played.is_ok());
            (is_cancelled, seen, last)
        };
        // While the hair settles before the stroke.
        assert_eq!(play(&[0.5], &|_, asked| asked < 3), (true, 0, (0, 1)));
        let many: Vec<f64> = (0..1000).map(|i| 0.5 + f64::from(i) / 60.0).collect();
        let (is_cancelled, seen, last) = play(&many, &|done, _| done < 3);
        assert_eq!((is_cancelled, last), (true, (3, 1000)));
        assert!(seen < 20, "{seen} steps");
        // On the long way to a sample, after at most thirty steps of settling.
        let (is_cancelled, seen, last) = play(&[0.5, 9.5], &|_, asked| asked < 100);
        assert_eq!((is_cancelled, last), (true, (1, 2)));
        assert!((60..100).contains(&seen), "{seen} steps");
        // Control: nobody cancels.
        let (is_cancelled, seen, last) = play(&many[..5], &|_, _| true);
        assert_eq!((is_cancelled, last), (false, (5, 5)));
        assert!(seen >= 5, "{seen} steps");
    }

    #[test]
    fn strokes_made_at_rest_are_carried_along_with_the_dancing_head() {
        let mut project = small_project();
        project.timeline.preroll_secs = 0.25;
        let go_on = &mut |_| ControlFlow::Continue(());
        let (scene, _) = load(&project, &Access::new(), go_on).expect("a scene");
        let engine = Engine::at_rest(scene, project.simulation, STEP_SECS);
        let rest = head_from_rest(&engine).inverse();
        let ear = Vec3::new(0.1, 0.06, 0.04);
        let sample = |i: usize| StrokeSample {
            position: rest.transform_point3(ear - Vec3::Z * (0.006 * i as f32)),
            view: rest.transform_vector3(Vec3::NEG_X),
            drag: if i > 0 { rest.transform_vector3(Vec3::NEG_Z * 0.006) } else { Vec3::ZERO },
            pressure: 1.0,
            ..StrokeSample::default()
        };
        let stroke = RecordedStroke {
            samples: (0..12).map(sample).collect(),
            settings: BrushSettings { radius: 0.06, ..BrushSettings::default() },
            ..RecordedStroke::default()
        };
        let file = StrokeFile::new(vec![stroke.clone(), stroke]);
        let mut seen = Vec::new();
        let mut see = |engine: &mut Engine, _: &Project, brush: Option<PlayedBrush>| {
            let head_from_world = engine.world_from_head().inverse();
            seen.push((
                engine.time_secs(),
                brush.map(|brush| head_from_world.transform_point3(brush.position)),
            ));
            Ok(())
        };
        let how = PlayStrokes { dance_from_secs: Some(0.5), see: Some(&mut see) };
        let (_, report, _) = play_strokes(&project, &Access::new(), &file, how, go_on).expect("a project");
        assert_eq!(report.missed, 0, "on the dance the brush meets the same hair");
        // One step per sample, the pause, and the time after the last stroke.
        let end = 0.5 + 24.0 * STEP_SECS + PAUSE_SECS + AFTER_SECS;
        let (last, _) = seen[seen.len() - 1];
        assert!((last - end).abs() < 3.0 * STEP_SECS, "{last} of {end}");
        assert!(seen.windows(2).all(|pair| pair[1].0 >= pair[0].0));
        let brushes: Vec<Vec3> = seen.iter().filter_map(|(_, brush)| *brush).collect();
        assert!(brushes.len() >= 24);
        for brush in brushes {
            assert!((brush - ear).reject_from_normalized(Vec3::Z).length() < 1e-4, "{brush}");
        }
        // At the same places of the world the dancing head is elsewhere.
        let (_, still, _) =
            play_strokes(&project, &Access::new(), &file, PlayStrokes::default(), go_on).expect("a project");
        assert_ne!(still.places, 0);
    }
}
