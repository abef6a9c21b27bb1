//! Projects that were saved before the place of the loop blend was a setting: they blend the start of a clip.

use serde::Deserialize;
use serde::de::IgnoredAny;

#[derive(Default, Deserialize)]
#[serde(default)]
struct Saved {
    motion: Motion,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct Motion {
    loop_blend: Option<IgnoredAny>,
    loop_blend_secs: Option<IgnoredAny>,
}

/// Whether the text is that of a project with the duration of the blend, but without its place. A saved project has all settings; one that
/// a person wrote has neither.
pub(super) fn is_at_start(options: &ron::Options, text: &str) -> bool {
    let saved: Saved = options.from_str(text).unwrap_or_default();
    saved.motion.loop_blend_secs.is_some() && saved.motion.loop_blend.is_none()
}
