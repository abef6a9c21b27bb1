//! The operations. Each is a file or a folder here, and a name in the table of [`crate::operation`].

mod curl;
mod length;
mod scissors;
mod tie;
mod wave;

pub use curl::Curl;
pub use length::{Length, LengthBy};
pub use lovelock_groom::HairTie;
pub use scissors::Scissors;
pub use wave::Wave;
