//! Panes on a small scene, on the processor; a lost device on an adapter.

use std::sync::mpsc::{Receiver, sync_channel};
use std::time::Duration;

use lovelock_render::{Backend, CpuRenderer, Gpu, GpuError, Picture, RenderError, ShadowMethod};

use super::*;
use crate::session::tests::small_project;
use crate::{Access, Contender, Engine, FrameSnapshot, Project, SceneLoader};

/// The thread on what a test opens, and one instant.
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
        let snapshot = Engine::new(scene, project.simulation).snapshot();
        let (sender, finished) = sync_channel(64);
        let wake = move || {
            let _ = sender.try_send(());
        };
        let live = Live::start_with(open, wake).expect("a thread");
        Self { live, project, snapshot, finished }
    }

    fn request(&self, panes: &[usize]) -> LiveRequest {
        LiveRequest {
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

    /// Asks for panes, and waits until nothing is drawn any more.
    fn draw(&self, request: LiveRequest) {
        self.live.request(request);
        while self.live.busy().load(Ordering::Relaxed) {
            // A guard against waiting for ever.
            self.finished.recv_timeout(Duration::from_secs(100)).expect("an end");
        }
    }

    fn pane(&self, index: usize) -> Arc<LivePane> {
        self.live.pane(index).expect("a slot").latest().expect("a pane")
    }
}

fn on_processor(methods: &[ShadowMethod]) -> Rig {
    Rig::new(Box::new(Renderer::open), Backend::Cpu, methods)
}

/// What the window's single picture would be.
fn alone(rig: &Rig, index: usize, width: u32, height: u32) -> Picture {
    let project = rig.project.compare.panes[index].applied_to(&rig.project);
    let camera = rig.snapshot.camera(&project.camera);
    let mut picture = Picture::default();
    let input = rig.snapshot.frame_input(&project, &camera);
    CpuRenderer::default().picture(&input, width, height, &mut picture).expect("a picture");
    picture
}

#[test]
fn each_pane_is_the_picture_that_its_settings_draw_alone() {
    let rig = on_processor(&[ShadowMethod::VoxelMap, ShadowMethod::None, ShadowMethod::OccupancyMaps]);
    rig.draw(rig.request(&[0, 1, 2]));
    for index in 0..3 {
        let pane = rig.pane(index);
        assert_eq!(pane.problem, None);
        assert_eq!(pane.contender, rig.project.compare.panes[index]);
        assert_eq!((pane.step, pane.adapter.backend), (rig.snapshot.step, Backend::Cpu));
        assert!(pane.times.whole() > 0.0);
        assert!(pane.picture == alone(&rig, index, 64, 48), "pane {index}");
    }
    assert!(rig.pane(0).picture != rig.pane(1).picture, "shadows are seen");
    assert!(rig.pane(0).shadow_bytes > 0 && rig.pane(1).shadow_bytes == 0);
}

#[test]
fn a_smaller_pane_is_drawn_smaller_and_others_are_left_alone() {
    let mut rig = on_processor(&[ShadowMethod::VoxelMap, ShadowMethod::None]);
    rig.project.compare.panes[1].scale = 0.5;
    rig.draw(rig.request(&[1, 7]));
    assert!(rig.live.pane(0).expect("a slot").latest().is_none(), "nobody asked for it");
    assert!(rig.live.pane(7).is_none());
    let picture = &rig.pane(1).picture;
    assert_eq!((picture.width, picture.height), (32, 24));
    assert!(*picture == alone(&rig, 1, 32, 24));
}

#[test]
fn how_much_light_hair_blocks_is_the_projects() {
    let mut rig = on_processor(&[ShadowMethod::VoxelMap]);
    rig.project.compare.panes[0].shadow.extinction_scale = 4.0;
    rig.draw(rig.request(&[0]));
    assert!(rig.pane(0).picture != alone(&rig, 0, 64, 48), "a pane of its own scale would look so");
    rig.project.compare.panes[0].shadow.extinction_scale = rig.project.shadow.extinction_scale;
    assert!(rig.pane(0).picture == alone(&rig, 0, 64, 48));
}

#[test]
fn a_pane_that_cannot_be_drawn_says_why_and_the_others_come() {
    let mut rig = on_processor(&[ShadowMethod::None, ShadowMethod::VoxelMap]);
    rig.project.compare.panes[1].scale = 0.1;
    let wide = LiveRequest { width: lovelock_render::MOST_SIDE + 8, ..rig.request(&[0, 1]) };
    rig.draw(wide);
    let problem = rig.pane(0).problem.clone().expect("a sentence");
    assert!(problem.contains("8192") && !problem.contains('\n'), "{problem}");
    assert!(rig.pane(0).picture.rgba.is_empty());
    assert_eq!(rig.pane(1).problem, None);
    rig.draw(rig.request(&[0, 1]));
    assert_eq!(rig.pane(0).problem, None, "it comes as soon as it can");
}

#[test]
fn panes_of_a_round_can_come_together() {
    let rig = on_processor(&[ShadowMethod::None; 6]);
    let seen = |rig: &Rig| (0..6).map(|i| rig.live.pane(i).expect("a slot").number()).collect::<Vec<_>>();
    for round in 1..=3 {
        rig.live.request(LiveRequest { together: true, ..rig.request(&[0, 1, 2, 3, 4, 5]) });
        while rig.live.busy().load(Ordering::Relaxed) {
            rig.finished.recv_timeout(Duration::from_secs(100)).expect("an end");
        }
        assert_eq!(seen(&rig), [round; 6]);
        // One call a round: nobody is told of a part of it.
        assert!(rig.finished.try_recv().is_err());
    }
    rig.draw(rig.request(&[0, 1]));
    assert_eq!(seen(&rig), [4, 4, 3, 3, 3, 3]);
    assert!(rig.finished.try_recv().is_ok(), "a call a pane otherwise");
}

#[test]
fn a_lost_device_is_opened_again_for_all_panes_on_it() {
    let devices = Arc::new(Mutex::new(Vec::<Arc<Gpu>>::new()));
    let noted = Arc::clone(&devices);
    let open = move |choice| {
        let renderer = Renderer::open(choice)?;
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
        assert_eq!(pane.problem, None, "drawn again although nobody asked");
        assert!(pane.picture == before.picture, "pane {index}");
    }
}

#[test]
fn a_card_that_always_fails_leaves_its_panes_to_the_processor_or_says_so() {
    for (backend, drawn) in [(Backend::Auto, true), (Backend::Gpu, false)] {
        let open = |choice| match choice {
            Backend::Cpu => Renderer::open(choice),
            _ => Err::<_, RenderError>(GpuError::Lost("for this test".to_owned()).into()),
        };
        let rig = Rig::new(Box::new(open), backend, &[ShadowMethod::None]);
        rig.draw(rig.request(&[0]));
        assert_eq!(rig.pane(0).problem.is_none(), drawn, "{backend}: {:?}", rig.pane(0).problem);
        assert_eq!(rig.live.notices().latest().is_some(), drawn || backend == Backend::Gpu);
    }
}
