//! Formats text and numbers for the page.

use std::fmt::Write as _;

/// Shown if nothing was measured.
pub const NOTHING: &str = "–";

/// Escapes text for an element or a double-quoted attribute.
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            '\'' => out += "&#39;",
            _ => out.push(letter),
        }
    }
    out
}

/// The URL of an image by its file name relative to the page, with special characters percent-encoded.
pub fn address(file: &str) -> String {
    let mut out = String::with_capacity(file.len());
    for byte in file.bytes() {
        if byte.is_ascii_alphanumeric() || b"-_./~".contains(&byte) {
            out.push(char::from(byte));
        } else {
            let _ = write!(out, "%{byte:02X}");
        }
    }
    // Without `./`, a name such as `a:b` would be a URL with a scheme, and `//a` another host.
    format!("./{}", out.trim_start_matches('/'))
}

/// A number with `places` decimals and a true minus sign; a dash if there is none or it is not finite.
pub fn fixed(value: Option<f64>, places: usize) -> String {
    match value.filter(|value| value.is_finite()) {
        Some(value) => {
            let text = format!("{value:.places$}");
            let nothing = text.trim_start_matches(['-', '0', '.']).is_empty();
            if nothing { text.trim_start_matches('-').to_owned() } else { text.replace('-', "−") }
        }
        None => NOTHING.into(),
    }
}

/// A possibly small number with at least two significant digits: four decimals, or a power of ten below 0.001.
pub fn small(value: Option<f64>) -> String {
    match value.filter(|value| value.is_finite()) {
        Some(0.0) => "0".into(),
        Some(value) if value.abs() < 9.995e-4 => format!("{value:.1e}").replace('-', "−"),
        value => fixed(value, 4),
    }
}

/// As [`fixed`], with a plus sign if positive.
pub fn signed(value: Option<f64>, places: usize) -> String {
    let text = fixed(value, places);
    let digits = text.contains(|letter: char| ('1'..='9').contains(&letter));
    if digits && !text.starts_with('−') { format!("+{text}") } else { text }
}

/// Milliseconds with three significant digits.
pub fn ms(value: Option<f64>) -> String {
    let places = match value.map_or(0.0, f64::abs) {
        size if size < 10.0 => 2,
        size if size < 100.0 => 1,
        _ => 0,
    };
    fixed(value, places)
}

/// Bytes in the largest binary unit with a number above one.
pub fn bytes(value: Option<u64>) -> String {
    let Some(bytes) = value else { return NOTHING.into() };
    let units = [("GiB", 30), ("MiB", 20), ("KiB", 10)];
    for (unit, power) in units {
        let size = bytes as f64 / f64::from(1_u32 << power);
        if size >= 1.0 {
            return format!("{} {unit}", fixed(Some(size), if size < 10.0 { 2 } else { 1 }));
        }
    }
    format!("{bytes} B")
}

/// A number of draws.
pub fn draws(count: u32) -> String {
    format!("{} draw{}", grouped(u64::from(count)), if count == 1 { "" } else { "s" })
}

/// A whole number in groups of three digits.
pub fn grouped(value: u64) -> String {
    let digits = value.to_string();
    let mut out = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            out.push('\u{202f}');
        }
        out.push(digit);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::{address, bytes, draws, escaped, fixed, grouped, ms, signed, small};

    #[test]
    fn numbers_read_as_they_should() {
        assert_eq!(fixed(Some(0.012_34), 4), "0.0123");
        assert_eq!(fixed(Some(-0.5), 2), "−0.50");
        assert_eq!(fixed(Some(-0.000_01), 2), "0.00");
        assert_eq!((fixed(None, 2), fixed(Some(f64::NAN), 2)), ("–".into(), "–".into()));
        let smalls = [0.0, 6.525e-5, -0.000_999_4, 0.000_999_6, 0.0123, 1.5, f64::NAN];
        let words = ["0", "6.5e−5", "−1.0e−3", "0.0010", "0.0123", "1.5000", "–"];
        assert_eq!(smalls.map(|value| small(Some(value))), words);
        assert_eq!(signed(Some(0.25), 2), "+0.25");
        assert_eq!((signed(Some(-0.25), 2), signed(Some(0.0), 2)), ("−0.25".into(), "0.00".into()));
        assert_eq!([0.123, 12.34, 456.7].map(|value| ms(Some(value))), ["0.12", "12.3", "457"]);
        assert_eq!([1, 2, 1000].map(draws), ["1 draw", "2 draws", "1\u{202f}000 draws"]);
        assert_eq!(bytes(Some(512)), "512 B");
        assert_eq!(bytes(Some(3 << 19)), "1.50 MiB");
        assert_eq!(bytes(Some(20 << 30)), "20.0 GiB");
        assert_eq!(grouped(1_234_567), "1\u{202f}234\u{202f}567");
        assert_eq!(grouped(999), "999");
    }

    #[test]
    fn text_cannot_leave_its_place() {
        assert_eq!(escaped("<b a=\"1\">&'"), "&lt;b a=&quot;1&quot;&gt;&amp;&#39;");
        assert_eq!(address("pictures/größe 1.png"), "./pictures/gr%C3%B6%C3%9Fe%201.png");
        assert_eq!(address("//host/a"), "./host/a");
        assert_eq!(address("http://host/\"><script>"), "./http%3A//host/%22%3E%3Cscript%3E");
    }
}
