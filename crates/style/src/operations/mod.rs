//! The operations. Each is a file or a folder here, and a name in the table of [`crate::operation`].

mod bend;
mod braid;
mod coil;
mod curl;
mod fringe;
mod length;
mod lift;
mod noise;
mod part;
mod scissors;
mod smooth;
mod straighten;
mod sweep;
#[cfg(test)]
mod testing;
mod tie;
mod twist;
mod wave;

pub use bend::Bend;
pub use braid::Braid;
pub use coil::Coil;
pub use curl::Curl;
pub use fringe::Fringe;
pub use length::{Length, LengthBy};
pub use lift::Lift;
pub use lovelock_groom::HairTie;
pub use noise::Noise;
pub use part::Part;
pub use scissors::Scissors;
pub use smooth::Smooth;
pub use straighten::Straighten;
pub use sweep::Sweep;
pub use twist::Twist;
pub use wave::Wave;
