//! Pens of tablets: their pressure and their eraser end, which the windowing library does not report on X11 and Wayland.
//!
//! On X11 a thread with a connection of its own hears what pens do, beside the events of the window ([`x11`]). On Wayland a pen that is heard
//! no longer moves the pointer, so its motion and its buttons are handed to the window as well ([`wayland`]). Elsewhere, and where a system has no
//! tablets, nothing listens and nothing is said.

mod contact;
#[cfg(all(test, target_os = "linux"))]
mod recorded;
#[cfg(target_os = "linux")]
mod wayland;
#[cfg(target_os = "linux")]
mod x11;

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use contact::End;
use contact::Pens;
pub(crate) use contact::Touch;

/// What is heard of pens, for the strokes of brushes.
#[derive(Default)]
pub(crate) struct Pen {
    pens: Arc<Mutex<Pens>>,
    /// The pressures since the last pass, and the end that touches.
    pass: Option<Touch>,
    #[cfg(target_os = "linux")]
    has_thread: bool,
    #[cfg(target_os = "linux")]
    tablets: Option<wayland::Tablets>,
}

fn lock(pens: &Mutex<Pens>) -> MutexGuard<'_, Pens> {
    pens.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Pen {
    /// Begins to listen for the pens of the window's display.
    pub(crate) fn listen(&mut self, creation: &eframe::CreationContext<'_>) {
        #[cfg(target_os = "linux")]
        {
            use raw_window_handle::{HasDisplayHandle as _, RawDisplayHandle};
            let display = creation.display_handle().map(|handle| handle.as_raw());
            match display {
                // The thread stays when the window is opened again.
                Ok(RawDisplayHandle::Xlib(_) | RawDisplayHandle::Xcb(_)) if !self.has_thread => {
                    self.has_thread = true;
                    x11::listen(Arc::clone(&self.pens));
                }
                Ok(RawDisplayHandle::Wayland(_)) => self.tablets = wayland::Tablets::of(creation),
                _ => {}
            }
        }
        #[cfg(not(target_os = "linux"))]
        let _ = creation;
    }

    /// Stops listening. Must be called before the display is closed.
    pub(crate) fn close(&mut self) {
        #[cfg(target_os = "linux")]
        {
            self.tablets = None;
        }
    }

    /// Adds what pens do as a pointer to the input of a pass, where the desktop does not.
    pub(crate) fn hook(&mut self, ctx: &egui::Context, input: &mut egui::RawInput) {
        #[cfg(target_os = "linux")]
        if let Some(tablets) = &mut self.tablets {
            tablets.hear(&mut lock(&self.pens), ctx, input);
        }
        #[cfg(not(target_os = "linux"))]
        let _ = (ctx, input);
    }

    /// Takes what pens have done since the last pass.
    pub(crate) fn begin_pass(&mut self) {
        self.pass = lock(&self.pens).take();
    }

    /// The pressures of the pen that touches, in the order in which they came; `None` if none does.
    pub(crate) fn touch(&self) -> Option<&Touch> {
        self.pass.as_ref()
    }

    /// Whether the eraser end of a pen touches.
    pub(crate) fn erases(&self) -> bool {
        self.pass.as_ref().is_some_and(|touch| touch.end == End::Eraser)
    }

    /// As if a pen had done this.
    #[cfg(test)]
    pub(crate) fn hear_for_tests(&self, events: &[(End, f32)]) {
        let mut pens = lock(&self.pens);
        for (end, pressure) in events {
            let device = u32::from(*end == End::Eraser);
            pens.add(device, *end);
            let event = if *pressure > 0.0 { contact::PenEvent::Down } else { contact::PenEvent::Up };
            pens.hear(device, contact::PenEvent::Pressure(*pressure));
            pens.hear(device, event);
        }
    }
}

#[cfg(test)]
pub(crate) use contact::End as PenEnd;
