use lovelock_style::operations::Curl;
use lovelock_style::{Layer, StyleStack};

use super::*;

fn project() -> Project {
    let mut project = Project::default();
    let mut stack = StyleStack::default();
    stack.push(Layer::of(Curl::default()));
    project.hair.stack = stack;
    project
}

fn differing(a: &Project, b: &Project) -> Vec<(Family, String)> {
    let pairs = varied(a).into_iter().zip(varied(b));
    pairs.filter(|((_, a), (_, b))| a.value != b.value).map(|((family, a), _)| (family, a.path)).collect()
}

#[test]
fn a_seed_gives_one_variant_in_range_and_another_seed_another() {
    let project = project();
    let [one, again, other] = [3, 3, 4].map(|seed| vary(&project, seed, 1.0, &Locks::default()));
    assert_eq!(one, again);
    assert_ne!(one, other);
    assert_eq!(one.sanitised().0, one, "a variant is in range");
    let families: BTreeSet<Family> =
        differing(&project, &one).into_iter().map(|(family, _)| family).collect();
    assert_eq!(families.len(), Family::ALL.len(), "all families vary: {families:?}");
    assert_eq!(vary(&project, 3, 0.0, &Locks::default()), project);
    assert_eq!(vary(&project, 3, f32::NAN, &Locks::default()), project);
}

#[test]
fn locks_hold_and_leave_the_rest_as_it_would_be() {
    let project = project();
    let free = vary(&project, 7, 1.0, &Locks::default());
    let changed = differing(&project, &free);
    let (_, path) =
        changed.iter().find(|(family, _)| *family == Family::Cut).expect("a changed length").clone();
    let locks = Locks { families: [Family::Colour].into(), paths: [path.clone()].into() };
    let locked = differing(&project, &vary(&project, 7, 1.0, &locks));
    let expected: Vec<_> =
        changed.into_iter().filter(|(family, other)| *family != Family::Colour && *other != path).collect();
    assert!(!expected.is_empty());
    assert_eq!(locked, expected);
}

#[test]
fn only_the_hairstyle_and_its_colours_vary() {
    let project = project();
    let variant = vary(&project, 11, 1.0, &Locks::default());
    let mut adopted = project.clone();
    adopt(&mut adopted, &variant);
    assert_eq!(adopted, variant);
    assert_eq!(variant.hair.groom.wisps, project.hair.groom.wisps);
    assert_eq!(variant.hair.groom.seed, project.hair.groom.seed);
    assert_eq!(variant.look.extinction_scale, project.look.extinction_scale);
}

#[test]
fn a_child_has_numbers_of_both_parents_and_none_outside_them() {
    let project = project();
    let [a, b] = [1, 2].map(|seed| vary(&project, seed, 1.0, &Locks::default()));
    let child = breed(&a, &b, 5);
    let (mut of_a, mut of_b) = (0, 0);
    for (((_, a), (_, b)), (_, child)) in varied(&a).into_iter().zip(varied(&b)).zip(varied(&child)) {
        for ((a, b), child) in a.value.numbers().into_iter().zip(b.value.numbers()).zip(child.value.numbers())
        {
            let slack = 1e-6 * a.abs().max(b.abs());
            assert!(child >= a.min(b) - slack && child <= a.max(b) + slack, "{a} {b} {child}");
            of_a += usize::from(a != b && child == a);
            of_b += usize::from(a != b && child == b);
        }
    }
    assert!(of_a > 3 && of_b > 3, "{of_a} {of_b}");
    assert_eq!(breed(&a, &a, 9), a);
}

#[test]
fn hair_of_a_file_varies_without_the_numbers_of_grown_hair() {
    let mut project = project();
    project.hair.source = HairSource::File;
    let paths: Vec<_> = varied(&project).into_iter().map(|(_, entry)| entry.path).collect();
    assert!(paths.iter().all(|path| !path.starts_with("hair.groom.")), "{paths:?}");
    assert!(paths.iter().any(|path| path.starts_with("hair.stack.")), "{paths:?}");
}

#[test]
fn a_row_names_its_layer() {
    let project = project();
    let labels: Vec<_> = varied(&project).iter().map(|(_, entry)| label_of(&project, entry)).collect();
    assert!(labels.iter().any(|label| label == "Curl: Weight"), "{labels:?}");
    assert!(labels.iter().any(|label| label == "Length"), "{labels:?}");
}
