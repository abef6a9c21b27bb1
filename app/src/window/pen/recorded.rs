//! Recordings of pens, in the form in which the tools of each system print events, and what must become of them.

use egui::{Event, PointerButton, pos2};

use super::contact::{End, PenEvent, Pens};
use super::wayland::{ToolEvent, Tools};
use super::x11::{Action, Device, Raw, end_of, events_of};

/// A press, a stroke and a release of a pen, then of its eraser end, as `xinput test-xi2 --root` prints them.
const X11: &str = include_str!("recorded/x11.txt");
/// The same as `WAYLAND_DEBUG=1` prints it.
const WAYLAND: &str = include_str!("recorded/wayland.txt");

/// The events of a recording of an X server.
fn raws(text: &str) -> Vec<Raw> {
    let mut raws: Vec<Raw> = Vec::new();
    for line in text.lines().map(str::trim) {
        if let Some(kind) = line.strip_prefix("EVENT type ") {
            let action = match kind.split(' ').next() {
                Some("15") => Action::Press(0),
                Some("16") => Action::Release(0),
                _ => Action::Motion,
            };
            raws.push(Raw { device: 0, action, valuators: Vec::new() });
        }
        let Some(raw) = raws.last_mut() else { continue };
        let Some((name, value)) = line.split_once(": ") else { continue };
        let first = value.split(' ').next().unwrap_or_default();
        match name {
            "device" => raw.device = first.parse().expect("a device"),
            "detail" => {
                let button = first.parse().expect("a button");
                raw.action = match raw.action {
                    Action::Press(_) => Action::Press(button),
                    Action::Release(_) => Action::Release(button),
                    Action::Motion => Action::Motion,
                };
            }
            axis => {
                if let (Ok(axis), Ok(value)) = (axis.parse(), first.parse()) {
                    raw.valuators.push((axis, value));
                }
            }
        }
    }
    raws
}

#[test]
fn a_recording_of_an_x_server_gives_pressure_and_eraser() {
    let device = |id, name| Device { id, end: end_of(name), axis: 2, range: [0.0, 2047.0] };
    let devices = [device(11, "Wacom Intuos Pro M Pen stylus"), device(14, "Wacom Intuos Pro M Pen eraser")];
    let mut pens = Pens::default();
    for device in &devices {
        pens.add(u32::from(device.id), device.end);
    }
    let mut touched = Vec::new();
    for raw in raws(X11) {
        let Some(device) = devices.iter().find(|device| device.id == raw.device) else { continue };
        for event in events_of(device, &raw) {
            pens.hear(u32::from(device.id), event);
        }
        touched.push(pens.take().map(|touch| (touch.end, (touch.pressure(0, 1) * 2047.0).round())));
    }
    let (tip, eraser) = (|p| Some((End::Tip, p)), |p| Some((End::Eraser, p)));
    // Hovering, pressing harder, resting, releasing; a mouse is not heard; then the other end.
    let wanted = [
        None,
        tip(96.0),
        tip(96.0),
        tip(512.0),
        tip(512.0),
        tip(1535.0),
        tip(1535.0),
        None,
        eraser(820.0),
        eraser(820.0),
        eraser(1024.0),
        eraser(1024.0),
        None,
    ];
    assert_eq!(touched, wanted);
}

#[test]
fn other_buttons_and_axes_of_an_x_server_press_nothing() {
    let device = Device { id: 11, end: End::Tip, axis: 2, range: [0.0, 2047.0] };
    let raw = |action, valuators| Raw { device: 11, action, valuators };
    assert_eq!(events_of(&device, &raw(Action::Press(3), vec![(0, 5.0), (1, 9.0)])), []);
    assert_eq!(events_of(&device, &raw(Action::Motion, vec![(2, 2047.0)])), [PenEvent::Pressure(1.0)]);
    let empty = Device { range: [0.0, 0.0], ..device };
    assert!(
        matches!(events_of(&empty, &raw(Action::Motion, vec![(2, 0.0)]))[..], [PenEvent::Pressure(p)] if p == 0.0)
    );
}

/// The events of a recording of Wayland: `[time] interface@id.event(arguments)`.
fn tools(text: &str) -> Vec<(u32, ToolEvent)> {
    let mut events = Vec::new();
    for line in text.lines() {
        let Some((_, rest)) = line.split_once("zwp_tablet_tool_v2@") else { continue };
        // Its number may also stand among the arguments of another object.
        let Some((id, rest)) = rest.split_once('.') else { continue };
        let (name, arguments) = rest.trim_end_matches(')').split_once('(').expect("arguments");
        let arguments: Vec<&str> = arguments.split(", ").collect();
        let number = |at: usize| arguments[at].parse::<f64>().expect("a number");
        let event = match name {
            "type" => ToolEvent::Kind(if arguments[0] == "321" { End::Eraser } else { End::Tip }),
            "proximity_in" => ToolEvent::Near { over_window: arguments[2] == "wl_surface@17" },
            "proximity_out" => ToolEvent::Away,
            "down" => ToolEvent::Down,
            "up" => ToolEvent::Up,
            "motion" => ToolEvent::Motion([number(0), number(1)]),
            "pressure" => ToolEvent::Pressure(number(0) as u32),
            "button" => ToolEvent::Button { button: number(1) as u32, pressed: arguments[2] == "1" },
            "frame" => ToolEvent::Frame,
            "removed" => ToolEvent::Removed,
            _ => continue,
        };
        events.push((id.parse().expect("an id"), event));
    }
    events
}

#[test]
fn a_recording_of_wayland_gives_pressure_eraser_and_pointer() {
    let (mut pens, mut state, mut events) = (Pens::default(), Tools::default(), Vec::new());
    let mut touched = Vec::new();
    for (device, event) in tools(WAYLAND) {
        state.hear(device, event, (&mut pens, 2.0), &mut events);
        if event == ToolEvent::Frame {
            touched.push(pens.take().map(|touch| (touch.end, (touch.pressure(0, 1) * 65_535.0).round())));
        }
    }
    let (tip, eraser) = (|p| Some((End::Tip, p)), |p| Some((End::Eraser, p)));
    assert_eq!(
        touched,
        [None, tip(4096.0), tip(32_768.0), tip(32_768.0), None, None, eraser(20_000.0), None, None]
    );
    let moved: Vec<_> = events
        .iter()
        .filter_map(|event| if let Event::PointerMoved(at) = event { Some(*at) } else { None })
        .collect();
    // In points of an interface that is drawn twice as large.
    assert_eq!(moved[..3], [pos2(320.0, 240.0), pos2(321.0, 240.5), pos2(330.0, 250.0)]);
    let clicks: Vec<_> = events
        .iter()
        .filter_map(|event| match event {
            Event::PointerButton { button, pressed, .. } => Some((*button, *pressed)),
            _ => None,
        })
        .collect();
    let (first, second) = (PointerButton::Primary, PointerButton::Secondary);
    let wanted =
        [(first, true), (second, true), (second, false), (first, false), (first, true), (first, false)];
    assert_eq!(clicks, wanted);
    assert_eq!(events.iter().filter(|event| **event == Event::PointerGone).count(), 2);
}

#[test]
fn a_pen_over_another_surface_does_nothing_here() {
    let elsewhere = WAYLAND.replace("wl_surface@17", "wl_surface@18");
    let (mut pens, mut state, mut events) = (Pens::default(), Tools::default(), Vec::new());
    for (device, event) in tools(&elsewhere) {
        state.hear(device, event, (&mut pens, 1.0), &mut events);
        assert_eq!(pens.take(), None);
    }
    assert_eq!(events, []);
}
