//! A stage in a binary crate (<https://openusd.org/release/api/crate_file_8h_source.html>), of which only the necessary
//! parts are read.
//!
//! The `openusd` library writes our crates but does not read those of others: it trusts the counts and indices of a
//! file, so that a broken one makes it panic, allocate without limit or loop forever. Here every count is compared with
//! the bytes of the file, and every entry of the path tree is visited once.

use std::collections::HashMap;

use crate::Source;
use crate::crate_bytes::{CrateBytes, u64_of};
use crate::crate_samples::CrateSamples;
use crate::crate_tokens::Tokens;
use crate::crate_value::CrateValues;
use crate::layer::{BASES, arcs_of};
use crate::transform::DEEPEST;
use crate::value::Value;
use crate::{Around, Layer, UsdError};

/// The first bytes of a crate.
pub(crate) const CRATE_MAGIC: &[u8] = b"PXR-USDC";

const NOTHING: u32 = u32::MAX;

const PRIM: u32 = 6;

/// The most fields of a spec that are looked at. Specs may share one run of fields, so without a limit a small file could make
/// every look-up long.
const MAX_FIELDS: usize = 1024;

/// A node of the path tree.
#[derive(Clone, Copy)]
struct Node {
    parent: u32,
    /// Index of its name.
    token: u32,
    depth: u32,
    /// Index of its first field in the fieldsets; [`NOTHING`] without a spec.
    fieldset: u32,
    spec_type: u32,
}

pub(crate) struct CrateLayer<'a> {
    values: CrateValues<'a>,
    /// Token and value of each field.
    fields: Vec<(u32, u64)>,
    /// Runs of fields, each terminated by [`NOTHING`].
    fieldsets: Vec<u32>,
    nodes: Vec<Node>,
    /// Properties by their prim and name.
    properties: HashMap<(u32, u32), u32>,
    /// Prims by their parent and name.
    children: HashMap<(u32, u32), u32>,
    /// Time samples that were looked up.
    samples: CrateSamples,
    root: u32,
    /// The time code of values; the first one of each attribute if there is none.
    time: Option<f64>,
}

impl<'a> CrateLayer<'a> {
    pub(crate) fn open(name: &str, source: Source<'a>) -> Result<Self, UsdError> {
        let mut layer = Self {
            values: CrateValues {
                file: CrateBytes::new(name, source),
                version: [0; 3],
                tokens: Tokens::default(),
            },
            fields: Vec::new(),
            fieldsets: Vec::new(),
            nodes: Vec::new(),
            properties: HashMap::new(),
            children: HashMap::new(),
            samples: CrateSamples::default(),
            root: 0,
            time: None,
        };
        let head = layer.values.file.bytes(0, 24, "bytes of header")?;
        layer.values.version = [head[8], head[9], head[10]];
        if layer.values.version[0] != 0 || !(4..=13).contains(&layer.values.version[1]) {
            let [major, minor, patch] = layer.values.version;
            return Err(layer.values.file.at(
                8,
                format!("a crate of version {major}.{minor}.{patch}"),
                "0.4 to 0.13",
            ));
        }
        let toc = layer.values.file.u64(16)?;
        let count = layer.values.file.u64(toc)?;
        if count > 64 {
            return Err(layer.values.file.at(toc, format!("{count} sections"), "64 at most"));
        }
        let mut sections = HashMap::new();
        for section in 0..count {
            let entry = layer.values.file.bytes(toc + 8 + 32 * section, 32, "bytes of a section's entry")?;
            let name = entry[..16].split(|&byte| byte == 0).next().unwrap_or_default().to_vec();
            sections.insert(name, u64_of(&entry[16..]));
        }
        let mut section = |layer: &Self, name: &str| {
            sections.remove(name.as_bytes()).ok_or_else(|| {
                layer.values.file.at(toc, "no such section".to_owned(), &format!("a section {name}"))
            })
        };
        let [tokens, fields, fieldsets, paths, specs] =
            ["TOKENS", "FIELDS", "FIELDSETS", "PATHS", "SPECS"].map(|name| section(&layer, name));
        layer.read_tokens(tokens?)?;
        layer.read_fields(fields?)?;
        let (at, count) = layer.values.file.counted(fieldsets?)?;
        layer.fieldsets = layer.values.file.ints(at, count)?.0;
        layer.read_paths(paths?)?;
        layer.read_specs(specs?)?;
        Ok(layer)
    }

    fn read_tokens(&mut self, at: u64) -> Result<(), UsdError> {
        let (count, length) = (self.values.file.u64(at)?, self.values.file.u64(at + 8)?);
        let (text, _) = self.values.file.unpacked(at + 16, length, length)?;
        if text.len() as u64 != length || text.last().is_some_and(|&byte| byte != 0) {
            return Err(self.values.file.at(
                at,
                format!("{} bytes of tokens", text.len()),
                "as many as stated, ending in a zero",
            ));
        }
        let words = text.strip_suffix(&[0]).unwrap_or(&text).split(|&byte| byte == 0);
        self.values.tokens = Tokens::new(words);
        if !text.is_empty() && self.values.tokens.len() as u64 != count {
            return Err(self.values.file.at(
                at,
                format!("{} tokens", self.values.tokens.len()),
                &format!("{count}"),
            ));
        }
        Ok(())
    }

    fn read_fields(&mut self, at: u64) -> Result<(), UsdError> {
        let (at, count) = self.values.file.counted(at)?;
        let (tokens, at) = self.values.file.ints(at, count)?;
        let (values, _) = self.values.file.unpacked(at, 8 * count, 8 * count)?;
        self.fields = tokens.into_iter().zip(values.chunks_exact(8).map(u64_of)).collect();
        Ok(())
    }

    /// Reads the path tree: each entry is followed by its children and states the distance to its next sibling.
    fn read_paths(&mut self, at: u64) -> Result<(), UsdError> {
        let (start, count) = self.values.file.counted(at)?;
        let (start, encoded) = self.values.file.counted(start)?;
        let (indices, next) = self.values.file.ints(start, encoded)?;
        let (names, next) = self.values.file.ints(next, encoded)?;
        let (jumps, _) = self.values.file.ints(next, encoded)?;
        let wrong = |what: &str| self.values.file.at(at, format!("a path tree with {what}"), "a tree");
        let empty = Node { parent: NOTHING, token: NOTHING, depth: 0, fieldset: NOTHING, spec_type: 0 };
        let mut nodes = vec![empty; count as usize];
        let mut visited = vec![false; indices.len()];
        let mut placed = vec![false; count as usize];
        let mut pending = if indices.is_empty() { Vec::new() } else { vec![(0_usize, NOTHING)] };
        let (mut root, mut properties, mut children) = (0, HashMap::new(), HashMap::new());
        while let Some((mut entry, mut parent)) = pending.pop() {
            loop {
                if visited.get(entry).is_none_or(|&visited| visited) {
                    return Err(wrong("a jump to a missing or visited entry"));
                }
                visited[entry] = true;
                let (node, name, jump) = (indices[entry], names[entry] as i32, jumps[entry] as i32);
                let depth = if parent == NOTHING { 0 } else { nodes[parent as usize].depth + 1 };
                let token = name.unsigned_abs();
                if node as usize >= nodes.len() || depth as usize > DEEPEST {
                    return Err(wrong("a path out of range"));
                }
                // A path with two parents could be its own ancestor.
                if std::mem::replace(&mut placed[node as usize], true) {
                    return Err(wrong("a path in two places"));
                }
                nodes[node as usize] = Node { parent, token, depth, ..empty };
                if parent == NOTHING {
                    root = node;
                } else if token as usize >= self.values.tokens.len() {
                    return Err(wrong("a name out of range"));
                } else if name < 0 {
                    properties.insert((parent, token), node);
                } else {
                    children.insert((parent, token), node);
                }
                let (has_child, has_sibling) = (jump > 0 || jump == -1, jump >= 0);
                if has_child {
                    if has_sibling {
                        pending.push((entry + jump as usize, parent));
                    }
                    parent = node;
                } else if !has_sibling {
                    break;
                }
                entry += 1;
            }
        }
        (self.nodes, self.root) = (nodes, root);
        (self.properties, self.children) = (properties, children);
        Ok(())
    }

    fn read_specs(&mut self, at: u64) -> Result<(), UsdError> {
        let (start, count) = self.values.file.counted(at)?;
        let (paths, next) = self.values.file.ints(start, count)?;
        let (fieldsets, next) = self.values.file.ints(next, count)?;
        let (types, _) = self.values.file.ints(next, count)?;
        for ((path, fieldset), spec_type) in paths.into_iter().zip(fieldsets).zip(types) {
            if fieldset as usize >= self.fieldsets.len() {
                return Err(self.values.file.at(
                    at,
                    format!("fields from index {fieldset}"),
                    "an existing index",
                ));
            }
            let Some(node) = self.nodes.get_mut(path as usize) else {
                return Err(self.values.file.at(at, format!("path {path}"), "an existing path"));
            };
            (node.fieldset, node.spec_type) = (fieldset, spec_type);
        }
        Ok(())
    }

    /// The stored value of a field of a spec.
    fn field_of(&self, node: u32, name: &str) -> Option<u64> {
        let start = self.nodes.get(node as usize)?.fieldset as usize;
        let run = self.fieldsets.get(start..)?.iter().take(MAX_FIELDS).take_while(|&&field| field != NOTHING);
        let mut fields = run.filter_map(|&field| self.fields.get(field as usize));
        fields
            .find(|(token, _)| self.values.tokens.get(*token).is_some_and(|token| token == name))
            .map(|&(_, value)| value)
    }

    fn property(&self, prim: usize, name: &str) -> Option<u32> {
        let token = self.values.tokens.index_of(name)?;
        self.properties.get(&(prim as u32, token)).copied()
    }

    /// The stored value of a field of a property.
    fn field_of_property(&self, prim: usize, name: &str, field: &str) -> Option<u64> {
        self.field_of(self.property(prim, name)?, field)
    }

    /// The names from the root down to a prim.
    fn names(&self, prim: usize) -> Vec<&str> {
        let mut names = Vec::new();
        let mut at = prim as u32;
        while at != NOTHING && at != self.root {
            let node = self.nodes[at as usize];
            names.push(self.values.tokens.get(node.token).unwrap_or_default());
            at = node.parent;
        }
        names.reverse();
        names
    }

    fn token_of(&mut self, node: u32, field: &str) -> Result<Option<String>, UsdError> {
        let Some(value) = self.field_of(node, field) else { return Ok(None) };
        Ok(match self.values.value(value, 1)? {
            Some(Value::Token(token)) => Some(token),
            _ => None,
        })
    }

    /// Whether a prim is defined and active.
    fn is_on(&mut self, node: u32) -> Result<bool, UsdError> {
        // `def`; `over` and `class` define nothing that is drawn.
        let defined = self.field_of(node, "specifier").is_some_and(|value| value as u8 == 0);
        let active = match self.field_of(node, "active") {
            Some(value) => self.values.value(value, 1)? != Some(Value::Bool(false)),
            None => true,
        };
        Ok(defined && active)
    }
}

impl CrateLayer<'_> {
    /// The prims of some types with their types, and whether they are on the stage.
    fn of_types(&mut self, types: &[&str]) -> Result<Vec<(usize, String, bool)>, UsdError> {
        let mut found = Vec::new();
        for node in 0..self.nodes.len() as u32 {
            if self.nodes[node as usize].spec_type != PRIM {
                continue;
            }
            let Some(kind) = self.token_of(node, "typeName")?.filter(|kind| types.contains(&kind.as_str()))
            else {
                continue;
            };
            let (mut at, mut on) = (node, true);
            while on && at != NOTHING && at != self.root {
                on = self.is_on(at)?;
                at = self.nodes[at as usize].parent;
            }
            found.push((node as usize, kind, on));
        }
        Ok(found)
    }
}

impl Layer for CrateLayer<'_> {
    fn prims(&mut self, types: &[&str]) -> Result<Vec<(usize, String)>, UsdError> {
        let all = self.of_types(types)?;
        let mut found: Vec<(usize, String)> =
            all.into_iter().filter_map(|(prim, kind, is_on)| is_on.then_some((prim, kind))).collect();
        // Names in place of whole paths: a path may repeat a long name at every level.
        found.sort_by_cached_key(|(prim, _)| self.names(*prim));
        Ok(found)
    }

    fn undefined(&mut self, types: &[&str]) -> Result<usize, UsdError> {
        let found = self.of_types(types)?;
        // Prims of variants, whose names are in braces, are on the stage if their variant is selected.
        let is_plain = |prim: usize| !self.names(prim).iter().any(|name| name.starts_with('{'));
        Ok(found.iter().filter(|&&(prim, _, is_on)| !is_on && is_plain(prim)).count())
    }

    fn kind(&mut self, prim: usize) -> Result<Option<String>, UsdError> {
        self.token_of(prim as u32, "typeName")
    }

    fn bases(&mut self, prim: usize) -> Result<Vec<usize>, UsdError> {
        let mut bases = Vec::new();
        for field in BASES {
            let Some(list) = self.field_of(prim as u32, field) else { continue };
            bases.extend(self.values.paths(list)?);
        }
        let is_prim = |&base: &u32| self.nodes.get(base as usize).is_some_and(|node| node.spec_type == PRIM);
        Ok(bases.into_iter().filter(is_prim).map(|base| base as usize).collect())
    }

    fn prim_at(&mut self, path: &str) -> Option<usize> {
        let mut node = self.root;
        for name in path.strip_prefix('/')?.split('/') {
            node = *self.children.get(&(node, self.values.tokens.index_of(name)?))?;
        }
        (self.nodes[node as usize].spec_type == PRIM).then_some(node as usize)
    }

    fn parent(&self, prim: usize) -> Option<usize> {
        let parent = self.nodes[prim].parent;
        (parent != NOTHING && parent != self.root).then_some(parent as usize)
    }

    fn path(&self, prim: usize) -> String {
        self.names(prim).iter().fold(String::new(), |path, name| path + "/" + name)
    }

    fn set_time(&mut self, time: f64) {
        self.time = Some(time);
    }

    fn time(&self) -> Option<f64> {
        self.time
    }

    fn default_value(&mut self, prim: usize, name: &str, most: usize) -> Result<Option<Value>, UsdError> {
        match self.property(prim, name).and_then(|property| self.field_of(property, "default")) {
            Some(value) => self.values.value(value, most),
            None => Ok(None),
        }
    }

    fn sample_times(&mut self, prim: usize, name: &str) -> Result<Vec<f64>, UsdError> {
        match self.field_of_property(prim, name, "timeSamples") {
            Some(samples) => Ok(self.samples.times(&mut self.values, samples)?.to_vec()),
            None => Ok(Vec::new()),
        }
    }

    fn around(&mut self, prim: usize, name: &str, time: f64) -> Result<Around, UsdError> {
        match self.field_of_property(prim, name, "timeSamples") {
            Some(samples) => Ok(Around::of(&self.samples.times(&mut self.values, samples)?, time, |at| *at)),
            None => Ok(Around { before: 0, next: None }),
        }
    }

    fn sample(
        &mut self,
        prim: usize,
        name: &str,
        sample: usize,
        most: usize,
    ) -> Result<Option<Value>, UsdError> {
        match self.field_of_property(prim, name, "timeSamples") {
            Some(samples) => self.samples.value(&mut self.values, samples, sample, most),
            None => Ok(None),
        }
    }

    fn field(&mut self, prim: usize, attribute: &str, field: &str) -> Result<Option<Value>, UsdError> {
        match self.field_of_property(prim, attribute, field) {
            Some(value) => self.values.value(value, 1),
            None => Ok(None),
        }
    }

    fn targets(&mut self, prim: usize, relationship: &str) -> Result<Vec<String>, UsdError> {
        let list = self.field_of_property(prim, relationship, "targetPaths");
        let list = list.or_else(|| self.field_of_property(prim, relationship, "connectionPaths"));
        let Some(list) = list else { return Ok(Vec::new()) };
        let paths = self.values.paths(list)?;
        let known = paths.into_iter().filter(|&path| (path as usize) < self.nodes.len());
        Ok(known.map(|path| self.path(path as usize)).collect())
    }

    fn metadata(&mut self, name: &str) -> Result<Option<Value>, UsdError> {
        match self.field_of(self.root, name) {
            Some(value) => self.values.value(value, 1),
            None => Ok(None),
        }
    }

    fn arcs(&self) -> Vec<&'static str> {
        arcs_of(|field| self.fields.iter().any(|(token, _)| self.values.tokens.get(*token) == Some(field)))
    }

    fn malformed(&self, found: String, wanted: &str) -> UsdError {
        self.values.file.at(0, found, wanted)
    }
}
