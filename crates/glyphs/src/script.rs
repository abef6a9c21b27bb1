//! Scripts: which characters belong to them, which fonts are preferred for them, and which package has one.

use std::collections::BTreeSet;

/// A group of characters that needs its own fonts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Script {
    /// Hiragana, Katakana, and Chinese characters, which Japanese also uses.
    Japanese,
    /// Chinese characters.
    Chinese,
    /// Hangul.
    Korean,
    /// Arabic.
    Arabic,
    /// Hebrew.
    Hebrew,
    /// Hindi and other languages in Devanagari.
    Devanagari,
    /// Thai.
    Thai,
    /// Emoji.
    Emoji,
    /// Everything else.
    Other,
}

impl Script {
    /// The script of a character. Chinese characters are [`Script::Chinese`] whatever the language.
    pub fn of(c: char) -> Self {
        match u32::from(c) {
            0x3040..=0x30FF | 0x31F0..=0x31FF | 0xFF66..=0xFF9D => Self::Japanese,
            0x1100..=0x11FF | 0x3130..=0x318F | 0xA960..=0xA97F | 0xAC00..=0xD7FF => Self::Korean,
            0x2E80..=0x303F
            | 0x3100..=0x312F
            | 0x31A0..=0x31EF
            | 0x3200..=0x4DBF
            | 0x4E00..=0x9FFF
            | 0xF900..=0xFAFF
            | 0xFE30..=0xFE4F
            | 0xFF00..=0xFF65
            | 0xFFE0..=0xFFEF
            | 0x2_0000..=0x3_FFFF => Self::Chinese,
            0x0600..=0x06FF | 0x0750..=0x077F | 0x0870..=0x08FF | 0xFB50..=0xFDFF | 0xFE70..=0xFEFE => {
                Self::Arabic
            }
            0x0590..=0x05FF | 0xFB1D..=0xFB4F => Self::Hebrew,
            0x0900..=0x097F | 0xA8E0..=0xA8FF => Self::Devanagari,
            0x0E00..=0x0E7F => Self::Thai,
            0x2600..=0x27BF | 0x2B50 | 0x2B55 | 0x1_F000..=0x1_FAFF => Self::Emoji,
            _ => Self::Other,
        }
    }

    /// The name in sentences, as in "no font has Japanese characters".
    pub fn name(self) -> &'static str {
        match self {
            Self::Japanese => "Japanese",
            Self::Chinese => "Chinese",
            Self::Korean => "Korean",
            Self::Arabic => "Arabic",
            Self::Hebrew => "Hebrew",
            Self::Devanagari => "Hindi",
            Self::Thai => "Thai",
            Self::Emoji => "emoji",
            Self::Other => "some",
        }
    }

    /// The package of Debian and its relatives that has a font.
    pub fn package(self) -> &'static str {
        match self {
            Self::Japanese | Self::Chinese | Self::Korean => "fonts-noto-cjk",
            Self::Emoji => "fonts-noto-color-emoji",
            _ => "fonts-noto-core",
        }
    }

    /// A sentence for the user that no font has characters of these scripts, so that boxes stand in their place; `None` for no scripts.
    pub fn missing(scripts: &[Self]) -> Option<String> {
        let (characters, packages) = Self::listed(scripts)?;
        Some(format!(
            "No font of this system has {characters}: boxes stand in their place. Install one and start Lovelock again, on Debian and Ubuntu \
             with `apt install {packages}`."
        ))
    }

    /// The same where question marks stand in their place.
    pub fn missing_in_images(scripts: &[Self]) -> Option<String> {
        let (characters, packages) = Self::listed(scripts)?;
        Some(format!(
            "labels have question marks in place of {characters}, which no font of this system has; install one, on Debian and Ubuntu with \
             `apt install {packages}`"
        ))
    }

    /// What scripts have, as in "Chinese, Thai or other characters, or emoji", and the packages with fonts.
    fn listed(scripts: &[Self]) -> Option<(String, String)> {
        let name =
            |script: &Self| if *script == Self::Other && scripts.len() > 1 { "other" } else { script.name() };
        let names: Vec<_> = scripts.iter().filter(|script| **script != Self::Emoji).map(name).collect();
        let mut characters = match &names[..] {
            [] => String::new(),
            [name] => format!("{name} characters"),
            [first @ .., last] => format!("{} or {last} characters", first.join(", ")),
        };
        if scripts.contains(&Self::Emoji) {
            characters.push_str(if characters.is_empty() { "emoji" } else { ", or emoji" });
        }
        let packages: BTreeSet<_> = scripts.iter().map(|script| script.package()).collect();
        let packages: Vec<_> = packages.into_iter().collect();
        (!scripts.is_empty()).then(|| (characters, packages.join(" ")))
    }

    /// Families preferred for the script, the best first, by how their names start. `language` is that of the user, such as `ja_JP`.
    pub(crate) fn families(self, language: &str) -> Vec<&'static str> {
        let han = [
            ["Noto Sans CJK JP", "Hiragino Sans", "Yu Gothic", "Meiryo", "IPAGothic"],
            ["Noto Sans CJK SC", "PingFang SC", "Microsoft YaHei", "WenQuanYi Zen Hei", "Source Han Sans"],
            ["Noto Sans CJK TC", "PingFang TC", "Microsoft JhengHei", "Noto Sans CJK HK", "AR PL UMing"],
            ["Noto Sans CJK KR", "Apple SD Gothic Neo", "Malgun Gothic", "NanumGothic", "UnDotum"],
        ];
        let first = match self {
            Self::Korean => 3,
            Self::Chinese if language.starts_with("zh_TW") || language.starts_with("zh_HK") => 2,
            Self::Chinese if language.starts_with("zh") => 1,
            Self::Chinese if language.starts_with("ko") => 3,
            _ => 0,
        };
        match self {
            Self::Japanese | Self::Chinese | Self::Korean => {
                let others = (0..han.len()).filter(|at| *at != first);
                std::iter::once(first).chain(others).flat_map(|at| han[at]).collect()
            }
            Self::Arabic => {
                vec!["Noto Sans Arabic", "Noto Naskh Arabic", "Geeza Pro", "Segoe UI", "DejaVu Sans"]
            }
            Self::Hebrew => vec!["Noto Sans Hebrew", "Arial Hebrew", "Segoe UI", "DejaVu Sans"],
            Self::Devanagari => {
                vec!["Noto Sans Devanagari", "Kohinoor Devanagari", "Nirmala UI", "Lohit Devanagari"]
            }
            Self::Thai => vec!["Noto Sans Thai", "Thonburi", "Leelawadee UI", "Loma"],
            Self::Emoji => vec!["Noto Color Emoji", "Apple Color Emoji", "Segoe UI Emoji", "Noto Emoji"],
            Self::Other => vec!["Noto Sans", "DejaVu Sans", "Segoe UI", "Helvetica Neue"],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn characters_have_the_script_of_their_block() {
        let samples = [
            ('あ', Script::Japanese),
            ('ア', Script::Japanese),
            ('笑', Script::Chinese),
            ('한', Script::Korean),
            ('م', Script::Arabic),
            ('ש', Script::Hebrew),
            ('ह', Script::Devanagari),
            ('ก', Script::Thai),
            ('😀', Script::Emoji),
            ('a', Script::Other),
            ('ж', Script::Other),
        ];
        for (c, script) in samples {
            assert_eq!(Script::of(c), script, "{c}");
        }
    }

    #[test]
    fn the_language_of_the_user_decides_about_chinese_characters() {
        assert_eq!(Script::Chinese.families("zh_CN.UTF-8")[0], "Noto Sans CJK SC");
        assert_eq!(Script::Chinese.families("zh_TW")[0], "Noto Sans CJK TC");
        assert_eq!(Script::Chinese.families("C")[0], "Noto Sans CJK JP");
        assert_eq!(Script::Korean.families("ja_JP")[0], "Noto Sans CJK KR");
    }

    #[test]
    fn one_sentence_names_all_scripts_and_each_package_once() {
        let said = |scripts: &[Script]| Script::missing(scripts).expect("a sentence");
        let some = said(&[Script::Chinese, Script::Korean, Script::Thai, Script::Emoji, Script::Other]);
        assert!(some.contains(" has Chinese, Korean, Thai or other characters, or emoji: "), "{some}");
        assert!(
            some.contains("`apt install fonts-noto-cjk fonts-noto-color-emoji fonts-noto-core`"),
            "{some}"
        );
        assert!(said(&[Script::Thai]).contains(" has Thai characters: "));
        assert!(said(&[Script::Emoji]).contains(" has emoji: "));
        assert!(said(&[Script::Other]).contains(" has some characters: "));
        assert_eq!((Script::missing(&[]), Script::missing_in_images(&[])), (None, None));
    }
}
