//! False colours on the window's device, compared with those in memory.

use lovelock_render::Transparency;

use super::super::round::Rounds;
use super::*;

const SIZE: [u32; 2] = [160, 120];
/// What a frame reports: the sum of its transmittances and the heads of its lists.
const REPORT_BYTES: u64 = 4 * lovelock_shadow::SUM_WORDS + 5 * 16;

/// Panes on one device, which is the window's if `is_window`; `None` without an adapter.
fn rounds(is_window: bool) -> Option<(Rounds, WindowDevice)> {
    let gpu = match Renderer::open(Backend::Gpu) {
        Ok(renderer) => Arc::clone(renderer.gpu().expect("a device")),
        Err(error) => {
            lovelock_testkit::skip_without_adapter(&error);
            return None;
        }
    };
    let window = WindowDevice::default();
    window.set(is_window.then(|| gpu.handle()));
    let open = move |_: Backend, _: Option<&Arc<Gpu>>| Renderer::on_window(&gpu, Backend::Gpu);
    Some((Rounds::new(super::Renderers::new(Box::new(open), window.clone())), window))
}

/// Renders pane 0.
fn drawn(rounds: &mut Rounds, request: &LiveRequest) -> LivePane {
    rounds.begin(request);
    let (pane, broken) = rounds.pane(request, 0);
    assert!(broken.is_none() && pane.problem.is_none(), "{:?}", pane.problem);
    rounds.finish(0);
    pane
}

/// The mean difference of a colour, of 255, and the fraction of pixels that differ by more than 8.
fn off(a: &Picture, b: &Picture) -> (f64, f64) {
    assert_eq!((a.width, a.height), (b.width, b.height));
    let apart = || a.rgba.iter().zip(&b.rgba).map(|(a, b)| a.abs_diff(*b));
    let sum = apart().map(f64::from).fold(0.0, |sum, apart| sum + apart);
    let apart: Vec<u8> = apart().collect();
    let far = apart.chunks_exact(4).filter(|pixel| pixel.iter().any(|&apart| apart > 8)).count();
    (sum / apart.len() as f64, far as f64 / f64::from(a.width * a.height))
}

#[test]
fn false_colours_on_the_device_are_those_in_memory() {
    let rig = on_processor(&[ShadowMethod::OpacityMaps]);
    let (Some((mut device, window)), Some((mut memory, _))) = (rounds(true), rounds(false)) else { return };
    let gpu = window.get().expect("a device");
    for transparency in
        lovelock_testkit::suite::sample([Transparency::Exact, Transparency::WeightedAverage], 2)
    {
        let mut project = rig.project.clone();
        (project.compare.panes[0].backend, project.compare.panes[0].transparency) =
            (Backend::Gpu, transparency);
        let ask = |shows, largest| LiveRequest {
            project: Arc::new(project.clone()),
            width: SIZE[0],
            height: SIZE[1],
            view: LiveView { shows, largest, ..LiveView::default() },
            ..rig.request(&[0])
        };
        for shows in [LiveShows::TransmittanceError, LiveShows::TransmittanceBias] {
            let before = gpu.traffic();
            let pane = drawn(&mut device, &ask(shows, 0.25));
            assert_eq!(gpu.traffic().since(before).bytes_up, 0, "the window receives no pixels");
            assert!(pane.image.on_device().is_some() && pane.times.whole > 0.0);
            let found = pixels(&pane);
            let held = drawn(&mut memory, &ask(shows, 0.25));
            assert!(held.image.on_device().is_none());
            assert_eq!(held.error, pane.error);
            let (mean, far) = off(&found, &pixels(&held));
            let (control, control_far) = off(&found, &pixels(&drawn(&mut memory, &ask(shows, 0.2))));
            println!(
                "{transparency}, {shows:?}: {mean:.4}, {far:.5}; control {control:.4}, {control_far:.5}"
            );
            // Strands whose depths are almost equal may be ordered differently. Measured on a software adapter: at most 0.032 and 0.0011;
            // another range of the colours gives at least 0.32 and 0.020.
            assert!(mean < 0.1 && far < 0.004, "{transparency}, {shows:?}: {mean} {far}");
            assert!(control > 0.2 && control_far > 0.01, "{control} {control_far}");
        }
        // The lists are long enough now: of the image nothing but the transmittance comes back.
        let points = rig.snapshot.scene.style.strands.points() as u64;
        let traffic = |rounds: &mut Rounds| {
            rounds
                .renderers
                .last(0)
                .and_then(|renderer| renderer.gpu().map(|gpu| gpu.traffic()))
                .expect("one")
        };
        let before = traffic(&mut device);
        drawn(&mut device, &ask(LiveShows::TransmittanceError, 0.25));
        let back = traffic(&mut device).since(before).bytes_back;
        assert_eq!(back, 4 * points + REPORT_BYTES + 8);
        let before = traffic(&mut memory);
        drawn(&mut memory, &ask(LiveShows::TransmittanceError, 0.25));
        let more = traffic(&mut memory).since(before).bytes_back;
        assert_eq!(
            more,
            4 * points + REPORT_BYTES + u64::from(4 * SIZE[0] * SIZE[1]),
            "control: with pixels"
        );
    }
}

#[test]
fn a_pane_on_the_device_changes_between_picture_and_colours() {
    let mut rig = on_processor(&[ShadowMethod::None]);
    let Some((mut device, _)) = rounds(true) else { return };
    rig.project.compare.panes[0].backend = Backend::Gpu;
    let ask = |shows| LiveRequest {
        view: LiveView { shows, ..LiveView::default() },
        width: SIZE[0],
        height: SIZE[1],
        ..rig.request(&[0])
    };
    let order = [LiveShows::Picture, LiveShows::TransmittanceError, LiveShows::PictureError];
    let [first, second] = [0; 2].map(|_| order.map(|shows| drawn(&mut device, &ask(shows))));
    for (a, b) in first.iter().zip(&second) {
        assert!(pixels(a) == pixels(b), "{:?}", a.shows);
        assert!(a.image.on_device().is_some() && a.colors_problem.is_none());
    }
    assert!(pixels(&first[0]) != pixels(&first[1]) && pixels(&first[1]) != pixels(&first[2]));
    // Without a light there are no colours, and the reason is there.
    let view = LiveView { light: 77, shows: LiveShows::TransmittanceError, ..LiveView::default() };
    let pane = drawn(&mut device, &LiveRequest { view, ..ask(LiveShows::Picture) });
    assert!(pane.colors_problem.is_some() && pane.image.is_empty());
}
