//! Time samples of a crate, of which the times and the place of the values are read once.

use std::collections::HashMap;
use std::sync::Arc;

use crate::UsdError;
use crate::crate_value::CrateValues;
use crate::value::Value;

/// The most times that are kept: 64 MiB.
const MAX_KEPT: usize = 8 << 20;

/// Time samples by the value of their field.
#[derive(Default)]
pub(crate) struct CrateSamples {
    times: HashMap<u64, Arc<[f64]>>,
    /// Number of times that are kept.
    kept: usize,
    /// Position of the first value, and the number of values.
    values: HashMap<u64, Option<(u64, u64)>>,
}

impl CrateSamples {
    /// The times of samples, in time codes.
    pub(crate) fn times(&mut self, file: &mut CrateValues<'_>, stored: u64) -> Result<Arc<[f64]>, UsdError> {
        if let Some(times) = self.times.get(&stored) {
            return Ok(Arc::clone(times));
        }
        let times: Arc<[f64]> = file.times(stored)?.into();
        if self.kept + times.len() > MAX_KEPT {
            (self.times, self.kept) = (HashMap::new(), 0);
        }
        self.kept += times.len();
        self.times.insert(stored, Arc::clone(&times));
        Ok(times)
    }

    /// The value of a sample; `None` if there is no such sample.
    pub(crate) fn value(
        &mut self,
        file: &mut CrateValues<'_>,
        stored: u64,
        sample: usize,
        most: usize,
    ) -> Result<Option<Value>, UsdError> {
        let values = match self.values.get(&stored) {
            Some(values) => *values,
            None => *self.values.entry(stored).or_insert(file.samples(stored)?),
        };
        match values {
            Some((first, count)) if (sample as u64) < count => {
                let value = file.file.u64(first + 8 * sample as u64)?;
                file.value(value, most)
            }
            _ => Ok(None),
        }
    }
}
