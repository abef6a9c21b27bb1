use super::axis::Axis;
use super::labels::Label;
use super::{Dot, Plot, Stroke};

const THIN: Stroke<'static> = Stroke { color: "#123", width: 1.0, dashed: false };

fn plot() -> Plot {
    Plot::new(100.0, 100.0, Axis::even("x & y", 0.0, 1.0), Axis::even("T", 0.0, 1.0))
}

#[test]
fn lines_go_where_their_numbers_are() {
    let mut lines = plot();
    lines.line(&[(0.0, 0.0), (0.5, 1.0), (f64::NAN, 0.5), (2.0, 0.5), (1.0, 0.5)], THIN, Some(3));
    lines.steps(&[(0.0, 1.0), (0.25, 0.5)], THIN);
    let svg = lines.svg("what it shows", 0.0);
    assert!(svg.contains("d=\"M0.0 100.0L50.0 0.0L100.0 50.0\""), "{svg}");
    assert!(svg.contains("data-m=\"3\"") && svg.contains("d=\"M0.0 0.0H25.0V50.0H100.0\""), "{svg}");
    assert!(svg.contains("x &amp; y") && svg.contains("aria-label=\"what it shows\""));
}

#[test]
fn a_dot_has_its_words_and_no_number_breaks_the_drawing() {
    let mut dots = plot();
    dots.dot((0.5, 0.5), Dot::Full, "red\"", Label::Always("<name>".into()), "more");
    dots.dot((f64::NAN, f64::INFINITY), Dot::Hollow, "blue", Label::Always("nowhere".into()), "");
    dots.lane("lane", "#456", [(f64::NAN, 1.0, f64::NAN), (-1.0, 5.0, 2.0), (7.0, 8.0, 1.0)], 0);
    let svg = dots.svg("", 40.0);
    assert!(svg.contains("&lt;name&gt;") && svg.contains("<title>more</title>") && svg.contains("red&quot;"));
    assert!(!svg.contains("nowhere") && !svg.contains("blue"));
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    // Spans outside the field or without a start are left out; the span across the whole field is clipped.
    assert_eq!(svg.matches("height=\"14\" fill").count(), 1, "{svg}");
    assert!(svg.contains("width=\"100.0\" height=\"14\""), "{svg}");
}

#[test]
fn long_lines_are_thinned_and_keep_their_ends() {
    let many: Vec<(f64, f64)> = (0..=100_000).map(|i| (f64::from(i) / 1e5, 0.5)).collect();
    let mut long = plot();
    long.line(&many, THIN, None);
    let svg = long.svg("", 0.0);
    assert!(svg.matches('L').count() <= 2001 && svg.contains("L100.0 50.0\""), "{}", svg.len());
}
