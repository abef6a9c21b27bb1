//! What advances the guides of an engine: the CPU, or a graphics device.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

use lovelock_render::{Backend, Gpu, GpuError, PooledBuffer};
use lovelock_simulation::device::StepDevice;
use lovelock_simulation::{Simulation, SimulationSettings, StepInput, StepReport};
use lovelock_simulation_gpu::{GuideDevice, GuideKernels, MIN_GUIDES};

use crate::window_device::WindowDevice;

/// Advances guides on the CPU or on a graphics device, which it opens when it first needs it.
#[derive(Debug, Default)]
pub(super) struct Stepper {
    choice: Option<Backend>,
    /// The device of the window, if steps are drawn there. There is none otherwise.
    window: WindowDevice,
    /// Kept for other hair and for copies, so that the device is opened once.
    kernels: KernelCell,
    device: Option<GuideDevice>,
    /// Whether the last step was that of the device.
    on_device: bool,
    /// Why the CPU goes on although a device was chosen.
    failure: Option<Failure>,
    note: Option<Arc<str>>,
}

/// Kernels on a device beside that of the window, once they are needed; of a stepper and its copies.
type KernelCell = Arc<Mutex<Option<Arc<GuideKernels>>>>;

/// How long the CPU goes on in place of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Failure {
    /// Until the choice changes or the window has another device than the one with this number: there is no device, it was lost, or its
    /// driver failed.
    Device(Option<u64>),
    /// While the hair has this many guides and points per guide, for which the device has no room.
    Size([usize; 2]),
}

impl Stepper {
    /// Lets steps use the device of the window, where they are drawn.
    pub(super) fn share(&mut self, window: &WindowDevice) {
        self.window = window.clone();
    }

    /// Sets the choice for `simulation`. Another one is tried even if the last device failed.
    pub(super) fn choose(&mut self, choice: Backend, simulation: &mut Simulation) {
        if self.choice != Some(choice) {
            if self.choice.is_some() {
                shared().has_no_card = false;
            }
            self.complete(simulation);
            let window = std::mem::take(&mut self.window);
            *self = Self { choice: Some(choice), window, ..Self::default() };
        }
    }

    /// One with the same choice, for a copy of the simulation. Its steps do not wait for images of the window.
    pub(super) fn copy(&self) -> Self {
        Self {
            choice: self.choice,
            window: WindowDevice::default(),
            kernels: Arc::clone(&self.kernels),
            device: None,
            on_device: self.on_device,
            failure: self.failure.filter(|_| !self.is_shared()),
            note: self.note.clone().filter(|_| !self.is_shared()),
        }
    }

    /// Takes that of a copy whose simulation goes on here, unless the choice has changed meanwhile.
    pub(super) fn take_settled(&mut self, aside: Self) {
        if aside.choice != self.choice {
            return;
        }
        self.on_device = aside.on_device;
        if !self.is_shared() {
            let window = std::mem::take(&mut self.window);
            *self = Self { window, ..aside };
        }
    }

    /// Whether the last step was that of a graphics device, and why not if one was chosen.
    pub(super) fn state(&self) -> (bool, Option<&Arc<str>>) {
        (self.on_device, self.note.as_ref())
    }

    /// Whether the next step may be begun while the last one is drawn.
    pub(super) fn goes_ahead(&self) -> bool {
        self.on_device && self.device.as_ref().is_some_and(GuideDevice::publishes)
    }

    /// One step of `simulation`.
    pub(super) fn step(
        &mut self,
        simulation: &mut Simulation,
        input: &StepInput,
        settings: &SimulationSettings,
        secs: f32,
    ) -> StepReport {
        let Some(device) = self.device_for(simulation) else { return simulation.step(input, settings, secs) };
        let (report, refusal) = simulation.step_on(device, input, settings, secs);
        self.done(refusal.as_deref(), simulation);
        report
    }

    /// The same, where a device only begins the step: then there is no report before [`Stepper::finish`].
    pub(super) fn begin(
        &mut self,
        simulation: &mut Simulation,
        input: &StepInput,
        settings: &SimulationSettings,
        secs: f32,
    ) -> Option<StepReport> {
        let Some(device) = self.device_for(simulation) else {
            return Some(simulation.step(input, settings, secs));
        };
        let (report, refusal) = simulation.begin_on(device, input, settings, secs)?;
        self.done(refusal.as_deref(), simulation);
        Some(report)
    }

    /// Waits for the step that was begun.
    pub(super) fn finish(&mut self, simulation: &mut Simulation) -> Option<StepReport> {
        let (report, refusal) = simulation.finish(self.device.as_mut()?)?;
        self.done(refusal.as_deref(), simulation);
        Some(report)
    }

    /// Brings what only the device has into `simulation`, so that something else can go on with it.
    pub(super) fn complete(&mut self, simulation: &mut Simulation) {
        simulation.complete(self.device.as_mut().map(|device| device as &mut dyn StepDevice));
    }

    /// The guides of `simulation` on the device of the window, if they are there.
    pub(super) fn guides(&self, simulation: &Simulation) -> Option<PooledBuffer> {
        self.device.as_ref()?.guides(simulation.state_stamp())
    }

    /// The device for the next step; `None` for the CPU, which then has the whole state.
    fn device_for(&mut self, simulation: &mut Simulation) -> Option<&mut GuideDevice> {
        let guides = &simulation.style().guides;
        let size = [guides.count(), guides.points_per_guide];
        let window = self.window.for_simulation();
        let number = window.as_ref().map(|gpu| gpu.number());
        let is_over = match self.failure {
            Some(Failure::Size(refused)) => refused != size,
            Some(Failure::Device(failed)) => number.is_some() && failed != number,
            None => false,
        };
        if is_over {
            (self.failure, self.note) = (None, None);
        }
        let wanted = match self.choice.unwrap_or(Backend::Cpu) {
            Backend::Cpu => false,
            Backend::Gpu => true,
            Backend::Auto => size[0] >= MIN_GUIDES,
        };
        let is_elsewhere = |device: &GuideDevice| {
            device.publishes() != window.is_some()
                || window.as_ref().is_some_and(|gpu| !gpu.is_same_device(device.gpu()))
        };
        self.on_device = wanted && self.failure.is_none();
        if !self.on_device || self.device.as_ref().is_some_and(is_elsewhere) {
            self.complete(simulation);
            self.device = None;
        }
        if self.on_device && self.device.is_none() {
            self.device = self.open(window);
            self.on_device = self.device.is_some();
        }
        self.device.as_mut()
    }

    /// A device without guides, that of the window if it is given. On failure, the CPU goes on.
    fn open(&mut self, window: Option<Arc<Gpu>>) -> Option<GuideDevice> {
        if let Some(gpu) = window {
            let compiled = GuideKernels::new(&gpu);
            let failed = compiled
                .inspect_err(|error| self.fail(Failure::Device(Some(gpu.number())), &error.to_string()));
            return failed.ok().map(|kernels| GuideDevice::new(Arc::new(kernels)).publishing());
        }
        let known = self.kernel_cell().clone().filter(|kernels| !kernels.gpu().is_lost());
        let found =
            known.map_or_else(|| kernels(self.choice == Some(Backend::Auto)), |known| Ok(Some(known)));
        match found {
            Ok(Some(kernels)) => {
                *self.kernel_cell() = Some(Arc::clone(&kernels));
                return Some(GuideDevice::new(kernels));
            }
            // Automatic chooses the CPU then, which is no failure to tell.
            Ok(None) => self.failure = Some(Failure::Device(None)),
            Err(reason) => self.fail(Failure::Device(None), &reason),
        }
        None
    }

    fn kernel_cell(&self) -> MutexGuard<'_, Option<Arc<GuideKernels>>> {
        self.kernels.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether steps are drawn on the device of the window.
    fn is_shared(&self) -> bool {
        self.window.for_simulation().is_some()
    }

    /// Notes how the step of the device has ended.
    fn done(&mut self, refusal: Option<&str>, simulation: &Simulation) {
        self.on_device = refusal.is_none();
        let (Some(reason), Some(device)) = (refusal, &self.device) else { return };
        let guides = &simulation.style().guides;
        let number = device.publishes().then(|| device.gpu().number());
        let failure = if device.has_room() {
            Failure::Device(number)
        } else {
            Failure::Size([guides.count(), guides.points_per_guide])
        };
        self.fail(failure, reason);
    }

    fn fail(&mut self, failure: Failure, reason: &str) {
        let note = format!("{reason}; the CPU simulates the hair");
        tracing::warn!("{note}");
        if matches!(failure, Failure::Device(_)) {
            *self.kernel_cell() = None;
        }
        (self.device, self.failure, self.note) = (None, Some(failure), Some(note.into()));
    }
}

/// What all engines of the program share.
struct Shared {
    /// The kernels, while one of the engines uses them.
    kernels: Weak<GuideKernels>,
    /// Whether there was no real graphics card when one was wanted last. Forgotten when a choice changes.
    has_no_card: bool,
}

fn shared() -> MutexGuard<'static, Shared> {
    static SHARED: Mutex<Shared> = Mutex::new(Shared { kernels: Weak::new(), has_no_card: false });
    SHARED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The shared kernels; `None` if a real graphics card is wanted (`real`) and there is none. They have a device beside that of the window:
/// a step that is read back at once would wait behind the images in the window's queue.
fn kernels(real: bool) -> Result<Option<Arc<GuideKernels>>, String> {
    let mut shared = shared();
    if real && shared.has_no_card {
        return Ok(None);
    }
    let known = shared.kernels.upgrade().filter(|kernels| !kernels.gpu().is_lost());
    let opened = match &known {
        Some(kernels) => Ok(Arc::clone(kernels.gpu())),
        None => Gpu::open(),
    };
    let gpu = match opened {
        Ok(gpu) => Some(gpu).filter(|gpu| !(real && gpu.is_software())),
        Err(GpuError::NoAdapter(_)) if real => None,
        Err(error) => return Err(error.to_string()),
    };
    let Some(gpu) = gpu else {
        shared.has_no_card = true;
        return Ok(None);
    };
    let kernels = match known {
        Some(kernels) => kernels,
        None => Arc::new(GuideKernels::new(&gpu).map_err(|error| error.to_string())?),
    };
    shared.kernels = Arc::downgrade(&kernels);
    Ok(Some(kernels))
}

/// The kernels for all tests of the crate, which are compiled once; `None` without an adapter, which is said.
#[cfg(test)]
pub(crate) fn kernels_for_tests() -> Option<&'static Arc<GuideKernels>> {
    static KERNELS: std::sync::OnceLock<Option<Arc<GuideKernels>>> = std::sync::OnceLock::new();
    let open =
        || kernels(false).inspect_err(|error| lovelock_testkit::skip_without_adapter(error)).ok().flatten();
    KERNELS.get_or_init(open).as_ref()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{farthest, load, scene, settled, small_project};

    fn has_adapter() -> bool {
        kernels_for_tests().is_some()
    }

    #[test]
    fn the_host_may_change_during_playback() {
        if !has_adapter() {
            return;
        }
        let mut project = small_project();
        project.timeline.preroll_secs = 0.1;
        project.picture.simulate = Backend::Cpu;
        let mut cpu = settled(scene(), &project);
        let mut mixed = cpu.copy();
        for step in 0..12 {
            project.picture.simulate = if step / 4 % 2 == 0 { Backend::Gpu } else { Backend::Cpu };
            mixed.follow(&project);
            mixed.step();
            cpu.step();
            assert_eq!(mixed.simulated_on_device(), (step / 4 % 2 == 0, None), "step {step}");
        }
        let apart = farthest(&cpu.snapshot(), &mixed.snapshot());
        println!("{apart} m apart");
        assert!(apart < 1e-4, "{apart} m");
        // A copy, as a pre-roll is, simulates where the original does.
        project.picture.simulate = Backend::Gpu;
        mixed.follow(&project);
        mixed.step();
        let mut copy = mixed.copy();
        copy.step();
        mixed.step();
        assert_eq!(copy.state_hash(), mixed.state_hash());
        assert_ne!(cpu.state_hash(), mixed.state_hash(), "control: other steps");
    }

    #[test]
    fn automatic_takes_the_cpu_for_little_hair() {
        let mut project = small_project();
        project.timeline.preroll_secs = 0.1;
        project.picture.simulate = Backend::Auto;
        let mut engine = settled(scene(), &project);
        engine.step();
        assert_eq!(engine.simulated_on_device(), (false, None));
        assert!(engine.scene().style.guides.count() < MIN_GUIDES);
    }

    #[test]
    fn a_lost_device_leaves_a_sentence_and_the_motion_goes_on() {
        // The driver compiles the kernels of the other tests first, and knows them then.
        if !has_adapter() {
            return;
        }
        let gpu = Gpu::open().expect("there is an adapter");
        let mut project = small_project();
        project.timeline.preroll_secs = 0.1;
        project.picture.simulate = Backend::Gpu;
        let mut engine = settled(scene(), &project);
        let kernels = Arc::new(GuideKernels::new(&gpu).expect("the kernels compile"));
        engine.stepper.device = Some(GuideDevice::new(kernels));
        engine.step();
        assert_eq!(engine.simulated_on_device(), (true, None));
        let before = engine.snapshot();
        gpu.device.destroy();
        engine.step();
        let (on_device, note) = engine.simulated_on_device();
        let note = note.expect("a sentence").to_string();
        assert!(!on_device && note.contains("lost") && note.contains("the CPU simulates"), "{note}");
        let after = engine.snapshot();
        assert_eq!(after.device_refusal.as_deref(), Some(&*note));
        let moved = farthest(&before, &after);
        assert!(moved > 0.0 && moved < 0.1, "{moved} m in a step");
        // Another choice, and back, tries again.
        for choice in [Backend::Cpu, Backend::Gpu] {
            project.picture.simulate = choice;
            engine.follow(&project);
            engine.step();
        }
        assert_eq!(engine.simulated_on_device(), (true, None));
    }

    #[test]
    fn settled_hair_goes_on_where_it_was_settled() {
        if !has_adapter() {
            return;
        }
        let mut project = small_project();
        project.timeline.preroll_secs = 0.1;
        project.picture.simulate = Backend::Gpu;
        let mut engine = settled(scene(), &project);
        assert!(engine.simulated_on_device().0 && engine.snapshot().on_device);
        // Another choice during a pre-roll applies to the settled hair.
        let mut preroll = engine.preroll();
        project.picture.simulate = Backend::Cpu;
        engine.follow(&project);
        while !preroll.advance() {}
        assert!(engine.take_settled(preroll), "it leads to this instant");
        engine.step();
        assert_eq!(engine.simulated_on_device(), (false, None));
    }

    #[test]
    fn only_a_refusal_because_of_size_is_forgotten_for_hair_of_another_size() {
        if !has_adapter() {
            return;
        }
        let mut project = small_project();
        project.timeline.preroll_secs = 0.1;
        project.picture.simulate = Backend::Gpu;
        let settled = settled(scene(), &project);
        let guides = &settled.scene().style.guides;
        let size = [guides.count(), guides.points_per_guide];
        project.hair.groom.wisps = 12;
        let fewer = load(&project).0;
        for (failure, is_forgotten) in [(Failure::Size(size), true), (Failure::Device(None), false)] {
            let mut engine = settled.copy();
            engine.stepper.fail(failure, "for this test");
            for (scene, on_device) in [(scene(), false), (Arc::clone(&fewer), is_forgotten)] {
                engine.set_scene(scene);
                engine.step();
                let (found, note) = engine.simulated_on_device();
                assert_eq!((found, note.is_none()), (on_device, on_device), "{failure:?}");
            }
        }
    }
}
