//! The samples of one property, of which only the addresses are in memory.

use crate::pod::{DataType, Pod};

/// A sample in the file, which several properties may share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stored {
    pub(super) at: u64,
    pub(super) digest: [u8; 16],
    /// Number of elements.
    pub(super) elements: u64,
    /// The address of the number of elements; empty data where it follows from the bytes.
    pub(super) dimensions: u64,
}

/// The samples of a scalar or an array over time.
#[derive(Clone, Debug)]
pub struct Samples {
    /// The type of its elements.
    pub ty: DataType,
    pub(super) is_array: bool,
    /// The index of its times in the archive.
    pub(super) times: u32,
    /// Number of samples.
    pub(super) count: u64,
    pub(super) first_changed: u64,
    pub(super) last_changed: u64,
    pub(super) is_single: bool,
    pub(super) is_homogeneous: bool,
    last: Option<Stored>,
    /// Addresses, as the children of the property's group.
    pub(super) children: Vec<u64>,
}

impl Samples {
    /// A property whose samples are one element each. `times` is from [`ArchiveWriter::add_times`](super::ArchiveWriter::add_times).
    pub fn scalar(ty: DataType, times: u32) -> Self {
        Self::new(ty, times, false)
    }

    /// A property whose samples are arrays of elements.
    pub fn array(ty: DataType, times: u32) -> Self {
        Self::new(ty, times, true)
    }

    fn new(ty: DataType, times: u32, is_array: bool) -> Self {
        Self {
            ty,
            is_array,
            times,
            count: 0,
            first_changed: 0,
            last_changed: 0,
            is_single: true,
            is_homogeneous: true,
            last: None,
            children: Vec::new(),
        }
    }

    /// Adds a sample. A sample equal to the one before takes no room.
    pub fn push(&mut self, stored: Stored) {
        if let Some(last) = self.last {
            if last.digest == stored.digest && last.elements == stored.elements {
                self.count += 1;
                return;
            }
            // Equal samples are left out before the first change and after the last one only.
            if self.first_changed > 0 {
                for _ in self.last_changed + 1..self.count {
                    self.list(last);
                }
            } else {
                self.first_changed = self.count;
            }
            self.last_changed = self.count;
            self.is_homogeneous &= last.elements == stored.elements;
        }
        self.list(stored);
        self.is_single &= stored.elements == 1;
        self.last = Some(stored);
        self.count += 1;
    }

    /// Repeats the last sample, if there is one.
    pub fn repeat(&mut self) {
        self.count += u64::from(self.last.is_some());
    }

    fn list(&mut self, stored: Stored) {
        self.children.push(stored.at);
        if self.is_array {
            self.children.push(stored.dimensions);
        }
    }

    /// Whether its type is text, whose lengths the bytes do not tell.
    pub(super) fn is_text(ty: DataType) -> bool {
        matches!(ty.pod, Pod::String | Pod::WideString)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stored(value: u8) -> Stored {
        Stored { at: u64::from(value), digest: [value; 16], elements: 1, dimensions: 100 }
    }

    #[test]
    fn equal_samples_are_stored_once_at_both_ends() {
        let mut samples = Samples::scalar(DataType::new(Pod::F32, 1), 0);
        for value in [1, 1, 2, 2, 3, 3, 3] {
            samples.push(stored(value));
        }
        samples.repeat();
        assert_eq!((samples.count, samples.first_changed, samples.last_changed), (8, 2, 4));
        assert_eq!(samples.children, [1, 2, 2, 3]);
        let mut constant = Samples::array(DataType::new(Pod::F32, 1), 0);
        constant.repeat();
        constant.push(stored(7));
        constant.repeat();
        assert_eq!((constant.count, constant.first_changed, constant.last_changed), (2, 0, 0));
        assert_eq!(constant.children, [7, 100]);
    }
}
