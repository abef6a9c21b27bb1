//! Numbers brought into ranges, and words that are no numbers.

/// `value` clamped to `low..=high`; `fallback` replaces NaN.
pub fn within(value: f32, low: f32, high: f32, fallback: f32) -> f32 {
    if value.is_nan() { fallback } else { value.clamp(low, high) }
}

/// Hermite interpolation from 0 at `low` to 1 at `high`, and constant beyond; `low` may be the larger of the two.
#[inline]
pub fn smoothstep(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Linear interpolation from `a` at 0 to `b` at 1. Always inlined, so that loops around it vectorise.
#[expect(clippy::inline_always, reason = "a call would prevent vectorisation")]
#[inline(always)]
pub fn mix(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}

/// Whether a word is what libraries of C write for a value that is no number or has no bound: `1.#QNAN` and `-1.#IND` of Microsoft's
/// older ones, `-nan(ind)` of its newer ones, `-nan` and `nan(0x8000)` of the others.
pub fn is_not_a_number(word: &str) -> bool {
    let name = word.trim_start_matches(['-', '+']);
    let is_nan = name.get(..3).is_some_and(|start| start.eq_ignore_ascii_case("nan"));
    word.contains(".#") || is_nan && (name.len() == 3 || name[3..].starts_with('(') && name.ends_with(')'))
}

/// Divides a word before each sign that begins another number, which is one that follows a digit or a decimal point: a column that is too
/// narrow leaves no blank.
pub fn numbers_of(word: &str) -> impl Iterator<Item = &str> {
    let bytes = word.as_bytes();
    let begins = |at: usize| {
        matches!(bytes[at], b'-' | b'+') && (bytes[at - 1].is_ascii_digit() || bytes[at - 1] == b'.')
    };
    let mut from = 0;
    let cuts = (1..=bytes.len()).filter(move |&at| at == bytes.len() || begins(at));
    cuts.map(move |at| {
        let part = &word[from..at];
        from = at;
        part
    })
}

/// The number of a word, which is NaN where it is what libraries write for none ([`is_not_a_number`]); `None` for other words.
pub fn number(word: &str) -> Option<f64> {
    word.parse().ok().or_else(|| is_not_a_number(word).then_some(f64::NAN))
}

#[cfg(test)]
mod tests {
    use super::{is_not_a_number, number, numbers_of, smoothstep, within};

    #[test]
    fn words_are_divided_before_signs_but_not_in_exponents() {
        let divided = |word| numbers_of(word).collect::<Vec<_>>();
        assert_eq!(divided("0.07-0.02+3.-1"), ["0.07", "-0.02", "+3.", "-1"]);
        assert_eq!(divided("-1.5e-3"), ["-1.5e-3"]);
        // Negative control: without a sign nothing says where a number begins.
        assert_eq!(divided("0.070.02"), ["0.070.02"]);
        assert_eq!((number("-1.5e-3"), number("1,5")), (Some(-0.0015), None));
        assert!(
            number("-nan(ind)").is_some_and(f64::is_nan)
                && number("0.070.02").is_none()
                && divided("").is_empty()
        );
    }

    #[test]
    fn what_libraries_write_for_no_number_is_told_from_words() {
        for word in ["1.#QNAN", "-1.#IND", "1.#INF", "-nan(ind)", "nan", "-NaN", "+nan(0x8000)", "nan(snan)"]
        {
            assert!(is_not_a_number(word), "{word}");
        }
        for word in ["", "-", "1.0", "nano", "nan(", "na", "inch", "é"] {
            assert!(!is_not_a_number(word), "{word}");
        }
    }

    #[test]
    fn values_are_clamped_and_nan_is_replaced() {
        assert_eq!(within(0.5, 0.0, 1.0, 0.25), 0.5);
        assert_eq!(within(-1.0, 0.0, 1.0, 0.25), 0.0);
        assert_eq!(within(f32::INFINITY, 0.0, 1.0, 0.25), 1.0);
        assert_eq!(within(f32::NAN, 0.0, 1.0, 0.25), 0.25);
    }

    #[test]
    fn the_smooth_step_is_constant_outside_and_runs_in_either_direction() {
        assert_eq!([1.0, 2.0, 3.0, 4.0, 5.0].map(|x| smoothstep(2.0, 4.0, x)), [0.0, 0.0, 0.5, 1.0, 1.0]);
        assert_eq!([1.0, 2.0, 3.0, 4.0, 5.0].map(|x| smoothstep(4.0, 2.0, x)), [1.0, 1.0, 0.5, 0.0, 0.0]);
    }
}
