//! Which sides of an array are strands, points and coordinates.

use glam::Vec3;

use super::array::Layout;

/// The most numbers of a point: its place, and what may stand beside it.
const MOST_COLUMNS: usize = 16;

/// The sides of an array of strands, and how far apart neighbours along each are stored.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sides {
    pub(super) strands: usize,
    pub(super) points: usize,
    /// Numbers of a point, of which the first three are its place.
    columns: usize,
    /// Steps to the next strand, point and coordinate, in numbers.
    steps: [usize; 3],
}

impl Sides {
    /// Whether an array may be one of strands.
    pub(super) fn fit(layout: &Layout) -> bool {
        Self::all_of(layout).next().is_some()
    }

    /// Whether it has three numbers per point, last.
    pub(super) fn are_usual(layout: &Layout) -> bool {
        layout.shape.last() == Some(&3)
    }

    /// The sides of an array with these numbers. Where its shape fits several, points are those with three coordinates, unless a fourth number
    /// is the same for all points: such a weight stands behind the coordinates.
    pub(super) fn of(layout: &Layout, numbers: &[f32]) -> Option<Self> {
        let mut all = Self::all_of(layout);
        let usual = all.next()?;
        if usual.columns == 3 {
            return Some(usual);
        }
        let has_weights = usual.columns == 4 && numbers.chunks_exact(4).all(|point| point[3] == numbers[3]);
        Some(if has_weights { usual } else { all.next().unwrap_or(usual) })
    }

    /// All sides that an array may have, the usual ones first.
    fn all_of(layout: &Layout) -> impl Iterator<Item = Self> {
        // A batch of one.
        let mut shape = &layout.shape[..];
        while let [1, rest @ ..] = shape
            && rest.len() >= 3
        {
            shape = rest;
        }
        let few = layout.count().is_some_and(|count| u32::try_from(count).is_ok());
        let sides = match *shape {
            [a, b, c] if few && layout.has_floats() => Some([a, b, c]),
            _ => None,
        };
        sides.into_iter().flat_map(|[a, b, c]| {
            let last = Self { strands: a, points: b, columns: c, steps: [b * c, c, 1] };
            let first = Self { strands: b, points: c, columns: a, steps: [c, 1, b * c] };
            let middle = Self { strands: a, points: c, columns: b, steps: [b * c, 1, c] };
            let is_only = c == 3;
            let fits = move |sides: &Self| sides.strands > 0 && sides.points > 1;
            let last = Some(last).filter(|_| (3..=MOST_COLUMNS).contains(&c));
            let others = [first, middle].into_iter().filter(move |sides| !is_only && sides.columns == 3);
            last.into_iter().chain(others).filter(fits)
        })
    }

    /// The place of a point.
    fn point(&self, numbers: &[f32], strand: usize, point: usize) -> Vec3 {
        let start = strand * self.steps[0] + point * self.steps[1];
        Vec3::from(
            [0, 1, 2].map(|axis| numbers.get(start + axis * self.steps[2]).copied().unwrap_or(f32::NAN)),
        )
    }

    /// All points, strand after strand.
    pub(super) fn all(&self, numbers: &[f32]) -> impl Iterator<Item = Vec3> {
        let pairs = (0..self.strands).flat_map(|strand| (0..self.points).map(move |point| (strand, point)));
        pairs.map(|(strand, point)| self.point(numbers, strand, point))
    }

    /// What is special about them, as a sentence.
    pub(super) fn note(&self) -> Option<String> {
        if self.steps[2] != 1 {
            return Some(format!(
                "The coordinates run along another side than the last: {} strands of {} points.",
                self.strands, self.points
            ));
        }
        let note = || format!("Each point has {} numbers; the first three are its place.", self.columns);
        (self.columns > 3).then(note)
    }
}
