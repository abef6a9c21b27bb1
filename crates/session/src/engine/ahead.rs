//! Steps that a graphics device does while the step before them is drawn.
//!
//! Only playback in a window goes ahead. Between [`Engine::begin_step`] and [`Engine::finish_step`] nothing else may use the engine.

use lovelock_base::clock::Stopwatch;

use super::Engine;
use crate::window_device::WindowDevice;

impl Engine {
    /// Lets a graphics device that simulates hair be that of the window, which then draws guides from its memory.
    pub(crate) fn share(&mut self, window: &WindowDevice) {
        self.stepper.share(window);
    }

    /// Whether the next step may be begun with [`Engine::begin_step`].
    pub(crate) fn goes_ahead(&self) -> bool {
        self.stepper.goes_ahead()
    }

    /// Begins a step. It is done at once if no device does it.
    pub(crate) fn begin_step(&mut self) {
        self.finish_step();
        self.advance(true);
    }

    /// Waits for the step that was begun. Returns whether there was one.
    pub(crate) fn finish_step(&mut self) -> bool {
        let watch = Stopwatch::start();
        let Some(report) = self.stepper.finish(&mut self.simulation) else { return false };
        self.report = report;
        self.times.simulate += watch.ms();
        self.end_step();
        true
    }

    /// Reads what a device has kept of the hair, so that something else can go on with it.
    pub(super) fn complete(&mut self) {
        self.finish_step();
        self.stepper.complete(&mut self.simulation);
    }
}
