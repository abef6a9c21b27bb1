//! The table of frames of a BVH file: a missing blank, a lost number or a wrapped row never moves what comes after it.

use crate::common;
use crate::common::dance::{Dance, MIXAMO};

use lovelock_motion::{MotionFile, MotionSettings, load_motion, load_motion_bytes};

fn load(text: &str) -> Result<MotionFile, String> {
    load_motion_bytes("x.bvh", text.as_bytes(), MotionSettings::default()).map_err(|error| error.to_string())
}

/// The dance with another spelling of its rows, and the number of its first row's line.
fn with_rows(change: impl Fn(usize, &str) -> String) -> (String, usize) {
    let text = Dance::new(&MIXAMO).bvh();
    let head = text.lines().position(|line| line.starts_with("Frame Time")).expect("a table") + 1;
    let lines = text.lines().enumerate().map(
        |(i, line)| {
            if i < head { line.to_owned() } else { change(i - head, line) }
        },
    );
    (lines.collect::<Vec<_>>().join("\n") + "\n", head + 1)
}

#[track_caller]
fn assert_same(found: &MotionFile, expected: &MotionFile) {
    assert_eq!(found.frames, expected.frames);
    let turns = found.rotations.iter().zip(&expected.rotations);
    let worst = turns.map(|(a, b)| a.angle_between(*b)).fold(0.0, f32::max);
    let places = found.positions.iter().zip(&expected.positions);
    let far = places.map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
    assert!(worst < 2e-3 && far < 1e-5, "{worst} radians, {far} m");
}

#[test]
fn a_missing_blank_before_a_sign_divides_two_numbers() {
    let plain = load(&Dance::new(&MIXAMO).bvh()).expect("a motion");
    // In every row, and in one row; with signs of both kinds.
    for only in [None, Some(7)] {
        let (text, _) = with_rows(|row, line| {
            if only.is_none_or(|only| only == row) { line.replace(" -", "-") } else { line.to_owned() }
        });
        assert!(text.lines().any(|line| line.split_whitespace().any(|w| w.matches('.').count() > 1)));
        assert_same(&load(&text).expect("a motion"), &plain);
        let plus = text.replace(" 0.00000 ", "+0.00000 ");
        assert_same(&load(&plus).expect("a motion"), &plain);
    }
    // An exponent is no second number.
    let (text, _) = with_rows(|_, line| line.replace(" 0.00000", " 1e-9"));
    assert_same(&load(&text).expect("a motion"), &plain);
    let Some(data) = common::data_dir() else { return };
    let of = |name: &str| load_motion(&data.join("reports").join(name)).expect(name);
    let reference = of("mixamo_names_reference.bvh");
    for name in ["glued_numbers.bvh", "one_glued_row.bvh"] {
        assert_same(&of(name), &reference);
    }
}

#[test]
fn rows_that_cannot_be_divided_are_refused_by_line_and_text() {
    // No sign between two numbers, a number lost, and one too many: in a single row, and in all.
    for only in [None, Some(5)] {
        for (from, to, says) in [
            (" 0.00000 ", " 0.000000", "numbers"),
            (" 0.00000 ", " ", "68 numbers"),
            (" 0.00000 ", " 1 2 ", "67"),
        ] {
            let (text, first) = with_rows(|row, line| {
                if only.is_none_or(|only| only == row) { line.replacen(from, to, 1) } else { line.to_owned() }
            });
            let error = load(&text).expect_err(says);
            let line = format!("line {}", first + only.unwrap_or(0));
            assert!(error.contains(&line) && error.contains("66"), "{error}");
            let start = text.lines().nth(first - 1 + only.unwrap_or(0)).expect("a row");
            assert!(error.contains(&start[..40]), "{error}");
        }
    }
    let (text, first) =
        with_rows(|row, line| if row == 3 { line.replacen("0.00000", "0.0.1", 1) } else { line.to_owned() });
    let error = load(&text).expect_err("no number");
    assert!(error.contains(&format!("line {}", first + 3)) && error.contains("`0.0.1`"), "{error}");
}

#[test]
fn rows_may_be_wrapped_and_the_header_may_be_wrong() {
    let plain = load(&Dance::new(&MIXAMO).bvh()).expect("a motion");
    // Every row over several lines, with empty ones between, whatever the header says.
    let (text, _) = with_rows(|_, line| {
        let words: Vec<&str> = line.split(' ').collect();
        words.chunks(20).map(|part| part.join(" ")).collect::<Vec<_>>().join("\n") + "\n\n"
    });
    assert_same(&load(&text).expect("wrapped rows"), &plain);
    assert_same(&load(&text.replace("Frames: 20", "Frames: 19")).expect("wrapped rows"), &plain);
    // All numbers in lines of one length, or in one line: only the header tells that none is missing.
    let rows: Vec<String> =
        text.lines().skip_while(|line| !line.starts_with("Frame Time")).skip(1).map(String::from).collect();
    let numbers: Vec<&str> = rows.iter().flat_map(|row| row.split_whitespace()).collect();
    let head = &text[..text.find("Frame Time").expect("it")];
    let filled = |numbers: &[&str], per_line: usize| {
        let lines: Vec<String> = numbers.chunks(per_line).map(|part| part.join(" ")).collect();
        format!("{head}Frame Time: 0.033333\n{}\n", lines.join("\n"))
    };
    assert_same(&load(&filled(&numbers, 16)).expect("filled lines"), &plain);
    assert_same(&load(&filled(&numbers, usize::MAX)).expect("one line"), &plain);
    let error = load(&filled(&numbers[1..], 16)).expect_err("a number is missing");
    assert!(error.contains("numbers") && error.contains("66"), "{error}");
    // Commas as decimal marks, and between numbers.
    let (text, _) = with_rows(|_, line| line.replace('.', ","));
    assert_same(&load(&text).expect("decimal commas"), &plain);
    let (text, _) = with_rows(|_, line| line.replace(' ', ", "));
    assert_same(&load(&text).expect("commas"), &plain);
    // A file that was cut off within its last row loses that row, and says so.
    let (text, _) = with_rows(|row, line| if row == 19 { line[..100].to_owned() } else { line.to_owned() });
    let cut = load(&text).expect("a motion");
    assert_eq!((cut.frames, cut.dropped["rows"]), (19, 1));
}

#[test]
fn a_line_that_is_missing_in_a_wrapped_table_is_refused() {
    // Rows of 66 numbers in lines of the given length.
    let wrapped = |per_line: usize| {
        let (text, first) = with_rows(|_, line| {
            let words: Vec<&str> = line.split(' ').collect();
            words.chunks(per_line).map(|part| part.join(" ")).collect::<Vec<_>>().join("\n")
        });
        (text.lines().map(String::from).collect::<Vec<_>>(), first)
    };
    let without = |lines: &[String], gone: &[usize]| {
        let kept = lines.iter().enumerate().filter(|(i, _)| !gone.contains(i));
        kept.map(|(_, line)| line.as_str()).collect::<Vec<_>>().join("\n") + "\n"
    };
    // Lines of equal length: each could stand for another. The last line may be the one that is missing.
    let (lines, first) = wrapped(22);
    for gone in [
        &[first - 1 + 7][..],
        &[first - 1 + 3, first - 1 + 20],
        &[lines.len() - 1],
        &[first - 1, first, first + 3],
    ] {
        let error = load(&without(&lines, gone)).expect_err("a missing line");
        assert!(error.contains(&format!("lines {first} to")) && error.contains("20 frames"), "{error}");
    }
    // Lines whose lengths tell their places: only the last row may be incomplete.
    let (lines, first) = wrapped(30);
    for at in [first - 1, first + 1, first - 1 + 10, lines.len() - 4] {
        let error = load(&without(&lines, &[at])).expect_err("a missing line");
        assert!(error.contains("line"), "{error}");
    }
    for (gone, frames) in [(&[lines.len() - 1][..], 19), (&[lines.len() - 2, lines.len() - 1], 19), (&[], 20)]
    {
        let motion = load(&without(&lines, gone)).expect("a motion");
        assert_eq!(motion.frames, frames);
    }
    // A joint per line, without the position of the root in the first row; then cut off within the last row.
    let (text, first) = with_rows(|_, line| {
        let words: Vec<&str> = line.split(' ').collect();
        let joints: Vec<String> = words[6..].chunks(3).map(|part| part.join(" ")).collect();
        format!("{}\n{}", words[..6].join(" "), joints.join("\n"))
    });
    let by_joint: Vec<String> = text.lines().map(String::from).collect();
    load(&without(&by_joint, &[first - 1])).expect_err("a missing line");
    let cut = load(&without(&by_joint, &[by_joint.len() - 1])).expect("a motion");
    assert_eq!((cut.frames, cut.dropped["rows"]), (19, 1));
    // The control: a row that is missing as a whole moves no number.
    let motion = load(&without(&lines, &[first + 2, first + 3, first + 4])).expect("a motion");
    assert!(motion.frames == 19 && motion.notes.iter().any(|note| note.contains("promises 20")));
}
