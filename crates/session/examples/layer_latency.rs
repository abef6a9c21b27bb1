//! The time from a change of a layer, and from a movement of a brush, to the image that shows it, while the dance plays and while it pauses:
//! `cargo run --release -p lovelock-session --example layer_latency -- [CHANGES] [WIDTHxHEIGHT]`.
//!
//! The threads are those of the window: the loader evaluates the stack, the simulation takes the new hair, and the render thread draws
//! on the CPU. It prints the spread for the smooth style and for one of 20,000 strands, how many images were drawn per second, and how many of
//! them show only what has moved.

use std::error::Error;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::time::Duration;

use glam::Vec3;
use lovelock_base::clock::Stopwatch;
use lovelock_brush::{BrushSettings, StrokeSample, Tool};
use lovelock_groom::Preset;
use lovelock_project::Project;
use lovelock_project::files::Access;
use lovelock_render::Backend;
use lovelock_session::render_thread::{ImageQuality, Inputs, RenderRequest, RenderThread, RenderedImage};
use lovelock_session::snapshot::FrameSnapshot;
use lovelock_session::strokes::StrokeStart;
use lovelock_session::window_device::WindowDevice;
use lovelock_session::worker::{Event, Worker};
use lovelock_style::hand::HandEdits;
use lovelock_style::operations::{Curl, Frizz, Hand, Lift};
use lovelock_style::{Layer, Operation, Ramp};

/// No change takes longer, seconds.
const PATIENCE: f64 = 30.0;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let changes: usize = arguments.next().map_or(Ok(40), |text| text.parse())?;
    let size = arguments.next().unwrap_or_else(|| "1280x720".to_owned());
    let (width, height) = size.split_once('x').ok_or("the size is WIDTHxHEIGHT")?;
    let size = [width.parse()?, height.parse()?];
    for (name, wisps, strands) in [("smooth", None, None), ("20,000 strands", Some(400), Some(50))] {
        let mut project = Project::default();
        project.set_preset(Preset::Smooth);
        project.picture.backend = Backend::Cpu;
        let groom = &mut project.hair.groom;
        groom.wisps = wisps.unwrap_or(groom.wisps);
        groom.strands_per_wisp = strands.unwrap_or(groom.strands_per_wisp);
        for operation in [Operation::from(Lift::default()), Curl::default().into(), Frizz::default().into()] {
            project.hair.stack.push(Layer { ramp: Ramp::line(0.2, 1.0), ..Layer::of(operation) });
        }
        for (plays, state) in [(true, "playing"), (false, "paused")] {
            for (layer, what) in [(0, "the first of three layers"), (2, "the last of three layers")] {
                let measured = measure(&project, layer, changes, (size, plays))?;
                println!("{name}, {} strands, {state}, {what}: {measured}", measured.strands);
            }
            let measured = measure_strokes(&project, changes, (size, plays))?;
            println!(
                "{name}, {} strands, {state}, a movement of the brush Smooth: {measured}",
                measured.strands
            );
        }
    }
    Ok(())
}

/// What was measured of one project.
struct Measured {
    strands: usize,
    /// Times to the loaded scene, the frame and the image, milliseconds.
    times_ms: [Vec<f64>; 3],
    images_per_sec: f64,
    /// Of the images those that show only what has moved, percent.
    partial: f64,
}

impl std::fmt::Display for Measured {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let names = ["scene", "frame", "image"];
        for (name, times) in names.iter().zip(&self.times_ms) {
            let at = |part: f64| times[((times.len() - 1) as f64 * part).round() as usize];
            write!(f, "{name} {:.0} ms ({:.0} to {:.0}), ", at(0.5), at(0.1), at(0.9))?;
        }
        write!(f, "{:.0} images per second, {:.0} % of them in part", self.images_per_sec, self.partial)
    }
}

/// The threads, and what they report.
struct Threads {
    worker: Worker,
    painter: RenderThread,
    woken: Receiver<()>,
    project: Arc<Project>,
    size: [u32; 2],
    drawn: Option<Arc<FrameSnapshot>>,
    /// Whether the scene of the project is loaded.
    is_loaded: bool,
    inputs: Inputs,
    seen: u64,
    images: usize,
    /// Images that show only what has moved.
    partial: usize,
    /// Reports of brushes so far.
    brushed: usize,
}

impl Threads {
    /// Starts the threads and waits until the dance has run for a while, and pauses it unless it `plays`. Returns the newest image.
    fn start(
        project: &Project,
        (size, plays): ([u32; 2], bool),
    ) -> Result<(Self, Arc<RenderedImage>), Box<dyn Error>> {
        let (send, woken) = sync_channel(1);
        // One that waits is enough.
        let wake = move || {
            let _ = send.try_send(());
        };
        let project = Arc::new(project.clone());
        let painter = RenderThread::start(WindowDevice::default(), wake.clone())?;
        let worker =
            Worker::start(Arc::clone(&project), Access::new(), &WindowDevice::default(), Arc::new(wake))?;
        let mut threads = Self {
            worker,
            painter,
            woken,
            project,
            size,
            drawn: None,
            is_loaded: false,
            inputs: Inputs::default(),
            seen: 0,
            images: 0,
            partial: 0,
            brushed: 0,
        };
        let watch = Stopwatch::start();
        let mut shown = loop {
            if let Some(shown) = threads.turn()? {
                break shown;
            }
            if watch.secs() > 4.0 * PATIENCE {
                return Err("no image".into());
            }
        };
        for secs in [2.0, 1.0] {
            let watch = Stopwatch::start();
            while watch.secs() < secs {
                shown = threads.turn()?.unwrap_or(shown);
            }
            threads.worker.set_playing(plays);
        }
        Ok((threads, shown))
    }

    /// The images so far and those that show only what has moved, since an earlier count over so many seconds.
    fn rates(&self, [images, partial]: [usize; 2], secs: f64) -> [f64; 2] {
        let images = (self.images - images) as f64;
        [images / secs, 100.0 * (self.partial - partial) as f64 / images.max(1.0)]
    }

    /// Waits for something new and hands frames on to the render thread, as the window does. Returns the newest image.
    fn turn(&mut self) -> Result<Option<Arc<RenderedImage>>, Box<dyn Error>> {
        match self.woken.recv_timeout(Duration::from_millis(200)) {
            Ok(()) | Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return Err("the threads ended".into()),
        }
        while self.woken.try_recv().is_ok() {}
        while let Some(event) = self.worker.poll_event() {
            if let Event::Loaded { project, .. } = &event {
                self.is_loaded |= Arc::ptr_eq(project, &self.project);
            }
            if let Event::Brushed(report) = event {
                self.brushed += 1;
                let mut changed = (*self.project).clone();
                if changed.hair.stack.hand(report.layer) != Some(&report.edits) {
                    self.inputs.brushed(report.layer, &report.edits);
                }
                if let Some(layer) = changed.hair.stack.layer_mut(report.layer) {
                    layer.operation = Operation::Hand(Hand { edits: report.edits });
                }
                self.project = Arc::new(changed);
                self.worker.set_project(Arc::clone(&self.project), Access::new());
            }
        }
        if let Some(frame) = self.worker.frame()
            && self.drawn.as_ref().is_none_or(|drawn| !Arc::ptr_eq(drawn, &frame))
        {
            self.inputs.drawn(&frame.scene.source);
            self.painter.request(RenderRequest {
                project: Arc::clone(&self.project),
                snapshot: Arc::clone(&frame),
                size: self.size,
                quality: ImageQuality::Draft,
                measured: false,
                mask: None,
                input: self.inputs.number(),
            });
            self.drawn = Some(frame);
        }
        let image = self.painter.images().newer_than(&mut self.seen);
        self.images += usize::from(image.is_some());
        self.partial += usize::from(image.as_ref().is_some_and(|image| image.stats.redrawn.is_some()));
        Ok(image)
    }
}

fn measure(
    project: &Project,
    layer: usize,
    changes: usize,
    view: ([u32; 2], bool),
) -> Result<Measured, Box<dyn Error>> {
    let (mut threads, mut shown) = Threads::start(project, view)?;
    let strands = shown.snapshot.scene.style.strands.count();
    let mut times_ms = [Vec::new(), Vec::new(), Vec::new()];
    let (images, whole) = ([threads.images, threads.partial], Stopwatch::start());
    for change in 0..changes {
        let mut changed = (*threads.project).clone();
        changed.hair.stack.layers[layer].weight = 0.5 + 0.01 * (change % 50) as f32;
        let before = Arc::clone(&shown.snapshot.scene.style);
        threads.project = Arc::new(changed);
        threads.is_loaded = false;
        let watch = Stopwatch::start();
        threads.worker.set_project(Arc::clone(&threads.project), Access::new());
        let (mut loaded, mut framed) = (None, None);
        loop {
            let image = threads.turn()?;
            if loaded.is_none() && threads.is_loaded {
                loaded = Some(watch.ms());
            }
            let is_new = |frame: &Arc<FrameSnapshot>| !Arc::ptr_eq(&frame.scene.style, &before);
            if framed.is_none() && threads.drawn.as_ref().is_some_and(is_new) {
                framed = Some(watch.ms());
            }
            if let Some(image) = image {
                let done = is_new(&image.snapshot);
                shown = image;
                if done {
                    break;
                }
            }
            if watch.secs() > PATIENCE {
                return Err(format!("nothing changed for {PATIENCE} s").into());
            }
        }
        let image = watch.ms();
        for (times, ms) in times_ms.iter_mut().zip([loaded.unwrap_or(image), framed.unwrap_or(image), image])
        {
            times.push(ms);
        }
        // Irregular, so that changes do not synchronise with the frames.
        let pause = 0.15 + 0.001 * ((change * 97) % 150) as f64;
        let watch = Stopwatch::start();
        while watch.secs() < pause {
            shown = threads.turn()?.unwrap_or(shown);
        }
    }
    let [images_per_sec, partial] = threads.rates(images, whole.secs());
    for times in &mut times_ms {
        times.sort_unstable_by(f64::total_cmp);
    }
    Ok(Measured { strands, times_ms, images_per_sec, partial })
}

/// The time from movements of a brush that smooths, each a few millimetres long, with the edits written into the project as the window does.
fn measure_strokes(
    project: &Project,
    changes: usize,
    view: ([u32; 2], bool),
) -> Result<Measured, Box<dyn Error>> {
    let mut project = project.clone();
    let layer = project.hair.stack.push(Layer::of(Hand::default())).ok_or("too many layers")?;
    let (mut threads, mut shown) = Threads::start(&project, view)?;
    let strands = shown.snapshot.scene.style.strands.count();
    let settings = BrushSettings { front_only: false, ..BrushSettings::default() };
    let tool = Tool::Smooth;
    let edits = HandEdits::default();
    threads.worker.begin_stroke(StrokeStart {
        id: 1,
        layer,
        tool,
        inverted: false,
        settings,
        edits,
        after: None,
    });
    let mut times_ms = [Vec::new(), Vec::new(), Vec::new()];
    let (images, whole) = ([threads.images, threads.partial], Stopwatch::start());
    for change in 0..changes {
        // Back and forth over the hair on the wearer's left.
        let step = Vec3::Z * if change % 20 < 10 { 0.009 } else { -0.009 };
        let at = (change % 20).min(20 - change % 20) as f32 * 0.009 - 0.045;
        let sample = StrokeSample {
            position: Vec3::new(0.1, 0.06, at),
            view: Vec3::NEG_X,
            drag: step,
            pressure: 1.0,
            time_secs: 0.0,
        };
        let (reports, watch) = (threads.brushed, Stopwatch::start());
        threads.worker.stroke_to(1, vec![sample]);
        let (mut applied, mut framed) = (None, None::<(f64, u64)>);
        loop {
            let before = threads.drawn.clone();
            let image = threads.turn()?;
            if applied.is_none() && threads.brushed > reports {
                applied = Some(watch.ms());
            }
            if let (Some(_), None, Some(now)) = (applied, framed, &threads.drawn)
                && before.is_none_or(|before| !Arc::ptr_eq(&before, now))
            {
                framed = Some((watch.ms(), threads.inputs.number()));
            }
            if let Some(image) = image {
                shown = image;
                if framed.is_some_and(|(_, input)| shown.input >= input) {
                    break;
                }
            }
            // The first movement of a stroke only puts the brush down, and one beside the hair does nothing.
            if watch.secs() > 0.5 {
                break;
            }
        }
        if let (Some(applied), Some((framed, _))) = (applied, framed) {
            for (times, ms) in times_ms.iter_mut().zip([applied, framed, watch.ms()]) {
                times.push(ms);
            }
        }
        let pause = 0.05 + 0.001 * ((change * 97) % 50) as f64;
        let watch = Stopwatch::start();
        while watch.secs() < pause {
            shown = threads.turn()?.unwrap_or(shown);
        }
    }
    if times_ms[0].is_empty() {
        return Err("no movement of the brush touched hair".into());
    }
    let [images_per_sec, partial] = threads.rates(images, whole.secs());
    for times in &mut times_ms {
        times.sort_unstable_by(f64::total_cmp);
    }
    Ok(Measured { strands, times_ms, images_per_sec, partial })
}
