//! The order in which the characters of a line are seen, by the Unicode Bidirectional Algorithm (Unicode Standard Annex 9).

use std::borrow::Cow;

use unicode_bidi::BidiInfo;

/// A piece of a line with one direction, in the order in which it is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Piece<'a> {
    /// Its characters, as they are typed.
    pub text: &'a str,
    /// Whether it is read from right to left.
    pub from_right: bool,
}

/// Whether a text may have characters that are read from right to left. All of them are above U+0590.
fn may_turn(text: &str) -> bool {
    text.chars().any(|c| u32::from(c) >= 0x0590)
}

/// The pieces of a line from left to right.
pub fn pieces(text: &str) -> Vec<Piece<'_>> {
    if !may_turn(text) {
        return vec![Piece { text, from_right: false }];
    }
    let info = BidiInfo::new(text, None);
    let mut pieces = Vec::new();
    // A line has one paragraph; what follows a line break is put after it.
    for paragraph in &info.paragraphs {
        let (levels, runs) = info.visual_runs(paragraph, paragraph.range.clone());
        for run in runs {
            let from_right = levels.get(run.start).is_some_and(unicode_bidi::Level::is_rtl);
            if let Some(text) = text.get(run).filter(|text| !text.is_empty()) {
                pieces.push(Piece { text, from_right });
            }
        }
    }
    pieces
}

/// A line whose words stand from left to right as they are seen, each as it is typed. For what shapes words from right to left but sets
/// them from left to right.
pub fn visual_words(text: &str) -> Cow<'_, str> {
    if !may_turn(text) {
        return Cow::Borrowed(text);
    }
    let pieces = pieces(text);
    if pieces.iter().all(|piece| !piece.from_right) {
        return Cow::Borrowed(text);
    }
    let mut line = String::with_capacity(text.len());
    for piece in pieces {
        if piece.from_right {
            // Words and the spaces between them, the last word first.
            let mut words: Vec<&str> = piece.text.split_inclusive(char::is_whitespace).collect();
            words.reverse();
            for word in words {
                let bare = word.trim_end_matches(char::is_whitespace);
                line.push_str(&word[bare.len()..]);
                line.push_str(bare);
            }
        } else {
            line.push_str(piece.text);
        }
    }
    Cow::Owned(line)
}

/// The character that stands for `c` where text is read from right to left.
fn mirrored(c: char) -> char {
    match c {
        '(' => ')',
        ')' => '(',
        '[' => ']',
        ']' => '[',
        '{' => '}',
        '}' => '{',
        '<' => '>',
        '>' => '<',
        '«' => '»',
        '»' => '«',
        other => other,
    }
}

/// The characters of a piece from left to right, one after the other, with brackets turned: for letters that need no shaping.
pub fn seen(piece: Piece<'_>) -> String {
    if piece.from_right { piece.text.chars().rev().map(mirrored).collect() } else { piece.text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hebrew_between_latin_is_one_piece_from_the_right() {
        let found = pieces("abc שלום עולם 12 x");
        let text: Vec<_> = found.iter().map(|piece| (piece.text, piece.from_right)).collect();
        // The number belongs to the Hebrew words and stands left of them.
        assert_eq!(text, [("abc ", false), ("12", false), ("שלום עולם ", true), (" x", false)]);
        assert_eq!(pieces("plain").len(), 1);
        assert_eq!(pieces("").len(), 1);
        assert_eq!(pieces("日本語"), [Piece { text: "日本語", from_right: false }]);
    }

    #[test]
    fn words_are_turned_and_their_letters_are_not() {
        assert_eq!(visual_words("שלום עולם"), "עולם שלום");
        assert_eq!(visual_words("שלום"), "שלום");
        assert!(matches!(visual_words("hello world"), Cow::Borrowed(_)));
        assert_eq!(visual_words("ab שלום עולם cd"), "ab עולם שלום cd");
    }

    #[test]
    fn brackets_are_mirrored() {
        assert_eq!(seen(Piece { text: " (1", from_right: true }), "1) ");
        assert_eq!(seen(Piece { text: " (1", from_right: false }), " (1");
    }
}
