//! `docs/shadow_methods.md` agrees with the registry and has a measured row per method and hairstyle.

use std::path::Path;

use lovelock_shadow::ShadowMethod;

const HAIRSTYLES: [&str; 5] = ["slab", "tuft", "smooth", "curly", "straight.hair"];

fn document() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/shadow_methods.md");
    std::fs::read_to_string(path).expect("the document is there")
}

/// The part that `examples/measure_methods` writes.
fn measured(document: &str) -> &str {
    let (_, rest) = document.split_once("<!-- measured:begin -->").expect("a begin");
    rest.split_once("<!-- measured:end -->").expect("an end").0
}

/// The section of one hairstyle.
fn section<'a>(measured: &'a str, hairstyle: &str) -> Option<&'a str> {
    let (_, rest) = measured.split_once(&format!("\n### Measured on {hairstyle}\n"))?;
    Some(rest.split_once("\n### ").map_or(rest, |(section, _)| section))
}

/// The table of both backends in a section.
fn both_backends(section: &str) -> &str {
    let at = section.find("| both backends |").expect("a table of both backends");
    &section[at..]
}

/// The cells of the row of a method in a table; `None` if there is no such row.
fn row<'a>(text: &'a str, first: &str) -> Option<Vec<&'a str>> {
    let rows = text.lines().map(|line| line.trim_matches('|').split('|').map(str::trim).collect::<Vec<_>>());
    rows.into_iter().find(|cells| cells[0] == first && cells.len() > 1)
}

#[test]
fn every_method_stands_in_the_document_as_in_the_registry() {
    let document = document();
    let measured = measured(&document);
    for &method in ShadowMethod::ALL {
        let cells = row(measured, &format!("`{method}`")).expect("a row of the registry");
        assert_eq!(cells[1], method.label(), "{method}");
        assert_eq!(cells[3], method.source().unwrap_or_default(), "{method}");
        let mentioned = document.matches(&format!("`{method}`")).count();
        assert!(mentioned > HAIRSTYLES.len(), "{method}");
    }
}

#[test]
fn every_method_is_measured_on_every_hairstyle() {
    let document = document();
    for hairstyle in HAIRSTYLES {
        let section = section(measured(&document), hairstyle).expect(hairstyle);
        let heads = row(section, "method").expect("heads of columns");
        for &method in ShadowMethod::ALL {
            let cells = row(section, &format!("`{method}`")).expect("a row of every method");
            assert_eq!(cells.len(), heads.len(), "{hairstyle}: {method}");
            let number = |head: &str| -> f64 {
                let at = heads.iter().position(|found| *found == head).expect(head);
                let number = cells[at].split(' ').next().unwrap_or_default();
                number.parse().unwrap_or_else(|_| panic!("{hairstyle}: {method}: {head}: {number:?}"))
            };
            for head in ["exact", "converged", "99 %", "first ten"] {
                assert!((0.0..=1.0).contains(&number(head)), "{hairstyle}: {method}: {head}");
            }
            assert!((-1.0..=1.0).contains(&number("bias")));
            // Checks of the numbers: `exact` is its own reference, and `none` has the largest error, unless hair is thin and its density
            // is taken for known.
            assert_eq!(method == ShadowMethod::Exact, number("exact") == 0.0, "{hairstyle}: {method}");
            if method != ShadowMethod::ApproximateDeep {
                assert_eq!(method == ShadowMethod::None, number("exact") > 0.2, "{hairstyle}: {method}");
            }
            assert!(number("build, ms") >= 0.0 && number("lookups, ms") >= 0.0 && number("map") >= 0.0);
        }
    }
}

#[test]
fn every_method_is_measured_on_both_backends() {
    let document = document();
    for hairstyle in HAIRSTYLES {
        let section = section(measured(&document), hairstyle).expect(hairstyle);
        let alone = row(section, "method").expect("heads of columns");
        let both = both_backends(section);
        let heads = row(both, "both backends").expect("heads of columns");
        for &method in ShadowMethod::ALL {
            let cells = row(both, &format!("`{method}`")).expect("a row of every method");
            assert_eq!(cells.len(), heads.len(), "{hairstyle}: {method}");
            let cell = |head: &str| cells[heads.iter().position(|found| *found == head).expect(head)];
            let number = |head: &str| -> f64 {
                let number = cell(head).split(' ').next().unwrap_or_default();
                number.parse().unwrap_or_else(|_| panic!("{hairstyle}: {method}: {head}: {number:?}"))
            };
            let first = row(section, &format!("`{method}`")).expect("a row of every method");
            let exact = alone.iter().position(|head| *head == "exact").expect("a column");
            assert_eq!(cell("exact, CPU"), first[exact], "{hairstyle}: {method}: of the same run");
            // Rounding to 8 bits, as in tests/gpu_agreement.rs.
            assert!(number("difference") <= 0.0021, "{hairstyle}: {method}");
            assert!((number("exact, GPU") - number("exact, CPU")).abs() <= 0.0011, "{hairstyle}: {method}");
            assert_eq!(number("held, GPU") > 0.0, method != ShadowMethod::None, "{hairstyle}: {method}");
            for head in ["build, CPU", "build, GPU", "lookups, CPU", "lookups, GPU"] {
                assert!(number(head) >= 0.0, "{hairstyle}: {method}: {head}");
            }
        }
    }
}

#[test]
fn a_missing_row_is_found_missing() {
    assert_eq!(row("| a | b |\n| `exact` | 1 |", "`none`"), None);
    assert_eq!(section("\n### Measured on slab\n\n| a |\n\n### Measured on tuft\n", "smooth"), None);
    assert_eq!(section("\n### Measured on slab\nx\n### Measured on tuft\n", "slab"), Some("x"));
}
