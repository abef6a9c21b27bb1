//! What pens press, from the events of any system.

/// The end of a pen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum End {
    #[default]
    Tip,
    Eraser,
}

/// An event of a pen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum PenEvent {
    /// It presses with this part, 0 to 1, of the largest pressure.
    Pressure(f32),
    /// It touches the tablet.
    Down,
    /// It no longer touches the tablet.
    Up,
    /// It is no longer near the tablet.
    Away,
}

/// The pen that touches the tablet.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Touch {
    pub(crate) end: End,
    /// The pressures since they were last asked for, at least one.
    pressures: Vec<f32>,
}

impl Touch {
    /// The pressure at place `at` of `count` places, from 0, that the pointer passed meanwhile.
    pub(crate) fn pressure(&self, at: usize, count: usize) -> f32 {
        let last = self.pressures.len() - 1;
        let place = if at + 1 >= count { last } else { (at + 1) * self.pressures.len() / count.max(1) };
        self.pressures[place.min(last)]
    }
}

/// A pen, or the eraser end of one: systems report them as two devices.
#[derive(Clone, Debug)]
struct Contact {
    device: u32,
    end: End,
    pressure: f32,
    is_down: bool,
}

impl Contact {
    /// Some drivers report no button for the tip, others send the pressure first.
    fn touches(&self) -> bool {
        self.is_down || self.pressure > 0.0
    }
}

/// The most pressures that are kept between two passes.
const MAX_PRESSURES: usize = 4096;

/// All pens.
#[derive(Debug, Default)]
pub(crate) struct Pens {
    contacts: Vec<Contact>,
    /// The device that did something last.
    latest: Option<u32>,
    /// Its pressures since the last call of [`Pens::take`].
    pressures: Vec<f32>,
}

impl Pens {
    /// Adds a device, or changes its end.
    pub(crate) fn add(&mut self, device: u32, end: End) {
        match self.contacts.iter_mut().find(|contact| contact.device == device) {
            Some(contact) => contact.end = end,
            None => self.contacts.push(Contact { device, end, pressure: 0.0, is_down: false }),
        }
    }

    /// Removes a device.
    pub(crate) fn remove(&mut self, device: u32) {
        self.contacts.retain(|contact| contact.device != device);
    }

    /// The devices.
    #[cfg(target_os = "linux")]
    pub(crate) fn devices(&self) -> Vec<u32> {
        self.contacts.iter().map(|contact| contact.device).collect()
    }

    /// Takes an event of a device. Those of unknown devices are ignored.
    pub(crate) fn hear(&mut self, device: u32, event: PenEvent) {
        let Some(contact) = self.contacts.iter_mut().find(|contact| contact.device == device) else { return };
        match event {
            PenEvent::Pressure(pressure) if pressure.is_finite() => {
                contact.pressure = pressure.clamp(0.0, 1.0);
            }
            PenEvent::Pressure(_) => return,
            PenEvent::Down => contact.is_down = true,
            PenEvent::Up => contact.is_down = false,
            PenEvent::Away => (contact.is_down, contact.pressure) = (false, 0.0),
        }
        if self.latest != Some(device) {
            self.pressures.clear();
            self.latest = Some(device);
        }
        if contact.pressure > 0.0 && self.pressures.len() < MAX_PRESSURES {
            self.pressures.push(contact.pressure);
        }
    }

    /// The pen that touches, with what it pressed since the last call; `None` while none does.
    pub(crate) fn take(&mut self) -> Option<Touch> {
        let mut pressures = std::mem::take(&mut self.pressures);
        let contact = self.contacts.iter().find(|contact| Some(contact.device) == self.latest)?;
        if pressures.is_empty() {
            // Without a change the pressure is that of the last event.
            pressures.push(contact.pressure);
        }
        contact.touches().then_some(Touch { end: contact.end, pressures })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pens(events: &[(u32, PenEvent)]) -> Pens {
        let mut pens = Pens::default();
        pens.add(1, End::Tip);
        pens.add(2, End::Eraser);
        for (device, event) in events {
            pens.hear(*device, *event);
        }
        pens
    }

    #[test]
    fn a_pen_touches_from_its_press_to_its_release() {
        use PenEvent::{Away, Down, Pressure, Up};
        assert_eq!(pens(&[]).take(), None);
        let mut pen = pens(&[(1, Pressure(0.0)), (1, Pressure(0.25)), (1, Down), (1, Pressure(0.5))]);
        let touch = pen.take().expect("it touches");
        assert_eq!((touch.end, touch.pressures), (End::Tip, vec![0.25, 0.25, 0.5]));
        let touch = pen.take().expect("it rests on the tablet");
        assert_eq!(touch.pressures, [0.5]);
        pen.hear(1, Pressure(0.0));
        pen.hear(1, Up);
        assert_eq!(pen.take(), None);
        pen.hear(1, Pressure(0.7));
        pen.hear(1, Away);
        assert_eq!(pen.take(), None);
    }

    #[test]
    fn the_eraser_is_a_device_of_its_own() {
        use PenEvent::{Down, Pressure};
        let mut pen = pens(&[(1, Pressure(0.9)), (1, Pressure(0.0)), (2, Down), (2, Pressure(0.4))]);
        let touch = pen.take().expect("it touches");
        assert_eq!(touch.end, End::Eraser);
        assert_eq!(touch.pressures, [0.4], "those of the other end are not its own");
    }

    #[test]
    fn unknown_devices_and_wrong_numbers_are_ignored() {
        let mut pen =
            pens(&[(9, PenEvent::Down), (9, PenEvent::Pressure(1.0)), (1, PenEvent::Pressure(f32::NAN))]);
        assert_eq!(pen.take(), None);
        pen.hear(1, PenEvent::Pressure(7.0));
        assert_eq!(pen.take().map(|touch| touch.pressures), Some(vec![1.0]));
        pen.remove(1);
        assert_eq!(pen.take(), None, "it was unplugged");
    }

    #[test]
    fn pressures_spread_over_the_way_of_the_pointer() {
        let touch = Touch { end: End::Tip, pressures: vec![0.1, 0.2, 0.3, 0.4] };
        let along = |count: usize| (0..count).map(|at| touch.pressure(at, count)).collect::<Vec<_>>();
        assert_eq!(along(1), [0.4]);
        assert_eq!(along(2), [0.3, 0.4]);
        assert_eq!(along(4), [0.2, 0.3, 0.4, 0.4]);
        assert_eq!(along(0), [] as [f32; 0]);
        let rests = Touch { end: End::Tip, pressures: vec![0.5] };
        assert_eq!((rests.pressure(0, 3), rests.pressure(2, 3)), (0.5, 0.5));
    }
}
