use lovelock_panes::probe::{ProbeCurve, ProbeMark};

use super::page;
use crate::changes::{ChangeReport, StabilityReport};
use crate::report::*;

/// A report with all parts, as if two methods had been measured on two backends.
fn report() -> CompareReport {
    let mut report = CompareReport {
        complete: true,
        version: "1.2.3".into(),
        machine: "a processor, 2 threads".into(),
        frames: [12, 15],
        swim_frames: vec![12, 13, 14],
        scene: SceneFacts {
            name: "curls <of> \"mine\".lovelock".into(),
            width: 320,
            height: 240,
            strands: 12_345,
            points: 400_000,
            lights: 1,
            draws: 30,
            ..SceneFacts::default()
        },
        reference: Reference {
            converged: true,
            samples: 32,
            change: 0.0004,
            limit: 0.001,
            footprints: vec![FootprintTruth {
                methods: vec!["voxel-map cpu".into()],
                converged: true,
                samples: 32,
                change: 0.0004,
                changes: vec![(8, 0.01), (16, 0.002), (32, 0.0004)],
                points: 1000,
            }],
            picture: Some("pictures/reference.png".into()),
            ..Reference::default()
        },
        ..CompareReport::default()
    };
    for (id, label, rmse, time) in [("voxel-map", "Voxel map", 0.02, 3.0), ("exact", "Exact", 0.05, 40.0)] {
        for (backend, factor) in [("cpu", 1.0), ("gpu", 0.1)] {
            let name = format!("{id} {backend}");
            let error =
                TransmittanceError { count: 9, rmse, bias: -0.004, p99: 0.09, max: 0.4, first10_rmse: None };
            report.methods.push(MethodReport {
                id: id.into(),
                label: label.into(),
                name: name.clone(),
                transparency: "sorted".into(),
                backend: backend.into(),
                adapter: format!("adapter of the {backend}"),
                settings: vec![
                    ("resolution".into(), "128".into()),
                    ("size".into(), "0.23999999463558197".into()),
                    ("memory_limit_bytes".into(), "8589934592".into()),
                ],
                transmittance: Some(error),
                flip: Some(FlipError { mean: 0.031, p99: 0.2, ..FlipError::default() }),
                psnr_db: Some(38.2),
                ssim: Some(0.99),
                ms: Some(StageMs {
                    build: Some(time * factor),
                    query: Some(1.0 * factor),
                    draw: 5.0,
                    whole: 9.0,
                }),
                times: vec![TimeSpread {
                    name: "build".into(),
                    median: time,
                    low: time,
                    high: time,
                    count: 30,
                }],
                memory_bytes: Some(3 << 20),
                light_sweep: Some(ChangeReport {
                    steps: 8,
                    points: 6_543,
                    pop: 0.234_56,
                    truth_pop: Some(0.0456),
                    excess: Some(0.211),
                    jitter: Some(6.54e-5),
                    ..ChangeReport::default()
                }),
                stray: Some(ChangeReport {
                    steps: 26,
                    points: 1024,
                    jitter: Some(0.0),
                    ..ChangeReport::default()
                }),
                stability: Some(StabilityReport {
                    swim: Some(0.0123),
                    swim_p99: Some(0.05),
                    ..StabilityReport::default()
                }),
                banding: Some(BandingReport {
                    curve: (0..64)
                        .map(|i| (i as f32 / 64.0, (-3.0 * i as f32 / 64.0).exp() + 0.02))
                        .collect(),
                    optical_depth: 3.0,
                    ..BandingReport::default()
                }),
                front_of_time: id == "voxel-map",
                files: MethodFiles {
                    picture: Some(format!("pictures/{name}.png")),
                    ..MethodFiles::default()
                },
                ..MethodReport::default()
            });
        }
    }
    report.probes.push(ProbeReport {
        pixel: [100, 80],
        steps: vec![(-0.01, 1.0), (0.0, 0.6), (0.02, 0.2)],
        reference: vec![(-0.02, 1.0), (0.02, 0.4), (0.03, 0.1)],
        methods: vec![ProbeCurve {
            method: "voxel-map cpu".into(),
            curve: vec![(-0.02, 0.97), (0.03, 0.2)],
            value: 0.66,
            marks: vec![ProbeMark { kind: "slice".into(), start: 0.0, end: 0.004, weight: 2.0 }],
        }],
        ..ProbeReport::default()
    });
    report
}

/// Fails if an element is not closed, or a closing tag has no opening tag.
fn balanced(html: &str) {
    let mut open = Vec::new();
    let body =
        html.split_once("<body>").and_then(|(_, body)| body.rsplit_once("<script>")).expect("a body").0;
    for piece in body.split('<').skip(1) {
        let (tag, _) = piece.split_once('>').expect("a tag ends");
        let name = tag.split_whitespace().next().unwrap_or_default();
        if let Some(name) = name.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name.to_owned()), "near {piece}");
        } else if !tag.ends_with('/') && !["img", "meta", "br", "!--"].contains(&name) {
            open.push(name.to_owned());
        }
    }
    assert_eq!(open, Vec::<String>::new());
}

#[test]
fn the_page_is_whole_and_names_everything() {
    let page = page(&report());
    for text in [
        "curls &lt;of&gt; &quot;mine&quot;.lovelock",
        "frames 12 to 14",
        "12\u{202f}345 strands",
        "On the CPU: adapter of the cpu",
        "On the GPU: adapter of the gpu",
        "Cost on the CPU (times: ms)",
        "Cost on the GPU (times: ms)",
        "Voxel map · GPU",
        "./pictures/voxel-map%20gpu.png",
        "−0.0040",
        "3.00 MiB",
        "Probe 1: pixel 100, 80",
        "in each of the 3 frames.",
        "6\u{202f}543 points are measured",
        "26 steps of 1 mm",
        ">0.2346</td>",
        ">6.5e−5</td>",
        "It converged",
        "<b>128</b> · size <b>0.24</b> · memory limit <b>8.00 GiB</b>",
    ] {
        assert!(page.contains(text), "{text}");
    }
    assert!(!page.contains("<of>") && !page.contains("NaN"), "what is in the report stays text");
    balanced(&page);
}

#[test]
fn the_page_asks_for_nothing_beyond_its_folder() {
    let page = page(&report());
    let mut found = 0;
    for attribute in ["src=\"", "href=\""] {
        for part in page.split(attribute).skip(1) {
            assert!(part.starts_with("./") || part.starts_with('#'), "{}", &part[..40]);
            found += 1;
        }
    }
    assert!(found > 10);
    for never in ["http:", "https:", "@import", "url(", "fetch("] {
        assert!(!page.contains(never), "{never}");
    }
    assert!(page.contains("default-src 'none'"));
}

#[test]
fn the_difference_between_the_backends_has_a_line_of_its_own() {
    let mut two = report();
    assert!(!page(&two).contains("Between the backends"), "one backend drew the reference");
    let of = |backend: &str| ReferencePicture {
        backend: backend.into(),
        file: format!("pictures/reference-{backend}.png"),
    };
    two.reference.pictures = vec![of("cpu"), of("gpu")];
    let flip = FlipError { mean: 0.0044, p99: 0.05, hair_mean: Some(0.0123) };
    two.reference.gpu_from_cpu = Some(ImageDifference { flip, psnr_db: Some(41.26), ssim: Some(0.9876) });
    let text = page(&two);
    let line = text.lines().find(|line| line.contains("Between the backends")).expect("a line");
    for number in ["FLIP 0.0044", "0.0123 in hair", "41.3 dB", "SSIM 0.9876"] {
        assert!(line.contains(number), "{number}");
    }
    for name in ["Reference · CPU", "Reference · GPU"] {
        assert!(text.contains(&format!("data-name=\"{name}\"")), "{name}");
    }
}

#[test]
fn a_reference_that_did_not_converge_is_said_at_the_top() {
    let mut doubtful = report();
    doubtful.reference.converged = false;
    doubtful.reference.footprints[0].converged = false;
    doubtful.reference.refused.push("the exact map needs 9 GiB".into());
    let text = page(&doubtful);
    let (head, rest) = text.split_once("<nav").unwrap();
    assert!(head.contains("did not converge within its limit") && head.contains("needs 9 GiB"), "{head}");
    assert!(!rest.contains("It converged"));
    // The ground truth of another light or a later frame counts as well.
    for name in ["reference picture, light 2", "frame 13"] {
        let mut doubtful = report();
        let other = NamedTruth { name: name.into(), converged: false, samples: 32, change: 0.07 };
        doubtful.reference.others.push(other);
        doubtful.reference.settle();
        assert!(!doubtful.reference.converged && doubtful.reference.change > 0.06);
        let head = page(&doubtful).split_once("<nav").unwrap().0.to_owned();
        assert!(head.contains(&format!("The truth of the {name} still changed by 0.07")), "{head}");
    }
    // Negative control.
    let mut trusted = report();
    trusted.reference.others.push(NamedTruth { converged: true, ..NamedTruth::default() });
    trusted.reference.settle();
    // The convergence of a probe's ray is mentioned beside the probe.
    let ray = NamedTruth { name: "probe at 100,80".into(), change: 0.007, ..NamedTruth::default() };
    trusted.reference.probes.push(ray);
    trusted.reference.settle();
    let text = page(&trusted);
    assert!(trusted.reference.converged && !text.contains("class=\"banner\""));
    assert!(text.contains("of the probe at 100,80 still changed by 0.0070"));
    assert!(!page(&report()).split_once("<nav").unwrap().0.contains("class=\"banner\""));
}

#[test]
fn a_map_that_is_not_what_was_asked_for_is_said_with_the_settings() {
    let mut clipped = report();
    clipped.methods[0].cells_total = Some(112 * 112);
    clipped.methods[1].cells_total = Some(3 * 112 * 112);
    let text = page(&clipped);
    assert!(
        text.contains("drawn with <b>112 × 112 texels</b>") && text.contains("<b>37\u{202f}632 cells</b>")
    );
    // Negative control: the requested map.
    clipped.methods[0].cells_total = Some(128 * 128);
    clipped.methods[1].cells_total = Some(128 * 128 * 128);
    assert!(!page(&clipped).contains("drawn with"));
}

#[test]
fn a_coarse_truth_at_points_is_said_at_the_top_and_at_its_column() {
    let mut coarse = report();
    let points = |change| Some(PointTruth { resolution: 112, memory_bytes: 1 << 20, change });
    coarse.reference.points = points(0.084);
    let text = page(&coarse);
    assert!(
        text.split_once("<nav").unwrap().0.contains("below 0.0840 may be the truth&#39;s own") || {
            text.split_once("<nav").unwrap().0.contains("below 0.0840 may be the truth's own")
        }
    );
    assert!(text.contains("Below 0.0840 it may be"));
    balanced(&text);
    // Negative control.
    coarse.reference.points = points(0.0009);
    assert!(!page(&coarse).contains("may be the truth"));
}

#[test]
fn swim_says_of_which_frames_it_is() {
    let mut some = report();
    some.frames = [12, 112];
    some.swim_frames = vec![12, 61, 111];
    assert!(page(&some).contains("in 3 of the 100 frames, evenly spaced: 12, 61, 111."));
    (some.frames, some.swim_frames) = ([12, 13], vec![12]);
    let text = page(&some);
    assert!(text.contains("in frame 12 alone.") && text.contains("several frames; here there is one"));
    assert!(!text.contains("evenly spaced"));
}

#[test]
fn tests_that_were_not_done_are_not_spoken_of() {
    let mut less = report();
    less.methods.iter_mut().for_each(|method| (method.light_sweep, method.stray) = (None, None));
    let text = page(&less);
    assert!(!text.contains("<b>Light turned</b>") && !text.contains("<b>Stray hair</b>"));
    assert!(text.contains("<b>Map shifted</b>"));
    balanced(&text);
}

#[test]
fn the_plots_of_cost_say_which_error_they_show() {
    let mut report = report();
    let own = "against each method's own texels";
    let one = "The error is that of <i>One truth</i>.";
    assert!(page(&report).contains(own) && !page(&report).contains(one));
    for method in &mut report.methods {
        method.transmittance_common = method.transmittance;
    }
    assert!(page(&report).contains(one) && !page(&report).contains(own));
}

#[test]
fn a_cancelled_and_an_empty_report_are_pages_too() {
    let empty = page(&CompareReport::default());
    assert!(empty.contains("is not complete") && empty.contains("no converged reference"));
    balanced(&empty);
    let mut refused = report();
    refused.methods[0] = MethodReport {
        id: "exact".into(),
        name: "exact cpu".into(),
        backend: "cpu".into(),
        refused: Some("needs 12 GiB & more".into()),
        ..MethodReport::default()
    };
    let text = page(&refused);
    assert!(text.contains("needs 12 GiB &amp; more"));
    balanced(&text);
}

#[test]
fn numbers_that_are_none_break_no_plot() {
    let mut broken = report();
    broken.methods[0].transmittance.as_mut().unwrap().rmse = f64::NAN;
    broken.methods[1].ms = Some(StageMs { build: Some(0.0), query: Some(0.0), ..StageMs::default() });
    broken.methods[2].banding.as_mut().unwrap().curve[3] = (f32::INFINITY, f32::NAN);
    broken.probes[0].steps.push((f32::NAN, f32::NAN));
    broken.probes[0].methods[0].marks[0].weight = f32::NAN;
    broken.reference.footprints[0].changes = vec![(0, 0.0), (u32::MAX, f32::INFINITY)];
    let page = page(&broken);
    assert!(!page.contains("NaN") && !page.contains("inf\"") && !page.contains("inf "));
    balanced(&page);
}

#[test]
fn a_note_says_what_is_not_measured_of_clusters() {
    let note = "Only strands have errors of transmittance";
    let mut report = report();
    assert!(!page(&report).contains(note));
    report.methods[0].draw = "clusters".into();
    assert!(page(&report).contains(note));
}
