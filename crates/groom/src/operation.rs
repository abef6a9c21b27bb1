//! Operations on a hairstyle after it is grown or imported, applied one after another.

use std::sync::Arc;

use crate::{HairTie, Haircut, Hairstyle, Obstacle, tied, trimmed};

/// A change of a hairstyle. A new operation is a variant here, and an arm in each match below.
#[derive(Clone, Debug, PartialEq)]
pub enum HairOperation {
    /// Shortens guides and strands ([`trimmed`]).
    Cut(Haircut),
    /// Gathers hair by ties ([`tied`]).
    Tie(Vec<HairTie>),
}

impl HairOperation {
    /// Name in sentences.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Cut(_) => "cut",
            Self::Tie(_) => "tie",
        }
    }

    /// Whether the operation would leave every hairstyle as it is.
    fn is_empty(&self) -> bool {
        match self {
            Self::Cut(cut) => cut.is_empty(),
            Self::Tie(ties) => ties.is_empty(),
        }
    }

    /// Whether the operation was made for this hairstyle.
    fn fits(&self, style: &Hairstyle) -> bool {
        match self {
            Self::Cut(cut) => cut.fits(&style.guides),
            Self::Tie(_) => true,
        }
    }

    /// The hairstyle after the operation. `obstacle` is the body without hair.
    pub fn apply(&self, style: &Hairstyle, obstacle: &dyn Obstacle) -> Hairstyle {
        match self {
            Self::Cut(cut) => trimmed(style, cut),
            Self::Tie(ties) => tied(style, ties, obstacle),
        }
    }
}

/// Applies lists of operations and keeps the hairstyle after each one, so that a change of one operation recomputes only
/// that one and those after it.
#[derive(Default)]
pub struct OperationCache {
    start: Option<(Arc<Hairstyle>, Arc<dyn Obstacle + Send>)>,
    steps: Vec<Step>,
}

/// An operation and the hairstyle after it.
struct Step {
    operation: HairOperation,
    style: Arc<Hairstyle>,
    fits: bool,
}

/// The result of a list of operations.
#[derive(Debug)]
pub struct OperationResult {
    /// The hairstyle after all operations; the base itself if none has an effect.
    pub style: Arc<Hairstyle>,
    /// The operations that were skipped because they were made for another hairstyle.
    pub skipped: Vec<HairOperation>,
}

impl OperationCache {
    /// Applies `operations` to `base` in their order. Results are reused for the first operations that are the same as in
    /// the last call, if that one had the same `base` and `obstacle` (the same allocations).
    pub fn apply(
        &mut self,
        base: &Arc<Hairstyle>,
        operations: Vec<HairOperation>,
        obstacle: Arc<dyn Obstacle + Send>,
    ) -> OperationResult {
        let body = Arc::clone(&obstacle);
        self.fold(base, operations, obstacle, |operation, style| operation.apply(style, &*body))
    }

    fn fold(
        &mut self,
        base: &Arc<Hairstyle>,
        operations: Vec<HairOperation>,
        obstacle: Arc<dyn Obstacle + Send>,
        mut compute: impl FnMut(&HairOperation, &Hairstyle) -> Hairstyle,
    ) -> OperationResult {
        let same_start = self.start.as_ref().is_some_and(|(style, body)| {
            Arc::ptr_eq(style, base) && std::ptr::addr_eq(Arc::as_ptr(body), Arc::as_ptr(&obstacle))
        });
        let kept = if same_start {
            self.steps
                .iter()
                .zip(&operations)
                .take_while(|(step, operation)| step.operation == **operation)
                .count()
        } else {
            0
        };
        self.start = Some((Arc::clone(base), obstacle));
        self.steps.truncate(kept);
        for operation in operations.into_iter().skip(kept) {
            let before = self.steps.last().map_or(base, |step| &step.style);
            let fits = operation.is_empty() || operation.fits(before);
            let style = if operation.is_empty() || !fits {
                Arc::clone(before)
            } else {
                Arc::new(compute(&operation, before))
            };
            self.steps.push(Step { operation, style, fits });
        }
        OperationResult {
            style: Arc::clone(self.steps.last().map_or(base, |step| &step.style)),
            skipped: self.steps.iter().filter(|step| !step.fits).map(|step| step.operation.clone()).collect(),
        }
    }
}

impl std::fmt::Debug for OperationCache {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_list().entries(self.steps.iter().map(|step| &step.operation)).finish()
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::{GroomSettings, Guides, PlainHead, StrandSet, TieKind, grow};

    fn base() -> Arc<Hairstyle> {
        let settings =
            GroomSettings { wisps: 12, strands_per_wisp: 3, length: 0.5, ..GroomSettings::default() };
        Arc::new(grow(&settings, &PlainHead.scalp(16), &PlainHead).expect("hair"))
    }

    fn shape(style: &Hairstyle) -> (&Guides, &StrandSet, &[f32]) {
        (&style.guides, &style.strands, &style.held)
    }

    /// Leaves the fraction `kept` of every guide.
    fn cut(style: &Hairstyle, kept: f32) -> HairOperation {
        let kept = vec![kept; style.guides.count()];
        HairOperation::Cut(Haircut { first_root: style.guides.point(0, 0), kept })
    }

    fn tie(kind: TieKind) -> HairOperation {
        HairOperation::Tie(vec![HairTie { kind, ..HairTie::default() }])
    }

    /// Applies operations and returns how many were computed.
    fn counted(
        cache: &mut OperationCache,
        base: &Arc<Hairstyle>,
        operations: &[HairOperation],
        head: &Arc<dyn Obstacle + Send>,
    ) -> (OperationResult, usize) {
        let mut count = 0;
        let made = cache.fold(base, operations.to_vec(), Arc::clone(head), |operation, style| {
            count += 1;
            operation.apply(style, &**head)
        });
        (made, count)
    }

    #[test]
    fn a_list_gives_what_its_operations_give_one_after_another() {
        let base = base();
        let operations = [cut(&base, 0.8), tie(TieKind::Ponytail), cut(&base, 0.6)];
        let mut expected = Hairstyle::clone(&base);
        for operation in &operations {
            expected = operation.apply(&expected, &PlainHead);
        }
        let made = OperationCache::default().apply(&base, operations.to_vec(), Arc::new(PlainHead));
        assert_eq!(shape(&made.style), shape(&expected));
        assert!(made.skipped.is_empty());
        assert_ne!(expected.guides, base.guides);
    }

    #[test]
    fn only_changed_operations_and_later_ones_are_computed() {
        let base = base();
        let head: Arc<dyn Obstacle + Send> = Arc::new(PlainHead);
        let mut operations = [cut(&base, 0.9), tie(TieKind::Ponytail), cut(&base, 0.7)];
        let mut cache = OperationCache::default();
        let (first, count) = counted(&mut cache, &base, &operations, &head);
        assert_eq!(count, 3);
        let (same, count) = counted(&mut cache, &base, &operations, &head);
        assert!(count == 0 && Arc::ptr_eq(&same.style, &first.style));
        for (changed, operation) in [(2, cut(&base, 0.5)), (1, tie(TieKind::Bun)), (0, cut(&base, 0.8))] {
            operations[changed] = operation;
            let (cached, count) = counted(&mut cache, &base, &operations, &head);
            assert_eq!(count, 3 - changed, "operation {changed}");
            let (afresh, _) = counted(&mut OperationCache::default(), &base, &operations, &head);
            assert_eq!(shape(&cached.style), shape(&afresh.style), "operation {changed}");
        }
        assert_eq!(counted(&mut cache, &base, &operations[..1], &head).1, 0, "fewer operations");
        assert_eq!(
            counted(&mut cache, &Arc::new(Hairstyle::clone(&base)), &operations, &head).1,
            3,
            "another base"
        );
        let other: Arc<dyn Obstacle + Send> = Arc::new(PlainHead);
        assert_eq!(counted(&mut cache, &base, &operations, &other).1, 3, "another obstacle");
    }

    #[test]
    fn operations_without_effect_keep_the_same_hairstyle() {
        let base = base();
        let empty = vec![HairOperation::Cut(Haircut::default()), HairOperation::Tie(Vec::new())];
        let made = OperationCache::default().apply(&base, empty, Arc::new(PlainHead));
        assert!(Arc::ptr_eq(&made.style, &base) && made.skipped.is_empty());
        let of_other_hair = HairOperation::Cut(Haircut { first_root: Vec3::ONE, kept: vec![0.5; 3] });
        let made = OperationCache::default().apply(&base, vec![of_other_hair.clone()], Arc::new(PlainHead));
        assert!(Arc::ptr_eq(&made.style, &base));
        assert_eq!(made.skipped, [of_other_hair]);
    }
}
