//! Drops and counts the strands of a file that cannot be drawn.

use glam::Vec3;
use lovelock_base::statistics::upper_median_by;

use super::HairFileError;
use super::file::{Bounds, HairFile, RawHair};
use super::format::HairFormat;

/// The largest valid coordinate, file units. Squares of such numbers and sums of squares stay finite in single
/// precision.
const LARGEST_COORDINATE: f32 = 1e12;
/// A strand that reaches farther from the centre of the roots than this multiple of the median reach is not part of the
/// groom.
const LARGEST_REACH: f32 = 1000.0;
/// A strand shorter than this fraction of the median reach has no direction in single precision.
const SMALLEST_LENGTH: f32 = 1e-5;
/// The shortest strand, file units. For shorter ones, the scale to metres overflows.
const SMALLEST_ABSOLUTE_LENGTH: f32 = 1e-12;

/// Why a strand is dropped.
#[derive(Clone, Copy, PartialEq)]
enum Fault {
    OnePoint,
    NonFinite,
    Distant,
    ZeroLength,
}

impl Fault {
    const ALL: [Self; 4] = [Self::OnePoint, Self::NonFinite, Self::Distant, Self::ZeroLength];

    fn key(self) -> &'static str {
        match self {
            Self::OnePoint => "one_point_strands",
            Self::NonFinite => "non_finite_strands",
            Self::Distant => "distant_strands",
            Self::ZeroLength => "zero_length_strands",
        }
    }

    fn note(self, count: u64) -> String {
        let strands = if count == 1 { "strand" } else { "strands" };
        let why = match self {
            Self::OnePoint => "of fewer than two points",
            Self::NonFinite => "with coordinates that are not numbers",
            Self::Distant => "reaching more than 1000 times farther than the others",
            Self::ZeroLength => "of no length",
        };
        format!("Left out {count} {strands} {why}.")
    }
}

/// Keeps the strands that can be drawn.
pub(super) fn clean(name: &str, format: &HairFormat, raw: RawHair) -> Result<HairFile, HairFileError> {
    clean_keeping(name, format, raw, None)
}

/// As [`clean`]. Puts the index of each point that is kept into `indices`.
pub(super) fn clean_keeping(
    name: &str,
    format: &HairFormat,
    raw: RawHair,
    mut indices: Option<&mut Vec<u32>>,
) -> Result<HairFile, HairFileError> {
    let strands = raw.point_counts.len();
    let mut faults: Vec<Option<Fault>> = Vec::with_capacity(strands);
    let mut first = 0;
    for &count in &raw.point_counts {
        let points = &raw.points[first..first + count as usize];
        first += count as usize;
        faults.push(if points.len() < 2 {
            Some(Fault::OnePoint)
        } else if points.iter().any(|p| !p.is_finite()) {
            Some(Fault::NonFinite)
        } else if points.iter().any(|p| p.abs().max_element() > LARGEST_COORDINATE) {
            Some(Fault::Distant)
        } else {
            None
        });
    }
    drop_by_size(&raw, &mut faults);

    let strands_kept = (0..strands).filter(|&strand| faults[strand].is_none());
    let mut file = HairFile {
        name: name.to_owned(),
        format: match raw.version {
            Some(version) => format!("{} {version:.1}", format.label),
            None => format.label.to_owned(),
        },
        common_up: format.common_up,
        written_up: raw.writer.map(|(_, up)| up),
        written_unit: raw.writer.map(|(unit, _)| unit),
        is_in_metres: format.states_unit || raw.says_metres,
        first_point: Vec::with_capacity(strands + 1),
        points: raw.points,
        thickness: raw.thickness,
        transparency: raw.transparency,
        colours: raw.colours,
        default_thickness: raw.default_thickness,
        default_transparency: raw.default_transparency,
        default_colour: raw.default_colour,
        both_ends_pinned: raw.both_ends_pinned,
        marks: raw.marks.selected(strands_kept),
        dropped: raw.dropped,
        notes: raw.notes,
        bounds: Bounds::EMPTY,
    };
    file.first_point.push(0);
    let (mut repeated, mut non_finite) = (0_u64, 0_u64);
    // A value that is not finite becomes the default, or the value that means "none".
    let mut finite = |value: f32, default: f32| {
        if value.is_finite() {
            value
        } else {
            non_finite += 1;
            default
        }
    };
    // What is kept moves toward the start of the same arrays, so that memory holds the hair once.
    let (mut end, mut kept) = (0, 0);
    for (&count, fault) in raw.point_counts.iter().zip(&faults) {
        let start = end;
        end += count as usize;
        if fault.is_some() {
            continue;
        }
        for i in start..end {
            if i > start && file.points[i] == file.points[i - 1] {
                repeated += 1;
                continue;
            }
            file.bounds.include(file.points[i]);
            file.points[kept] = file.points[i];
            if let Some(indices) = &mut indices {
                indices.push(i as u32);
            }
            if let Some(values) = &mut file.thickness {
                values[kept] = finite(values[i], file.default_thickness.unwrap_or(0.0));
            }
            if let Some(values) = &mut file.transparency {
                values[kept] = finite(values[i], file.default_transparency.unwrap_or(0.0));
            }
            if let Some(values) = &mut file.colours {
                let (value, default) = (values[i], file.default_colour.unwrap_or([0.5; 3]));
                values[kept] = std::array::from_fn(|k| finite(value[k], default[k]));
            }
            kept += 1;
        }
        file.first_point.push(kept as u32);
    }
    shorten(&mut file.points, kept);
    file.thickness.iter_mut().for_each(|values| shorten(values, kept));
    file.transparency.iter_mut().for_each(|values| shorten(values, kept));
    file.colours.iter_mut().for_each(|values| shorten(values, kept));

    file.notes.extend(file.marks.note());
    report(&mut file, &faults, repeated, non_finite, raw.trailing_bytes);
    if file.strands() == 0 {
        let reason = match file.dropped.len() {
            0 => "it contains none".to_owned(),
            _ => file.dropped.iter().map(|(what, n)| format!("{what}: {n}")).collect::<Vec<_>>().join(", "),
        };
        return Err(HairFileError::NothingToDraw { name: name.to_owned(), reason });
    }
    Ok(file)
}

fn shorten<T>(values: &mut Vec<T>, length: usize) {
    values.truncate(length);
    values.shrink_to_fit();
}

/// Marks strands that are far from the groom, or that have no length compared with it.
fn drop_by_size(raw: &RawHair, faults: &mut [Option<Fault>]) {
    let spans = || {
        raw.point_counts.iter().scan(0, |first, &count| {
            let start = *first;
            *first += count as usize;
            Some(start..*first)
        })
    };
    let mut roots: [Vec<f32>; 3] = Default::default();
    for (span, fault) in spans().zip(faults.iter()) {
        if fault.is_none() {
            for (axis, values) in roots.iter_mut().enumerate() {
                values.push(raw.points[span.start][axis]);
            }
        }
    }
    let [Some(x), Some(y), Some(z)] = roots.map(|mut values| upper_median_by(&mut values, f32::total_cmp))
    else {
        return;
    };
    let centre = Vec3::new(x, y, z);
    let reach =
        |points: &[Vec3]| points.iter().map(|&p| (p - centre).abs().max_element()).fold(0.0_f32, f32::max);
    let kept = || spans().zip(faults.iter()).filter(|(_, fault)| fault.is_none());
    let mut reaches: Vec<f32> = kept().map(|(span, _)| reach(&raw.points[span])).collect();
    let Some(median_reach) = upper_median_by(&mut reaches.clone(), f32::total_cmp) else {
        return;
    };
    let shortest = (SMALLEST_LENGTH * median_reach).max(SMALLEST_ABSOLUTE_LENGTH);
    let mut reaches = reaches.drain(..);
    for (span, fault) in spans().zip(faults.iter_mut()) {
        if fault.is_some() {
            continue;
        }
        let points = &raw.points[span];
        let length: f32 = points.array_windows().map(|[a, b]| a.distance(*b)).sum();
        if length < shortest {
            *fault = Some(Fault::ZeroLength);
        }
        if reaches.next().is_some_and(|reach| reach > LARGEST_REACH * median_reach) {
            *fault = Some(Fault::Distant);
        }
    }
}

fn report(file: &mut HairFile, faults: &[Option<Fault>], repeated: u64, non_finite: u64, trailing: u64) {
    for kind in Fault::ALL {
        let count = faults.iter().filter(|&&fault| fault == Some(kind)).count() as u64;
        if count > 0 {
            file.dropped.insert(kind.key().to_owned(), count);
            file.notes.push(kind.note(count));
        }
    }
    for (count, key, note) in [
        (repeated, "repeated_points", "points that repeat the one before"),
        (non_finite, "non_finite_values", "widths, transparencies or colours that are not numbers"),
        (trailing, "trailing_bytes", "bytes after the last array"),
    ] {
        if count > 0 {
            file.dropped.insert(key.to_owned(), count);
            file.notes.push(format!("Left out {count} {note}."));
        }
    }
}
