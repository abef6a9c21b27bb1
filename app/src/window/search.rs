//! Finds what was typed: the best match first, by one rule for commands, settings, layers and styles.

/// How well a text fits what was typed, the best first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Fit {
    /// The name is what was typed.
    Name,
    /// The name begins with it.
    NameBegins,
    /// A word of the name begins with it.
    WordBegins,
    /// The name contains it.
    NameContains,
    /// The name contains every word of it, in any order.
    NameContainsWords,
    /// Every word of it is contained in the name or begins a word of another text.
    Texts,
}

/// How well a thing of that name, with other texts about it, fits what was typed. `None` if a word of it is missing. Nothing typed
/// fits everything equally well.
pub(crate) fn fit(typed: &str, name: &str, others: &[&str]) -> Option<Fit> {
    let typed = typed.trim().to_lowercase();
    let name = name.to_lowercase();
    if typed.is_empty() || name == typed {
        return Some(Fit::Name);
    }
    if name.starts_with(&typed) {
        return Some(Fit::NameBegins);
    }
    if word_begins(&name, &typed) {
        return Some(Fit::WordBegins);
    }
    if name.contains(&typed) {
        return Some(Fit::NameContains);
    }
    let words: Vec<&str> = typed.split_whitespace().collect();
    if words.iter().all(|word| name.contains(word)) {
        return Some(Fit::NameContainsWords);
    }
    let others: Vec<String> = others.iter().map(|text| text.to_lowercase()).collect();
    let is_found = |word: &&str| name.contains(word) || others.iter().any(|text| word_begins(text, word));
    words.iter().all(is_found).then_some(Fit::Texts)
}

/// Whether a word of `text` begins with `part`.
fn word_begins(text: &str, part: &str) -> bool {
    text.match_indices(part).any(|(at, _)| {
        let before = text[..at].chars().next_back();
        before.is_none_or(|c| !c.is_alphanumeric())
    })
}

/// The things that fit what was typed, the best first; those that fit equally well stay in their order.
pub(crate) fn best_first<T>(
    typed: &str,
    things: impl IntoIterator<Item = T>,
    fit_of: impl Fn(&str, &T) -> Option<Fit>,
) -> Vec<T> {
    let mut found: Vec<(Fit, T)> =
        things.into_iter().filter_map(|thing| Some((fit_of(typed, &thing)?, thing))).collect();
    found.sort_by_key(|(fit, _)| *fit);
    found.into_iter().map(|(_, thing)| thing).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_match_comes_first() {
        let things = [
            ("Uncurled", ""),
            ("Smooth", "Removes curl."),
            ("Red curls", ""),
            ("Curl radius", ""),
            ("Radius of a curl", ""),
            ("Curl", ""),
            ("Density", "Hair per area."),
            ("Density again", "Takes uncurled hair back."),
        ];
        let found = best_first(" cURL ", things, |typed, (name, text)| fit(typed, name, &[text]));
        let names: Vec<_> = found.iter().map(|(name, _)| *name).collect();
        let wanted = ["Curl", "Curl radius", "Red curls", "Radius of a curl", "Uncurled", "Smooth"];
        assert_eq!(names, wanted);
    }

    #[test]
    fn every_word_must_be_found_and_nothing_typed_finds_all() {
        assert_eq!(fit("hair frame", "Frame the hair", &[]), Some(Fit::NameContainsWords));
        assert_eq!(fit("hair zebra", "Frame the hair", &["for horses"]), None);
        assert_eq!(fit("  ", "Frame the hair", &[]), Some(Fit::Name));
        for (typed, found) in [
            ("LONG", true),
            ("wav lo", true),
            ("gold", true),
            ("loose", true),
            ("long short", false),
            ("olden", false),
        ] {
            let texts = ["Golden waves far past the shoulders.", "loose"];
            assert_eq!(fit(typed, "Long waves", &texts).is_some(), found, "{typed}");
        }
        assert_eq!(fit("ö", "Größe", &[]), Some(Fit::NameContains));
    }
}
