//! A USD layer whose animated arrays are in a [`Spool`], for the writers of the `openusd` library.

use std::borrow::Cow;
use std::cell::RefCell;
use std::collections::HashMap;
use std::io;

use openusd::gf::Vec3f;
use openusd::sdf::{
    AbstractData, ChildrenKey, Data, DataError, Path, PathListOp, SpecData, SpecType, Specifier, TokenListOp,
    Value, Variability,
};
use openusd::tf::Token;

use super::spool::Spool;

/// The field with an attribute's values over time.
const TIME_SAMPLES: &str = "timeSamples";

/// A range of vectors in each frame of a spool.
#[derive(Clone, Copy, Debug)]
pub(super) struct Track {
    /// Index of the first vector in a frame.
    pub(super) first: usize,
    /// Number of vectors.
    pub(super) count: usize,
}

/// Scene description. It is in memory except for the large arrays, which are read from the spool while they are written.
pub(super) struct SpooledLayer {
    data: Data,
    tracks: HashMap<Path, Track>,
    spool: RefCell<Spool>,
    first_frame: u64,
    is_text: bool,
    /// The first error while reading the spool, because the library's text writer treats an error as a missing field.
    failed: RefCell<Option<io::Error>>,
}

impl SpooledLayer {
    pub(super) fn new(spool: Spool, first_frame: u64, is_text: bool) -> Self {
        Self {
            is_text,
            data: Data::new(),
            tracks: HashMap::new(),
            spool: RefCell::new(spool),
            first_frame,
            failed: RefCell::new(None),
        }
    }

    /// The first error while reading frames back, if there was one.
    pub(super) fn take_failure(&self) -> Option<io::Error> {
        self.failed.borrow_mut().take()
    }

    /// Time codes of all frames.
    pub(super) fn times(&self) -> impl Iterator<Item = f64> + use<> {
        let first = self.first_frame;
        (0..self.spool.borrow().frames).map(move |frame| (first + frame) as f64)
    }

    /// Adds a spec to the layer.
    pub(super) fn spec(&mut self, path: Path, ty: SpecType) -> &mut SpecData {
        self.data.create_spec(path, ty)
    }

    /// Starts a prim.
    pub(super) fn prim(&mut self, path: Path, type_name: &'static str) -> PrimBuilder<'_> {
        let spec = self.data.create_spec(path.clone(), SpecType::Prim);
        spec.add("specifier", Value::Specifier(Specifier::Def));
        spec.add("typeName", Value::Token(Token::from(type_name)));
        PrimBuilder { layer: self, path, properties: Vec::new() }
    }

    fn samples(&self, track: Track) -> io::Result<Value> {
        let mut spool = self.spool.borrow_mut();
        let mut samples = Vec::with_capacity(spool.frames as usize);
        for frame in 0..spool.frames {
            let mut points = vec![Vec3f::default(); track.count];
            spool.read(frame, track.first, bytemuck::cast_slice_mut(&mut points))?;
            samples.push(((self.first_frame + frame) as f64, Value::Vec3fVec(points)));
        }
        Ok(Value::TimeSamples(samples))
    }
}

/// A prim to which attributes are being added.
pub(super) struct PrimBuilder<'a> {
    layer: &'a mut SpooledLayer,
    path: Path,
    properties: Vec<Token>,
}

impl PrimBuilder<'_> {
    /// Adds an attribute, whose fields the caller sets.
    pub(super) fn attribute(&mut self, name: &'static str, type_name: &'static str) -> &mut SpecData {
        self.properties.push(Token::from(name));
        let spec = self.layer.data.create_spec(self.property(name), SpecType::Attribute);
        spec.add("typeName", Value::Token(Token::from(type_name)));
        spec
    }

    /// Adds an attribute whose values over time are in the spool.
    pub(super) fn track(
        &mut self,
        name: &'static str,
        type_name: &'static str,
        track: Track,
    ) -> &mut SpecData {
        self.layer.tracks.insert(self.property(name), track);
        self.attribute(name, type_name)
    }

    /// Adds a relationship to another prim.
    pub(super) fn relationship(&mut self, name: &'static str, target: Path) {
        self.properties.push(Token::from(name));
        let spec = self.layer.data.create_spec(self.property(name), SpecType::Relationship);
        spec.add("targetPaths", Value::PathListOp(PathListOp::explicit([target])));
    }

    /// Adds an attribute that takes its value from another one.
    pub(super) fn connection(&mut self, name: &'static str, type_name: &'static str, source: Path) {
        let spec = self.attribute(name, type_name);
        spec.add("connectionPaths", Value::PathListOp(PathListOp::explicit([source])));
    }

    /// Names the schema that the prim follows besides that of its type.
    pub(super) fn api(&mut self, schema: &'static str) {
        // The library's text writer leaves out the brackets around a single name of a list operation, which other readers refuse.
        let names = if self.layer.is_text {
            Value::TokenVec(vec![Token::from(schema)])
        } else {
            Value::TokenListOp(TokenListOp::prepended([Token::from(schema)]))
        };
        if let Some(spec) = self.layer.data.spec_mut(&self.path) {
            spec.add("apiSchemas", names);
        }
    }

    /// Sets the prim's kind in the model hierarchy.
    pub(super) fn kind(self, kind: &'static str) -> Self {
        if let Some(spec) = self.layer.data.spec_mut(&self.path) {
            spec.add("kind", Value::Token(Token::from(kind)));
        }
        self
    }

    /// Sets the names of the children and ends the prim.
    pub(super) fn finish(self, children: Vec<Token>) {
        let Some(spec) = self.layer.data.spec_mut(&self.path) else { return };
        if !self.properties.is_empty() {
            spec.add(ChildrenKey::PropertyChildren, Value::TokenVec(self.properties));
        }
        if !children.is_empty() {
            spec.add(ChildrenKey::PrimChildren, Value::TokenVec(children));
        }
    }

    fn property(&self, name: &'static str) -> Path {
        // All names are from this crate and valid.
        self.path.append_property(name).unwrap_or_else(|_| self.path.clone())
    }
}

/// Path of a child prim. Its name is one of this crate's, and valid.
pub(super) fn child(parent: &Path, name: &str) -> Path {
    parent.append_path(name).unwrap_or_else(|_| parent.clone())
}

/// Gives an attribute a value that does not change over time.
pub(super) fn uniform(spec: &mut SpecData, value: &'static str) {
    spec.add("variability", Value::Variability(Variability::Uniform));
    spec.add("default", Value::Token(Token::from(value)));
}

impl AbstractData for SpooledLayer {
    fn has_spec(&self, path: &Path) -> bool {
        self.data.has_spec(path)
    }

    fn has_field(&self, path: &Path, field: &str) -> bool {
        self.data.has_field(path, field) || field == TIME_SAMPLES && self.tracks.contains_key(path)
    }

    fn spec_type(&self, path: &Path) -> Option<SpecType> {
        self.data.spec_type(path)
    }

    fn try_field(&self, path: &Path, field: &str) -> Result<Option<Cow<'_, Value>>, DataError> {
        let Some(track) = self.tracks.get(path).filter(|_| field == TIME_SAMPLES) else {
            return self.data.try_field(path, field);
        };
        self.samples(*track).map(|value| Some(Cow::Owned(value))).map_err(|error| {
            let told = io::Error::new(error.kind(), error.to_string());
            self.failed.borrow_mut().get_or_insert(error);
            DataError::Decode { path: path.clone(), field: field.to_owned(), source: told.into() }
        })
    }

    fn list_fields(&self, path: &Path) -> Option<Vec<String>> {
        let mut fields = self.data.list_fields(path)?;
        if self.tracks.contains_key(path) {
            fields.push(TIME_SAMPLES.to_owned());
        }
        Some(fields)
    }

    fn spec_paths(&self) -> Vec<Path> {
        self.data.spec_paths()
    }

    fn create_spec(&mut self, path: Path, ty: SpecType) {
        self.data.create_spec(path, ty);
    }

    fn erase_spec(&mut self, path: &Path) {
        self.data.erase_spec(path);
    }

    fn set_field(&mut self, path: &Path, field: &str, value: Value) {
        self.data.set_field(path, field, value);
    }

    fn erase_field(&mut self, path: &Path, field: &str) {
        self.data.erase_field(path, field);
    }
}
