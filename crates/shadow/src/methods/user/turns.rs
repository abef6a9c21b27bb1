//! Limits on the loops and the length of the text of a user's method.

use std::fmt::Write;

use lovelock_gpu::ShaderPart;

use crate::gpu::wgsl;

/// Declares what [`bound_loops`] inserts.
pub(super) const TURNS: ShaderPart = wgsl!("methods/user/", "turns.wgsl");

/// Turns of all loops together in one call of a function of the method. Twin of the constant in turns.wgsl.
///
/// Mesa's software device ends each loop after 65,535 turns by itself, without a word; this limit comes first.
pub(super) const MAX_TURNS: u32 = 32_768;

/// The most loops of a method: their numbers take 8 bits of a word.
const MAX_LOOPS: usize = 200;

/// The most words and signs of one statement. Compilers nest as deep as an expression is long.
const MAX_STATEMENT: usize = 1000;

/// The most `else`, which compilers nest too.
const MAX_ELSE: usize = 200;

/// A word or a sign of WGSL.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Token<'a> {
    pub text: &'a str,
    /// Where it starts, bytes.
    pub start: usize,
    /// Its line, from 1.
    pub line: usize,
}

/// The words and signs of a text without its comments.
pub(super) fn tokens(text: &str) -> Vec<Token<'_>> {
    let bytes = text.as_bytes();
    let is_word = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'_' || byte >= 0x80;
    let (mut at, mut line, mut found) = (0, 1, Vec::new());
    while at < bytes.len() {
        let start = at;
        if bytes[at..].starts_with(b"//") {
            while at < bytes.len() && bytes[at] != b'\n' {
                at += 1;
            }
        } else if bytes[at..].starts_with(b"/*") {
            let mut depth = 0;
            while at < bytes.len() {
                if bytes[at..].starts_with(b"/*") {
                    depth += 1;
                    at += 2;
                } else if bytes[at..].starts_with(b"*/") {
                    depth -= 1;
                    at += 2;
                    if depth == 0 {
                        break;
                    }
                } else {
                    line += usize::from(bytes[at] == b'\n');
                    at += 1;
                }
            }
        } else if is_word(bytes[at]) {
            while at < bytes.len() && is_word(bytes[at]) {
                at += 1;
            }
            found.push(Token { text: &text[start..at], start, line });
        } else {
            at += 1;
            if bytes[start] == b'\n' {
                line += 1;
            } else if !bytes[start].is_ascii_whitespace() {
                found.push(Token { text: &text[start..at], start, line });
            }
        }
    }
    found
}

/// The line on which a name is declared, if it is.
pub(super) fn declared(text: &str, name: &str) -> Option<usize> {
    let tokens = tokens(text);
    let declares =
        |word: &str| matches!(word, "fn" | "const" | "override" | "struct" | "alias" | ">" | "var");
    let is_declared = |pair: &&[Token]| declares(pair[0].text) && pair[1].text == name;
    tokens.windows(2).find(is_declared).map(|pair| pair[1].line)
}

/// The text of a method whose loops end after [`MAX_TURNS`].
#[derive(Debug)]
pub(super) struct Bounded {
    /// As many lines as before.
    pub text: String,
    /// The line of each loop.
    pub lines: Vec<usize>,
}

/// Inserts a limit into every loop.
///
/// # Errors
/// The line of a text that is too long for compilers, and why.
pub(super) fn bound_loops(text: &str) -> Result<Bounded, (usize, String)> {
    let tokens = tokens(text);
    let (mut statement, mut elses) = (0, 0);
    for token in &tokens {
        statement = if matches!(token.text, ";" | "{" | "}") { 0 } else { statement + 1 };
        if statement > MAX_STATEMENT {
            let why = format!("this statement has more than {MAX_STATEMENT} words and signs; divide it");
            return Err((token.line, why));
        }
        elses += usize::from(token.text == "else");
        if elses > MAX_ELSE {
            return Err((
                token.line,
                format!("there are more than {MAX_ELSE} `else`; use a switch or a loop"),
            ));
        }
    }
    let (mut bounded, mut lines, mut copied) = (String::with_capacity(2 * text.len()), Vec::new(), 0);
    for (at, token) in tokens.iter().enumerate() {
        if !matches!(token.text, "for" | "while" | "loop") {
            continue;
        }
        // The head of a loop has no braces.
        let Some(brace) = tokens[at..].iter().find(|token| token.text == "{") else { continue };
        lines.push(token.line);
        if lines.len() > MAX_LOOPS {
            return Err((token.line, format!("there are more than {MAX_LOOPS} loops")));
        }
        bounded.push_str(&text[copied..=brace.start]);
        let _ = write!(bounded, " if (turns_are_over({}u)) {{ break; }}", lines.len());
        copied = brace.start + 1;
    }
    bounded.push_str(&text[copied..]);
    Ok(Bounded { text: bounded, lines })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_limit_is_that_of_the_shader() {
        assert!(TURNS.text.contains(&format!("const MAX_TURNS: u32 = {MAX_TURNS}u;")));
    }

    #[test]
    fn every_kind_of_loop_is_bounded_on_its_line() {
        let text = "fn a() {\n    for (var i = 0u; i < 4u; i++) {\n        while i > 2u { loop\n{ break; } }\n    }\n}\n\
            // loop { }\n/* while { /* for { */ } */\nfn looped() { }\n";
        let bounded = bound_loops(text).expect("short");
        assert_eq!(bounded.lines, [2, 3, 3]);
        assert_eq!(bounded.text.lines().count(), text.lines().count());
        let inserted = |number: u32| format!("{{ if (turns_are_over({number}u)) {{ break; }}");
        let lines: Vec<&str> = bounded.text.lines().collect();
        assert!(lines[1].contains(&inserted(1)) && lines[2].contains(&inserted(2)), "{}", bounded.text);
        assert!(lines[3].starts_with(&inserted(3)), "{}", bounded.text);
        assert_eq!(bounded.text.matches("turns_are_over").count(), 3, "none in comments");
    }

    #[test]
    fn declarations_are_found_outside_of_comments() {
        let text = "// fn a\nfn b() {}\nvar<private> c: u32;\nconst d = 1u;";
        let lines = ["a", "b", "c", "d"].map(|name| declared(text, name));
        assert_eq!(lines, [None, Some(2), Some(3), Some(4)]);
    }

    #[test]
    fn texts_that_nest_too_deep_are_refused_by_line() {
        let long = format!("fn a() -> f32 {{\n    return 1.0{};\n}}", " + 1.0".repeat(600));
        assert_eq!(bound_loops(&long).expect_err("long").0, 2);
        let chain = format!("fn a() {{\n if true {{}}{} }}", " else if true {}".repeat(300));
        assert!(bound_loops(&chain).expect_err("deep").1.contains("else"));
        assert!(bound_loops(&"loop {} ".repeat(201)).expect_err("many").1.contains("loops"));
        assert!(
            bound_loops("fn a() { /* open").is_ok()
                && bound_loops("loop").is_ok()
                && bound_loops("é{").is_ok()
        );
    }
}
