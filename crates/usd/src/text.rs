//! A stage in a text file, parsed by the `openusd` library.

use std::panic::{AssertUnwindSafe, catch_unwind};

use glam::Vec3;
use openusd::sdf::{AbstractData, Data, ListOp, Path, SpecType, Specifier, Value as Sdf};
use openusd::usda::parser::Parser;

use crate::layer::{BASES, arcs_of};
use crate::text_check::check;
use crate::transform::DEEPEST;
use crate::value::{Value, half};
use crate::{Around, Layer, UsdError};

/// The longest text; parsing needs several times as much memory.
const LONGEST: usize = 512 << 20;

pub(crate) struct TextLayer {
    name: String,
    data: Data,
    prims: Vec<Path>,
    /// The time code of values; the first one of each attribute if there is none.
    time: Option<f64>,
}

impl TextLayer {
    pub(crate) fn parse(name: &str, bytes: &[u8]) -> Result<Self, UsdError> {
        let malformed = |offset: usize, found: String, wanted: &str| UsdError::Malformed {
            name: name.to_owned(),
            offset: offset as u64,
            found,
            wanted: wanted.to_owned(),
        };
        if bytes.len() > LONGEST {
            return Err(malformed(
                0,
                format!("{} bytes of text", bytes.len()),
                "536870912 at most: .usdc is smaller",
            ));
        }
        let text = std::str::from_utf8(bytes)
            .map_err(|error| malformed(error.valid_up_to(), "bytes that are not text".to_owned(), "UTF-8"))?;
        check(text).map_err(|(offset, found, wanted)| malformed(offset, found, &wanted))?;
        let mut parser = Parser::new(text);
        // Input that could abort the program was rejected above. Any remaining panic of the library becomes an error
        // here.
        let parsed = catch_unwind(AssertUnwindSafe(|| parser.parse()));
        let found = match parsed {
            Ok(Ok(mut specs)) => {
                // Sorted once, so that a sample is found without a look at all of them.
                for (_, value) in specs.values_mut().flat_map(|spec| &mut spec.fields) {
                    if let Sdf::TimeSamples(samples) = value {
                        samples.sort_by(|a, b| a.0.total_cmp(&b.0));
                    }
                }
                let data = Data::from_specs(specs);
                let mut prims: Vec<Path> = data
                    .iter()
                    .filter(|(_, spec)| spec.ty == SpecType::Prim)
                    .map(|(path, _)| path.clone())
                    .collect();
                prims.sort_by(|a, b| a.as_str().cmp(b.as_str()));
                return Ok(Self { name: name.to_owned(), data, prims, time: None });
            }
            Ok(Err(error)) => format!("{error:#}").split_whitespace().collect::<Vec<_>>().join(" "),
            Err(_) => "text that cannot be parsed".to_owned(),
        };
        let line = parser.last_error_highlight().map_or(1, |highlight| highlight.line);
        let offset = text.split_inclusive('\n').take(line - 1).map(str::len).sum();
        Err(malformed(offset, format!("in line {line}: {found}"), "a USD stage as text"))
    }

    fn field_of(&self, path: &Path, field: &str) -> Option<&Sdf> {
        self.data.spec(path).and_then(|spec| spec.get(field))
    }

    /// The time samples of an attribute, ascending.
    fn samples(&self, prim: usize, name: &str) -> &[(f64, Sdf)] {
        let Ok(path) = self.prims[prim].append_property(name.to_owned()) else { return &[] };
        match self.field_of(&path, "timeSamples") {
            Some(Sdf::TimeSamples(samples)) => samples,
            _ => &[],
        }
    }

    fn is_off(&self, path: &Path) -> bool {
        let defined = matches!(self.field_of(path, "specifier"), Some(Sdf::Specifier(Specifier::Def)));
        !defined || matches!(self.field_of(path, "active"), Some(Sdf::Bool(false)))
    }
}

impl TextLayer {
    /// The prims of some types with their types, and whether they are on the stage.
    fn of_types<'a>(&'a self, types: &'a [&str]) -> impl Iterator<Item = (usize, &'a str, bool)> {
        let kind = move |path: &Path| match self.field_of(path, "typeName") {
            Some(Sdf::Token(name)) if types.contains(&name.as_str()) => Some(name.as_str()),
            _ => None,
        };
        let is_on = move |path: &Path| {
            let mut at = Some(path.clone());
            std::iter::from_fn(|| {
                let path = at.take()?;
                at = path.parent();
                Some(path)
            })
            .filter(|path| path.as_str() != "/")
            .take(DEEPEST)
            .all(|path| !self.is_off(&path))
        };
        let prims = self.prims.iter().enumerate();
        prims.filter_map(move |(prim, path)| Some((prim, kind(path)?, is_on(path))))
    }
}

impl Layer for TextLayer {
    fn prims(&mut self, types: &[&str]) -> Result<Vec<(usize, String)>, UsdError> {
        let on = self.of_types(types).filter(|(.., is_on)| *is_on);
        Ok(on.map(|(prim, kind, _)| (prim, kind.to_owned())).collect())
    }

    fn undefined(&mut self, types: &[&str]) -> Result<usize, UsdError> {
        // Prims of variants are on the stage if their variant is selected.
        let plain = |prim: usize| !self.prims[prim].as_str().contains('{');
        Ok(self.of_types(types).filter(|&(prim, _, is_on)| !is_on && plain(prim)).count())
    }

    fn kind(&mut self, prim: usize) -> Result<Option<String>, UsdError> {
        Ok(match self.field_of(&self.prims[prim], "typeName") {
            Some(Sdf::Token(name)) => Some(name.as_str().to_owned()),
            _ => None,
        })
    }

    fn bases(&mut self, prim: usize) -> Result<Vec<usize>, UsdError> {
        let path = &self.prims[prim];
        let lists = BASES.iter().filter_map(|field| match self.field_of(path, field) {
            Some(Sdf::PathListOp(list)) => Some(items(list)),
            _ => None,
        });
        let known = |base: &Path| self.prims.binary_search_by(|known| known.as_str().cmp(base.as_str())).ok();
        Ok(lists.flatten().filter_map(|base| known(&path.make_absolute(base))).collect())
    }

    fn prim_at(&mut self, path: &str) -> Option<usize> {
        self.prims.binary_search_by(|known| known.as_str().cmp(path)).ok()
    }

    fn parent(&self, prim: usize) -> Option<usize> {
        let parent = self.prims[prim].parent()?;
        self.prims.binary_search_by(|path| path.as_str().cmp(parent.as_str())).ok()
    }

    fn path(&self, prim: usize) -> String {
        self.prims[prim].as_str().to_owned()
    }

    fn set_time(&mut self, time: f64) {
        self.time = Some(time);
    }

    fn time(&self) -> Option<f64> {
        self.time
    }

    fn default_value(&mut self, prim: usize, name: &str, _: usize) -> Result<Option<Value>, UsdError> {
        self.field(prim, name, "default")
    }

    fn sample_times(&mut self, prim: usize, name: &str) -> Result<Vec<f64>, UsdError> {
        Ok(self.samples(prim, name).iter().map(|(time, _)| *time).collect())
    }

    fn around(&mut self, prim: usize, name: &str, time: f64) -> Result<Around, UsdError> {
        Ok(Around::of(self.samples(prim, name), time, |(at, _)| *at))
    }

    fn sample(
        &mut self,
        prim: usize,
        name: &str,
        sample: usize,
        _: usize,
    ) -> Result<Option<Value>, UsdError> {
        Ok(self.samples(prim, name).get(sample).and_then(|(_, value)| value_of(value)))
    }

    fn field(&mut self, prim: usize, attribute: &str, field: &str) -> Result<Option<Value>, UsdError> {
        let Ok(path) = self.prims[prim].append_property(attribute.to_owned()) else { return Ok(None) };
        Ok(self.field_of(&path, field).and_then(value_of))
    }

    fn targets(&mut self, prim: usize, relationship: &str) -> Result<Vec<String>, UsdError> {
        let Ok(path) = self.prims[prim].append_property(relationship.to_owned()) else {
            return Ok(Vec::new());
        };
        let lists = ["targetPaths", "connectionPaths"].map(|field| self.field_of(&path, field));
        let Some(list) = lists.into_iter().flatten().find_map(|value| match value {
            Sdf::PathListOp(list) => Some(list),
            _ => None,
        }) else {
            return Ok(Vec::new());
        };
        Ok(items(list).map(|path| path.as_str().to_owned()).collect())
    }

    fn metadata(&mut self, name: &str) -> Result<Option<Value>, UsdError> {
        Ok(self.field_of(&Path::abs_root(), name).and_then(value_of))
    }

    fn arcs(&self) -> Vec<&'static str> {
        arcs_of(|field| self.data.iter().any(|(path, _)| self.data.has_field(path, field)))
    }

    fn malformed(&self, found: String, wanted: &str) -> UsdError {
        UsdError::Malformed { name: self.name.clone(), offset: 0, found, wanted: wanted.to_owned() }
    }
}

/// The paths of a list.
fn items(list: &ListOp<Path>) -> impl Iterator<Item = &Path> {
    let lists = [&list.explicit_items, &list.added_items, &list.prepended_items, &list.appended_items];
    lists.into_iter().flatten()
}

fn value_of(value: &Sdf) -> Option<Value> {
    let vector = |x: f64, y: f64, z: f64| Vec3::new(x as f32, y as f32, z as f32);
    Some(match value {
        Sdf::Token(token) => Value::Token(token.as_str().to_owned()),
        Sdf::AssetPath(path) => Value::Token(path.authored_path.clone()),
        // Metadata without a type is a string.
        Sdf::String(text) => Value::Token(text.clone()),
        Sdf::TokenVec(tokens) => {
            Value::Tokens(tokens.iter().map(|token| token.as_str().to_owned()).collect())
        }
        Sdf::StringVec(texts) => Value::Tokens(texts.clone()),
        Sdf::Bool(value) => Value::Bool(*value),
        Sdf::IntVec(ints) => Value::Ints(ints.clone()),
        Sdf::Int(v) => Value::Numbers(vec![f64::from(*v)]),
        Sdf::Int64(v) => Value::Numbers(vec![*v as f64]),
        Sdf::Half(v) => Value::Numbers(vec![f64::from(half(v.to_bits()))]),
        Sdf::Float(v) => Value::Numbers(vec![f64::from(*v)]),
        Sdf::Double(v) => Value::Numbers(vec![*v]),
        Sdf::Vec2f(v) => Value::Numbers([v.x, v.y].map(f64::from).to_vec()),
        Sdf::Vec3h(v) => {
            Value::Numbers([v.x, v.y, v.z].iter().map(|v| f64::from(half(v.to_bits()))).collect())
        }
        Sdf::Vec3f(v) => Value::Numbers([v.x, v.y, v.z].map(f64::from).to_vec()),
        Sdf::Vec3d(v) => Value::Numbers(vec![v.x, v.y, v.z]),
        Sdf::Vec4f(v) => Value::Numbers([v.x, v.y, v.z, v.w].map(f64::from).to_vec()),
        Sdf::Vec4d(v) => Value::Numbers(vec![v.x, v.y, v.z, v.w]),
        Sdf::Quath(q) => {
            Value::Numbers([q.w, q.x, q.y, q.z].iter().map(|v| f64::from(half(v.to_bits()))).collect())
        }
        Sdf::Quatf(q) => Value::Numbers([q.w, q.x, q.y, q.z].map(f64::from).to_vec()),
        Sdf::Quatd(q) => Value::Numbers(vec![q.w, q.x, q.y, q.z]),
        Sdf::Matrix4d(m) => Value::Numbers(m.0.to_vec()),
        Sdf::HalfVec(v) => Value::Floats(v.iter().map(|v| half(v.to_bits())).collect()),
        Sdf::FloatVec(v) => Value::Floats(v.clone()),
        Sdf::DoubleVec(v) => Value::Floats(v.iter().map(|&v| v as f32).collect()),
        Sdf::Vec3hVec(v) => Value::Vectors(
            v.iter()
                .map(|v| Vec3::new(half(v.x.to_bits()), half(v.y.to_bits()), half(v.z.to_bits())))
                .collect(),
        ),
        Sdf::Vec2hVec(v) => Value::Vectors(
            v.iter().map(|v| Vec3::new(half(v.x.to_bits()), half(v.y.to_bits()), 0.0)).collect(),
        ),
        Sdf::Vec2fVec(v) => Value::Vectors(v.iter().map(|v| Vec3::new(v.x, v.y, 0.0)).collect()),
        Sdf::Vec2dVec(v) => Value::Vectors(v.iter().map(|v| vector(v.x, v.y, 0.0)).collect()),
        Sdf::Vec3fVec(v) => Value::Vectors(v.iter().map(|v| Vec3::new(v.x, v.y, v.z)).collect()),
        Sdf::Vec3dVec(v) => Value::Vectors(v.iter().map(|v| vector(v.x, v.y, v.z)).collect()),
        Sdf::QuathVec(v) => Value::Quaternions(
            v.iter().map(|q| [q.w, q.x, q.y, q.z].map(|part| half(part.to_bits()))).collect(),
        ),
        Sdf::QuatfVec(v) => Value::Quaternions(v.iter().map(|q| [q.w, q.x, q.y, q.z]).collect()),
        Sdf::QuatdVec(v) => {
            Value::Quaternions(v.iter().map(|q| [q.w, q.x, q.y, q.z].map(|part| part as f32)).collect())
        }
        Sdf::Matrix4dVec(v) => Value::Matrices(v.iter().map(|m| m.0).collect()),
        _ => return None,
    })
}
