//! Strange strokes and strange hair.

use glam::Vec3;
use lovelock_base::settings::{Choices as _, Settings as _};
use lovelock_groom::{StrandSet, Wisp};
use lovelock_style::Mask;
use lovelock_testkit::clock::alone_ms;

use super::*;

#[test]
fn layers_without_weight_mask_or_touch_change_no_byte() {
    let style = hair(1, 40);
    let made = stroked((Tool::Comb, false), &brush(), &style, &across(), &PlainHead);
    let layer = Layer::of(Hand { edits: made.edits });
    let nowhere = Mask { parts: Vec::new(), inverted: true };
    for idle in [Layer { weight: 0.0, ..layer.clone() }, Layer { mask: nowhere, ..layer }] {
        assert!(apply_layer(&idle, 1.0, &style, &PlainHead).is_none());
    }
    let still: Vec<StrokeSample> =
        across().into_iter().map(|s| StrokeSample { drag: Vec3::ZERO, ..s }).collect();
    let far: Vec<StrokeSample> =
        across().into_iter().map(|s| StrokeSample { position: s.position + Vec3::X, ..s }).collect();
    let weak = BrushSettings { strength: 0.0, ..brush() };
    let none = BrushSettings { share: 0.0, ..brush() };
    for (settings, samples) in [(&brush(), &still), (&brush(), &far), (&weak, &across()), (&none, &across())]
    {
        let made = stroked((Tool::Comb, false), settings, &style, samples, &PlainHead);
        assert!(made.edits.is_empty() && made.frame.guides == style.guides);
    }
}

#[test]
fn a_share_of_the_locks_is_touched() {
    let style = hair(1, 200);
    let count = |share| {
        let settings = BrushSettings { share, radius: 0.1, ..brush() };
        let made = stroked((Tool::Puff, false), &settings, &style, &across(), &FREE);
        made.touched.iter().filter(|touched| **touched).count() as f32
    };
    let part = count(0.3) / count(1.0);
    assert!((0.15..0.45).contains(&part), "{part}");
}

#[test]
fn only_the_front_is_touched_unless_the_brush_goes_through() {
    let style = hair(1, 100);
    let right = |front_only| {
        let settings = BrushSettings { radius: 0.5, front_only, ..brush() };
        let made = stroked((Tool::Pinch, false), &settings, &style, &across()[..1], &PlainHead);
        let far = |g: &usize| style.guides.point(*g, 0).x < -0.06;
        let all: Vec<usize> = (0..300).filter(far).collect();
        all.iter().filter(|g| made.touched[**g]).count() as f32 / all.len() as f32
    };
    println!("{} {}", right(true), right(false));
    assert!(right(true) < 0.8 && right(false) == 1.0);
}

#[test]
fn a_thousand_strokes_are_undone_to_the_byte_and_survive_a_file_long_suite() {
    let style = hair(1, 60);
    let mut history = vec![HandEdits::default()];
    let mut texts = vec![String::new()];
    let mut edits = HandEdits::default();
    let mut frame = GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0);
    let mut rest = Hairstyle::clone(&style);
    for i in 0..1000_usize {
        let tool = Tool::ALL[i % 11];
        let angle = 0.7 * i as f32;
        let from = Vec3::new(0.09 * angle.cos(), 0.12 + 0.05 * (0.3 * i as f32).sin(), 0.1 * angle.sin());
        let mut way = samples(from, from + Vec3::new(0.0, -0.02, 0.02), 4);
        for sample in &mut way {
            sample.view = (Vec3::Y * 0.1 - from).normalize_or(Vec3::NEG_Z);
        }
        let now = Arc::new(rest);
        let mut stroke = Brush::new(tool, false, &brush(), [&style, &now], &edits, &[]).expect("a stroke");
        for sample in &way {
            stroke.stroke_to(&mut frame, &BrushSurroundings { obstacle: &PlainHead }, sample);
        }
        stroke.write(&mut edits);
        rest = Hairstyle { guides: stroke.rest().clone(), ..Hairstyle::clone(&now) };
        history.push(edits.clone());
        texts.push(edits.to_text());
    }
    let bytes: usize = history.windows(2).map(|pair| pair[1].bytes_beside(&pair[0])).sum();
    println!(
        "{} places, {} KB of text, {} KB of history",
        edits.count(),
        texts[1000].len() / 1000,
        bytes / 1000
    );
    assert!(bytes < 60_000_000, "{bytes}");
    for (step, text) in history.iter().zip(&texts).rev() {
        assert_eq!(step.to_text(), *text);
    }
    assert!(history[0].is_empty());
    let read = HandEdits::from_text(&texts[1000]).expect("edits");
    assert_eq!((read.to_text(), &read), (texts[1000].clone(), &edits));
    assert_eq!(edits.mirrored().mirrored().to_text(), texts[1000]);
    assert!(applied(&edits, &style, &PlainHead).guides.x.iter().all(|v| v.is_finite()));
}

fn empty() -> Arc<Hairstyle> {
    let mut style = Hairstyle { scalp: PlainHead.scalp(8), ..Hairstyle::default() };
    style.guides.points_per_guide = 31;
    style.strands.first_point.push(0);
    Arc::new(style)
}

/// Hair of one strand, with three guides of the same root.
fn one_strand() -> Arc<Hairstyle> {
    let mut style = Hairstyle::clone(&empty());
    let points: Vec<Vec3> = (0..31).map(|i| Vec3::new(0.08 + 0.004 * i as f32, 0.12, 0.0)).collect();
    (0..3).for_each(|_| style.guides.push(&points));
    style.wisps.push(Wisp { guides: [0, 1, 2], first_strand: 0, strand_count: 1 });
    style.strands = StrandSet {
        wisp: vec![0],
        weights: vec![[0.2, 0.3, 0.5]],
        first_point: vec![0, 2],
        guide_param: vec![0.0, 30.0],
        offset_normal: vec![0.0; 2],
        offset_binormal: vec![0.0; 2],
        offset_tangent: vec![0.0; 2],
        taper: vec![1.0; 2],
        shade: vec![0.5],
        ..StrandSet::default()
    };
    style.check().expect("sound");
    Arc::new(style)
}

#[test]
fn strange_brushes_and_hair_are_harmless() {
    let [empty, one, some] = [empty(), one_strand(), hair(1, 12)];
    for tool in Tool::ALL {
        for inverted in [false, true] {
            for radius in [0.0, 1e-9, 0.5, 1e9, f32::NAN, f32::INFINITY] {
                let settings = BrushSettings { radius, strength: 1.0, keep_lengths: radius < 1.0, ..brush() };
                for style in [&empty, &one, &some] {
                    let mut way = across();
                    way.truncate(6);
                    way[3].position = Vec3::NAN;
                    way[4].drag = Vec3::X * 1e30;
                    let made = stroked((*tool, inverted), &settings, style, &way, &PlainHead);
                    let after = applied(&made.edits, style, &PlainHead);
                    let finite = after.guides.x.iter().chain(&made.frame.guides.y).all(|v| v.is_finite());
                    assert!(finite, "{tool:?} {radius}");
                }
            }
        }
    }
    let made = stroked((Tool::Comb, false), &brush(), &one, &across(), &FREE);
    let off = apart(&applied(&made.edits, &one, &FREE).guides, &made.frame.guides);
    assert_eq!(made.touched, [true; 3]);
    assert!(off < 1e-4, "{off}");
    let edits = HandEdits::default();
    assert!(Brush::new(Tool::Comb, false, &brush(), [&one, &some], &edits, &[]).is_none());
}

#[test]
fn a_hundred_thousand_samples_leave_finite_hair() {
    let style = hair(1, 12);
    // Round and round, a tenth of a millimetre each.
    let at =
        |i: usize| Vec3::new(0.1, 0.08 + 0.02 * (i as f32 * 0.005).cos(), 0.02 * (i as f32 * 0.005).sin());
    let way: Vec<StrokeSample> = (0..100_000)
        .map(|i| StrokeSample {
            position: at(i),
            view: Vec3::NEG_X,
            drag: if i > 0 { at(i) - at(i - 1) } else { Vec3::ZERO },
            pressure: 1.0,
            time_secs: 0.0,
        })
        .collect();
    let made = stroked((Tool::Comb, false), &brush(), &style, &way, &PlainHead);
    assert!(made.frame.guides.x.iter().all(|v| v.is_finite()));
    assert!(brush().clamped() == brush());
}

#[test]
fn a_dab_on_a_thousand_locks_is_quick() {
    let settings = GroomSettings { wisps: 1000, strands_per_wisp: 1, ..GroomSettings::default() };
    let style = Arc::new(grow(&settings, &PlainHead.scalp(48), &PlainHead).expect("hair"));
    for (tool, radius) in [(Tool::Comb, 0.04), (Tool::Smooth, 0.04), (Tool::Comb, 0.5)] {
        let settings = BrushSettings { radius, ..brush() };
        let mut edits = HandEdits::default();
        let mut stroke = None;
        let begun = alone_ms(|| {
            stroke = Brush::new(tool, false, &settings, [&style, &style], &edits, &[]);
        });
        let mut stroke = stroke.expect("a stroke");
        let mut frame = GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0);
        let way = samples(Vec3::new(0.1, 0.08, 0.04), Vec3::new(0.1, 0.08, -0.08), 20);
        let whole = alone_ms(|| {
            for sample in &way {
                stroke.stroke_to(&mut frame, &BrushSurroundings { obstacle: &PlainHead }, sample);
            }
        });
        let each = whole / way.len() as f64;
        stroke.write(&mut edits);
        println!(
            "{tool:?} {radius}: begin {begun} ms, {each} ms per sample of CPU time, {} places",
            edits.count()
        );
        assert!(begun < 4000.0 && each < 2000.0, "{begun} {each}");
    }
}
