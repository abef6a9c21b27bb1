//! Settings as text: values that are typed, and ranges that are read.

use super::{Counts, Info, Kind, Range, Value};

impl Info {
    /// Reads a value. Numbers are in the setting's own unit, or end in the unit that the window shows, as `30cm`.
    ///
    /// # Errors
    /// What the setting takes, where the text is none of it.
    pub fn parse(&self, text: &str) -> Result<Value, String> {
        let text = text.trim();
        if self.none.is_some() && text.eq_ignore_ascii_case("none") {
            return Ok(Value::None);
        }
        let value = match self.kind {
            Kind::Number(range) => self.number(text).filter(|v| contains(&range, *v)).map(Value::Number),
            Kind::Count(counts) => {
                let whole = text
                    .parse()
                    .ok()
                    .or_else(|| self.number(text).filter(|v| is_whole(*v)).map(|v| v as u64));
                if let Some((below, above)) = whole.and_then(|v| counts.neighbours(v)) {
                    return Err(format!("{}; the nearest are {below} and {above}", self.values()));
                }
                whole.filter(|v| counts.contains(*v)).map(Value::Count)
            }
            Kind::Switch => match text.to_ascii_lowercase().as_str() {
                "true" | "on" | "yes" => Some(Value::Switch(true)),
                "false" | "off" | "no" => Some(Value::Switch(false)),
                _ => None,
            },
            Kind::Choice(options) => {
                options.iter().find(|(id, _)| plain(id) == plain(text)).map(|(id, _)| Value::Choice(id))
            }
            Kind::Color | Kind::Direction { .. } | Kind::Vector { .. } => self.vector(text),
        };
        value.ok_or_else(|| self.values())
    }

    fn number(&self, text: &str) -> Option<f64> {
        let (number, factor) = match text.strip_suffix(self.unit.suffix.trim()) {
            Some(number) if !self.unit.suffix.trim().is_empty() => (number, self.unit.factor),
            _ => (text.strip_suffix(self.unit.base).unwrap_or(text), 1.0),
        };
        let number: f64 = number.trim().parse().ok()?;
        number.is_finite().then_some(if factor == 1.0 { number } else { number / factor })
    }

    fn vector(&self, text: &str) -> Option<Value> {
        let text = text.trim_start_matches(['(', '[']).trim_end_matches([')', ']']);
        let numbers: Option<Vec<f32>> =
            text.split(',').map(|part| self.number(part.trim()).map(|v| v as f32)).collect();
        let value = Value::Vector(numbers?.try_into().ok()?);
        // What clamping would change is out of range.
        (self.clamp(value, Value::None) == value).then_some(value)
    }

    /// The values that it takes, as text: `0.02 to 1 m`, or `nearest, bilinear, jitter`.
    pub fn values(&self) -> String {
        let unit = if self.unit.base.is_empty() { String::new() } else { format!(" {}", self.unit.base) };
        let text = match self.kind {
            Kind::Number(range) => format!("{} to {}{unit}", range.hard[0], range.hard[1]),
            Kind::Count(counts) if !counts.choices.is_empty() => {
                let choices: Vec<_> = counts.choices.iter().map(u64::to_string).collect();
                format!("{}{unit}", choices.join(", "))
            }
            Kind::Count(counts) => {
                let zero = if counts.zero { "0, or " } else { "" };
                let step =
                    if counts.step > 1 { format!(", in steps of {}", counts.step) } else { String::new() };
                format!("{zero}{} to {}{unit}{step}", counts.hard[0], counts.hard[1])
            }
            Kind::Switch => "false, true".to_owned(),
            Kind::Choice(options) => options.iter().map(|(id, _)| id).collect::<Vec<_>>().join(", "),
            Kind::Color => format!("red, green, blue, each 0 to {}", Kind::BRIGHTEST),
            Kind::Direction { zero: true } => "x, y, z".to_owned(),
            Kind::Direction { zero: false } => "x, y, z, not all 0".to_owned(),
            Kind::Vector { range, .. } => {
                format!("x, y, z, each {} to {}{unit}", range.hard[0], range.hard[1])
            }
        };
        if self.none.is_some() { format!("{text}, or none") } else { text }
    }

    /// The value as text that [`Info::parse`] reads.
    pub fn format(&self, value: Value) -> String {
        match value {
            Value::Number(v) => number_text(v),
            Value::Count(v) => v.to_string(),
            Value::Switch(v) => v.to_string(),
            Value::Choice(id) => id.to_owned(),
            Value::Vector(v) => v.map(|v| v.to_string()).join(", "),
            Value::None => "none".to_owned(),
        }
    }

    /// What the window shows of the setting in its tooltip.
    pub fn tooltip(&self) -> String {
        if self.symbol.is_empty() {
            self.text.to_owned()
        } else {
            format!("{} Symbol: {}.", self.text, self.symbol)
        }
    }
}

/// The shortest text; a number of single precision is not written with the digits of double precision.
fn number_text(v: f64) -> String {
    if f64::from(v as f32) == v { (v as f32).to_string() } else { v.to_string() }
}

fn is_whole(v: f64) -> bool {
    v >= 0.0 && v.fract() == 0.0 && v < 9e15
}

/// A choice without the differences of spelling that nobody types twice the same.
fn plain(text: &str) -> String {
    text.chars().filter(|c| !matches!(c, '-' | '_' | ' ')).flat_map(char::to_lowercase).collect()
}

/// Whether a number is in the range, given that it is kept in single precision.
fn contains(range: &Range, v: f64) -> bool {
    let [low, high] = range.hard.map(|v| v as f32);
    (low..=high).contains(&(v as f32))
}

impl Counts {
    fn contains(&self, v: u64) -> bool {
        if !self.choices.is_empty() {
            return self.choices.contains(&v);
        }
        (self.zero && v == 0) || (self.hard[0]..=self.hard[1]).contains(&v)
    }

    /// The multiples of the step on both sides of a number in the range that is none itself.
    fn neighbours(&self, v: u64) -> Option<(u64, u64)> {
        let below = v - v % self.step;
        (self.choices.is_empty() && self.contains(v) && below < v).then(|| (below, below + self.step))
    }
}
