//! Quality of the simulation: gauges with limits, and advice if a gauge is over its limit.

use glam::Vec3;
use lovelock_groom::Guides;
use lovelock_simulation::{BodyPart, InsidePoint, Integrator, SimulationSettings};
use serde::Serialize;

use crate::scene::Scene;
use crate::snapshot::FrameSnapshot;
use crate::totals::{Occurrence, Totals};

/// The quantity that a gauge measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum GaugeKind {
    /// The largest relative change of a link's length.
    Stretch,
    /// The deepest point inside the body.
    Penetration,
    /// Points in folded skin, whose penetration depth is unknown.
    Folded,
    /// Mean kinetic energy.
    Energy,
    /// Guides that became non-finite and were reset.
    PutBack,
    /// How deep the style at rest lies inside a collider.
    RestInside,
}

impl GaugeKind {
    /// All gauges, in display order.
    pub const ALL: [Self; 6] =
        [Self::Stretch, Self::Penetration, Self::Folded, Self::Energy, Self::PutBack, Self::RestInside];

    /// The name in the interface.
    pub fn label(self) -> &'static str {
        match self {
            Self::Stretch => "Largest stretch",
            Self::Penetration => "Deepest in the body",
            Self::Folded => "In folded skin",
            Self::Energy => "Energy",
            Self::PutBack => "Guides put back",
            Self::RestInside => "Style in the body",
        }
    }

    /// The tooltip.
    pub fn tooltip(self) -> &'static str {
        match self {
            Self::Stretch => {
                "The largest relative change of a guide link's length since the hair was last settled."
            }
            Self::Penetration => {
                "The largest penetration depth of hair in the body since the hair was last settled."
            }
            Self::Folded => {
                "The largest number of guide points at one time in skin that is folded over itself, since the hair was last settled. \
                 Their depth is unknown, so they do not count in Deepest in the body."
            }
            Self::Energy => {
                "The mean kinetic energy of the hair now, per kilogram: a brisk turn of the head gives 5 J/kg."
            }
            Self::PutBack => {
                "Guides that became invalid and were reset to the previous step, since the hair was last settled."
            }
            Self::RestInside => {
                "The largest penetration depth of the style at rest in the shapes that it collides with."
            }
        }
    }

    /// Values up to the first number are good; values over the second one are wrong.
    ///
    /// Stretch: the solver leaves 3e-6, and a thousandth of a strand's length is a pixel of a large image. Penetration: skin hides
    /// about a millimetre. Folded skin: ten points are a part of one wisp, a hundred are three wisps. Energy: 30 J/kg are 8 m/s on
    /// average, faster than any head turns. The style at rest: it stays as close as it was designed, and round shapes approximate
    /// the neck to about a centimetre.
    fn limits(self) -> [f64; 2] {
        match self {
            Self::Stretch => [1e-4, 1e-3],
            Self::Penetration => [1e-3, 5e-3],
            Self::Folded => [10.0, 100.0],
            Self::Energy => [30.0, 100.0],
            Self::PutBack => [0.0, 0.0],
            Self::RestInside => [10e-3, 25e-3],
        }
    }

    /// A value with its unit.
    pub fn in_words(self, value: f64) -> String {
        match self {
            Self::Stretch => format!("{:.4} %", 1e2 * value),
            Self::Penetration | Self::RestInside => format!("{:.1} mm", 1e3 * value),
            Self::Energy => format!("{value:.1} J/kg"),
            Self::Folded => format!("{value:.0} {}", if value == 1.0 { "point" } else { "points" }),
            Self::PutBack => format!("{value:.0}"),
        }
    }
}

/// The rating of a gauge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum HealthLevel {
    /// Within the first limit.
    Good,
    /// Between the limits: it may be visible.
    Watch,
    /// Over the second limit.
    Wrong,
}

/// One gauge.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Gauge {
    /// The quantity that a gauge measures.
    pub kind: GaugeKind,
    /// Its value: a fraction, metres, joules per kilogram, or a number of points or guides.
    pub value: f64,
    /// The rating.
    pub level: HealthLevel,
    /// The guide and its point with this value, if there is one.
    pub at: Option<(u32, u32)>,
    /// Time and position of that point when the value occurred; `None` for a value of this instant or of the style at rest.
    pub found: Option<Occurrence>,
    /// The part of the body that the point penetrates: `head and shoulders`, or the name of a joint.
    pub within: Option<String>,
    /// What it means and what to change; empty if the rating is good.
    pub advice: String,
}

impl Gauge {
    /// The value as a fraction of the second limit, 0 to 1.
    pub fn fill(&self) -> f32 {
        let [_, wrong] = self.kind.limits();
        if wrong > 0.0 { (self.value / wrong).clamp(0.0, 1.0) as f32 } else { f32::from(self.value > 0.0) }
    }

    /// The value with its unit, the penetrated part of the body, and the time.
    pub fn in_words(&self) -> String {
        let mut words = self.kind.in_words(self.value);
        for more in self.within.iter().map(|within| format!(" in {within}")).chain(self.when_in_words()) {
            words.push_str(&more);
        }
        words
    }

    /// Time on the timeline when the value occurred, seconds; `None` if it has no such time.
    pub fn found_secs(&self) -> Option<f64> {
        self.found?.at_secs
    }

    /// The same as text to append: ` at 3.8 s`.
    pub fn when_in_words(&self) -> Option<String> {
        self.found_secs().map(|secs| format!(" at {secs:.1} s"))
    }

    fn new(kind: GaugeKind, value: f64, at: Option<(u32, u32)>, advice: impl FnOnce() -> String) -> Self {
        let [good, wrong] = kind.limits();
        let level = if value <= good {
            HealthLevel::Good
        } else if value <= wrong {
            HealthLevel::Watch
        } else {
            HealthLevel::Wrong
        };
        let advice = if level == HealthLevel::Good { String::new() } else { advice() };
        Self { kind, value, level, at, found: None, within: None, advice }
    }
}

/// The gauges of all steps of a recording. Energy is the maximum, with its time.
pub fn health(
    totals: &Totals,
    rest: Option<InsidePoint>,
    scene: &Scene,
    settings: &SimulationSettings,
) -> Vec<Gauge> {
    let mut gauges = gauges((totals.max_kinetic_energy, totals.fastest_at), totals, rest, scene, settings);
    for gauge in gauges.iter_mut().filter(|gauge| gauge.kind == GaugeKind::Energy) {
        gauge.found = totals.fastest_found;
    }
    gauges
}

fn gauges(
    (energy, fastest_at): (f32, Option<(u32, u32)>),
    totals: &Totals,
    rest: Option<InsidePoint>,
    scene: &Scene,
    settings: &SimulationSettings,
) -> Vec<Gauge> {
    let place = |inside: Option<InsidePoint>| inside.map(|inside| (inside.guide, inside.point));
    let within = |inside: Option<InsidePoint>| inside.map(|inside| scene.name_of(inside.within).to_owned());
    let mut gauges = vec![
        Gauge::new(GaugeKind::Stretch, f64::from(totals.max_stretch), totals.worst_stretch_at, || {
            let more = if settings.integrator == Integrator::Relaxation {
                "Choose the direct method, or raise the iterations"
            } else if settings.substeps < lovelock_simulation::MAX_SUBSTEPS {
                "Raise the substeps"
            } else {
                "Slow the motion down"
            };
            format!("Locks are stretched. {more}, and check whether the motion jumps there.")
        }),
        Gauge::new(
            GaugeKind::Penetration,
            f64::from(totals.max_penetration_m),
            place(totals.deepest),
            || {
                let (part, fit) = fitting(totals.deepest, scene, "raise");
                format!(
                    "Hair goes into the body: {part}. Raise the skin margin or the substeps; to hide the rest, {fit}."
                )
            },
        ),
        Gauge::new(GaugeKind::Folded, f64::from(totals.unsure_points), totals.unsure_at, || {
            "Hair is caught where skin is folded over itself: under a chin, or between a raised shoulder and the neck. Tie \
             it up, cut it shorter or soften the pose there; to keep hair further out, raise Lift (Colliders, Head and \
             shoulders)."
                .to_owned()
        }),
        Gauge::new(GaugeKind::Energy, f64::from(energy), fastest_at, || {
            if settings.wind.speed > 15.0 {
                "The wind blows the hair too hard. Lower the wind speed or the air drag.".to_owned()
            } else {
                "The hair moves too fast. Slow the motion down, or raise Settling and Air drag.".to_owned()
            }
        }),
        Gauge::new(
            GaugeKind::PutBack,
            totals.recovered_guides as f64,
            totals.recovered_at.map(|guide| (guide, u32::MAX)),
            || {
                "Guides became invalid and were put back to the previous step. Raise the substeps, or lower stiffness, wind \
                 and repulsion; a guide that fails repeatedly has points on top of each other."
                    .to_owned()
            },
        ),
        Gauge::new(
            GaugeKind::RestInside,
            rest.map_or(0.0, |rest| f64::from(rest.depth_m)),
            place(rest),
            || {
                let (part, fit) = fitting(rest, scene, "lower");
                format!(
                    "The style starts inside the body: {part}. The simulation does not push it out; move the style away \
                     from the body, or {fit}."
                )
            },
        ),
    ];
    for gauge in &mut gauges {
        gauge.within = match gauge.kind {
            GaugeKind::Penetration => within(totals.deepest),
            GaugeKind::RestInside => within(rest),
            GaugeKind::Stretch | GaugeKind::Folded | GaugeKind::Energy | GaugeKind::PutBack => None,
        };
        gauge.found = match gauge.kind {
            GaugeKind::Stretch => totals.worst_stretch_found,
            GaugeKind::Penetration => totals.deepest_found,
            GaugeKind::Folded => totals.unsure_found,
            GaugeKind::PutBack => totals.recovered_found,
            GaugeKind::Energy | GaugeKind::RestInside => None,
        };
    }
    gauges
}

/// The part of the body that a point penetrates, and which of its controls to change.
fn fitting(inside: Option<InsidePoint>, scene: &Scene, change: &str) -> (String, String) {
    let part = inside.map_or("the body", |inside| scene.name_of(inside.within)).to_owned();
    let fit = match inside.map(|inside| inside.within) {
        Some(BodyPart::Field) => format!("{change} Lift (Colliders, Head and shoulders)"),
        Some(BodyPart::Collider(_)) => format!("{change} Size of {part} (Colliders)"),
        None => "fit it better (Colliders)".to_owned(),
    };
    (part, fit)
}

impl FrameSnapshot {
    /// The gauges at this instant, which was simulated with `settings`.
    pub fn health(&self, settings: &SimulationSettings) -> Vec<Gauge> {
        let now = (self.report.kinetic_energy, self.report.fastest_at);
        gauges(now, &self.totals, self.rest_inside, &self.scene, settings)
    }

    /// The position of a gauge's point, world space, metres: its position when the value occurred; for the style at rest, its
    /// position on the head now; for a value of this instant, its position now. `None` if the gauge has no point.
    pub fn place_of(&self, gauge: &Gauge) -> Option<Vec3> {
        if let Some(found) = gauge.found {
            return Some(found.place);
        }
        let at = gauge.at?;
        if gauge.kind == GaugeKind::RestInside {
            let in_head = point_of(&self.scene.style.guides, at)?;
            return Some(self.guides.world_from_head.transform_point3(in_head));
        }
        self.guide_point(at)
    }

    /// Current position of a guide point, world space; the tip if the guide has fewer points. `None` if there is no such guide.
    pub fn guide_point(&self, at: (u32, u32)) -> Option<Vec3> {
        point_of(&self.guides.guides, at)
    }
}

fn point_of(guides: &Guides, (guide, point): (u32, u32)) -> Option<Vec3> {
    let last = guides.points_per_guide.checked_sub(1)?;
    ((guide as usize) < guides.count()).then(|| guides.point(guide as usize, (point as usize).min(last)))
}

#[cfg(test)]
mod tests;
