//! Chores: run, test, ci, layers, goldens and assets.
fn main() {}
