//! Which figure of the yardstick bounds a stage, and the amount of work that its time is divided by.

use super::report::StageReport;
use super::yardstick::{Bound, Yardstick};

/// What a stage handles: its multiple is the work per item.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Item {
    /// A point of a strand.
    StrandPoint,
    /// A point of a strand for one light.
    LitPoint,
    /// A point of a guide in one step of the simulation.
    SimulatedPoint,
    /// A vertex of the body.
    Vertex,
    /// A pixel of the image.
    Pixel,
}

/// The amount of work in a frame of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Amounts {
    /// Points of all strands.
    pub(super) strand_points: u64,
    /// Lights that cast shadows.
    pub(super) lights: u64,
    /// Points of all guides, times the steps of the simulation per frame.
    pub(super) simulated_points: u64,
    /// Vertices of the body.
    pub(super) vertices: u64,
    /// Pixels of the image.
    pub(super) pixels: u64,
}

/// The bound of each stage and pass. A row applies to the stages whose name begins with it; the first row that does counts.
/// `docs/performance.md` contains this table with the least work per item.
const BOUNDS: [(&str, Bound, Item); 18] = [
    ("motion", Bound::MultiplyAdds, Item::Vertex),
    ("simulate", Bound::MultiplyAdds, Item::SimulatedPoint),
    ("interpolate", Bound::Copy, Item::StrandPoint),
    ("shadow", Bound::ScatteredAdds, Item::LitPoint),
    ("draw/body", Bound::MultiplyAdds, Item::Vertex),
    ("draw/points", Bound::MultiplyAdds, Item::StrandPoint),
    ("draw/sort-and-blend", Bound::MultiplyAdds, Item::StrandPoint),
    ("draw/sort", Bound::Copy, Item::StrandPoint),
    ("draw/scatter", Bound::ScatteredAdds, Item::StrandPoint),
    ("draw/clear", Bound::Copy, Item::Pixel),
    ("draw/background", Bound::Copy, Item::Pixel),
    ("draw/picture", Bound::Copy, Item::Pixel),
    ("draw", Bound::MultiplyAdds, Item::StrandPoint),
    // Of the simulation and one step by each method.
    ("animation/", Bound::MultiplyAdds, Item::SimulatedPoint),
    ("animation", Bound::MultiplyAdds, Item::StrandPoint),
    ("passes", Bound::MultiplyAdds, Item::StrandPoint),
    ("picture", Bound::MultiplyAdds, Item::StrandPoint),
    ("frame", Bound::MultiplyAdds, Item::StrandPoint),
];

impl Bound {
    /// The unit of work in a table.
    pub(super) const fn unit(self) -> &'static str {
        match self {
            Self::Copy => "bytes copied",
            Self::MultiplyAdds => "multiply-adds",
            Self::ScatteredAdds => "scattered additions",
        }
    }
}

impl Item {
    const fn label(self) -> &'static str {
        match self {
            Self::StrandPoint => "point",
            Self::LitPoint => "point and light",
            Self::SimulatedPoint => "guide point and step",
            Self::Vertex => "vertex",
            Self::Pixel => "pixel",
        }
    }
}

impl Amounts {
    fn of(&self, item: Item) -> u64 {
        match item {
            Item::StrandPoint => self.strand_points,
            Item::LitPoint => self.strand_points * self.lights,
            Item::SimulatedPoint => self.simulated_points,
            Item::Vertex => self.vertices,
            Item::Pixel => self.pixels,
        }
    }
}

impl StageReport {
    /// Sets the bound of the stage and its multiple: the median divided by the time of one unit of the bound for each item. Stages
    /// without items keep none.
    pub(super) fn measure_by(&mut self, yardstick: &Yardstick, amounts: &Amounts) {
        let row = BOUNDS.iter().find(|(start, ..)| self.name.starts_with(start));
        let Some(&(_, bound, item)) = row else { return };
        let items = amounts.of(item);
        if items == 0 {
            return;
        }
        self.bound = Some(bound);
        self.multiple = Some(self.median_ms * 1e6 / (yardstick.unit_ns(bound) * items as f64));
        self.multiple_of = Some(format!("{} per {}", bound.unit(), item.label()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const YARDSTICK: Yardstick =
        Yardstick { copy_gb_per_s: 10.0, multiply_adds_g_per_s: 50.0, scattered_adds_m_per_s: 200.0 };

    fn measured(name: &str, ms: f64) -> StageReport {
        let amounts =
            Amounts { strand_points: 1000, lights: 3, simulated_points: 200, vertices: 0, pixels: 50 };
        let mut stage = StageReport::new(name, None, &[ms]);
        stage.measure_by(&YARDSTICK, &amounts);
        stage
    }

    #[test]
    fn a_multiple_is_the_work_of_the_bound_per_item() {
        // 1 ms is 1e6 ns: 1e7 bytes, 5e7 multiply-adds or 2e5 scattered additions.
        let near = |stage: StageReport, wanted: f64| {
            let found = stage.multiple.expect("a multiple");
            assert!((found / wanted - 1.0).abs() < 1e-12, "{stage:?}");
        };
        near(measured("interpolate", 1.0), 1e4);
        near(measured("draw/tiles", 1.0), 5e4);
        near(measured("shadow/build", 3.0), 200.0);
        near(measured("simulate/direct", 2.0), 5e5);
        assert_eq!(
            measured("shadow", 1.0).multiple_of.as_deref(),
            Some("scattered additions per point and light")
        );
    }

    #[test]
    fn a_stage_without_items_or_bound_has_no_multiple() {
        assert_eq!(measured("motion", 1.0).multiple, None, "there is no body");
        assert_eq!(measured("unknown", 1.0).multiple, None);
    }

    #[test]
    fn a_row_is_never_hidden_by_an_earlier_one() {
        for (index, (name, ..)) in BOUNDS.iter().enumerate() {
            let first = BOUNDS.iter().position(|(start, ..)| name.starts_with(start));
            assert_eq!(first, Some(index), "{name}");
        }
    }
}
