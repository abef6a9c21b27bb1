//! The content of a stage in one file.

use crate::{UsdError, Value};

/// The content of a stage in one file. Prims are numbers that the layer assigns.
pub trait Layer {
    /// The active prims of some types with their types, in the order of their paths.
    ///
    /// # Errors
    /// If the file contradicts itself, as in all methods.
    fn prims(&mut self, types: &[&str]) -> Result<Vec<(usize, String)>, UsdError>;

    /// The prim at a path, active or not.
    fn prim_at(&mut self, path: &str) -> Option<usize>;

    /// The parent of a prim.
    fn parent(&self, prim: usize) -> Option<usize>;

    /// Path of a prim.
    fn path(&self, prim: usize) -> String;

    /// Lets [`Layer::attribute`] return the values at a time code.
    fn set_time(&mut self, time: f64);

    /// Value of an attribute at its first time sample, or at the last one up to the time that is set, otherwise its default. `most` limits the
    /// length of compressed arrays.
    ///
    /// # Errors
    /// See [`Layer::prims`].
    fn attribute(&mut self, prim: usize, name: &str, most: usize) -> Result<Option<Value>, UsdError>;

    /// Times at which an attribute has samples, in time codes, ascending; empty without samples.
    ///
    /// # Errors
    /// See [`Layer::prims`].
    fn sample_times(&mut self, prim: usize, name: &str) -> Result<Vec<f64>, UsdError>;

    /// Value of the sample of a number, as [`Layer::sample_times`] counts them.
    ///
    /// # Errors
    /// See [`Layer::prims`].
    fn sample(
        &mut self,
        prim: usize,
        name: &str,
        sample: usize,
        most: usize,
    ) -> Result<Option<Value>, UsdError>;

    /// A metadata field of an attribute, such as its interpolation.
    ///
    /// # Errors
    /// See [`Layer::prims`].
    fn field(&mut self, prim: usize, attribute: &str, field: &str) -> Result<Option<Value>, UsdError>;

    /// The paths that a relationship of a prim points at.
    ///
    /// # Errors
    /// See [`Layer::prims`].
    fn targets(&mut self, prim: usize, relationship: &str) -> Result<Vec<String>, UsdError>;

    /// A metadata field of the stage.
    ///
    /// # Errors
    /// See [`Layer::prims`].
    fn metadata(&mut self, name: &str) -> Result<Option<Value>, UsdError>;

    /// Whether the file refers to other files or to variants.
    fn composes(&self) -> bool;

    /// An error about this file.
    fn malformed(&self, found: String, wanted: &str) -> UsdError;
}

/// The number of the last of `samples`, which ascend in time, up to `time`; that of the first one before it.
pub(crate) fn sample_at<T>(samples: &[T], time_of: impl Fn(&T) -> f64, time: f64) -> usize {
    samples.partition_point(|sample| time_of(sample) <= time).saturating_sub(1)
}
