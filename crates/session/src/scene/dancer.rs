//! The dancer that is part of the program.

use lovelock_motion::{Character, MotionError, load_character_bytes};

/// `assets/dancer.glb`, made by `cargo xtask assets`.
const DANCER: &[u8] = include_bytes!("../../../../assets/dancer.glb");

/// Loads the dancer.
///
/// # Errors
/// None, as long as the file in `assets` is sound, which a test checks.
pub fn dancer() -> Result<Character, MotionError> {
    load_character_bytes("dancer.glb", DANCER, None)
}
