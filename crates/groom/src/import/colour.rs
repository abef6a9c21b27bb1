//! Colour, shade and taper of an imported groom.

use glam::Vec3;

use super::PlacedGroom;
use crate::{HairFile, HairLook};
use lovelock_base::random::SplitMix64;

/// Fraction of a strand's length at which it begins to taper, and its relative width at the tip.
const TAPER: [f32; 2] = [0.7, 0.25];

/// Width of each point relative to the widest: from the file if its widths vary, otherwise tapering to the tip.
pub(super) fn taper(file: &HairFile, groom: &PlacedGroom, order: &[u32]) -> Vec<f32> {
    let widths = file.thickness.as_deref().filter(|widths| varies(widths));
    let widest = widths.map_or(1.0, |widths| widths.iter().copied().fold(0.0, f32::max));
    let mut taper = Vec::with_capacity(groom.points.len());
    for &strand in order {
        let span =
            groom.first_point[strand as usize] as usize..groom.first_point[strand as usize + 1] as usize;
        if let Some(widths) = widths.filter(|_| widest > 0.0) {
            taper.extend(widths[span].iter().map(|width| (width / widest).clamp(0.02, 1.0)));
            continue;
        }
        let points = &groom.points[span];
        let length = super::length(points).max(f32::MIN_POSITIVE);
        let mut run = 0.0;
        taper.push(1.0);
        for [a, b] in points.array_windows() {
            run += a.distance(*b);
            let t = ((run / length - TAPER[0]) / (1.0 - TAPER[0])).clamp(0.0, 1.0);
            taper.push(1.0 + t * t * (TAPER[1] - 1.0));
        }
    }
    taper
}

/// A shade in 0..=1 per strand: from the strands' brightness if the file's colours differ, otherwise random.
pub(super) fn shade(file: &HairFile, order: &[u32], seed: u32) -> Vec<f32> {
    let brightness: Option<Vec<f32>> = file.colours.as_ref().map(|colours| {
        file.first_point
            .array_windows()
            .map(|&[start, end]| {
                let of_strand = &colours[start as usize..end as usize];
                of_strand.iter().map(|&colour| Vec3::from(colour).element_sum()).sum::<f32>()
                    / of_strand.len() as f32
            })
            .collect()
    });
    match brightness.filter(|brightness| varies(brightness)) {
        Some(brightness) => {
            let (low, high) = range(&brightness);
            order.iter().map(|&i| ((brightness[i as usize] - low) / (high - low)).clamp(0.0, 1.0)).collect()
        }
        None => order.iter().map(|&i| SplitMix64::of_stream(seed, u64::from(i)).unit()).collect(),
    }
}

fn range(values: &[f32]) -> (f32, f32) {
    values.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)))
}

/// Whether values differ by more than a hundredth of the largest.
fn varies(values: &[f32]) -> bool {
    let (low, high) = range(values);
    (high - low).is_finite() && high - low > 0.01 * high.abs().max(low.abs())
}

/// The look derived from a file: melanin from its colour, if it has one.
pub(super) fn look(file: &HairFile) -> HairLook {
    let of_points = file.colours.as_ref().map(|colours| {
        let sum: glam::DVec3 = colours.iter().map(|&colour| Vec3::from(colour).as_dvec3()).sum();
        (sum / colours.len() as f64).as_vec3()
    });
    let colour = of_points.or(file.default_colour.map(Vec3::from));
    let Some(colour) = colour.filter(|c| c.is_finite() && c.max_element() > 0.0) else {
        return HairLook::default();
    };
    let (eumelanin, pheomelanin) = melanin_of(linear_from_srgb(colour));
    HairLook { eumelanin, pheomelanin, ..HairLook::default() }
}

fn linear_from_srgb(colour: Vec3) -> Vec3 {
    Vec3::from(
        colour
            .clamp(Vec3::ZERO, Vec3::ONE)
            .to_array()
            .map(|v| if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }),
    )
}

/// Concentrations of eumelanin and pheomelanin of hair with about this colour (linear sRGB).
///
/// Absorption by the Beer-Lambert law, then non-negative least squares for the two concentrations.
fn melanin_of(colour: Vec3) -> (f32, f32) {
    let absorption = colour.map(|c| {
        let through = (c - HairLook::SURFACE_SHARE).clamp(1e-4, 1.0);
        (-through.ln() / HairLook::BODY_PATH).powf(1.0 / HairLook::STRETCH)
    });
    let only = |melanin: Vec3| (melanin.dot(absorption) / melanin.length_squared()).max(0.0);
    let basis =
        |eumelanin, pheomelanin| HairLook { eumelanin, pheomelanin, ..HairLook::default() }.absorption();
    let (e, p) = (basis(1.0, 0.0), basis(0.0, 1.0));
    let determinant = e.length_squared() * p.length_squared() - e.dot(p).powi(2);
    let eumelanin = (e.dot(absorption) * p.length_squared() - p.dot(absorption) * e.dot(p)) / determinant;
    let pheomelanin = (p.dot(absorption) * e.length_squared() - e.dot(absorption) * e.dot(p)) / determinant;
    let (eumelanin, pheomelanin) = match (eumelanin >= 0.0, pheomelanin >= 0.0) {
        (true, true) => (eumelanin, pheomelanin),
        (true, false) => (only(e), 0.0),
        (false, _) => (0.0, only(p)),
    };
    (eumelanin.clamp(0.0, 8.0), pheomelanin.clamp(0.0, 8.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn colour_of(eumelanin: f32, pheomelanin: f32) -> Vec3 {
        let absorption = HairLook { eumelanin, pheomelanin, ..HairLook::default() }.absorption();
        HairLook::body_color(absorption)
    }

    #[test]
    fn melanin_comes_back_from_its_own_colour() {
        for (eumelanin, pheomelanin) in [(0.3, 0.0), (1.0, 0.05), (0.1, 0.4), (0.0, 0.3)] {
            let (e, p) = melanin_of(colour_of(eumelanin, pheomelanin));
            // Colours of 1e-4 and below are clamped; none of these is.
            assert!((e - eumelanin).abs() < 1e-3 && (p - pheomelanin).abs() < 1e-3, "{e} {p}");
        }
    }

    #[test]
    fn no_colour_leaves_the_range_of_melanin() {
        for colour in [Vec3::ZERO, Vec3::ONE, Vec3::X, Vec3::Y, Vec3::Z, Vec3::new(1.0, 1.0, 0.0)] {
            let (e, p) = melanin_of(colour);
            assert!((0.0..=8.0).contains(&e) && (0.0..=8.0).contains(&p));
        }
    }
}
