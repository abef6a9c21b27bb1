//! Places labels beside dots where they overlap least.

use super::escaped;
use std::fmt::Write as _;

/// Average width of a letter, and height of a line, pixels.
const LETTER: (f64, f64) = (6.7, 13.0);

/// A rectangle: left, top, right, bottom.
type Box4 = [f64; 4];

/// The label of a dot.
#[derive(Clone, Debug, PartialEq)]
pub enum Label {
    /// Always drawn unless empty.
    Always(String),
    /// Left out if it would overlap too much.
    WhereFree(String),
}

/// Fraction of a label that may overlap before it is left out.
const COVERED: f64 = 0.2;

/// Length of the line pieces that labels avoid, pixels.
const PIECE: f64 = 6.0;

/// Labels beside dots. They are placed after all dots are known, so that none covers a dot.
pub(super) struct Labels {
    field: (f64, f64),
    dots: Vec<(f64, f64, Label)>,
    /// Pieces of lines to avoid.
    lines: Vec<Box4>,
}

impl Labels {
    /// For a field of this size.
    pub(super) fn new(width: f64, height: f64) -> Self {
        Self { field: (width, height), dots: Vec::new(), lines: Vec::new() }
    }

    /// Adds a dot and its label.
    pub(super) fn add(&mut self, x: f64, y: f64, label: Label) {
        self.dots.push((x, y, label));
    }

    /// Makes labels avoid a line if possible.
    pub(super) fn keep_free(&mut self, from: (f64, f64), to: (f64, f64)) {
        let [across, down] = [to.0 - from.0, to.1 - from.1];
        // No line is longer than the diagonal of its field.
        let pieces = (across.hypot(down) / PIECE).ceil().clamp(1.0, 400.0);
        for piece in 0..pieces as u32 {
            let part = (f64::from(piece) + 0.5) / pieces;
            let (x, y) = (from.0 + part * across, from.1 + part * down);
            self.lines.push([x - PIECE / 2.0, y - PIECE / 2.0, x + PIECE / 2.0, y + PIECE / 2.0]);
        }
    }

    /// All words, each at the one of eight places that covers the least; those that must be there come first.
    pub(super) fn svg(&self) -> String {
        // A covered dot is worse than a covered word.
        let mut taken: Vec<(Box4, f64)> =
            self.dots.iter().map(|(x, y, _)| ([x - 7.0, y - 7.0, x + 7.0, y + 7.0], 3.0)).collect();
        taken.extend(self.lines.iter().map(|piece| (*piece, 0.5)));
        let mut out = String::new();
        let words = |always: bool| {
            self.dots.iter().filter_map(move |(x, y, label)| match label {
                Label::Always(word) if always && !word.is_empty() => Some((*x, *y, word, f64::INFINITY)),
                Label::WhereFree(word) if !always && !word.is_empty() => Some((*x, *y, word, COVERED)),
                Label::Always(_) | Label::WhereFree(_) => None,
            })
        };
        for (x, y, word, most) in words(true).chain(words(false)).take(200) {
            let (width, height) = (word.chars().count() as f64 * LETTER.0, LETTER.1);
            // Words end at their dot where they stand before it: their true width is the browser's alone to know.
            let around = [
                (x + 9.0, y - height / 2.0, "start"),
                (x - 9.0 - width, y - height / 2.0, "end"),
                (x - width / 2.0, y - 8.0 - height, "middle"),
                (x - width / 2.0, y + 8.0, "middle"),
                (x + 6.0, y - 6.0 - height, "start"),
                (x + 6.0, y + 6.0, "start"),
                (x - 6.0 - width, y - 6.0 - height, "end"),
                (x - 6.0 - width, y + 6.0, "end"),
            ];
            let boxes = around.map(|(left, top, anchor)| ([left, top, left + width, top + height], anchor));
            let cost = |place: &Box4| {
                let covered: f64 = taken.iter().map(|(other, weight)| weight * overlap(place, other)).sum();
                covered + 4.0 * (width * height - overlap(place, &[0.0, 0.0, self.field.0, self.field.1]))
            };
            let Some((best, anchor)) = boxes.into_iter().min_by(|a, b| cost(&a.0).total_cmp(&cost(&b.0)))
            else {
                continue;
            };
            if cost(&best) > most * width * height {
                continue;
            }
            taken.push((best, 1.0));
            let base = best[1] + height - 3.0;
            let at = match anchor {
                "end" => best[2],
                "middle" => best[0] + width / 2.0,
                _ => best[0],
            };
            let word = escaped(word);
            let _ = write!(
                out,
                "<text class=\"label\" x=\"{at:.1}\" y=\"{base:.1}\" text-anchor=\"{anchor}\">{word}</text>"
            );
        }
        out
    }
}

/// The area that two rectangles share.
fn overlap(a: &Box4, b: &Box4) -> f64 {
    let across = (a[2].min(b[2]) - a[0].max(b[0])).max(0.0);
    across * (a[3].min(b[3]) - a[1].max(b[1])).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::{Label, Labels, overlap};

    #[test]
    fn words_do_not_cover_each_other_where_there_is_room() {
        let mut labels = Labels::new(400.0, 300.0);
        for i in 0..5 {
            labels.add(
                200.0 + f64::from(i) * 3.0,
                150.0 + f64::from(i) * 12.0,
                Label::Always("six letters".into()),
            );
        }
        let svg = labels.svg();
        let number = |text: &str, name: &str| -> f64 {
            text.split_once(name).unwrap().1.split_once('"').unwrap().0.parse().unwrap()
        };
        let boxes: Vec<_> = (svg.split("<text").skip(1))
            .map(|text| {
                let before = match text.split_once("anchor=\"").unwrap().1.as_bytes()[0] {
                    b'e' => 1.0,
                    b'm' => 0.5,
                    _ => 0.0,
                };
                (number(text, "x=\"") - before * 11.0 * 6.7, number(text, "y=\""))
            })
            .map(|(x, y)| [x, y - 10.0, x + 11.0 * 6.7, y + 3.0])
            .collect();
        assert_eq!(boxes.len(), 5);
        for (i, a) in boxes.iter().enumerate() {
            assert!(boxes[..i].iter().all(|b| overlap(a, b) < 1.0), "{boxes:?}");
        }
    }

    #[test]
    fn words_that_need_not_be_there_lower_priority() {
        let mut labels = Labels::new(300.0, 300.0);
        for i in 0..40 {
            labels.add(
                150.0 + f64::from(i % 3),
                150.0 + f64::from(i % 5),
                Label::WhereFree(format!("word {i:02}")),
            );
        }
        labels.add(150.0, 150.0, Label::Always("the name".into()));
        let svg = labels.svg();
        assert!(svg.contains("the name"));
        let words = svg.matches("word").count();
        assert!((1..16).contains(&words), "{words}");
    }

    #[test]
    fn words_keep_off_a_line() {
        let word = |ends: &[(f64, f64)]| {
            let mut labels = Labels::new(300.0, 300.0);
            labels.add(150.0, 150.0, Label::Always("a name".into()));
            for end in ends {
                labels.keep_free((150.0, 150.0), *end);
            }
            labels.svg()
        };
        let above = "y=\"139.0\" text-anchor=\"middle\"";
        assert!(!word(&[(150.0, 20.0)]).contains(above), "{}", word(&[(150.0, 20.0)]));
        // Negative controls: no line, and one that leaves the other way.
        assert!(word(&[]).contains(above) && word(&[(150.0, 290.0)]).contains(above), "{}", word(&[]));
    }

    #[test]
    fn words_stay_in_the_field() {
        let mut labels = Labels::new(100.0, 100.0);
        labels.add(99.0, 50.0, Label::Always("at the rim".into()));
        let svg = labels.svg();
        assert!(svg.contains("x=\"90.0\"") && svg.contains("\"end\""), "{svg}");
        // Without words there is nothing.
        let mut silent = Labels::new(100.0, 100.0);
        silent.add(50.0, 50.0, Label::Always(String::new()));
        assert_eq!(silent.svg(), "");
    }
}
