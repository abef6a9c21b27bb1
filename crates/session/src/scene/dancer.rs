//! The dancer that is built into the program.

use lovelock_motion::{Character, MotionError, load_character_bytes};

/// `assets/dancer.glb`, made by `cargo xtask assets`.
const DANCER: &[u8] = include_bytes!("../../../../assets/dancer.glb");

/// Loads the dancer.
///
/// # Errors
/// Never, because a test checks the file in `assets`.
pub fn dancer() -> Result<Character, MotionError> {
    load_character_bytes("dancer.glb", DANCER, None)
}
