//! The operations. Each is a file or a folder here, and a name in the table of [`crate::operation`].

mod bend;
mod curl;
mod length;
mod lift;
mod part;
mod scissors;
mod straighten;
mod sweep;
#[cfg(test)]
mod testing;
mod tie;
mod wave;

pub use bend::Bend;
pub use curl::Curl;
pub use length::{Length, LengthBy};
pub use lift::Lift;
pub use lovelock_groom::HairTie;
pub use part::Part;
pub use scissors::Scissors;
pub use straighten::Straighten;
pub use sweep::Sweep;
pub use wave::Wave;
