//! The bodies that are built into the program.

use lovelock_motion::{Character, MotionError, load_character_bytes};
use lovelock_project::project::BodySource;

/// Files of `assets`, made by `cargo xtask assets`.
const DANCER: &[u8] = include_bytes!("../../../../assets/dancer.glb");
const MAN: &[u8] = include_bytes!("../../../../assets/man.glb");
const WOMAN: &[u8] = include_bytes!("../../../../assets/woman.glb");
const ELDER: &[u8] = include_bytes!("../../../../assets/elder.glb");
const ANIMAL: &[u8] = include_bytes!("../../../../assets/animal.glb");
const LAWN: &[u8] = include_bytes!("../../../../assets/lawn.glb");

/// Loads the dancer.
///
/// # Errors
/// Never, because a test checks the file in `assets`.
pub fn dancer() -> Result<Character, MotionError> {
    shipped(BodySource::Dancer)
}

/// Loads a shipped body; the dancer, if the source is a file.
///
/// # Errors
/// Never, because tests check the files in `assets`.
pub(super) fn shipped(source: BodySource) -> Result<Character, MotionError> {
    let (name, bytes) = match source {
        BodySource::Man => ("man.glb", MAN),
        BodySource::Woman => ("woman.glb", WOMAN),
        BodySource::Elder => ("elder.glb", ELDER),
        BodySource::Animal => ("animal.glb", ANIMAL),
        BodySource::Lawn => ("lawn.glb", LAWN),
        BodySource::Dancer | BodySource::File => ("dancer.glb", DANCER),
    };
    load_character_bytes(name, bytes, None)
}
