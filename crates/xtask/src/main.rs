//! Chores: run, test, ci, layers, goldens and assets.

mod assets;

fn main() -> anyhow::Result<()> {
    match std::env::args().nth(1).as_deref() {
        Some("assets") => assets::run(),
        _ => Ok(()),
    }
}
