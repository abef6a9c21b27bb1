//! Lost devices and devices that never work. Tests of lost devices need an adapter, which may be software.

use std::sync::Mutex;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, sync_channel};

use lovelock_base::clock::Stopwatch;
use lovelock_project::files::Access;
use lovelock_render::Gpu;
use lovelock_testkit::wait::HANG;

use super::*;
use crate::scene::SceneLoader;
use crate::snapshot::FrameSnapshot;
use crate::testing::{settled, small_project};

/// A render thread with the renderers of a test, one instant, and the backends that were requested.
struct Rig {
    thread: RenderThread,
    snapshot: Arc<FrameSnapshot>,
    finished: Receiver<()>,
    opened: Arc<Mutex<Vec<Backend>>>,
}

impl Rig {
    fn new(open: impl FnMut(Backend) -> Result<Renderer, RenderError> + Send + 'static) -> Self {
        Self::on(WindowDevice::default(), open)
    }

    /// As [`Rig::new`], with a window on a device.
    fn on(
        window: WindowDevice,
        mut open: impl FnMut(Backend) -> Result<Renderer, RenderError> + Send + 'static,
    ) -> Self {
        let (scene, _) = SceneLoader::new().load_now(&small_project(), &Access::new()).expect("a scene");
        let snapshot = settled(scene, &small_project()).snapshot();
        let opened = Arc::new(Mutex::new(Vec::new()));
        let noted = Arc::clone(&opened);
        let open = move |choice, _: Option<&Arc<Gpu>>| {
            noted.lock().expect("a list").push(choice);
            open(choice)
        };
        let (sender, finished) = sync_channel(64);
        let wake = move || {
            let _ = sender.try_send(());
        };
        let patience = Patience::default();
        let thread = RenderThread::start_with(Box::new(open), window, patience, wake).expect("a thread");
        Self { thread, snapshot, finished, opened }
    }

    /// Requests one image and waits until the thread is idle.
    fn draw(&self, backend: Backend) {
        let mut project = small_project();
        project.picture.backend = backend;
        let (project, snapshot) = (Arc::new(project), Arc::clone(&self.snapshot));
        self.thread.request(RenderRequest {
            project,
            snapshot,
            size: [64, 48],
            quality: ImageQuality::Full,
            measured: false,
            mask: None,
            input: 0,
        });
        while self.thread.busy().load(Ordering::Relaxed) {
            // Do not wait forever.
            self.finished.recv_timeout(HANG).expect("an end");
        }
    }

    fn opened(&self) -> Vec<Backend> {
        self.opened.lock().expect("a list").clone()
    }

    fn pixels(&self) -> Vec<u8> {
        self.thread.images().latest().expect("a picture").image.picture().expect("pixels").rgba.clone()
    }

    /// Numbers of images, failures and notices so far.
    fn counts(&self) -> [u64; 3] {
        let thread = &self.thread;
        [thread.images.number(), thread.failures.number(), thread.notices.number()]
    }
}

fn lost(_: Backend) -> Result<Renderer, RenderError> {
    Err(GpuError::Lost("for this test".to_owned()).into())
}

#[test]
fn a_lost_device_is_opened_again_and_draws_the_same() {
    let devices = Arc::new(Mutex::new(Vec::<Arc<Gpu>>::new()));
    let noted = Arc::clone(&devices);
    let rig = Rig::new(move |choice| {
        let renderer = Renderer::open(choice)?;
        noted.lock().expect("a list").extend(renderer.gpu().cloned());
        Ok(renderer)
    });
    rig.draw(Backend::Gpu);
    if devices.lock().expect("a list").is_empty() {
        return lovelock_testkit::skip_without_adapter(&rig.thread.error().unwrap_or_default());
    }
    let before = rig.pixels();
    rig.draw(Backend::Gpu);
    assert_eq!((rig.counts(), rig.opened().len()), ([2, 0, 0], 1), "a working device is kept");

    devices.lock().expect("a list")[0].device.destroy();
    rig.draw(Backend::Gpu);
    let said = rig.thread.failures.latest().expect("a sentence").message.clone();
    assert!(said.contains("graphics device") && said.contains("lost") && !said.contains('\n'), "{said}");
    assert_eq!(rig.counts(), [3, 1, 0], "one error, and a new image without another request");
    assert_eq!(rig.opened(), [Backend::Gpu; 2]);
    assert_eq!(rig.thread.error(), None, "the error is gone");
    assert!(rig.pixels() == before, "the same bytes");
}

#[test]
fn a_gpu_that_always_fails_is_replaced_by_the_cpu() {
    let rig = Rig::new(|choice| if choice == Backend::Cpu { Renderer::open(choice) } else { lost(choice) });
    rig.draw(Backend::Auto);
    assert_eq!(rig.counts(), [1, 3, 1], "an image after three failures, and a notice");
    let notice = rig.thread.notices().latest().expect("a notice");
    assert!(notice.contains("processor renders from now on"), "{notice}");
    assert_eq!(rig.thread.adapter().expect("it draws").backend, Backend::Cpu);
    rig.draw(Backend::Auto);
    assert_eq!((rig.counts(), rig.opened().len()), ([2, 3, 1], 4), "the CPU stays in use");
    let by_fallback = rig.pixels();
    rig.draw(Backend::Cpu);
    assert!(rig.pixels() == by_fallback, "the image of the CPU");

    // An explicit request tries the GPU again and keeps the last image.
    rig.draw(Backend::Gpu);
    assert_eq!((rig.counts()[0], rig.opened().pop()), (3, Some(Backend::Gpu)));
    assert!(rig.thread.error().is_some_and(|said| said.contains("for this test")));
    assert!(rig.pixels() == by_fallback);
}

#[test]
fn a_device_that_always_fails_is_not_retried_forever() {
    let rig = Rig::new(lost);
    rig.draw(Backend::Gpu);
    assert_eq!((rig.counts(), rig.opened().len()), ([0, 3, 0], 3));
    rig.draw(Backend::Gpu);
    assert_eq!(rig.counts(), [0, 4, 0], "once per requested image");
    assert!(rig.thread.error().is_some());
    let never = Rig::new(lost);
    never.draw(Backend::Auto);
    assert_eq!(never.counts(), [0, 4, 1], "neither is a failing CPU");
}

#[test]
fn a_shader_that_does_not_compile_is_reported_and_the_last_image_stays() {
    const TOLD: &str = "crates/render/src/gpu/shaders/x.wgsl, line 3: no definition in scope for `y`";
    let rig = Rig::new(|choice| match choice {
        Backend::Cpu => Renderer::open(choice),
        _ => Err(GpuError::Shader(TOLD.to_owned()).into()),
    });
    rig.draw(Backend::Cpu);
    let good = rig.pixels();
    rig.draw(Backend::Gpu);
    assert_eq!((rig.counts(), rig.opened().len()), ([1, 1, 0], 2), "it is not compiled again automatically");
    assert_eq!(rig.thread.error().as_deref(), Some(TOLD));
    assert!(rig.pixels() == good);
    rig.draw(Backend::Cpu);
    assert_eq!(rig.thread.error(), None);
    assert_eq!(rig.counts(), [2, 1, 0]);
}

#[test]
fn a_panic_while_rendering_is_reported_and_rendering_continues() {
    let mut times = 0;
    let rig = Rig::new(move |choice| {
        times += 1;
        assert!(times != 1, "on purpose, once");
        Renderer::open(choice)
    });
    rig.draw(Backend::Cpu);
    assert_eq!(rig.counts(), [1, 1, 0]);
    assert_eq!(rig.thread.error(), None);
}

/// A device as that of a window, if the machine has an adapter.
fn window_device() -> Option<Arc<Gpu>> {
    match Renderer::open(Backend::Gpu) {
        Ok(renderer) => renderer.gpu().cloned(),
        Err(error) => {
            lovelock_testkit::skip_without_adapter(&error);
            None
        }
    }
}

#[test]
fn images_are_textures_of_the_window_whatever_draws_them() {
    let Some(gpu) = window_device() else { return };
    let window = WindowDevice::default();
    window.set(Some(Arc::clone(&gpu)));
    let (there, here) = (Rig::on(window, Renderer::open), Rig::new(Renderer::open));
    // The renderer on the GPU has a device of its own, as beside the software adapter of a window.
    for (backend, (rig, is_texture)) in [Backend::Gpu, Backend::Cpu]
        .into_iter()
        .flat_map(|backend| [(backend, (&there, true)), (backend, (&here, false))])
    {
        rig.draw(backend);
        assert_eq!(rig.thread.error(), None, "{backend}");
        let image = rig.thread.images().latest().expect("an image").image.clone();
        assert_eq!(image.on_device().is_some(), is_texture);
        assert!(image.on_device().is_none_or(|image| image.gpu().is_same_device(&gpu)));
    }
    assert!(there.pixels() == here.pixels(), "the same bytes");
}

#[test]
fn a_lost_window_device_is_not_retried_until_the_window_has_another_one() {
    let Some(gpu) = window_device() else { return };
    let window = WindowDevice::default();
    window.set(Some(Arc::clone(&gpu)));
    let of_window = window.clone();
    let open = move |choice| match (choice, of_window.get()) {
        (Backend::Gpu, Some(gpu)) => Renderer::on_window(&gpu, choice),
        _ => Renderer::open(choice),
    };
    let rig = Rig::on(window.clone(), open);
    rig.draw(Backend::Gpu);
    let before = rig.pixels();
    let image = rig.thread.images().latest().expect("an image");
    assert!(image.image.on_device().is_some_and(|image| image.gpu().is_same_device(&gpu)));
    drop(image);
    gpu.device.destroy();
    rig.draw(Backend::Gpu);
    assert_eq!((rig.counts(), rig.opened().len()), ([1, 1, 0], 1), "it waits for the window");
    rig.draw(Backend::Gpu);
    assert_eq!((rig.counts(), rig.opened().len()), ([1, 1, 0], 1), "another request is the same loss");
    assert!(rig.thread.error().is_some_and(|said| said.contains("lost")));
    // The CPU goes on, in memory.
    rig.draw(Backend::Cpu);
    let image = rig.thread.images().latest().expect("an image");
    assert!(image.image.on_device().is_none());
    window.set(window_device());
    rig.draw(Backend::Gpu);
    assert_eq!(rig.counts(), [3, 1, 0]);
    assert!(rig.pixels() == before, "the same bytes on the new device");
}

#[test]
fn what_stands_still_is_refined_until_something_else_is_wanted() {
    let rig = Rig::new(Renderer::open);
    let mut project = small_project();
    project.picture.backend = Backend::Cpu;
    let project = Arc::new(project);
    let request = |quality| RenderRequest {
        project: Arc::clone(&project),
        snapshot: Arc::clone(&rig.snapshot),
        size: [64, 48],
        quality,
        measured: false,
        mask: None,
        input: 0,
    };
    let wait = |samples: u32| loop {
        rig.finished.recv_timeout(HANG).expect("an image");
        let image = rig.thread.images().latest().expect("an image");
        if image.samples == samples {
            return image.image.picture().expect("pixels");
        }
    };
    rig.thread.request(request(ImageQuality::Full));
    let plain = wait(1);
    rig.thread.request(request(ImageQuality::Refined));
    let first = wait(1);
    assert!(first == plain, "the first sample is the image");
    let refined = wait(16);
    assert!(refined != plain, "edges are smoother");
    let off = |a: &Picture, b: &Picture| {
        let sum: u64 = a.rgba.iter().zip(&b.rgba).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
        sum as f64 / a.rgba.len() as f64
    };
    assert!(off(&refined, &plain) < 4.0, "{}", off(&refined, &plain));
    // A quarter as many samples are nearer to all than one is.
    rig.thread.request(request(ImageQuality::Full));
    assert!(wait(1) == plain);
    rig.thread.request(request(ImageQuality::Refined));
    let some = wait(4);
    assert!(
        off(&some, &refined) < 0.6 * off(&plain, &refined),
        "{} {}",
        off(&some, &refined),
        off(&plain, &refined)
    );
}

#[test]
fn input_that_never_stops_is_seen() {
    let rig = Rig::new(Renderer::open);
    let mut project = small_project();
    project.picture.backend = Backend::Cpu;
    let project = Arc::new(project);
    let (mut input, mut seen, mut images) = (0, 0, 0);
    // A new input arrives many times during each image.
    let watch = Stopwatch::start();
    while images < 8 {
        assert!(watch.elapsed() < HANG, "{images} images of {input} inputs");
        input += 1;
        rig.thread.request(RenderRequest {
            project: Arc::clone(&project),
            snapshot: Arc::clone(&rig.snapshot),
            size: [64, 48],
            quality: ImageQuality::Draft,
            measured: false,
            mask: None,
            input,
        });
        images += usize::from(rig.thread.images().newer_than(&mut seen).is_some());
        std::thread::sleep(Duration::from_micros(500));
    }
    while rig.thread.busy().load(Ordering::Relaxed) {
        rig.finished.recv_timeout(HANG).expect("an end");
    }
    assert_eq!(rig.thread.error(), None, "an image that is given up is no failure");
}

#[test]
fn what_a_brush_moves_is_shown_first_and_the_whole_image_after_it() {
    let mut project = small_project();
    (project.hair.groom.wisps, project.hair.groom.strands_per_wisp) = (100, 4);
    project.picture.backend = Backend::Cpu;
    let (scene, _) = SceneLoader::new().load_now(&project, &Access::new()).expect("a scene");
    let rest = settled(scene, &project).snapshot();
    let eye = rest.camera(&project.camera).eye;
    // The guide nearest to the eye, moved away from the body.
    let brushed = |metres: f32| {
        let mut moved = (*rest).clone();
        let guides = &mut moved.guides.guides;
        let points = guides.points_per_guide;
        let distance = |guide: &usize| guides.point(*guide, points / 2).distance(eye);
        let nearest = (0..guides.count()).min_by(|a, b| distance(a).total_cmp(&distance(b))).expect("guides");
        let way = (eye - guides.point(nearest, points / 2)).normalize_or_zero() * metres;
        for i in nearest * points + 1..(nearest + 1) * points {
            guides.x[i] += way.x;
            guides.y[i] += way.y;
            guides.z[i] += way.z;
        }
        Arc::new(moved)
    };
    let size = [640, 480];
    let project = Arc::new(project);
    let request = |snapshot: &Arc<FrameSnapshot>, quality: ImageQuality, input: u64| RenderRequest {
        project: Arc::clone(&project),
        snapshot: Arc::clone(snapshot),
        size,
        quality,
        measured: false,
        mask: None,
        input,
    };
    let anew = |snapshot: &FrameSnapshot, is_draft: bool| {
        let camera = snapshot.camera(&project.camera);
        let input = FrameInput { is_draft, ..snapshot.frame_input(&project, &camera) };
        let mut picture = Picture::default();
        let mut renderer = Renderer::open(Backend::Cpu).expect("the processor");
        renderer.picture(&input, size[0], size[1], &mut picture).expect("an image");
        picture
    };

    // A thread that stops after each image, and takes its time for no sign of a slow one.
    let (send, finished) = sync_channel(64);
    let (sender, stopped) = sync_channel::<()>(64);
    let wake = move || {
        let _ = send.try_send(());
        let _ = stopped.recv();
    };
    let open = |choice: Backend, _: Option<&Arc<Gpu>>| Renderer::open(choice);
    let patience = Patience::with_limits(0.0, HANG);
    let thread =
        RenderThread::start_with(Box::new(open), WindowDevice::default(), patience, wake).expect("a thread");
    // It is dropped before the thread, which would wait for it.
    let go = sender;
    let next = || {
        finished.recv_timeout(HANG).expect("an image");
        let image = thread.images().latest().expect("an image");
        (image.image.picture().expect("pixels"), image.stats.redrawn, image.cost.is_some())
    };
    let go_on = || go.send(()).expect("a thread that waits");
    thread.request(request(&rest, ImageQuality::Draft, 0));
    let (first, redrawn, _) = next();
    assert!(redrawn.is_none() && *first == anew(&rest, true), "nothing is there to be drawn over");

    let moved = brushed(0.02);
    thread.request(request(&moved, ImageQuality::Draft, 1));
    go_on();
    let (part, redrawn, has_cost) = next();
    let share = redrawn.expect("a part of the image");
    let same = part.rgba.iter().zip(&first.rgba).filter(|(a, b)| a == b).count() as f32;
    assert!(part != first && share < 0.5, "{share}");
    assert!(same >= (1.0 - share) * part.rgba.len() as f32, "the rest is that of the image before");
    assert!(!has_cost, "the window would take it for the cost of an image");
    assert!(!thread.busy().load(Ordering::Relaxed), "nothing else is waited for");
    go_on();
    let (whole, redrawn, has_cost) = next();
    assert!(redrawn.is_none() && has_cost && *whole == anew(&moved, true), "the rest follows by itself");
    // Hair that moves on without new input.
    let swung = brushed(0.025);
    thread.request(request(&swung, ImageQuality::Draft, 1));
    go_on();
    let (image, redrawn, _) = next();
    assert!(redrawn.is_none() && *image == anew(&swung, true), "nobody waits for it");

    // The whole of an image is left out where the brush moves on.
    let further = [brushed(0.03), brushed(0.04)];
    for (input, snapshot) in (2..).zip(&further) {
        thread.request(request(snapshot, ImageQuality::Draft, input));
        go_on();
        assert!(next().1.is_some(), "{input}");
    }
    go_on();
    assert!(next().1.is_none());
    // At rest nothing of all this is left.
    thread.request(request(&further[1], ImageQuality::Full, 3));
    go_on();
    let (best, redrawn, _) = next();
    assert!(redrawn.is_none() && *best == anew(&further[1], false));
    go_on();
}
