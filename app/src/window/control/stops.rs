//! Whole numbers through which a slider steps, such as the sizes of maps.

use std::cell::Cell;

use egui::{Response, Slider, SliderClamping, Ui, Widget};
use lovelock_base::settings::{Counts, Info};

use super::number::{NUMBER_WIDTH, is_escaped, is_secondary, typed};
use super::spoken::spoken_slider;
use super::{row, say};

/// The row of a whole number whose slider steps through what is offered. Any number of its range can be typed; another one is refused
/// with a message, because the smallest or largest map is not what was meant.
pub(super) fn stops(ui: &mut Ui, info: &Info, counts: &Counts, value: &mut u64, default: u64) -> Response {
    row(ui, info.label, &info.tooltip(), *value != default, value, default, |ui, value| {
        let entered = Cell::new(None);
        // In the pass of its release the pointer still says where the slider is.
        let dragged = ui.input(|input| input.pointer.any_down() || input.pointer.any_released());
        let opens_menu = is_secondary(ui);
        let parser = parser(ui, info, counts, *value, &entered);
        ui.spacing_mut().slider_width = (ui.available_width() - NUMBER_WIDTH).max(40.0);
        let [low, high] = counts.soft.map(|bound| bound as f64);
        let response = Slider::from_get_set(low..=high, |new| {
            if let Some(new) = new.filter(|new| new.is_finite() && !opens_menu) {
                *value = match entered.take() {
                    Some(entered) => entered,
                    None if dragged => nearest(counts.offered, new),
                    None => stepped(counts.offered, *value, new),
                };
            }
            *value as f64
        })
        .integer()
        .suffix(info.unit.suffix)
        .custom_parser(parser)
        .logarithmic(true)
        .clamping(SliderClamping::Never)
        .update_while_editing(false)
        .ui(ui);
        let range = counts.hard.map(|bound| bound as f64);
        spoken_slider(ui, &response, range, || format!("{value}{}", info.unit.suffix));
        response
    })
}

/// Reads what was typed, and notes it in `entered`; `None` where the value stays as it is.
fn parser<'a>(
    ui: &Ui,
    info: &Info,
    counts: &Counts,
    value: u64,
    entered: &'a Cell<Option<u64>>,
) -> impl Fn(&str) -> Option<f64> + 'a {
    let (ctx, canceled) = (ui.ctx().clone(), is_escaped(ui));
    let (label, suffix) = (info.label, info.unit.suffix);
    let ([least, most], step) = (counts.hard, counts.step);
    move |text| {
        let number = typed(text, suffix).filter(|_| !canceled)?;
        if number < least as f64 || number > most as f64 {
            let found = if number.abs() < 1e9 { number.to_string() } else { format!("{number:e}") };
            let sentence =
                format!("{label}: found {found}; must be {least} to {most}. It stays {value}{suffix}.");
            say(&ctx, sentence);
            return None;
        }
        let number = number.round() as u64;
        let rounded = (number + step / 2) / step * step;
        // What stood in the field is no new number.
        if rounded != number && number != value {
            let sentence = format!(
                "{label}: found {number}; must be a multiple of {step}. It is set to {rounded}{suffix}."
            );
            say(&ctx, sentence);
        }
        entered.set(Some(rounded));
        Some(rounded as f64)
    }
}

/// The stop whose ratio to `number` is nearest to 1.
fn nearest(stops: &[u64], number: f64) -> u64 {
    let away = |stop: u64| (stop as f64 / number.max(1.0)).ln().abs();
    stops.iter().copied().min_by(|a, b| away(*a).total_cmp(&away(*b))).unwrap_or(number as u64)
}

/// The stop that a key reaches from `value` if the slider itself would move to `number`: the next one in that direction, or the one
/// that is nearest to a distant number.
fn stepped(stops: &[u64], value: u64, number: f64) -> u64 {
    if number == value as f64 {
        return value;
    }
    let next = if number > value as f64 {
        stops.iter().copied().find(|stop| *stop > value)
    } else {
        stops.iter().copied().rev().find(|stop| *stop < value)
    };
    let near = nearest(stops, number);
    let is_beyond = |next: u64| near.abs_diff(value) > next.abs_diff(value);
    next.filter(|next| !is_beyond(*next)).unwrap_or(near)
}

#[cfg(test)]
mod tests {
    use super::*;

    const STOPS: [u64; 5] = [16, 32, 48, 64, 512];

    #[test]
    fn the_nearest_stop_is_that_of_the_smallest_ratio() {
        for (number, stop) in [(0.0, 16), (16.0, 16), (22.0, 16), (23.0, 32), (56.0, 64), (1e9, 512)] {
            assert_eq!(nearest(&STOPS, number), stop, "{number}");
        }
        assert_eq!(nearest(&STOPS, 180.0), 64, "not the nearest difference");
    }

    #[test]
    fn a_key_goes_to_the_next_stop_however_little_the_slider_would_move() {
        assert_eq!(stepped(&STOPS, 32, 32.4), 48);
        assert_eq!(stepped(&STOPS, 32, 31.0), 16);
        // From between two stops, and at both ends.
        assert_eq!((stepped(&STOPS, 40, 41.0), stepped(&STOPS, 40, 39.0)), (48, 32));
        assert_eq!((stepped(&STOPS, 512, 520.0), stepped(&STOPS, 16, 15.0)), (512, 16));
        assert_eq!(stepped(&STOPS, 40, 40.0), 40);
        // A number that a screen reader asks for.
        assert_eq!(stepped(&STOPS, 16, 500.0), 512);
    }
}
