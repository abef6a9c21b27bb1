//! Numbers in sentences.

use std::fmt::Display;

/// A number of things in words: `counted(1, "frame", "frames")` is `1 frame`, and 2 are `2 frames`. The words may go on, such as with
/// a verb.
pub fn counted(count: impl Display + Copy, one: &str, many: &str) -> String {
    let count = count.to_string();
    let what = if count == "1" { one } else { many };
    format!("{count} {what}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_thing_is_singular() {
        assert_eq!(counted(1, "mesh was left out", "meshes were left out"), "1 mesh was left out");
        assert_eq!(counted(0, "key", "keys"), "0 keys");
        assert_eq!(counted(21_u64, "key", "keys"), "21 keys");
    }
}
