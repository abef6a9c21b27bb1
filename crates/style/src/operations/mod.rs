//! The operations. Each is a file or a folder here, and a name in the imports and in the table of [`crate::operation`].

mod bend;
mod braid;
mod clump;
mod coil;
mod colour;
mod curl;
mod dreadlock;
mod fringe;
mod frizz;
mod hand;
mod length;
mod lift;
mod motion;
mod noise;
mod part;
mod scissors;
mod smooth;
mod straighten;
mod strays;
mod sweep;
mod taper;
#[cfg(test)]
pub(crate) mod testing;
#[cfg(test)]
mod tests;
mod tie;
mod twist;
mod wander;
mod wave;
mod width;

pub use bend::Bend;
pub use braid::Braid;
pub use clump::Clump;
pub use coil::Coil;
pub use colour::{Dye, Gradient, GradientPigment, Grey, Highlights, Melanin, Streak};
pub use curl::Curl;
pub use dreadlock::Dreadlock;
pub use fringe::Fringe;
pub use frizz::Frizz;
pub use hand::Hand;
pub use length::{Length, LengthBy};
pub use lift::Lift;
pub use lovelock_groom::HairTie;
pub use motion::{Damping, Friction, Hold, Stiffness};
pub use noise::Noise;
pub use part::Part;
pub use scissors::Scissors;
pub use smooth::Smooth;
pub use straighten::Straighten;
pub use strays::Strays;
pub use sweep::Sweep;
pub use taper::Taper;
pub use twist::Twist;
pub use wander::Wander;
pub use wave::Wave;
pub use width::Width;
