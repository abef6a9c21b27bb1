//! A stage whose errors are those of hair files.

use glam::DMat4;
use lovelock_usd::{CRATE_MAGIC, Layer, Primvar, StageSpace, Undrawn, UsdError, Value};

use super::HairFileError;
use crate::io::file::Hidden;
use crate::io::source::Source;

/// The content of a stage in one file. Prims are numbers.
pub(super) struct Stage<'a>(Box<dyn Layer + Send + 'a>);

impl<'a> Stage<'a> {
    pub(super) fn open(name: &str, source: Source<'a>) -> Result<Self, HairFileError> {
        let is_crate = source.start().starts_with(CRATE_MAGIC);
        let source = match source {
            Source::Memory(data) => lovelock_usd::Source::Memory(data),
            Source::File { file, length, .. } => lovelock_usd::Source::File(file, length),
        };
        lovelock_usd::open(name, source, is_crate).map(Self).map_err(refused)
    }

    /// The active prims of type `BasisCurves`, in the order of their paths.
    pub(super) fn curves(&mut self) -> Result<Vec<usize>, HairFileError> {
        let prims = self.0.prims(&["BasisCurves"]).map_err(refused)?;
        Ok(prims.into_iter().map(|(prim, _)| prim).collect())
    }

    /// The active prims of type `Mesh`, in the order of their paths.
    pub(super) fn meshes(&mut self) -> Result<Vec<usize>, HairFileError> {
        let prims = self.0.prims(&["Mesh"]).map_err(refused)?;
        Ok(prims.into_iter().map(|(prim, _)| prim).collect())
    }

    /// Number of prims of curves that are not on the stage.
    pub(super) fn undefined_curves(&mut self) -> Result<usize, HairFileError> {
        self.0.undefined(&["BasisCurves"]).map_err(refused)
    }

    /// Why the curves of a prim are not drawn, and whether that changes over time.
    pub(super) fn hidden(&mut self, prim: usize) -> Result<(Option<Hidden>, bool), HairFileError> {
        let start = self.times(prim, "points")?.first().copied();
        let why = lovelock_usd::undrawn(&mut *self.0, prim, start).map_err(refused)?;
        let why = why.map(|why| match why {
            Undrawn::Invisible => Hidden::Invisible,
            Undrawn::StandIn => Hidden::StandIn,
            Undrawn::Prototype => Hidden::Prototype,
        });
        Ok((why, lovelock_usd::visibility_changes(&mut *self.0, prim).map_err(refused)?))
    }

    /// Path of a prim, for messages.
    pub(super) fn path(&self, prim: usize) -> String {
        self.0.path(prim)
    }

    /// Value of an attribute at its first time sample or at the time that is set, otherwise its default. `most` limits the length of compressed
    /// arrays.
    pub(super) fn attribute(
        &mut self,
        prim: usize,
        name: &str,
        most: usize,
    ) -> Result<Option<Value>, HairFileError> {
        self.0.attribute(prim, name, most).map_err(refused)
    }

    /// Lets [`Self::attribute`] return the values at a time code.
    pub(super) fn set_time(&mut self, time: f64) {
        self.0.set_time(time);
    }

    /// The time codes of an attribute's samples; none without samples.
    pub(super) fn times(&mut self, prim: usize, name: &str) -> Result<Vec<f64>, HairFileError> {
        self.0.sample_times(prim, name).map_err(refused)
    }

    /// Whether the samples of an attribute differ.
    pub(super) fn changes(&mut self, prim: usize, name: &str) -> Result<bool, HairFileError> {
        let samples = self.times(prim, name)?.len();
        let mut sample = |k| self.0.sample(prim, name, k, usize::MAX).map_err(refused);
        let first = if samples > 1 { sample(0)? } else { None };
        for k in 1..samples {
            if sample(k)? != first {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// The time codes at which the transform of a prim or of an ancestor changes.
    pub(super) fn transform_times(&mut self, prim: usize) -> Result<Vec<f64>, HairFileError> {
        lovelock_usd::transform_times(&mut *self.0, prim).map_err(refused)
    }

    /// A primvar of a prim, its own or inherited, named without `primvars:`.
    pub(super) fn primvar(
        &mut self,
        prim: usize,
        name: &str,
        most: usize,
    ) -> Result<Option<Primvar>, HairFileError> {
        lovelock_usd::primvar(&mut *self.0, prim, name, most).map_err(refused)
    }

    /// A metadata field of the stage.
    pub(super) fn metadata(&mut self, name: &str) -> Result<Option<Value>, HairFileError> {
        self.0.metadata(name).map_err(refused)
    }

    /// Unit and axis of the stage.
    pub(super) fn space(&mut self) -> Result<StageSpace, HairFileError> {
        lovelock_usd::stage_space(&mut *self.0).map_err(refused)
    }

    /// The transform from a prim's own space to the stage.
    pub(super) fn transform(&mut self, prim: usize) -> Result<DMat4, HairFileError> {
        lovelock_usd::to_stage(&mut *self.0, prim).map_err(refused)
    }

    /// What the file composes of that is not read, as a remark.
    pub(super) fn left_out_arcs(&self) -> Option<String> {
        lovelock_usd::left_out_arcs(&*self.0)
    }

    /// An error about this file.
    pub(super) fn malformed(&self, found: String, wanted: &str) -> HairFileError {
        refused(self.0.malformed(found, wanted))
    }
}

fn refused(error: UsdError) -> HairFileError {
    match error {
        UsdError::Io { name, source } => HairFileError::Io { name, source },
        UsdError::Malformed { name, offset, found, wanted } => {
            HairFileError::Malformed { name, offset, found, wanted }
        }
    }
}
