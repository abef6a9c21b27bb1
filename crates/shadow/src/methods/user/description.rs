//! What `method.toml` says of a user's method.

use std::ops::Range;

use serde::Deserialize;
use toml::Spanned;

use super::MAX_SETTINGS;
use super::turns::tokens;

/// The most words of a record, and of the scratch memory of a texel.
const MAX_WORDS: u64 = 4096;
/// The most passes.
const MAX_PASSES: usize = 16;
/// The largest whole number of a setting: settings are floats on the device.
const MAX_COUNT: i64 = 1 << 24;
/// The most letters of a name.
const MAX_NAME: usize = 60;

/// A sentence, and the line that it is about.
pub(super) type Problem = (Option<usize>, String);

/// A method as its file describes it, checked.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Description {
    pub name: String,
    pub text: String,
    pub shader: String,
    pub record: Words,
    pub scratch: Words,
    pub passes: Vec<PassOfUser>,
    pub settings: Vec<SettingOfUser>,
}

/// A pass of the method.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct PassOfUser {
    pub function: String,
    pub over_fragments: bool,
    /// Its line in the file.
    pub line: usize,
}

/// A setting of the method.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SettingOfUser {
    pub name: String,
    pub label: String,
    pub text: String,
    pub range: [f64; 2],
    pub default: f64,
    /// Whether it is a whole number.
    pub is_count: bool,
}

/// A number of words: a sum of products of numbers and settings.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Words(Vec<(u64, Vec<usize>)>);

impl Words {
    /// The number with these values of the settings.
    pub fn with(&self, values: impl Fn(usize) -> f64) -> u64 {
        let product = |(factor, settings): &(u64, Vec<usize>)| {
            settings.iter().fold(*factor, |product, &at| product.saturating_mul(values(at) as u64))
        };
        self.0.iter().map(product).fold(0, u64::saturating_add)
    }

    fn parse(text: &str, settings: &[SettingOfUser]) -> Result<Self, String> {
        let whole = |setting: &&SettingOfUser| setting.is_count;
        let term = |text: &str| {
            let (mut factor, mut names) = (1_u64, Vec::new());
            for part in text.split('*').map(str::trim) {
                if let Ok(number) = part.parse::<u64>() {
                    factor = factor.saturating_mul(number);
                } else if let Some(at) =
                    settings.iter().position(|setting| setting.is_count && setting.name == part)
                {
                    names.push(at);
                } else {
                    let known: Vec<&str> =
                        settings.iter().filter(whole).map(|setting| setting.name.as_str()).collect();
                    let known = if known.is_empty() { "there is none".to_owned() } else { known.join(", ") };
                    return Err(format!(
                        "found `{part}`; must be a whole number or a setting that is one ({known})"
                    ));
                }
            }
            Ok((factor, names))
        };
        text.split('+').map(term).collect::<Result<_, _>>().map(Self)
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    name: Spanned<String>,
    #[serde(default)]
    text: String,
    shader: Option<Spanned<String>>,
    record: Spanned<WordsText>,
    scratch: Option<Spanned<WordsText>>,
    passes: Vec<PassFile>,
    #[serde(default)]
    settings: Vec<SettingFile>,
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "must be a number of words, or a sum such as \"2 + 2 * nodes\"")]
enum WordsText {
    Number(u64),
    Sum(String),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PassFile {
    function: Spanned<String>,
    over: Spanned<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SettingFile {
    name: Spanned<String>,
    label: Option<String>,
    #[serde(default)]
    text: String,
    range: Spanned<[Number; 2]>,
    default: Spanned<Number>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(untagged, expecting = "must be a number")]
enum Number {
    Whole(i64),
    Real(f64),
}

impl Number {
    fn value(self) -> f64 {
        match self {
            Self::Whole(value) => value as f64,
            Self::Real(value) => value,
        }
    }

    fn whole(self) -> Option<i64> {
        if let Self::Whole(value) = self { Some(value) } else { None }
    }
}

/// Reads a description.
///
/// # Errors
/// The first problem, and its line where it has one.
pub(super) fn read(text: &str) -> Result<Description, Problem> {
    let line_of = |span: Range<usize>| {
        Some(1 + text.as_bytes().iter().take(span.start).filter(|b| **b == b'\n').count())
    };
    let file: File = toml::from_str(text).map_err(|error| {
        let message = error.message().trim().replace('\n', ", ");
        (error.span().and_then(line_of), message)
    })?;
    let name = file.name.get_ref().trim();
    if name.is_empty() || name.chars().count() > MAX_NAME || name.chars().any(char::is_control) {
        let why = format!("name: found {name:?}; must be 1 to {MAX_NAME} letters");
        return Err((line_of(file.name.span()), why));
    }
    let shader = file.shader.as_ref().map_or("method.wgsl", |shader| shader.get_ref().as_str());
    if shader.is_empty() || shader.contains(['/', '\\', ':']) || shader.starts_with('.') {
        let line = file.shader.as_ref().and_then(|shader| line_of(shader.span()));
        return Err((line, format!("shader: found {shader:?}; must be the name of a file in the folder")));
    }
    let mut settings: Vec<SettingOfUser> = Vec::new();
    for setting in &file.settings {
        let line = line_of(setting.name.span());
        let read = read_setting(setting).map_err(|(at, why)| (at.and_then(line_of).or(line), why))?;
        if settings.iter().any(|known| known.name == read.name)
            || ["resolution", "filter"].contains(&&*read.name)
        {
            return Err((line, format!("the setting {} is there already; choose another name", read.name)));
        }
        settings.push(read);
    }
    if settings.len() > MAX_SETTINGS {
        return Err((None, format!("found {} settings; must be at most {MAX_SETTINGS}", settings.len())));
    }
    let words = |key: &str, found: &Spanned<WordsText>, least: u64| {
        let line = line_of(found.span());
        let text = match found.get_ref() {
            WordsText::Number(number) => number.to_string(),
            WordsText::Sum(text) => text.clone(),
        };
        let words = Words::parse(&text, &settings).map_err(|why| (line, format!("{key}: {why}")))?;
        let [low, high] = [0, 1].map(|end| words.with(|at| settings[at].range[end]));
        if low < least || high > MAX_WORDS {
            let found = if low == high { low.to_string() } else { format!("{low} to {high}") };
            return Err((
                line,
                format!("{key}: found {found} words for each texel; must be {least} to {MAX_WORDS}"),
            ));
        }
        Ok(words)
    };
    let record = words("record", &file.record, 1)?;
    let scratch = file.scratch.as_ref().map_or(Ok(Words::default()), |found| words("scratch", found, 0))?;
    let passes = &file.passes;
    if passes.is_empty() || passes.len() > MAX_PASSES {
        let why = format!("passes: found {}; must be 1 to {MAX_PASSES}", passes.len());
        return Err((None, why));
    }
    let pass = |pass: &PassFile| {
        let line = line_of(pass.function.span());
        let over_fragments = match pass.over.get_ref().as_str() {
            "fragments" => true,
            "texels" => false,
            other => {
                let why = format!("over: found {other:?}; must be \"fragments\" or \"texels\"");
                return Err((line_of(pass.over.span()), why));
            }
        };
        let function = pass.function.get_ref().clone();
        is_name(&function).map_err(|why| (line, format!("function: {why}")))?;
        Ok(PassOfUser { function, over_fragments, line: line.unwrap_or(1) })
    };
    Ok(Description {
        name: name.to_owned(),
        text: file.text.split_whitespace().collect::<Vec<_>>().join(" "),
        shader: shader.to_owned(),
        record,
        scratch,
        passes: passes.iter().map(pass).collect::<Result<_, _>>()?,
        settings,
    })
}

/// Whether a text is a name in WGSL that the compiler leaves to programs.
fn is_name(text: &str) -> Result<(), String> {
    let plain = text.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
    let is_one = tokens(text).len() == 1 && plain && !text.starts_with(|c: char| c.is_ascii_digit());
    if is_one && text.len() <= MAX_NAME && !text.starts_with("__") && text != "_" {
        Ok(())
    } else {
        Err(format!("found {text:?}; must be letters, digits and _, and start with a letter"))
    }
}

fn read_setting(setting: &SettingFile) -> Result<SettingOfUser, (Option<Range<usize>>, String)> {
    let name = setting.name.get_ref();
    is_name(name).map_err(|why| (None, format!("name: {why}")))?;
    let (range, default) = (setting.range.get_ref(), *setting.default.get_ref());
    let is_count = [range[0], range[1], default].into_iter().all(|number| number.whole().is_some());
    let [low, high] = range.map(Number::value);
    let in_order = low < high && low.is_finite() && high.is_finite() && low.abs().max(high.abs()) < 1e30;
    if !in_order || (is_count && (low < 0.0 || high > MAX_COUNT as f64)) {
        let limits = if is_count { format!(" from 0 to {MAX_COUNT}") } else { String::new() };
        let why = format!("range of {name}: found {low} and {high}; must be two numbers{limits} that rise");
        return Err((Some(setting.range.span()), why));
    }
    let value = default.value();
    if !(low..=high).contains(&value) {
        let why = format!("default of {name}: found {value}; must be {low} to {high}");
        return Err((Some(setting.default.span()), why));
    }
    let label = setting.label.clone().unwrap_or_else(|| name.replace('_', " "));
    let text = setting.text.split_whitespace().collect::<Vec<_>>().join(" ");
    let text = if text.is_empty() { "A setting of the method of one's own.".to_owned() } else { text };
    Ok(SettingOfUser { name: name.clone(), label, text, range: [low, high], default: value, is_count })
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEMPLATE: &str = include_str!("template/method.toml");

    fn refused(from: &str, to: &str) -> Problem {
        assert!(TEMPLATE.contains(from), "{from}");
        read(&TEMPLATE.replacen(from, to, 1)).expect_err(to)
    }

    #[test]
    fn the_template_is_read() {
        let read = read(TEMPLATE).expect("the template");
        assert_eq!((read.name.as_str(), read.shader.as_str()), ("My method", "method.wgsl"));
        assert_eq!((read.record.with(|_| 64.0), read.scratch.with(|_| 64.0)), (64, 0));
        let passes: Vec<_> =
            read.passes.iter().map(|pass| (pass.function.as_str(), pass.over_fragments)).collect();
        assert_eq!(passes, [("add_fragment", true), ("sum_slices", false)]);
        let slices = &read.settings[0];
        assert_eq!((slices.name.as_str(), slices.range, slices.default), ("slices", [8.0, 256.0], 128.0));
        assert!(slices.is_count);
    }

    #[test]
    fn words_are_sums_of_products() {
        let settings = read(TEMPLATE).expect("the template").settings;
        let words = Words::parse("2 + 3 * slices*slices + 5", &settings).expect("a sum");
        assert_eq!(words.with(|_| 10.0), 307);
        assert_eq!(
            Words::parse("18446744073709551615 * slices + 9", &settings).map(|w| w.with(|_| 9.0)),
            Ok(u64::MAX)
        );
        for wrong in ["", "2 +", "slices / 2", "-1", "depth", "1.5"] {
            let why = Words::parse(wrong, &settings).expect_err(wrong);
            assert!(why.contains("slices"), "{why}");
        }
    }

    #[test]
    fn every_problem_has_a_line_and_says_what_must_be() {
        let line = |text: &str| Some(1 + TEMPLATE.lines().position(|line| line == text).expect(text));
        let cases = [
            ("record = \"slices\"", "records = 4", "records"),
            ("record = \"slices\"", "record = 1000000000", "must be 1 to 4096"),
            ("record = \"slices\"", "record = \"64 * slices\"", "found 512 to 16384 words"),
            ("record = \"slices\"", "record = true", "number of words"),
            ("scratch = 0", "scratch = \"layers\"", "(slices)"),
            ("scratch = 0", "scratch = = 1", ""),
            ("default = 128", "default = 512", "must be 8 to 256"),
            ("default = 128", "default = \"many\"", "number"),
            ("range = [8, 256]", "range = [256, 8]", "that rise"),
            ("range = [8, 256]", "range = [8, 99999999]", "that rise"),
            ("over = \"texels\"", "over = \"lights\"", "\"fragments\" or \"texels\""),
            ("function = \"sum_slices\"", "function = \"a b\"", "letters"),
            ("name = \"slices\"", "name = \"resolution\"", "there already"),
            ("name = \"My method\"", "name = \"\"", "letters"),
        ];
        for (from, to, says) in cases {
            let (at, why) = refused(from, to);
            assert!(why.contains(says), "{to}: {why}");
            assert_eq!(at, line(from), "{to}: {why}");
            assert!(!why.contains('\n'), "{why}");
        }
        assert!(refused("scratch = 0", "shader = \"../x.wgsl\"").1.contains("name of a file"));
        assert!(read("").expect_err("nothing").1.contains("name"));
        let many = "[[passes]]\nfunction = \"f\"\nover = \"texels\"\n".repeat(20);
        assert!(read(&format!("name = \"a\"\nrecord = 1\n{many}")).expect_err("many").1.contains("1 to 16"));
    }
}
