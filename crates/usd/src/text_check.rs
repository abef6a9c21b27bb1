//! What the library's parser of text does not check by itself: nesting, which it follows recursively, the number of statements, and the
//! length of tuples, of which it leaves missing numbers uninitialised.

use logos::Logos;
use openusd::usda::token::Token;

use crate::transform::DEEPEST;

/// The most statements. The library searches all names of a prim for each one that it adds.
const MAX_STATEMENTS: usize = 100_000;

/// Where a text is wrong: the byte, what was found, and what must be there.
pub(crate) type Fault = (usize, String, String);

/// Checks a text. What the library refuses by itself may pass.
pub(crate) fn check(text: &str) -> Result<(), Fault> {
    let mut state = State::default();
    for (token, span) in Token::lexer(text).spanned() {
        let Ok(token) = token else { continue };
        state.take(token, span.start).map_err(|wrong| match wrong {
            Wrong::Deep => {
                (span.start, format!("more than {DEEPEST} nested brackets"), "less nesting".to_owned())
            }
            Wrong::Long => (
                span.start,
                format!("more than {MAX_STATEMENTS} statements"),
                "fewer, or a .usdc file".to_owned(),
            ),
            Wrong::Tuple { from, count, wanted } => {
                let line = text[..from].bytes().filter(|&byte| byte == b'\n').count() + 1;
                let words: Vec<&str> = text[from..span.end].split_whitespace().take(60).collect();
                let tuple: String = words.join(" ").chars().take(60).collect();
                let found = format!("in line {line}: `{tuple}` of {count}");
                (from, found, format!("a tuple of {wanted}"))
            }
        })?;
    }
    Ok(())
}

enum Wrong {
    Deep,
    Long,
    Tuple { from: usize, count: usize, wanted: usize },
}

/// What the tuples of a value hold.
#[derive(Clone, Copy)]
enum Shape {
    /// This many numbers.
    Tuple(usize),
    /// Numbers of a spline: by the words before them.
    Spline(usize),
}

/// A value that is not complete yet.
struct Open {
    /// Brackets around the value.
    depth: usize,
    shape: Option<Shape>,
}

/// A bracket that is open.
struct Bracket {
    from: usize,
    /// Words in it.
    count: usize,
    holds_brackets: bool,
    /// What was declared before it.
    declared: Option<Shape>,
}

#[derive(Default)]
struct State<'a> {
    statements: usize,
    brackets: Vec<Bracket>,
    values: Vec<Open>,
    /// Whether a value begins here.
    begins: bool,
    /// The last tokens outside of values with a known shape, newest last.
    recent: [Option<Token<'a>>; 8],
    /// What was declared before the bracket that was closed last.
    before_bracket: Option<Shape>,
}

impl<'a> State<'a> {
    fn take(&mut self, token: Token<'a>, at: usize) -> Result<(), Wrong> {
        let begins = std::mem::take(&mut self.begins);
        match token {
            Token::Punctuation('{' | '(' | '[') => {
                let declared = if self.values.is_empty() { self.declared() } else { None };
                if let Some(around) = self.brackets.last_mut() {
                    around.holds_brackets = true;
                }
                self.brackets.push(Bracket { from: at, count: 0, holds_brackets: false, declared });
                if self.brackets.len() > DEEPEST {
                    return Err(Wrong::Deep);
                }
            }
            Token::Punctuation(close @ ('}' | ')' | ']')) => self.close(close)?,
            Token::Punctuation('=') => {
                self.statement()?;
                let follows_bracket = matches!(self.recent[7], Some(Token::Punctuation(')')));
                let shape = if follows_bracket { self.before_bracket } else { self.declared() };
                self.values.push(Open { depth: self.brackets.len(), shape });
                self.begins = true;
            }
            Token::Def | Token::Over | Token::Class => self.statement()?,
            Token::Punctuation(mark) => self.spline_word(mark.encode_utf8(&mut [0; 4])),
            _ => {
                if let Some(around) = self.brackets.last_mut() {
                    around.count += 1;
                }
                if let Token::Identifier(word) | Token::NamespacedIdentifier(word) = token {
                    self.spline_word(word);
                }
                if begins {
                    // A single word is a whole value.
                    self.values.pop();
                }
            }
        }
        if self.values.last().is_none_or(|value| value.shape.is_none()) {
            self.recent.rotate_left(1);
            self.recent[7] = Some(token);
        }
        Ok(())
    }

    fn statement(&mut self) -> Result<(), Wrong> {
        self.statements += 1;
        if self.statements > MAX_STATEMENTS { Err(Wrong::Long) } else { Ok(()) }
    }

    fn close(&mut self, close: char) -> Result<(), Wrong> {
        let Some(bracket) = self.brackets.pop() else { return Ok(()) };
        self.before_bracket = bracket.declared;
        // Values whose brackets ended without them.
        while self.values.last().is_some_and(|value| value.depth > self.brackets.len()) {
            self.values.pop();
        }
        let Some(value) = self.values.last() else { return Ok(()) };
        let wanted = value.shape.map(|shape| match shape {
            Shape::Tuple(wanted) | Shape::Spline(wanted) => wanted,
        });
        if let Some(wanted) = wanted.filter(|&wanted| wanted != bracket.count)
            && close == ')'
            && !bracket.holds_brackets
        {
            return Err(Wrong::Tuple { from: bracket.from, count: bracket.count, wanted });
        }
        if value.depth == self.brackets.len() {
            self.values.pop();
        }
        Ok(())
    }

    /// Notes how many numbers the next tuple of a spline has: `loop: (5)`, `pre: sloped (1)` beyond the ends, `pre (2)` and
    /// `post curve (2)` at a knot.
    fn spline_word(&mut self, word: &str) {
        if let Some(Open { shape: Some(Shape::Spline(wanted)), .. }) = self.values.last_mut() {
            *wanted = match word {
                "loop" | "loop:" => 5,
                "pre:" | "post:" => 1,
                ":" if *wanted == 2 => 1,
                "pre" | "post" => 2,
                _ => *wanted,
            };
        }
    }

    /// What the last tokens declare: a type, `[]` for an array of it, a name, and what of it follows.
    fn declared(&self) -> Option<Shape> {
        let mut before = self.recent.iter().rev().map_while(Option::as_ref);
        let mut name = before.next()?;
        if matches!(name, Token::TimeSamples | Token::Spline | Token::Connect) {
            let is_spline = matches!(name, Token::Spline);
            let after = before.clone().next()?;
            if matches!(after, Token::Punctuation('.')) {
                if is_spline {
                    return Some(Shape::Spline(2));
                }
                before.next();
                name = before.next()?;
            }
        }
        if matches!(name, Token::Punctuation(_)) {
            return None;
        }
        let kind = before.find(|token| !matches!(token, Token::Punctuation('[' | ']')))?;
        match kind {
            Token::Identifier(kind) => numbers_of(kind).map(Shape::Tuple),
            _ => None,
        }
    }
}

/// Numbers of a tuple of a type; `None` for types without tuples. The rows of a matrix are tuples.
fn numbers_of(kind: &str) -> Option<usize> {
    if matches!(kind, "quath" | "quatf" | "quatd") {
        return Some(4);
    }
    let plain = kind.trim_end_matches(['h', 'f', 'd']);
    let name = plain.trim_end_matches(['2', '3', '4']);
    let known = [
        "int", "half", "float", "double", "texCoord", "point", "normal", "vector", "color", "matrix", "frame",
    ];
    let count = known.contains(&name).then(|| plain.strip_prefix(name))??;
    count.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::check;

    fn stage(line: &str) -> String {
        format!("#usda 1.0\n(\n    doc = \"about (1, 2)\"\n)\ndef Xform \"a\"\n{{\n    {line}\n}}\n")
    }

    #[test]
    fn tuples_with_a_number_too_few_or_too_many_are_refused_by_line_and_text() {
        for (line, tuple) in [
            ("point3f[] points = [(0, 0, 0), (0.1, 0)]", "(0.1, 0)"),
            ("point3f[] points = [(0.1,)]", "(0.1,)"),
            ("point3f[] points = [()]", "()"),
            ("float3 a = (1, 2, 3, 4)", "(1, 2, 3, 4)"),
            ("uniform double2 a = (1)", "(1)"),
            ("texCoord2f[] primvars:st = [(0, 1), (-inf)]", "(-inf)"),
            ("color3f[] primvars:displayColor (\n interpolation = \"constant\"\n) = [(1, 0)]", "(1, 0)"),
            ("point3f[] points.timeSamples = {\n 0: [(1, 2, 3)],\n 1: [(1, 2)],\n}", "(1, 2)"),
            ("quatf[] rotations.timeSamples = { 0: [(1, 0, 0)] }", "(1, 0, 0)"),
            ("float3 color3f.timeSamples = { 0: (1, 0) }", "(1, 0)"),
            ("matrix4d m = ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1), (0, 0, 0, 1))", "(0, 0, 1)"),
            ("matrix2d[] m = [((1, 0), (0))]", "(0)"),
            ("int a = 1 (\n customData = {\n dictionary b = { int3 c = (1, 2) }\n }\n)", "(1, 2)"),
            ("double a.spline = { bezier, 1: 5; pre (1) }", "(1)"),
            ("double a.spline = { bezier, 1: 5; post curve (1) }", "(1)"),
            ("double a.spline = { loop: (1, 2, 3, 4) }", "(1, 2, 3, 4)"),
        ] {
            let text = stage(line);
            let (offset, found, wanted) = check(&text).expect_err(line);
            assert!(text[offset..].starts_with(tuple) && wanted.starts_with("a tuple of "), "{found}");
            let at = text[..offset].lines().count();
            assert!(found.starts_with(&format!("in line {at}: `{tuple}`")), "{found}");
        }
    }

    #[test]
    fn whole_tuples_pass() {
        for line in [
            "point3f[] points = [(0, 0, 0), (0.1, 0, -1e3),]",
            "float a = 1 (\n \"a comment\"\n)",
            "float3 a = (1, 2, 3) (\n \"a comment\"\n customData = { int2 b = (1, 2) }\n)",
            "float3 a = None (\n \"a comment\"\n)",
            "float3[] none = []",
            "float3 a (\n doc = \"x\"\n) = (1, -inf, 3)",
            "uniform token[] xformOpOrder = [\"a\", \"b\"]\n float3 xformOp:scale = (1, 1, 1)",
            "point3f[] points.timeSamples = { 0: [(1, 2, 3)], 1: None, 2: [] }",
            "matrix4d[] m = [((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))]",
            "float3 scale = (1, 1, 1)\n rel material:binding = </a/b>",
            "float3 a.connect = </a/b.c> (\n \"a comment\"\n)",
            "double a.spline = { bezier, pre: sloped (0.5), post: held, loop: (1, 2, 3, 4, 5), 1: 5; pre (1, 2); post curve (1, 2), 2: 3 & 4; post held }",
        ] {
            let text = stage(line);
            check(&text).unwrap_or_else(|fault| panic!("{line}: {fault:?}"));
        }
    }
}
