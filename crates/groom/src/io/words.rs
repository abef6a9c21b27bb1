//! The words and lines of text formats.

/// The first word of a text, after a byte order mark, blanks and lines that begin with `#`. `None` if there is none.
pub(super) fn first_word(start: &[u8]) -> Option<&[u8]> {
    let mut rest = start.strip_prefix(b"\xef\xbb\xbf").unwrap_or(start).trim_ascii_start();
    while let Some(comment) = rest.strip_prefix(b"#") {
        let end = comment.iter().position(|&byte| byte == b'\n')?;
        rest = comment[end..].trim_ascii_start();
    }
    let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
    Some(&rest[..end]).filter(|word| !word.is_empty())
}

/// Whether the first word of a text is one of these, or the text consists of comments.
pub(super) fn begins_with_word(start: &[u8], words: &[&str]) -> bool {
    match first_word(start) {
        Some(word) => words.iter().any(|known| known.as_bytes() == word),
        None => start.contains(&b'#'),
    }
}

/// The first characters of a line, for messages.
pub(super) fn start_of(line: &[u8]) -> String {
    String::from_utf8_lossy(line).trim().chars().take(40).collect::<String>().escape_debug().to_string()
}

#[cfg(test)]
mod tests {
    use super::{begins_with_word, first_word};

    #[test]
    fn comments_come_before_the_first_word() {
        assert_eq!(first_word(b"\xef\xbb\xbf# a\r\n\n  #b\nv 1 2 3"), Some(&b"v"[..]));
        assert_eq!((first_word(b"# only"), first_word(b""), first_word(b" \n")), (None, None, None));
        assert!(begins_with_word(b"# only", &["v"]) && !begins_with_word(b"", &["v"]));
        assert!(!begins_with_word(b"vv 1", &["v"]));
    }
}
