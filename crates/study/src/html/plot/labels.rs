//! Places labels beside dots so that no two overlap.

use super::escaped;
use std::fmt::Write as _;

/// Average width of a letter, and height of a line, pixels.
const LETTER: (f64, f64) = (6.7, 13.0);

/// A rectangle: left, top, right, bottom.
type Box4 = [f64; 4];

/// The label of a dot.
#[derive(Clone, Debug, PartialEq)]
pub enum Label {
    /// Drawn unless empty; away from its dot if there is no room beside it. Left out only if it fits nowhere.
    Always(String),
    /// Left out if it would overlap a label, or too much of dots and lines.
    WhereFree(String),
}

/// Fraction of a label that may overlap dots and lines before it is left out.
const COVERED: f64 = 0.2;

/// Distance between the places that a label may move to, pixels.
const STEP: f64 = 4.0;
/// The cost of a pixel by which a label moves, as an area that it covers.
const MOVED: f64 = 8.0;
/// A label farther from its dot has a line to it, pixels.
const AWAY: f64 = 10.0;
/// The rim of a dot, where such a line begins, pixels from the centre.
const RIM: f64 = 6.0;

/// Length of the line pieces that labels avoid, pixels.
const PIECE: f64 = 6.0;

/// A place for a label.
#[derive(Clone, Copy, Debug)]
struct Place {
    area: Box4,
    /// The end of the label at the dot, as in SVG.
    anchor: &'static str,
    /// Distance from the place beside the dot, pixels.
    moved: f64,
}

/// A label at its place.
#[derive(Clone, Copy, Debug)]
struct Placed<'a> {
    word: &'a str,
    dot: (f64, f64),
    place: Place,
}

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

    /// Each label at the free place that covers the least; those that must be drawn come first. No two overlap.
    fn placed(&self) -> Vec<Placed<'_>> {
        // A covered dot is worse than a crossed line.
        let mut avoided: Vec<(Box4, f64)> =
            self.dots.iter().map(|(x, y, _)| ([x - 7.0, y - 7.0, x + 7.0, y + 7.0], 3.0)).collect();
        avoided.extend(self.lines.iter().map(|piece| (*piece, 0.5)));
        let words = |always: bool| {
            self.dots.iter().filter_map(move |(x, y, label)| match label {
                Label::Always(word) if always && !word.is_empty() => Some((*x, *y, word, f64::INFINITY)),
                Label::WhereFree(word) if !always && !word.is_empty() => Some((*x, *y, word, COVERED)),
                Label::Always(_) | Label::WhereFree(_) => None,
            })
        };
        let mut placed: Vec<Placed<'_>> = Vec::new();
        for (x, y, word, most) in words(true).chain(words(false)).take(200) {
            let width = word.chars().count() as f64 * LETTER.0;
            let area = width * LETTER.1;
            let is_free = |at: &Place| placed.iter().all(|other| overlap(&at.area, &other.place.area) <= 0.0);
            let cost = |at: &Place| {
                let covered: f64 =
                    avoided.iter().map(|(other, weight)| weight * overlap(&at.area, other)).sum();
                let outside = area - overlap(&at.area, &[0.0, 0.0, self.field.0, self.field.1]);
                covered + 4.0 * outside + MOVED * at.moved
            };
            let places = self.places((x, y), width, most.is_infinite());
            let costs = places.into_iter().filter(is_free).map(|at| (cost(&at), at));
            let best = costs.min_by(|a, b| a.0.total_cmp(&b.0));
            let Some((_, place)) = best.filter(|(cost, _)| *cost <= most * area) else { continue };
            placed.push(Placed { word, dot: (x, y), place });
        }
        placed
    }

    /// The places beside a dot, and, if the label may be `moved`, those above and below them.
    fn places(&self, (x, y): (f64, f64), width: f64, moved: bool) -> Vec<Place> {
        let height = LETTER.1;
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
        let place = |(left, top, anchor): (f64, f64, &'static str), by: f64| Place {
            area: [left, top + by, left + width, top + by + height],
            anchor,
            moved: by.abs(),
        };
        let mut places: Vec<Place> = around.into_iter().map(|beside| place(beside, 0.0)).collect();
        if moved {
            let steps = (self.field.1 / STEP).ceil().clamp(0.0, 200.0) as u32;
            for by in (1..=steps).flat_map(|step| [-STEP, STEP].map(|by| by * f64::from(step))) {
                let there = around[..3].iter().map(|beside| place(*beside, by));
                places.extend(there.filter(|at| at.area[1] >= 0.0 && at.area[3] <= self.field.1));
            }
        }
        places
    }

    /// All labels, above a line to its dot from each that is away from it.
    pub(super) fn svg(&self) -> String {
        let (mut leaders, mut words) = (String::new(), String::new());
        for Placed { word, dot, place } in self.placed() {
            let [left, top, right, bottom] = place.area;
            let (to_x, to_y) = (dot.0.clamp(left, right), dot.1.clamp(top, bottom));
            let [across, down] = [to_x - dot.0, to_y - dot.1];
            let away = across.hypot(down);
            if away > AWAY {
                let (from_x, from_y) = (dot.0 + RIM * across / away, dot.1 + RIM * down / away);
                let _ = write!(
                    leaders,
                    "<path class=\"leader\" d=\"M{from_x:.1} {from_y:.1}L{to_x:.1} {to_y:.1}\"/>"
                );
            }
            let base = bottom - 3.0;
            let anchor = place.anchor;
            let at = match anchor {
                "end" => right,
                "middle" => f64::midpoint(left, right),
                _ => left,
            };
            let word = escaped(word);
            let _ = write!(
                words,
                "<text class=\"label\" x=\"{at:.1}\" y=\"{base:.1}\" text-anchor=\"{anchor}\">{word}</text>"
            );
        }
        leaders + &words
    }
}

/// The area that two rectangles share.
fn overlap(a: &Box4, b: &Box4) -> f64 {
    let across = (a[2].min(b[2]) - a[0].max(b[0])).max(0.0);
    across * (a[3].min(b[3]) - a[1].max(b[1])).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::super::Axis;
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

    /// Fails unless all labels are drawn in the field without overlaps.
    fn check(labels: &Labels, count: usize) {
        let placed = labels.placed();
        assert_eq!(placed.len(), count);
        let field = [0.0, 0.0, labels.field.0, labels.field.1];
        for (i, a) in placed.iter().enumerate() {
            let [left, top, right, bottom] = a.place.area;
            let outside = (right - left) * (bottom - top) - overlap(&a.place.area, &field);
            assert!(outside < 1e-6, "{a:?}");
            for b in &placed[..i] {
                assert!(overlap(&a.place.area, &b.place.area) <= 0.0, "{a:?} {b:?}");
            }
        }
        assert_eq!(labels.svg(), labels.svg());
    }

    /// Milliseconds and errors of `docs/measured_methods.md`, smooth hair.
    #[test]
    fn the_names_of_measured_methods_do_not_overlap() {
        let measured = [
            ("Voxel map", 3.94, 0.0267),
            ("Opacity maps", 13.97, 0.0332),
            ("Deep opacity maps", 14.04, 0.1111),
            ("Density clustering", 33.66, 0.0357),
            ("Occupancy maps", 18.86, 0.0373),
            ("Deep shadow maps", 29.56, 0.0359),
            ("Approximate deep", 11.36, 0.1803),
            ("Fourier maps", 42.56, 0.0355),
            ("Adaptive maps", 31.25, 0.0390),
            ("Moments", 20.41, 0.0971),
            ("Voxel march", 269.37, 0.0861),
            ("Ray traced", 7982.84, 0.0152),
            ("Exact", 18.36, 0.0343),
        ];
        let x = Axis::logarithmic("", measured.map(|(_, ms, _)| ms));
        let y = Axis::logarithmic("", measured.map(|(.., error)| error));
        let mut labels = Labels::new(470.0, 320.0);
        for (name, ms, error) in measured {
            labels.add(470.0 * x.place(ms), 320.0 * (1.0 - y.place(error)), Label::Always(name.into()));
        }
        check(&labels, measured.len());
    }

    #[test]
    fn names_of_crowded_dots_move_and_have_lines() {
        let mut labels = Labels::new(470.0, 320.0);
        for i in 0..16 {
            let i = f64::from(i);
            labels.add(235.0 + i % 4.0, 160.0 + i / 4.0, Label::Always("Density clustering".into()));
        }
        check(&labels, 16);
        assert!(labels.svg().contains("class=\"leader\""));
        // Negative control: a dot alone.
        let mut alone = Labels::new(470.0, 320.0);
        alone.add(235.0, 160.0, Label::Always("Density clustering".into()));
        check(&alone, 1);
        assert!(!alone.svg().contains("leader"));
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
