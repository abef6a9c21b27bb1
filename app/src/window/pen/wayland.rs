//! Pens of a Wayland desktop, by the tablet protocol (`tablet-v2`), on the display of the window.
//!
//! A desktop moves the pointer by a pen only while a program does not ask for the pen itself. So what the pen does over the window is added to the
//! input of the window here.

#![allow(unsafe_code)]

use std::ffi::c_void;
use std::ptr::NonNull;
use std::time::Duration;

use egui::{Event, Modifiers, PointerButton, RawInput, pos2};
use raw_window_handle::{HasDisplayHandle as _, HasWindowHandle as _, RawDisplayHandle, RawWindowHandle};
use wayland_backend::client::Backend;
use wayland_client::globals::{GlobalListContents, registry_queue_init};
use wayland_client::protocol::{wl_registry, wl_seat};
use wayland_client::{Connection, Dispatch, EventQueue, Proxy as _, QueueHandle, WEnum, event_created_child};
use wayland_protocols::wp::tablet::zv2::client::{
    zwp_tablet_manager_v2 as manager, zwp_tablet_pad_dial_v2 as pad_dial,
    zwp_tablet_pad_group_v2 as pad_group, zwp_tablet_pad_ring_v2 as pad_ring,
    zwp_tablet_pad_strip_v2 as pad_strip, zwp_tablet_pad_v2 as pad, zwp_tablet_seat_v2 as seat,
    zwp_tablet_tool_v2 as tool, zwp_tablet_v2 as tablet,
};

use super::contact::{End, PenEvent, Pens};

/// How often the window asks for pens while nothing else happens in it.
const ASKS: Duration = Duration::from_millis(40);
/// The pressure of a pen that is pressed as hard as it can be.
const FULL: f32 = 65_535.0;
/// The buttons at the side of a pen, as the kernel numbers them.
const STYLUS: u32 = 0x14b;
const STYLUS_2: u32 = 0x14c;

/// What a tool reports, in the words of the protocol.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ToolEvent {
    /// It is an eraser, or a pen or brush of any other kind.
    Kind(End),
    /// It is near the tablet, over the window or over another surface.
    Near {
        over_window: bool,
    },
    Away,
    Down,
    Up,
    /// Where it is on the surface, in its units.
    Motion([f64; 2]),
    /// 0 to 65535.
    Pressure(u32),
    Button {
        button: u32,
        pressed: bool,
    },
    /// What was reported since the last one happened at once.
    Frame,
    Removed,
}

/// One tool.
#[derive(Clone, Debug, Default)]
struct Tool {
    device: u32,
    is_over: bool,
    at: Option<[f64; 2]>,
    /// The events of the frame that has not ended.
    frame: Vec<ToolEvent>,
}

/// All tools, from what they report to pressures and to what a pointer would do.
#[derive(Clone, Debug, Default)]
pub(super) struct Tools(Vec<Tool>);

impl Tools {
    /// Takes an event of a tool. At the end of a frame, adds what a pointer would do to `events`; positions are divided by `scale`.
    pub(super) fn hear(
        &mut self,
        device: u32,
        event: ToolEvent,
        (pens, scale): (&mut Pens, f32),
        events: &mut Vec<Event>,
    ) {
        if !self.0.iter().any(|tool| tool.device == device) {
            self.0.push(Tool { device, ..Tool::default() });
            pens.add(device, End::Tip);
        }
        let Some(at) = self.0.iter().position(|tool| tool.device == device) else { return };
        match event {
            ToolEvent::Kind(end) => pens.add(device, end),
            ToolEvent::Removed => {
                pens.remove(device);
                self.0.remove(at);
            }
            ToolEvent::Frame => {
                for event in std::mem::take(&mut self.0[at].frame) {
                    self.0[at].act(event, (&mut *pens, scale), events);
                }
            }
            event => self.0[at].frame.push(event),
        }
    }

    /// Whether any is near a tablet over the window.
    fn are_near(&self) -> bool {
        self.0.iter().any(|tool| tool.is_over)
    }
}

impl Tool {
    fn act(&mut self, event: ToolEvent, (pens, scale): (&mut Pens, f32), events: &mut Vec<Event>) {
        let pos = |at: [f64; 2]| pos2(at[0] as f32 / scale, at[1] as f32 / scale);
        let click = |button, pressed, at: Option<[f64; 2]>| {
            at.map(|at| Event::PointerButton { pos: pos(at), button, pressed, modifiers: Modifiers::NONE })
        };
        match event {
            ToolEvent::Near { over_window } => self.is_over = over_window,
            ToolEvent::Away => {
                if self.is_over {
                    events.push(Event::PointerGone);
                }
                (self.is_over, self.at) = (false, None);
                pens.hear(self.device, PenEvent::Away);
            }
            _ if !self.is_over => {}
            ToolEvent::Motion(at) if at.iter().all(|side| side.is_finite()) => {
                self.at = Some(at);
                events.push(Event::PointerMoved(pos(at)));
            }
            ToolEvent::Pressure(pressure) => {
                pens.hear(self.device, PenEvent::Pressure(pressure as f32 / FULL));
            }
            ToolEvent::Down => {
                pens.hear(self.device, PenEvent::Down);
                events.extend(click(PointerButton::Primary, true, self.at));
            }
            ToolEvent::Up => {
                pens.hear(self.device, PenEvent::Up);
                events.extend(click(PointerButton::Primary, false, self.at));
            }
            ToolEvent::Button { button: STYLUS, pressed } => {
                events.extend(click(PointerButton::Secondary, pressed, self.at));
            }
            ToolEvent::Button { button: STYLUS_2, pressed } => {
                events.extend(click(PointerButton::Middle, pressed, self.at));
            }
            _ => {}
        }
    }
}

/// The tablets of a display.
pub(super) struct Tablets {
    heard: Heard,
    queue: EventQueue<Heard>,
    tools: Tools,
}

/// What the display has reported.
#[derive(Default)]
struct Heard {
    /// The surface of the window.
    window: Option<NonNull<c_void>>,
    events: Vec<(u32, ToolEvent)>,
    has_tablets: bool,
    seats: Vec<(wl_seat::WlSeat, seat::ZwpTabletSeatV2)>,
}

impl Tablets {
    /// The tablets of the display of a window; `None` if it has no tablet protocol.
    pub(super) fn of(creation: &eframe::CreationContext<'_>) -> Option<Self> {
        let RawDisplayHandle::Wayland(display) = creation.display_handle().ok()?.as_raw() else {
            return None;
        };
        let window = match creation.window_handle().ok()?.as_raw() {
            RawWindowHandle::Wayland(window) => Some(window.surface),
            _ => None,
        };
        // SAFETY: the display is that of the window, and `Pen::close` drops this before the window and its display.
        let backend = unsafe { Backend::from_foreign_display(display.display.as_ptr().cast()) };
        match Self::on(&Connection::from_backend(backend), window) {
            Ok(tablets) => Some(tablets),
            Err(error) => {
                tracing::debug!(%error, "pens are not heard");
                None
            }
        }
    }

    fn on(
        connection: &Connection,
        window: Option<NonNull<c_void>>,
    ) -> Result<Self, Box<dyn std::error::Error>> {
        let (globals, mut queue) = registry_queue_init::<Heard>(connection)?;
        let handle = queue.handle();
        let manager: manager::ZwpTabletManagerV2 = globals.bind(&handle, 1..=1, ())?;
        let mut heard = Heard { window, ..Heard::default() };
        for global in globals.contents().clone_list() {
            if global.interface == "wl_seat" {
                let of: wl_seat::WlSeat = globals.registry().bind(global.name, 1, &handle, ());
                let tablets = manager.get_tablet_seat(&of, &handle, ());
                heard.seats.push((of, tablets));
            }
        }
        queue.roundtrip(&mut heard)?;
        Ok(Self { heard, queue, tools: Tools::default() })
    }

    /// Adds what tools did since the last call.
    pub(super) fn hear(&mut self, pens: &mut Pens, ctx: &egui::Context, input: &mut RawInput) {
        // The window has read the display. What it read for other listeners waits here.
        if let Err(error) = self.queue.dispatch_pending(&mut self.heard) {
            tracing::debug!(%error, "pens are no longer heard");
            return;
        }
        let _ = self.queue.flush();
        let mut events = Vec::new();
        for (device, event) in self.heard.events.drain(..) {
            self.tools.hear(device, event, (&mut *pens, ctx.zoom_factor()), &mut events);
        }
        let held = ctx.input(|input| input.modifiers);
        for event in &mut events {
            if let Event::PointerButton { modifiers, .. } = event {
                *modifiers = held;
            }
        }
        input.events.extend(events);
        if self.tools.are_near() {
            ctx.request_repaint();
        } else if self.heard.has_tablets {
            ctx.request_repaint_after(ASKS);
        }
    }
}

impl Dispatch<tool::ZwpTabletToolV2, ()> for Heard {
    fn event(
        heard: &mut Self,
        proxy: &tool::ZwpTabletToolV2,
        event: tool::Event,
        (): &(),
        _: &Connection,
        _: &QueueHandle<Self>,
    ) {
        use tool::{ButtonState, Event as E, Type};
        let event = match event {
            E::Type { tool_type: WEnum::Value(Type::Eraser) } => ToolEvent::Kind(End::Eraser),
            E::Type { .. } => ToolEvent::Kind(End::Tip),
            E::ProximityIn { surface, .. } => {
                let surface = surface.id().as_ptr().cast::<c_void>();
                let over_window = heard.window.is_some_and(|window| window.as_ptr() == surface);
                ToolEvent::Near { over_window }
            }
            E::ProximityOut => ToolEvent::Away,
            E::Down { .. } => ToolEvent::Down,
            E::Up => ToolEvent::Up,
            E::Motion { x, y } => ToolEvent::Motion([x, y]),
            E::Pressure { pressure } => ToolEvent::Pressure(pressure),
            E::Button { button, state, .. } => {
                ToolEvent::Button { button, pressed: state == WEnum::Value(ButtonState::Pressed) }
            }
            E::Frame { .. } => ToolEvent::Frame,
            E::Removed => {
                proxy.destroy();
                ToolEvent::Removed
            }
            _ => return,
        };
        heard.events.push((proxy.id().protocol_id(), event));
    }
}

impl Dispatch<seat::ZwpTabletSeatV2, ()> for Heard {
    fn event(
        heard: &mut Self,
        _: &seat::ZwpTabletSeatV2,
        event: seat::Event,
        (): &(),
        _: &Connection,
        _: &QueueHandle<Self>,
    ) {
        heard.has_tablets |= matches!(event, seat::Event::TabletAdded { .. });
    }

    event_created_child!(Heard, seat::ZwpTabletSeatV2, [
        seat::EVT_TABLET_ADDED_OPCODE => (tablet::ZwpTabletV2, ()),
        seat::EVT_TOOL_ADDED_OPCODE => (tool::ZwpTabletToolV2, ()),
        seat::EVT_PAD_ADDED_OPCODE => (pad::ZwpTabletPadV2, ()),
    ]);
}

impl Dispatch<wl_registry::WlRegistry, GlobalListContents> for Heard {
    fn event(
        _: &mut Self,
        _: &wl_registry::WlRegistry,
        _: wl_registry::Event,
        _: &GlobalListContents,
        _: &Connection,
        _: &QueueHandle<Self>,
    ) {
    }
}

/// Objects whose events say nothing about pens.
macro_rules! ignored {
    ($($interface:ty $(, $opcode:pat => $child:ty)*;)*) => {
        $(impl Dispatch<$interface, ()> for Heard {
            fn event(
                _: &mut Self,
                _: &$interface,
                _: <$interface as wayland_client::Proxy>::Event,
                (): &(),
                _: &Connection,
                _: &QueueHandle<Self>,
            ) {
            }

            event_created_child!(Heard, $interface, [$($opcode => ($child, ()),)*]);
        })*
    };
}

ignored! {
    wl_seat::WlSeat;
    manager::ZwpTabletManagerV2;
    tablet::ZwpTabletV2;
    pad::ZwpTabletPadV2, pad::EVT_GROUP_OPCODE => pad_group::ZwpTabletPadGroupV2;
    pad_group::ZwpTabletPadGroupV2,
        pad_group::EVT_RING_OPCODE => pad_ring::ZwpTabletPadRingV2,
        pad_group::EVT_STRIP_OPCODE => pad_strip::ZwpTabletPadStripV2,
        pad_group::EVT_DIAL_OPCODE => pad_dial::ZwpTabletPadDialV2;
    pad_ring::ZwpTabletPadRingV2;
    pad_strip::ZwpTabletPadStripV2;
    pad_dial::ZwpTabletPadDialV2;
}
