//! Words beside dots, where they cover least.

use super::escaped;
use std::fmt::Write as _;

/// Pixels that a letter takes, on average, and the height of a line.
const LETTER: (f64, f64) = (6.7, 13.0);

/// A rectangle: left, top, right, bottom.
type Box4 = [f64; 4];

/// Words beside dots. All dots are known before a word is placed, so that none covers a dot.
pub(super) struct Labels {
    field: (f64, f64),
    dots: Vec<(f64, f64, String)>,
}

impl Labels {
    /// For a field of this size.
    pub(super) fn new(width: f64, height: f64) -> Self {
        Self { field: (width, height), dots: Vec::new() }
    }

    /// A dot and its word, which may be empty.
    pub(super) fn add(&mut self, x: f64, y: f64, word: &str) {
        self.dots.push((x, y, word.to_owned()));
    }

    /// All words, each at the one of eight places that covers the least.
    pub(super) fn svg(&self) -> String {
        // A dot is in the way of all words but those at its own place.
        let mut taken: Vec<Box4> =
            self.dots.iter().map(|(x, y, _)| [x - 6.0, y - 6.0, x + 6.0, y + 6.0]).collect();
        let mut out = String::new();
        for (x, y, word) in self.dots.iter().filter(|(_, _, word)| !word.is_empty()).take(200) {
            let (width, height) = (word.chars().count() as f64 * LETTER.0, LETTER.1);
            let around = [
                (x + 9.0, y - height / 2.0),
                (x - 9.0 - width, y - height / 2.0),
                (x - width / 2.0, y - 8.0 - height),
                (x - width / 2.0, y + 8.0),
                (x + 6.0, y - 6.0 - height),
                (x + 6.0, y + 6.0),
                (x - 6.0 - width, y - 6.0 - height),
                (x - 6.0 - width, y + 6.0),
            ];
            let boxes = around.map(|(left, top)| [left, top, left + width, top + height]);
            let cost = |place: &Box4| {
                let covered: f64 = taken.iter().map(|other| overlap(place, other)).sum();
                covered + 4.0 * (width * height - overlap(place, &[0.0, 0.0, self.field.0, self.field.1]))
            };
            let Some(best) = boxes.into_iter().min_by(|a, b| cost(a).total_cmp(&cost(b))) else { continue };
            taken.push(best);
            let (left, base) = (best[0], best[1] + height - 3.0);
            let word = escaped(word);
            let _ = write!(out, "<text class=\"label\" x=\"{left:.1}\" y=\"{base:.1}\">{word}</text>");
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
    use super::{Labels, overlap};

    #[test]
    fn words_do_not_cover_each_other_where_there_is_room() {
        let mut labels = Labels::new(400.0, 300.0);
        for i in 0..5 {
            labels.add(200.0 + f64::from(i) * 3.0, 150.0 + f64::from(i) * 12.0, "six letters");
        }
        let svg = labels.svg();
        let number = |text: &str, name: &str| -> f64 {
            text.split_once(name).unwrap().1.split_once('"').unwrap().0.parse().unwrap()
        };
        let boxes: Vec<_> = (svg.split("<text").skip(1))
            .map(|text| (number(text, "x=\""), number(text, "y=\"")))
            .map(|(x, y)| [x, y - 10.0, x + 11.0 * 6.7, y + 3.0])
            .collect();
        assert_eq!(boxes.len(), 5);
        for (i, a) in boxes.iter().enumerate() {
            assert!(boxes[..i].iter().all(|b| overlap(a, b) < 1.0), "{boxes:?}");
        }
    }

    #[test]
    fn words_stay_in_the_field() {
        let mut labels = Labels::new(100.0, 100.0);
        labels.add(99.0, 50.0, "at the rim");
        let svg = labels.svg();
        assert!(svg.contains("x=\"23.0\""), "{svg}");
        // Without words there is nothing.
        let mut silent = Labels::new(100.0, 100.0);
        silent.add(50.0, 50.0, "");
        assert_eq!(silent.svg(), "");
    }
}
