//! Accessors that several primitives share, so that each is decoded once.

use std::collections::HashMap;
use std::rc::Rc;

/// The most elements that are kept for later primitives: 1 GiB of positions.
const MAX_KEPT: usize = 1 << 26;

/// The decoded accessors of one attribute.
pub(super) struct Shared<T> {
    /// How often each accessor will still be asked for.
    uses: HashMap<usize, usize>,
    kept: HashMap<usize, Rc<[T]>>,
    /// Number of elements that are kept.
    size: usize,
}

impl<T> Shared<T> {
    /// For accessors in the order in which they will be asked for, each as often as it will be.
    pub(super) fn new(accessors: impl Iterator<Item = usize>) -> Self {
        let mut uses = HashMap::new();
        for accessor in accessors {
            *uses.entry(accessor).or_default() += 1;
        }
        Self { uses, kept: HashMap::new(), size: 0 }
    }

    /// The elements of an accessor. They are kept until it was asked for the last time, if they are not too many.
    pub(super) fn get<E>(
        &mut self,
        accessor: usize,
        read: impl FnOnce() -> Result<Vec<T>, E>,
    ) -> Result<Rc<[T]>, E> {
        let left = self.uses.get_mut(&accessor).map_or(0, |uses| {
            *uses = uses.saturating_sub(1);
            *uses
        });
        if left == 0 {
            if let Some(known) = self.kept.remove(&accessor) {
                self.size -= known.len();
                return Ok(known);
            }
            return Ok(read()?.into());
        }
        if let Some(known) = self.kept.get(&accessor) {
            return Ok(Rc::clone(known));
        }
        let elements: Rc<[T]> = read()?.into();
        if self.size + elements.len() <= MAX_KEPT {
            self.size += elements.len();
            self.kept.insert(accessor, Rc::clone(&elements));
        }
        Ok(elements)
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    #[test]
    fn each_accessor_is_read_once_and_freed_after_its_last_use() {
        let order = [3, 4, 3, 5, 3, 4];
        let mut shared = Shared::new(order.into_iter());
        let reads = Cell::new(0);
        for (step, accessor) in order.into_iter().enumerate() {
            let found = shared.get(accessor, || {
                reads.set(reads.get() + 1);
                Ok::<_, ()>(vec![accessor; 2])
            });
            assert_eq!(found.expect("elements")[..], [accessor; 2]);
            let kept = [1, 2, 2, 2, 1, 0][step];
            assert_eq!((shared.kept.len(), shared.size), (kept, 2 * kept), "step {step}");
        }
        assert_eq!(reads.get(), 3);
        // The control: without knowing how often they are used, each is read again.
        let mut shared = Shared::new(std::iter::empty());
        for accessor in order {
            let read = || Ok::<_, ()>(vec![reads.replace(reads.get() + 1)]);
            assert!(shared.get(accessor, read).is_ok() && shared.kept.is_empty());
        }
        assert_eq!(reads.get(), 9);
    }
}
