//! Pens of an X server, by the valuators of the X Input Extension 2.

use std::error::Error;
use std::sync::{Arc, Mutex};

use x11rb::connection::{Connection as _, RequestConnection as _};
use x11rb::protocol::Event;
use x11rb::protocol::xinput::{
    self, ConnectionExt as _, DeviceClassData, DeviceType, EventMask, Fp3232, XIDeviceInfo, XIEventMask,
};
use x11rb::protocol::xproto::{Atom, ConnectionExt as _};
use x11rb::rust_connection::RustConnection;

use super::contact::{End, PenEvent, Pens};
use super::lock;

/// The label of the valuator with the pressure.
const PRESSURE: &[u8] = b"Abs Pressure";
/// Every device, in requests for their list and for changes of it.
const ALL_DEVICES: u16 = 0;
/// The button of the tip.
const TIP: u32 = 1;

/// A device that has a pressure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Device {
    pub(super) id: u16,
    pub(super) end: End,
    /// The number of the valuator.
    pub(super) axis: u16,
    /// Its smallest and its largest value.
    pub(super) range: [f64; 2],
}

/// What a device did, with the valuators that changed.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Raw {
    pub(super) device: u16,
    pub(super) action: Action,
    pub(super) valuators: Vec<(u16, f64)>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Action {
    Motion,
    Press(u32),
    Release(u32),
}

/// The events of a pen that `raw` contains.
pub(super) fn events_of(device: &Device, raw: &Raw) -> Vec<PenEvent> {
    let pressed = raw.valuators.iter().find(|(axis, _)| *axis == device.axis);
    let [least, most] = device.range;
    let mut events: Vec<_> = pressed
        .map(|(_, value)| PenEvent::Pressure(((value - least) / (most - least).max(1e-9)) as f32))
        .into_iter()
        .collect();
    match raw.action {
        Action::Press(TIP) => events.push(PenEvent::Down),
        Action::Release(TIP) => events.push(PenEvent::Up),
        Action::Motion | Action::Press(_) | Action::Release(_) => {}
    }
    events
}

/// The end of a device of that name: drivers list the eraser end as a device whose name says so.
pub(super) fn end_of(name: &str) -> End {
    if name.to_ascii_lowercase().contains("eraser") { End::Eraser } else { End::Tip }
}

/// Listens on a thread until the connection ends. A server without the extension has no pens.
pub(super) fn listen(pens: Arc<Mutex<Pens>>) {
    let thread = std::thread::Builder::new().name("pens".to_owned());
    let started = thread.spawn(move || {
        if let Err(error) = hear(&pens) {
            tracing::debug!(%error, "pens are no longer heard");
        }
    });
    if let Err(error) = started {
        tracing::debug!(%error, "pens are not heard");
    }
}

fn hear(pens: &Mutex<Pens>) -> Result<(), Box<dyn Error>> {
    let Some(listener) = Listener::connect(None)? else { return Ok(()) };
    let mut devices = listener.devices(pens)?;
    loop {
        match listener.connection.wait_for_event()? {
            Event::XinputHierarchy(_) | Event::XinputDeviceChanged(_) => devices = listener.devices(pens)?,
            event => {
                let Some(raw) = raw_of(&event) else { continue };
                let Some(device) = devices.iter().find(|device| device.id == raw.device) else { continue };
                let mut pens = lock(pens);
                for event in events_of(device, &raw) {
                    pens.hear(u32::from(device.id), event);
                }
            }
        }
    }
}

/// A connection that hears of pens.
pub(super) struct Listener {
    connection: RustConnection,
    root: u32,
    pressure: Atom,
}

impl Listener {
    /// Connects to the server of that name, or of the environment; `None` if it lacks the extension.
    pub(super) fn connect(display: Option<&str>) -> Result<Option<Self>, Box<dyn Error>> {
        let (connection, screen) = x11rb::connect(display)?;
        if connection.extension_information(xinput::X11_EXTENSION_NAME)?.is_none() {
            return Ok(None);
        }
        // Raw events reach a client while another one holds the pointer from version 2.1 on.
        let version = connection.xinput_xi_query_version(2, 2)?.reply()?;
        if (version.major_version, version.minor_version) < (2, 1) {
            return Ok(None);
        }
        let pressure = connection.intern_atom(false, PRESSURE)?.reply()?.atom;
        let root = connection.setup().roots.get(screen).ok_or("the server has no such screen")?.root;
        let hierarchy = EventMask { deviceid: ALL_DEVICES, mask: vec![XIEventMask::HIERARCHY] };
        connection.xinput_xi_select_events(root, &[hierarchy])?.check()?;
        Ok(Some(Self { connection, root, pressure }))
    }

    /// Finds the pens and asks for their events.
    pub(super) fn devices(&self, pens: &Mutex<Pens>) -> Result<Vec<Device>, Box<dyn Error>> {
        let infos = self.connection.xinput_xi_query_device(ALL_DEVICES)?.reply()?.infos;
        let devices: Vec<_> = infos.iter().filter_map(|info| device_of(info, self.pressure)).collect();
        let mask = XIEventMask::RAW_MOTION | XIEventMask::RAW_BUTTON_PRESS | XIEventMask::RAW_BUTTON_RELEASE;
        for device in &devices {
            let wanted = EventMask { deviceid: device.id, mask: vec![mask | XIEventMask::DEVICE_CHANGED] };
            // A device may be gone by now.
            let _ = self.connection.xinput_xi_select_events(self.root, &[wanted])?.check();
        }
        let mut pens = lock(pens);
        for known in pens.devices() {
            if devices.iter().all(|device| u32::from(device.id) != known) {
                pens.remove(known);
            }
        }
        for device in &devices {
            pens.add(u32::from(device.id), device.end);
        }
        Ok(devices)
    }
}

fn device_of(info: &XIDeviceInfo, pressure: Atom) -> Option<Device> {
    if !matches!(info.type_, DeviceType::SLAVE_POINTER | DeviceType::FLOATING_SLAVE) {
        return None;
    }
    info.classes.iter().find_map(|class| match &class.data {
        DeviceClassData::Valuator(axis) if axis.label == pressure => Some(Device {
            id: info.deviceid,
            end: end_of(&String::from_utf8_lossy(&info.name)),
            axis: axis.number,
            range: [number(axis.min), number(axis.max)],
        }),
        _ => None,
    })
}

/// A number of the protocol: a whole part and a fraction of 2³².
fn number(value: Fp3232) -> f64 {
    f64::from(value.integral) + f64::from(value.frac) / 4_294_967_296.0
}

fn raw_of(event: &Event) -> Option<Raw> {
    let (raw, action) = match event {
        Event::XinputRawMotion(raw) => (raw, Action::Motion),
        Event::XinputRawButtonPress(raw) => (raw, Action::Press(raw.detail)),
        Event::XinputRawButtonRelease(raw) => (raw, Action::Release(raw.detail)),
        _ => return None,
    };
    Some(Raw { device: raw.deviceid, action, valuators: valuators(&raw.valuator_mask, &raw.axisvalues) })
}

/// The numbers of the valuators whose bits are set, with their values.
fn valuators(mask: &[u32], values: &[Fp3232]) -> Vec<(u16, f64)> {
    let bits = mask.iter().enumerate().flat_map(|(word, bits)| {
        (0..32).filter(move |bit| (bits >> bit) & 1 == 1).map(move |bit| word * 32 + bit)
    });
    bits.zip(values).map(|(axis, value)| (axis as u16, number(*value))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_masks_of_the_protocol() {
        assert_eq!(number(Fp3232 { integral: 3, frac: 1 << 31 }), 3.5);
        assert_eq!(number(Fp3232 { integral: -1, frac: 1 << 30 }), -0.75);
        let value = |integral| Fp3232 { integral, frac: 0 };
        let found = valuators(&[0b101, 1], &[value(7), value(8), value(9)]);
        assert_eq!(found, [(0, 7.0), (2, 8.0), (32, 9.0)]);
        assert_eq!(valuators(&[0b11], &[]), [], "a message that is cut");
    }

    #[test]
    fn the_eraser_end_has_a_name_of_its_own() {
        for (name, end) in [
            ("Wacom Intuos Pro M Pen stylus", End::Tip),
            ("Wacom Intuos Pro M Pen eraser", End::Eraser),
            ("HUION Huion Tablet_H640P Pen Eraser (0)", End::Eraser),
            ("XTEST pointer", End::Tip),
        ] {
            assert_eq!(end_of(name), end, "{name}");
        }
    }

    /// On a screen of an X server, such as a virtual one, the pens can be listed and heard. Skipped without a screen.
    #[test]
    fn a_server_can_be_listened_to() {
        let Ok(display) = std::env::var("DISPLAY") else { return };
        let Ok(Some(listener)) = Listener::connect(Some(&display)) else { return };
        let pens = Mutex::default();
        let devices = listener.devices(&pens).expect("a list of devices");
        assert_eq!(devices.len(), lock(&pens).devices().len());
    }

    #[test]
    fn without_a_server_there_are_no_pens() {
        assert!(Listener::connect(Some(":65000")).is_err());
        let pens = Mutex::default();
        assert_eq!(lock(&pens).take(), None);
    }
}
