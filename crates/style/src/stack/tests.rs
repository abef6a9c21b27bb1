use lovelock_base::settings::{Settings, find, set};

use super::*;
use crate::operations::{Curl, Length, Wave};
use crate::{Mask, MaskPart, MaskRegion, Operation, Ramp};

fn stack() -> StyleStack {
    let mut stack = StyleStack::default();
    for operation in [Operation::from(Length::default()), Wave::default().into(), Curl::default().into()] {
        stack.push(Layer::of(operation));
    }
    stack
}

fn kinds(stack: &StyleStack) -> Vec<&str> {
    stack.layers.iter().map(|layer| layer.operation.id()).collect()
}

#[test]
fn layers_keep_their_numbers_when_they_are_moved() {
    let mut stack = stack();
    assert_eq!(kinds(&stack), ["length", "wave", "curl"]);
    let ids: Vec<u32> = stack.layers.iter().map(|layer| layer.id).collect();
    stack.move_to(ids[2], 0, None);
    assert_eq!(kinds(&stack), ["curl", "length", "wave"]);
    assert_eq!(stack.layer(ids[2]).expect("the layer").operation.id(), "curl");
    set(&mut stack, &format!("{}.weight", ids[2]), "50 %").expect("a weight");
    assert_eq!(stack.layers[0].weight, 0.5);
    let copy = stack.duplicate(ids[0]).expect("room");
    assert!(!ids.contains(&copy));
    assert_eq!(kinds(&stack), ["curl", "length", "length", "wave"]);
    stack.remove(ids[0]);
    assert_eq!(kinds(&stack), ["curl", "length", "wave"]);
    stack.move_to(ids[2], 99, None);
    assert_eq!(kinds(&stack), ["length", "wave", "curl"]);
}

#[test]
fn groups_stay_together_and_switch_their_layers() {
    let mut stack = stack();
    let ids: Vec<u32> = stack.layers.iter().map(|layer| layer.id).collect();
    let group = stack.make_group(&[ids[0], ids[2]], "Volume").expect("a group");
    assert_eq!(kinds(&stack), ["length", "curl", "wave"]);
    stack.groups[0].weight = 0.5;
    let factors =
        |stack: &StyleStack| -> Vec<f32> { stack.layers.iter().map(|layer| stack.factor(layer)).collect() };
    assert_eq!(factors(&stack), [0.5, 0.5, 1.0]);
    stack.groups[0].on = false;
    assert_eq!(factors(&stack), [0.0, 0.0, 1.0]);
    stack.groups[0].on = true;
    stack.solo = Some(ids[2]);
    assert_eq!(factors(&stack), [0.0, 0.5, 0.0]);
    stack.ungroup(group);
    assert!(stack.groups.is_empty() && stack.layers.iter().all(|layer| layer.group.is_none()));
}

#[test]
fn a_group_is_moved_heard_alone_and_removed_as_one() {
    let mut stack = stack();
    let ids: Vec<u32> = stack.layers.iter().map(|layer| layer.id).collect();
    stack.push(Layer::of(crate::operations::Frizz::default()));
    let group = stack.make_group(&ids[..2], "Volume").expect("a group");
    assert_eq!(kinds(&stack), ["length", "wave", "curl", "frizz"]);
    stack.move_group(group, 4);
    assert_eq!(kinds(&stack), ["curl", "frizz", "length", "wave"]);
    stack.move_group(group, 1);
    assert_eq!(kinds(&stack), ["curl", "length", "wave", "frizz"]);
    let other = stack.make_group(&[stack.layers[3].id], "Other").expect("a group");
    stack.move_group(other, 2);
    assert_eq!(kinds(&stack), ["curl", "frizz", "length", "wave"], "before the group and not into it");
    stack.solo_group = Some(group);
    let factors: Vec<f32> = stack.layers.iter().map(|layer| stack.factor(layer)).collect();
    assert_eq!(factors, [0.0, 0.0, 1.0, 1.0]);
    stack.remove_group(group);
    assert_eq!(kinds(&stack), ["curl", "frizz"]);
    assert_eq!((stack.solo_group, stack.groups.len()), (None, 1));
}

#[test]
fn a_stack_survives_text_and_keeps_what_it_does_not_know() {
    let mut stack = stack();
    stack.layers[1].mask = Mask::of(MaskPart::region(MaskRegion::Left));
    stack.layers[2].ramp = Ramp::line(0.0, 1.0);
    stack.layers[2].name = "Ends".to_owned();
    let text = ron::to_string(&stack).expect("text");
    assert_eq!(ron::from_str::<StyleStack>(&text).expect("a stack"), stack);

    let newer = text.replacen("\"wave\"", "\"crystal\"", 1).replacen("\"left\"", "\"ear-tips\"", 1);
    assert_ne!(newer, text);
    let read: StyleStack = ron::from_str(&newer).expect("a stack");
    assert_eq!(
        read.unknown(),
        [("crystal", "crystal"), ("crystal", "ear-tips")].map(|(a, b)| (a.into(), b.into()))
    );
    assert_eq!(ron::to_string(&read).expect("text"), newer, "nothing is lost");
}

#[test]
fn bad_stacks_are_brought_into_order() {
    let mut stack = stack();
    for layer in &mut stack.layers {
        (layer.id, layer.weight, layer.group) = (7, f32::NAN, Some(99));
    }
    stack.layers[0].name = "x\u{7}y".repeat(100);
    stack.solo = Some(3);
    let tidy = stack.clamped();
    let mut ids: Vec<u32> = tidy.layers.iter().map(|layer| layer.id).collect();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), 3);
    assert!(tidy.layers.iter().all(|layer| layer.weight == 1.0 && layer.group.is_none()));
    assert_eq!(tidy.layers[0].name.len(), Layer::LONGEST_NAME);
    assert_eq!(tidy.solo, None);
    let many = StyleStack { layers: vec![Layer::default(); 1000], ..StyleStack::default() }.clamped();
    assert_eq!(many.layers.len(), StyleStack::MAX_LAYERS);
    assert_eq!(many.clone().push(Layer::default()), None);
    assert!(find(&many, "1.length.length").is_some() || find(&many, "1.weight").is_some());
}
