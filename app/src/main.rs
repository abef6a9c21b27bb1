//! Lovelock.
fn main() {}
