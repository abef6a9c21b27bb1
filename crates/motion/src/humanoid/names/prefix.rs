//! The words that most names of a skeleton begin with, such as `m_avg` or the name of a performer.

use std::collections::HashMap;

/// Share of the names that must begin with a word before it counts as a prefix.
const SHARE: f32 = 0.6;
/// Fewest names with which this can be judged.
const FEWEST: usize = 6;
/// Most words of a prefix.
const LONGEST: usize = 4;

/// Number of words at the start of most names, and those words. `has_meaning` tells words that name a side or a part of the body.
pub(super) fn common(names: &[Vec<String>], has_meaning: impl Fn(&str) -> bool) -> Vec<String> {
    let mut prefix: Vec<String> = Vec::new();
    while prefix.len() < LONGEST {
        let mut counts: HashMap<&str, usize> = HashMap::new();
        let longer =
            names.iter().filter(|words| words.len() > prefix.len() + 1 && words.starts_with(&prefix));
        for words in longer {
            *counts.entry(&words[prefix.len()]).or_default() += 1;
        }
        let most = counts.into_iter().max_by_key(|&(word, count)| (count, word.len()));
        match most {
            Some((word, count))
                if count >= FEWEST && count as f32 >= SHARE * names.len() as f32 && !has_meaning(word) =>
            {
                prefix.push(word.to_owned());
            }
            _ => break,
        }
    }
    prefix
}
