use glam::{Vec2, Vec3};
use lovelock_groom::{GroomSettings, Guides, Haircut, PlainHead, StrandSet, TieKind, grow};

use super::*;
use crate::hand::{HandChannel, HandEdit, HandRoots};
use crate::operations::{Curl, HairTie, Hand, Length, Scissors, Wave};
use crate::{Mask, MaskPart, MaskRegion, Operation, Ramp};

fn base() -> Arc<Hairstyle> {
    let settings = GroomSettings { wisps: 12, strands_per_wisp: 3, length: 0.5, ..GroomSettings::default() };
    Arc::new(grow(&settings, &PlainHead.scalp(16), &PlainHead).expect("hair"))
}

fn shape(style: &Hairstyle) -> (&Guides, &StrandSet, &[f32]) {
    (&style.guides, &style.strands, &style.held)
}

/// Leaves the fraction `kept` of every guide.
fn cut(style: &Hairstyle, kept: f32) -> Layer {
    let kept = vec![kept; style.guides.count()];
    Layer::of(Scissors { cut: Haircut { first_root: style.guides.point(0, 0), kept } })
}

/// Turns and curls every guide.
fn combed(style: &Hairstyle) -> Layer {
    let mut edit = HandEdit { turns: vec![Vec2::new(0.2, 0.1); 30], ..HandEdit::default() };
    edit.channel_mut(HandChannel::Curl, 30).fill(0.01);
    let mut hand = Hand::default();
    hand.edits.change(&HandRoots::of(style), (0..style.guides.count()).map(|guide| (guide, edit.clone())));
    Layer::of(hand)
}

fn tie(kind: TieKind) -> Layer {
    Layer::of(HairTie { kind, ..HairTie::default() })
}

fn stack(layers: impl IntoIterator<Item = Layer>) -> StyleStack {
    let mut stack = StyleStack::default();
    for layer in layers {
        stack.push(layer);
    }
    stack
}

/// Applies a stack and returns how many layers were computed.
fn counted(
    cache: &mut StyleCache,
    base: &Arc<Hairstyle>,
    stack: &StyleStack,
    head: &Arc<dyn Obstacle + Send>,
) -> (Styled, usize) {
    let mut count = 0;
    let made = cache.fold(base, stack, Arc::clone(head), |layer, factor, style| {
        count += 1;
        apply_layer(layer, factor, style, &**head)
    });
    (made, count)
}

#[test]
fn a_stack_gives_what_its_layers_give_one_after_another() {
    let base = base();
    let stack = stack([cut(&base, 0.8), tie(TieKind::Ponytail), cut(&base, 0.6)]);
    let mut expected = Hairstyle::clone(&base);
    for layer in &stack.layers {
        expected = apply_layer(layer, 1.0, &expected, &PlainHead).expect("a change");
    }
    let made = StyleCache::default().apply(&base, &stack, Arc::new(PlainHead));
    assert_eq!(shape(&made.style), shape(&expected));
    assert!(made.skipped.is_empty());
    assert_ne!(expected.guides, base.guides);
}

#[test]
fn hairstyles_between_layers_stay_within_their_memory() {
    let base = base();
    let head: Arc<dyn Obstacle + Send> = Arc::new(PlainHead);
    let mut stack = stack((0..8).map(|k| cut(&base, 0.95 - 0.05 * k as f32)));
    // A layer without effect has the hairstyle of the one before.
    stack.layers[5].weight = 0.0;
    let mut all = StyleCache::default();
    let (expected, _) = counted(&mut all, &base, &stack, &head);
    let most_bytes = all.bytes() / 3;
    let mut cache = StyleCache { most_bytes, ..StyleCache::default() };
    let (made, count) = counted(&mut cache, &base, &stack, &head);
    assert_eq!((count, shape(&made.style)), (8, shape(&expected.style)));
    assert!(cache.bytes() <= most_bytes && cache.bytes() > 0, "{} of {most_bytes}", cache.bytes());
    // What is kept is used: late layers again, early ones from the start.
    stack.layers[7] = Layer { id: stack.layers[7].id, ..cut(&base, 0.3) };
    assert_eq!(counted(&mut cache, &base, &stack, &head).1, 1);
    stack.layers[1] = Layer { id: stack.layers[1].id, ..cut(&base, 0.85) };
    let (made, count) = counted(&mut cache, &base, &stack, &head);
    assert_eq!(count, 8);
    assert_eq!(shape(&made.style), shape(&counted(&mut StyleCache::default(), &base, &stack, &head).0.style));
    assert!(cache.bytes() <= most_bytes);
    // The result is kept whatever it takes.
    let mut none = StyleCache { most_bytes: 0, ..StyleCache::default() };
    counted(&mut none, &base, &stack, &head);
    assert_eq!(counted(&mut none, &base, &stack, &head).1, 0);
}

#[test]
fn only_changed_layers_and_later_ones_are_computed() {
    let base = base();
    let head: Arc<dyn Obstacle + Send> = Arc::new(PlainHead);
    let mut stack = stack([cut(&base, 0.9), tie(TieKind::Ponytail), cut(&base, 0.7)]);
    let mut cache = StyleCache::default();
    let (first, count) = counted(&mut cache, &base, &stack, &head);
    assert_eq!(count, 3);
    let (same, count) = counted(&mut cache, &base, &stack, &head);
    assert!(count == 0 && Arc::ptr_eq(&same.style, &first.style));
    stack.layers[1].name = "A name changes no hair".to_owned();
    assert_eq!(counted(&mut cache, &base, &stack, &head).1, 0);
    for (changed, layer) in [(2, cut(&base, 0.5)), (1, tie(TieKind::Bun)), (0, cut(&base, 0.8))] {
        stack.layers[changed] = Layer { id: stack.layers[changed].id, ..layer };
        let (cached, count) = counted(&mut cache, &base, &stack, &head);
        assert_eq!(count, 3 - changed, "layer {changed}");
        let (afresh, _) = counted(&mut StyleCache::default(), &base, &stack, &head);
        assert_eq!(shape(&cached.style), shape(&afresh.style), "layer {changed}");
    }
    stack.solo = Some(stack.layers[2].id);
    assert_eq!(counted(&mut cache, &base, &stack, &head).1, 3, "another factor");
    stack.solo = None;
    counted(&mut cache, &base, &stack, &head);
    stack.layers.truncate(1);
    assert_eq!(counted(&mut cache, &base, &stack, &head).1, 0, "fewer layers");
    assert_eq!(counted(&mut cache, &Arc::new(Hairstyle::clone(&base)), &stack, &head).1, 1, "another base");
    let other: Arc<dyn Obstacle + Send> = Arc::new(PlainHead);
    assert_eq!(counted(&mut cache, &base, &stack, &other).1, 1, "another obstacle");
}

/// One layer of every kind.
fn every_kind(base: &Hairstyle) -> Vec<Layer> {
    let new = |kind: &crate::Kind| Layer::of(Operation::new(kind.id).expect("its kind"));
    let mut layers: Vec<Layer> = Operation::KINDS.iter().map(new).collect();
    for layer in &mut layers {
        if layer.operation.id() == "scissors" {
            *layer = cut(base, 0.5);
        }
        if layer.operation.id() == "hand" {
            *layer = combed(base);
        }
    }
    layers
}

#[test]
fn every_operation_acts_and_does_nothing_without_weight_mask_or_ramp() {
    let base = base();
    for layer in every_kind(&base) {
        let kind = layer.operation.id().to_owned();
        let acted = StyleCache::default().apply(&base, &stack([layer.clone()]), Arc::new(PlainHead));
        assert!(!Arc::ptr_eq(&acted.style, &base), "{kind} acts");
        acted.style.check().unwrap_or_else(|error| panic!("{kind}: {error}"));
        assert_ne!(format!("{:?}", acted.style), format!("{base:?}"), "{kind} changes something");
        let nowhere = Mask { parts: Vec::new(), inverted: true };
        for idle in [
            Layer { weight: 0.0, ..layer.clone() },
            Layer { on: false, ..layer.clone() },
            Layer { mask: nowhere, ..layer.clone() },
            Layer { ramp: Ramp::constant(0.0), ..layer.clone() },
        ] {
            let made = StyleCache::default().apply(&base, &stack([idle]), Arc::new(PlainHead));
            assert!(Arc::ptr_eq(&made.style, &base), "{kind} is idle");
        }
    }
}

#[test]
fn every_operation_leaves_hair_outside_its_mask_as_it_is() {
    let base = base();
    let left = Mask::of(MaskPart { softness: 0.0, ..MaskPart::region(MaskRegion::Left) });
    for layer in every_kind(&base) {
        let kind = layer.operation.id().to_owned();
        let masked = Layer { mask: left.clone(), ..layer };
        let made = StyleCache::default().apply(&base, &stack([masked]), Arc::new(PlainHead)).style;
        let head = crate::HeadBox::of(&base.scalp);
        let mut outside = 0;
        for (w, wisp) in base.wisps.iter().enumerate() {
            let right = wisp.guides.iter().all(|&g| left.at(&head, base.guides.point(g as usize, 0)) == 0.0);
            if !right {
                continue;
            }
            outside += 1;
            for g in wisp.guides {
                for p in 0..base.guides.points_per_guide {
                    assert_eq!(
                        made.guides.point(g as usize, p),
                        base.guides.point(g as usize, p),
                        "{kind}, wisp {w}"
                    );
                }
            }
            for g in wisp.guides {
                let points = base.guides.points_per_guide;
                for (name, list) in made.motion.lists() {
                    let own = list.get(g as usize * points..(g as usize + 1) * points).unwrap_or(&[]);
                    assert!(own.iter().all(|factor| *factor == 1.0), "{kind}, {name}, wisp {w}");
                }
            }
            assert_eq!(made.wisps[w].strand_count, wisp.strand_count, "{kind}, wisp {w}");
            for strand in 0..wisp.strand_count {
                let of = |style: &Hairstyle| {
                    let set = &style.strands;
                    let strand = (style.wisps[w].first_strand + strand) as usize;
                    let range = set.first_point[strand] as usize..set.first_point[strand + 1] as usize;
                    (set.guide_param[range.clone()].to_vec(), set.offset_normal[range].to_vec())
                };
                assert_eq!(of(&made), of(&base), "{kind}, wisp {w}, strand {strand}");
            }
        }
        assert!(outside > 2, "the mask leaves some wisps out");
    }
}

#[test]
fn layers_of_other_hair_and_of_other_versions_are_skipped() {
    let base = base();
    let of_other_hair = Scissors { cut: Haircut { first_root: Vec3::ONE, kept: vec![0.5; 3] } };
    let unknown =
        Operation::Unknown(crate::UnknownOperation { id: "crystal".to_owned(), ..Default::default() });
    let stack = stack([Layer::of(of_other_hair), Layer { operation: unknown, ..Layer::default() }]);
    let made = StyleCache::default().apply(&base, &stack, Arc::new(PlainHead));
    assert!(Arc::ptr_eq(&made.style, &base));
    assert_eq!(made.skipped, ["Scissors"]);
}

#[test]
fn ties_that_gather_nothing_are_found_each_time() {
    let base = base();
    let far = HairTie { at: Vec3::new(0.0, 0.6, -0.6), ..HairTie::default() };
    // A layer without weight is not meant to act.
    let idle = Layer { weight: 0.0, ..Layer::of(far) };
    let mut stack = stack([tie(TieKind::Ponytail), Layer::of(far), idle, cut(&base, 0.9)]);
    let mut cache = StyleCache::default();
    let head: Arc<dyn Obstacle + Send> = Arc::new(PlainHead);
    let (made, count) = counted(&mut cache, &base, &stack, &head);
    assert_eq!((made.idle_ties, count), (vec![1], 4));
    let (made, count) = counted(&mut cache, &base, &stack, &head);
    assert_eq!((made.idle_ties, count), (vec![1], 0), "what is kept tells it too");
    stack.layers.remove(1);
    assert!(counted(&mut cache, &base, &stack, &head).0.idle_ties.is_empty(), "the ponytail gathers hair");
}

#[test]
fn two_hundred_layers_leave_sound_hair() {
    let base = base();
    let layers = (0..200).map(|i| {
        let operation: Operation = match i % 4 {
            0 => Wave { height: 0.05, ..Wave::default() }.into(),
            1 => Length { factor: 1.3, ..Length::default() }.into(),
            2 => Curl { pitch: 0.03, ..Curl::default() }.into(),
            _ => Length { factor: 0.7, ..Length::default() }.into(),
        };
        Layer { seed: i, weight: 2.0, ..Layer::of(operation) }
    });
    let made = StyleCache::default().apply(&base, &stack(layers), Arc::new(PlainHead)).style;
    made.check().expect("sound");
    assert!(made.guides.x.iter().chain(&made.strands.offset_normal).all(|v| v.is_finite()));
    assert!(made.strands.points() as u64 <= u64::from(lovelock_groom::MAX_POINTS));
    let longest = (0..made.guides.count())
        .map(|g| (1..31).map(|p| made.guides.point(g, p).distance(made.guides.point(g, p - 1))).sum::<f32>())
        .fold(0.0, f32::max);
    assert!(longest < 1.6, "{longest} m");
}
