//! Panes of a small scene on the CPU; lost devices need an adapter.

mod against_exact;
mod on_device;
mod takes;

use std::sync::Mutex;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, sync_channel};

use lovelock_project::Project;
use lovelock_project::files::Access;
use lovelock_project::project::Contender;
use lovelock_render::{Backend, CpuRenderer, Gpu, GpuError, HairDrawing, Picture, RenderError, ShadowMethod};
use lovelock_session::engine::Engine;
use lovelock_session::scene::SceneLoader;
use lovelock_session::snapshot::FrameSnapshot;
use lovelock_session::testing::{settled, small_project};
use lovelock_session::window_device::WindowDevice;
use lovelock_testkit::wait::{HANG, wait_until};

use super::*;
use crate::probe::{ProbePlace, ProbedHair};
use crate::request::LiveError;
use crate::view::{LiveShows, LiveView};

/// The thread with the renderers of a test, and one instant.
struct Rig {
    live: Live,
    project: Project,
    snapshot: Arc<FrameSnapshot>,
    finished: Receiver<()>,
}

impl Rig {
    fn new(open: Open, backend: Backend, methods: &[ShadowMethod]) -> Self {
        let mut project = small_project();
        let pane = |&method: &ShadowMethod| {
            let mut pane = Contender { backend, ..Contender::of(&project) };
            pane.shadow.method = method;
            pane
        };
        project.compare.panes = methods.iter().map(pane).collect();
        let (scene, _) = SceneLoader::new().load_now(&project, &Access::new()).expect("a scene");
        let snapshot = settled(scene, &project).snapshot();
        let (sender, finished) = sync_channel(64);
        let wake = move || {
            let _ = sender.try_send(());
        };
        let live = Live::start_with(open, WindowDevice::default(), wake).expect("a thread");
        Self { live, project, snapshot, finished }
    }

    fn request(&self, panes: &[usize]) -> LiveRequest {
        LiveRequest {
            access: Access::new(),
            project: Arc::new(self.project.clone()),
            snapshot: Arc::clone(&self.snapshot),
            panes: panes.to_vec(),
            width: 64,
            height: 48,
            together: false,
            view: LiveView::default(),
            probe: None,
        }
    }

    /// Requests panes and waits until the thread is idle.
    fn draw(&self, request: LiveRequest) {
        self.live.request(request);
        while self.live.busy().load(Ordering::Relaxed) {
            // Do not wait forever.
            self.finished.recv_timeout(HANG).expect("an end");
        }
    }

    fn pane(&self, index: usize) -> Arc<LivePane> {
        self.live.pane(index).expect("a slot").latest().expect("a pane")
    }
}

fn on_processor(methods: &[ShadowMethod]) -> Rig {
    Rig::new(Box::new(Renderer::open_for), Backend::Cpu, methods)
}

/// The pixels of a pane.
fn pixels(pane: &LivePane) -> Picture {
    Picture::clone(&pane.image.picture().expect("pixels"))
}

/// The image that the window would show without panes.
fn alone(rig: &Rig, index: usize, width: u32, height: u32) -> Picture {
    let project = rig.project.compare.panes[index].applied_to(&rig.project).compared();
    let camera = rig.snapshot.camera(&project.camera);
    let mut picture = Picture::default();
    let input = rig.snapshot.frame_input(&project, &camera);
    CpuRenderer::default().picture(&input, width, height, &mut picture).expect("a picture");
    picture
}

#[test]
fn each_pane_equals_the_single_image_with_its_settings() {
    let rig = on_processor(&[ShadowMethod::VoxelMap, ShadowMethod::None, ShadowMethod::OccupancyMaps]);
    rig.draw(rig.request(&[0, 1, 2]));
    for index in 0..3 {
        let pane = rig.pane(index);
        assert_eq!(pane.problem, None);
        assert_eq!(pane.contender, rig.project.compare.panes[index]);
        assert_eq!((pane.step, pane.adapter.backend), (rig.snapshot.step, Backend::Cpu));
        assert!(pane.times.whole > 0.0);
        assert!(pixels(&pane) == alone(&rig, index, 64, 48), "pane {index}");
    }
    assert!(pixels(&rig.pane(0)) != pixels(&rig.pane(1)), "shadows are visible");
    assert!(rig.pane(0).shadow_bytes > 0 && rig.pane(1).shadow_bytes == 0);
}

#[test]
fn a_pane_of_lower_scale_is_rendered_smaller_and_others_are_unchanged() {
    let mut rig = on_processor(&[ShadowMethod::VoxelMap, ShadowMethod::None]);
    rig.project.compare.panes[1].scale = 0.5;
    rig.draw(rig.request(&[1, 9]));
    assert!(rig.live.pane(0).expect("a slot").latest().is_none(), "it was not requested");
    assert!(rig.live.pane(9).is_none());
    let picture = &pixels(&rig.pane(1));
    assert_eq!((picture.width, picture.height), (32, 24));
    assert!(*picture == alone(&rig, 1, 32, 24));
}

#[test]
fn panes_use_the_extinction_of_the_hair() {
    let mut rig = on_processor(&[ShadowMethod::VoxelMap]);
    let before = alone(&rig, 0, 64, 48);
    rig.project.look.extinction_scale = 4.0;
    rig.draw(rig.request(&[0]));
    assert!(pixels(&rig.pane(0)) == alone(&rig, 0, 64, 48));
    assert!(pixels(&rig.pane(0)) != before, "control: extinction is visible");
}

#[test]
fn a_failing_pane_says_why_and_the_others_are_rendered() {
    let mut rig = on_processor(&[ShadowMethod::None, ShadowMethod::VoxelMap]);
    rig.project.compare.panes[1].scale = 0.1;
    let wide = LiveRequest { width: lovelock_render::MAX_SIDE + 8, ..rig.request(&[0, 1]) };
    rig.draw(wide);
    let problem = rig.pane(0).problem.clone().expect("a sentence");
    assert!(problem.contains("8192") && !problem.contains('\n'), "{problem}");
    assert!(rig.pane(0).image.is_empty());
    assert_eq!(rig.pane(1).problem, None);
    rig.draw(rig.request(&[0, 1]));
    assert_eq!(rig.pane(0).problem, None, "it is rendered as soon as possible");
}

#[test]
fn panes_of_a_round_can_be_published_together() {
    let rig = on_processor(&[ShadowMethod::None; 6]);
    let seen = |rig: &Rig| (0..6).map(|i| rig.live.pane(i).expect("a slot").number()).collect::<Vec<_>>();
    // The thread may be idle before it has made its call, so wait for the calls.
    let call = |rig: &Rig| rig.finished.recv_timeout(HANG).expect("a call");
    for round in 1..=3 {
        rig.live.request(LiveRequest { together: true, ..rig.request(&[0, 1, 2, 3, 4, 5]) });
        call(&rig);
        // One call per round, when all panes are finished.
        assert_eq!(seen(&rig), [round; 6]);
        assert!(!rig.live.busy().load(Ordering::Relaxed));
    }
    rig.live.request(rig.request(&[0, 1]));
    for _ in 0..3 {
        call(&rig);
    }
    assert_eq!(seen(&rig), [4, 4, 3, 3, 3, 3]);
    // Otherwise one call per pane and one at the end; the thread has ended when all are counted.
    let Rig { live, finished, .. } = rig;
    drop(live);
    assert_eq!(finished.try_iter().count(), 0);
}

#[test]
fn a_lost_device_is_opened_again_for_all_panes_on_it() {
    let devices = Arc::new(Mutex::new(Vec::<Arc<Gpu>>::new()));
    let noted = Arc::clone(&devices);
    let open = move |choice, window: Option<&Arc<Gpu>>| {
        let renderer = Renderer::open_for(choice, window)?;
        noted.lock().expect("a list").extend(renderer.gpu().cloned());
        Ok(renderer)
    };
    let rig = Rig::new(Box::new(open), Backend::Gpu, &[ShadowMethod::None, ShadowMethod::OpacityMaps]);
    rig.draw(rig.request(&[0, 1]));
    if devices.lock().expect("a list").is_empty() {
        return lovelock_testkit::skip_without_adapter(&rig.pane(0).problem.clone().unwrap_or_default());
    }
    let before = [rig.pane(0), rig.pane(1)];
    assert!(before.iter().all(|pane| pane.problem.is_none() && pane.adapter.backend == Backend::Gpu));
    assert_eq!(devices.lock().expect("a list").len(), 1, "all panes share a device");
    devices.lock().expect("a list")[0].device.destroy();
    rig.draw(rig.request(&[0, 1]));
    assert_eq!(devices.lock().expect("a list").len(), 2);
    for (index, before) in before.iter().enumerate() {
        let pane = rig.pane(index);
        assert_eq!(pane.problem, None, "rendered again without another request");
        assert!(pixels(&pane) == pixels(before), "pane {index}");
    }
}

#[test]
fn panes_on_a_lost_window_device_wait_for_another_one_and_are_not_given_up() {
    let device = || Renderer::open(Backend::Gpu).map(|renderer| renderer.gpu().cloned());
    let (first, second) = match (device(), device()) {
        (Ok(Some(first)), Ok(Some(second))) => (first, second),
        (Err(error), _) | (_, Err(error)) => {
            return lovelock_testkit::skip_without_adapter(&error.to_string());
        }
        _ => panic!("a renderer without a device"),
    };
    let window = WindowDevice::default();
    window.set(Some(Arc::clone(&first)));
    let open = |_: Backend, window: Option<&Arc<Gpu>>| match window {
        Some(gpu) => Renderer::on_window(gpu, Backend::Gpu),
        None => Err(GpuError::NoAdapter("for this test".to_owned()).into()),
    };
    let mut renderers = super::Renderers::new(Box::new(open), window.clone());
    let pane = Contender { backend: Backend::Gpu, ..Contender::default() };
    renderers.of_pane(0, &pane).expect("a renderer");
    first.device.destroy();
    for _ in 0..10 {
        let lost = renderers.of_pane(0, &pane).expect_err("the device is lost");
        assert!(lost.to_string().contains("lost"), "{lost}");
        let broken = renderers.broke(0);
        assert!(!broken.try_again && broken.notice.is_none(), "it waits for the window");
    }
    window.set(Some(Arc::clone(&second)));
    let renderer = renderers.of_pane(0, &pane).expect("a renderer on the new device");
    assert!(renderer.gpu().is_some_and(|gpu| gpu.is_same_device(&second)));
}

#[test]
fn a_gpu_that_always_fails_leaves_its_panes_to_the_cpu_or_says_so() {
    for (backend, drawn) in [(Backend::Auto, true), (Backend::Gpu, false)] {
        let open = |choice, window: Option<&Arc<Gpu>>| match choice {
            Backend::Cpu => Renderer::open_for(choice, window),
            _ => Err::<_, RenderError>(GpuError::Lost("for this test".to_owned()).into()),
        };
        let rig = Rig::new(Box::new(open), backend, &[ShadowMethod::None]);
        rig.draw(rig.request(&[0]));
        assert_eq!(rig.pane(0).problem.is_none(), drawn, "{backend}: {:?}", rig.pane(0).problem);
        assert_eq!(rig.live.notices().latest().is_some(), drawn || backend == Backend::Gpu);
    }
}

#[test]
fn a_pane_that_always_loses_the_device_stops_retrying_beside_one_that_works() {
    let opened = Arc::new(std::sync::atomic::AtomicUsize::new(0));
    let counted = Arc::clone(&opened);
    let open: Open = Box::new(move |choice, window: Option<&Arc<Gpu>>| {
        counted.fetch_add(1, Ordering::Relaxed);
        Renderer::open_for(choice, window)
    });
    let mut renderers = super::Renderers::new(open, WindowDevice::default());
    let [healthy, broken] = [ShadowMethod::None, ShadowMethod::Exact].map(|method| {
        let mut pane = Contender { backend: Backend::Gpu, ..Contender::default() };
        pane.shadow.method = method;
        pane
    });
    let mut tries = 0;
    loop {
        if let Err(error) = renderers.of_pane(0, &healthy) {
            return lovelock_testkit::skip_without_adapter(&error.to_string());
        }
        renderers.worked(0);
        if renderers.of_pane(1, &broken).is_err() {
            break;
        }
        tries += 1;
        assert!(tries < 10, "it retries forever");
        let after = renderers.broke(1);
        assert!(after.try_again, "the other pane lost its device as well");
        assert_eq!(after.notice.is_some(), tries == 3);
    }
    assert_eq!(tries, 3);
    assert!(renderers.of_pane(0, &healthy).is_ok(), "the other one is still rendered");
    // Changed settings allow another attempt.
    let other = Contender { scale: 0.5, ..broken };
    assert!(renderers.of_pane(1, &other).is_ok());
    assert_eq!(opened.load(Ordering::Relaxed), 4);
}

#[test]
fn a_probe_follows_a_strand_and_reads_each_pane_there_long_suite() {
    let mut rig = on_processor(&[ShadowMethod::None, ShadowMethod::Exact, ShadowMethod::OpacityMaps]);
    rig.project.compare.panes[1].shadow.exact.filter = lovelock_render::TexelFilter::Nearest;
    let shown = LiveRequest { width: 160, height: 120, ..rig.request(&[0, 1, 2]) };
    rig.draw(shown.clone());
    assert!(rig.live.probe().latest().is_none());
    // The densest of many rays, and slices of centimetres, so that an inexact method differs along much of the ray.
    rig.project.compare.panes[2].shadow.opacity_maps.slices = 16;
    let shown = LiveRequest { project: Arc::new(rig.project.clone()), ..shown };
    let mut found: Option<(u64, (f32, f32), ProbedHair)> = None;
    for number in 1..480_u64 {
        let (x, y) = ((number * 37 % 160) as f32 / 160.0, (number * 61 % 120) as f32 / 120.0);
        rig.draw(LiveRequest { probe: Some(ProbePlace { number, x, y }), ..shown.clone() });
        let probe = rig.live.probe().latest().expect("an answer");
        assert_eq!(probe.number, number);
        if let Some(hair) = &probe.hair
            && hair.steps.len() > found.as_ref().map_or(3, |(.., busiest)| busiest.steps.len())
        {
            found = Some((number, (x, y), hair.clone()));
        }
    }
    let (number, (x, y), hair) = found.expect("hair with hair before or behind it");
    assert_eq!(hair.curves.iter().map(|(pane, _)| *pane).collect::<Vec<_>>(), [0, 1, 2]);
    let curve = |pane: usize| &hair.curves[pane].1;
    assert!(curve(0).curve.iter().all(|point| point.1 == 1.0) && curve(0).marks.is_empty());
    assert!(curve(1).marks.len() == hair.steps.len(), "a mark for each fragment");
    assert!(curve(2).marks.iter().all(|mark| mark.kind == "slice"));
    // With nearest-texel lookup the exact method returns its step function.
    let step =
        |depth: f32| hair.steps.iter().take_while(|step| step.0 < depth).last().map_or(1.0, |step| step.1);
    let wrong = curve(1).curve.iter().filter(|point| (point.1 - step(point.0)).abs() > 1e-3).count();
    // At the edge of a texel the ray may leave the point's column by rounding.
    assert!(wrong < curve(1).curve.len() / 10, "{wrong} of {}", curve(1).curve.len());
    let opacity = curve(2).curve.iter().filter(|point| (point.1 - step(point.0)).abs() > 1e-3).count();
    assert!(opacity > curve(2).curve.len() / 10, "another method is not: {opacity}");
    println!("{} steps, {wrong} and {opacity} of {}", hair.steps.len(), curve(2).curve.len());

    // The same pick at a later instant refers to the same hair.
    rig.snapshot = {
        let mut engine = Engine::new(Arc::clone(&rig.snapshot.scene), rig.project.simulation);
        engine.advance_to_step(40);
        engine.snapshot()
    };
    let later = LiveRequest { snapshot: Arc::clone(&rig.snapshot), ..shown };
    rig.draw(LiveRequest { probe: Some(ProbePlace { number, x, y }), ..later });
    let probe = rig.live.probe().latest().expect("an answer");
    let moved = probe.hair.as_ref().expect("the hair");
    assert_eq!((moved.strand, moved.point), (hair.strand, hair.point));
    assert_ne!(moved.position, hair.position);
}

/// Threads that render panes have a lower priority than the requesting thread.
#[cfg(target_os = "linux")]
#[test]
fn threads_that_draw_panes_lower_priority() {
    let rig = on_processor(&[ShadowMethod::VoxelMap]);
    rig.draw(rig.request(&[0]));
    // A thread gets its name before it lowers its priority, so wait for starting threads.
    wait_until("threads that render panes at a lower priority", || {
        let (least, mine) = niceness();
        // If the tests run at the lowest priority, it cannot be lowered further.
        least.is_some_and(|least| least > mine || mine >= 9)
    });
}

/// The lowest niceness of the threads that render panes, and that of the requesting thread.
#[cfg(target_os = "linux")]
fn niceness() -> (Option<i32>, i32) {
    // The name may contain anything, so count fields from its closing bracket: niceness is the 17th after it.
    let of = |task: &std::path::Path| {
        let read = |name: &str| std::fs::read_to_string(task.join(name)).unwrap_or_default();
        let stat = read("stat");
        let nice = stat.rsplit_once(')').and_then(|(_, rest)| rest.split_whitespace().nth(16)?.parse().ok());
        (read("comm").trim().to_owned(), nice)
    };
    let tasks = std::fs::read_dir("/proc/self/task").expect("threads").flatten();
    let seen = tasks.map(|task| of(&task.path()));
    let own = seen.filter(|(name, _)| name == "compare" || name.starts_with("pane "));
    let mine = of(std::path::Path::new("/proc/thread-self")).1;
    (own.filter_map(|(_, nice)| nice).min(), mine.expect("this thread"))
}

#[test]
fn panes_that_rest_keep_nothing_and_are_drawn_again() {
    let rig = on_processor(&[ShadowMethod::VoxelMap, ShadowMethod::Exact]);
    let request = LiveRequest {
        view: LiveView { measures: true, shows: LiveShows::PictureError, ..LiveView::default() },
        ..rig.request(&[0, 1])
    };
    rig.draw(request.clone());
    let before = rig.pane(0);
    let held = rig.live.held_bytes();
    assert!(held > 100_000, "{held} bytes");
    let snapshots = Arc::strong_count(&rig.snapshot);
    let pane = Arc::downgrade(&rig.pane(1));
    rig.live.rest();
    wait_until("the rest", || !rig.live.busy().load(Ordering::Relaxed));
    assert_eq!(rig.live.held_bytes(), 0);
    assert!(rig.live.pane(0).is_some_and(|slot| slot.latest().is_none()) && pane.strong_count() == 0);
    assert!(Arc::strong_count(&rig.snapshot) < snapshots, "the instant of the panes is not kept");
    rig.draw(request);
    assert!(pixels(&rig.pane(0)) == pixels(&before), "the same panes again");
    assert!(rig.live.held_bytes() > 0);
}

#[test]
fn a_pane_at_rest_shows_what_its_work_costs() {
    let mut rig = on_processor(&[ShadowMethod::VoxelMap, ShadowMethod::OpacityMaps]);
    rig.draw(rig.request(&[0, 1]));
    let costs = |rig: &Rig| [0, 1].map(|index| rig.pane(index).times);
    let first = costs(&rig);
    // Only the camera turns: the maps are kept.
    rig.project.camera.fov_y *= 0.9;
    rig.draw(rig.request(&[0, 1]));
    for (before, after) in first.into_iter().zip(costs(&rig)) {
        assert!(
            before.build.is_some_and(|ms| ms > 0.0) && before.ask.is_some_and(|ms| ms > 0.0),
            "{before:?}"
        );
        assert_eq!((after.build, after.ask), (before.build, before.ask), "of the same maps");
        assert!(after.draw.is_some_and(|ms| ms > 0.0) && after != before, "{after:?}");
        assert!(after.whole >= before.build.unwrap_or(0.0) + before.ask.unwrap_or(0.0));
    }
    // Negative control: with another extinction the maps are made again.
    rig.project.look.extinction_scale *= 0.5;
    rig.draw(rig.request(&[0, 1]));
    for (before, after) in first.into_iter().zip(costs(&rig)) {
        assert_ne!((after.build, after.ask), (before.build, before.ask));
    }
}
