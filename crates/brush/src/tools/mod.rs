//! What each tool does to one guide at one dab.

mod moving;
mod shaping;

use glam::Vec3;
use lovelock_groom::{Guides, Obstacle};
use lovelock_style::hand::HandChannel;

use crate::settings::BrushSettings;
use crate::stroke::Dab;
use crate::tool::Tool;
use crate::touch::{TouchedGuide, Wisps};

pub(crate) use moving::Grab;
pub(crate) use shaping::neighbours;

/// What a tool does to one guide.
#[derive(Clone, Debug)]
pub(crate) enum Change {
    /// Its points are brought to these places as far as its links allow.
    Points(Vec<Vec3>),
    /// Its length is multiplied.
    Length(f32),
    /// It ends at this place, in links.
    Cut(f32),
    /// A channel of its strands changes by the weight of each point.
    Channel(HandChannel, Step, Vec<f32>),
    /// Its lock is removed or comes back.
    Removed(bool),
    /// Its lock is protected or free.
    Frozen(bool),
}

/// A change of a value, at a weight of 1.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Step {
    /// Multiplied.
    Times(f32),
    /// Added.
    Plus(f32),
    /// Brought nearer to a value by a part of the way.
    Toward(f32, f32),
}

impl Step {
    pub fn of(self, value: f32, weight: f32) -> f32 {
        match self {
            Self::Times(factor) => value * (1.0 + (factor - 1.0) * weight),
            Self::Plus(more) => value + more * weight,
            Self::Toward(target, part) => value + (target - value) * part * weight,
        }
    }
}

/// One dab of a tool.
pub(crate) struct Stamp<'a> {
    pub tool: Tool,
    pub inverted: bool,
    pub settings: &'a BrushSettings,
    pub dab: Dab,
    /// The way of the brush so far, head space.
    pub path: &'a [Vec3],
    /// All guides as they are seen, head space.
    pub seen: &'a Guides,
    /// Guides with near roots, of each guide; only for tools that use them.
    pub neighbours: &'a [Vec<u32>],
    pub locks: &'a Wisps,
    /// What was grabbed when the stroke began.
    pub grab: &'a [Grab],
    pub obstacle: &'a dyn Obstacle,
}

impl Stamp<'_> {
    /// What the tool does to a guide; `None` for nothing.
    pub fn change(&self, touched: &TouchedGuide) -> Option<Change> {
        use Change::{Channel, Cut, Frozen, Length, Points, Removed};
        let weights = || touched.weights.clone();
        Some(match self.tool {
            Tool::Comb => Points(self.combed(touched)),
            Tool::Puff => Points(self.puffed(touched)),
            Tool::Flatten => Points(self.flattened(touched)),
            Tool::Attract => Points(self.attracted(touched)),
            Tool::Part => Points(self.parted(touched)?),
            Tool::Place => Points(self.placed(touched)?),
            Tool::Smooth => Points(self.smoothed(touched)),
            Tool::Straighten => Points(Self::straightened(touched)),
            Tool::Pinch => Channel(HandChannel::Spread, Step::Times(0.8), weights()),
            Tool::Spread => Channel(HandChannel::Spread, Step::Times(1.25), weights()),
            Tool::Twist => {
                let more = if self.inverted { -0.1 } else { 0.1 };
                Channel(HandChannel::Twist, Step::Plus(more), touched.trailing())
            }
            Tool::Curl => {
                let radius = if self.inverted { 0.0 } else { self.settings.curl_radius };
                Channel(HandChannel::Curl, Step::Toward(radius, 0.35), weights())
            }
            Tool::Grow => Length(1.0 + 0.06 * touched.most()),
            Tool::Shrink => Length(1.0 - 0.06 * touched.most()),
            Tool::Cut => Cut(self.cut(touched)?),
            Tool::Remove => Removed(!self.inverted),
            Tool::Freeze => Frozen(!self.inverted),
        })
    }
}
