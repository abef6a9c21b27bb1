//! The operations. Each is a file or a folder here, and a name in the imports and in the table of [`crate::operation`].

mod clump;
mod curl;
mod frizz;
mod length;
mod scissors;
mod strays;
mod taper;
#[cfg(test)]
mod tests;
mod tie;
mod wander;
mod wave;
mod width;

pub use clump::Clump;
pub use curl::Curl;
pub use frizz::Frizz;
pub use length::{Length, LengthBy};
pub use lovelock_groom::HairTie;
pub use scissors::Scissors;
pub use strays::Strays;
pub use taper::Taper;
pub use wander::Wander;
pub use wave::Wave;
pub use width::Width;
