//! Methods beside each other on the same hair at the same instant, with the truth, the error and the cost.

mod contender;

pub use contender::Contender;
