//! Widths and colours that only some curves of a file state.

use super::file::RawHair;

/// The values of all points read so far. Points of curves that state none have a blank one.
pub(super) struct Partial<T> {
    pub(super) values: Vec<T>,
    blank: T,
    has: bool,
    lacks: bool,
}

impl<T: Copy> Partial<T> {
    pub(super) fn new(blank: T) -> Self {
        Self { values: Vec::new(), blank, has: false, lacks: false }
    }

    /// Ends the values of some curves after which there are `points` points. `stated` says whether the curves have values.
    pub(super) fn end_at(&mut self, points: usize, stated: bool) {
        self.values.resize(points, self.blank);
        self.has |= stated;
        self.lacks |= !stated;
    }

    /// The values, if any curve has some.
    pub(super) fn finish(self, raw: &mut RawHair) -> Option<Vec<T>> {
        raw.lacks_values |= self.has && self.lacks;
        Some(self.values).filter(|_| self.has)
    }
}

impl RawHair {
    /// Gives points without a width or colour the mean of the others, once strands that are left out are gone.
    pub(super) fn fill_missing(&mut self) {
        if !std::mem::take(&mut self.lacks_values) {
            return;
        }
        for (what, is_filled) in
            [("width", fill_widths(&mut self.thickness)), ("colour", fill_colours(&mut self.colours))]
        {
            if is_filled {
                self.notes.push(format!("Curves without a {what} get the mean of the others."));
            }
        }
    }
}

fn fill_widths(widths: &mut Option<Vec<f32>>) -> bool {
    let Some(values) = widths else { return false };
    let stated = values.iter().filter(|width| width.is_finite());
    let (sum, count) = stated.fold((0.0, 0_usize), |(sum, n), &width| (sum + f64::from(width), n + 1));
    if count == 0 {
        *widths = None;
        return false;
    }
    let mean = (sum / count as f64) as f32;
    let blank = values.iter_mut().filter(|width| !width.is_finite());
    let filled = blank.map(|width| *width = mean).count();
    filled > 0
}

fn fill_colours(colours: &mut Option<Vec<[f32; 3]>>) -> bool {
    let Some(values) = colours else { return false };
    let is_stated = |colour: &[f32; 3]| colour.iter().all(|v| v.is_finite());
    let stated = values.iter().filter(|colour| is_stated(colour)).map(|&colour| glam::Vec3::from(colour));
    let (sum, count) = stated.fold((glam::DVec3::ZERO, 0_usize), |(sum, n), c| (sum + c.as_dvec3(), n + 1));
    if count == 0 {
        *colours = None;
        return false;
    }
    let mean = (sum / count as f64).as_vec3().to_array();
    let filled = values.iter_mut().filter(|colour| !is_stated(colour)).map(|colour| *colour = mean).count();
    filled > 0
}
