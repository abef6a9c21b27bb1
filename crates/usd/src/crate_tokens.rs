//! The tokens of a crate: by index, and by their text.

/// All tokens of a crate.
#[derive(Default)]
pub(crate) struct Tokens {
    texts: Vec<String>,
    /// Indices in the order of the texts.
    by_text: Vec<u32>,
}

impl Tokens {
    pub(crate) fn new<'a>(words: impl Iterator<Item = &'a [u8]>) -> Self {
        let texts: Vec<String> = words.map(|word| String::from_utf8_lossy(word).into_owned()).collect();
        let mut by_text: Vec<u32> = (0..texts.len() as u32).collect();
        by_text.sort_by(|a, b| texts[*a as usize].cmp(&texts[*b as usize]));
        Self { texts, by_text }
    }

    pub(crate) fn len(&self) -> usize {
        self.texts.len()
    }

    pub(crate) fn get(&self, index: u32) -> Option<&str> {
        self.texts.get(index as usize).map(String::as_str)
    }

    /// The first index of a text.
    pub(crate) fn index_of(&self, text: &str) -> Option<u32> {
        let at = self.by_text.partition_point(|index| self.texts[*index as usize].as_str() < text);
        self.by_text.get(at).copied().filter(|index| self.texts[*index as usize] == text)
    }
}

#[cfg(test)]
mod tests {
    use super::Tokens;

    #[test]
    fn texts_are_found_where_they_stand_first() {
        let tokens = Tokens::new(["b", "a", "", "b", "c"].map(str::as_bytes).into_iter());
        let found = ["a", "b", "c", "", "d", "aa"].map(|text| tokens.index_of(text));
        assert_eq!(found, [Some(1), Some(0), Some(4), Some(2), None, None]);
        assert_eq!((tokens.len(), tokens.get(4), tokens.get(5)), (5, Some("c"), None));
        assert_eq!(Tokens::default().index_of("a"), None);
    }
}
