//! Which modules of a crate use which, read from its source, and the circles among them.
//!
//! Modules with the same parent may not use each other in a circle. A module stands for everything below it. Paths are
//! resolved through re-exports, so `use crate::Thing` counts as a use of the module that defines `Thing`. Tests are left
//! out: they may reach for whatever they check.

use anyhow::Context as _;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use syn::visit::Visit;

/// A module's path below its crate, such as `["io", "usd"]`; the crate's root is empty.
type ModulePath = Vec<String>;

/// What one module declares and what it mentions.
#[derive(Debug, Default)]
struct Module {
    /// The names of its items, child modules left out.
    items: BTreeSet<String>,
    /// What `use` brings in: the name here, and the path as it is written.
    imports: BTreeMap<String, Vec<String>>,
    /// The paths of `use some::path::*`.
    globs: Vec<Vec<String>>,
    /// Every path that its code mentions, as it is written.
    paths: BTreeSet<Vec<String>>,
}

/// The modules of one crate.
#[derive(Debug, Default)]
pub(crate) struct Modules {
    all: BTreeMap<ModulePath, Module>,
}

/// Modules with one parent that use each other, directly or through others.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Circle {
    /// The modules, as `io::usd`, in alphabetical order.
    pub(crate) modules: Vec<String>,
    /// One arrow out of each of them to another one: who uses what, as `io::usd::bytes → io::usd::file`.
    pub(crate) arrows: Vec<String>,
}

impl Modules {
    /// Reads every file below a crate's `src` folder, tests left out.
    pub(crate) fn read(src: &Path) -> anyhow::Result<Self> {
        let mut modules = Self::default();
        modules.read_folder(src, &[])?;
        Ok(modules)
    }

    /// Number of modules.
    pub(crate) fn len(&self) -> usize {
        self.all.len()
    }

    fn read_folder(&mut self, folder: &Path, at: &[String]) -> anyhow::Result<()> {
        let cannot_read = || format!("could not read {}", folder.display());
        for entry in std::fs::read_dir(folder).with_context(cannot_read)? {
            let path = entry.with_context(cannot_read)?.path();
            let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            if stem == "tests" || stem.ends_with("_tests") || stem == "testing" {
                continue;
            }
            if path.is_dir() {
                self.read_folder(&path, &[at, &[stem]].concat())?;
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let root = ["lib", "main", "mod"].contains(&stem.as_str());
                let module = if root { at.to_vec() } else { [at, &[stem]].concat() };
                let source = std::fs::read_to_string(&path)
                    .with_context(|| format!("could not read {}", path.display()))?;
                self.add(&module, &source).with_context(|| format!("could not parse {}", path.display()))?;
            }
        }
        Ok(())
    }

    /// Adds the source of one module.
    fn add(&mut self, at: &[String], source: &str) -> syn::Result<()> {
        let file = syn::parse_file(source)?;
        self.add_items(at, &file.items);
        Ok(())
    }

    fn add_items(&mut self, at: &[String], items: &[syn::Item]) {
        let mut reader = Reader { module: Module::default(), inner: Vec::new() };
        for item in items {
            reader.visit_item(item);
        }
        let Reader { module, inner } = reader;
        let here = self.all.entry(at.to_vec()).or_default();
        here.items.extend(module.items);
        here.imports.extend(module.imports);
        here.globs.extend(module.globs);
        here.paths.extend(module.paths);
        for (name, items) in inner {
            self.add_items(&[at, &[name]].concat(), items);
        }
    }

    /// The module that defines what `path` names where it stands in the module `at`; `None` where it is of another crate.
    fn resolve(&self, at: &[String], path: &[String], depth: usize) -> Option<ModulePath> {
        if depth > 16 {
            return None;
        }
        let (first, rest) = path.split_first()?;
        let parent = |of: &[String]| of.split_last().map(|(_, parent)| parent.to_vec());
        match first.as_str() {
            "crate" => self.descend(Vec::new(), rest, depth),
            "self" => self.descend(at.to_vec(), rest, depth),
            "super" => {
                let mut module = parent(at)?;
                let mut rest = rest;
                while let Some((first, left)) = rest.split_first().filter(|(first, _)| *first == "super") {
                    debug_assert_eq!(first, "super");
                    (module, rest) = (parent(&module)?, left);
                }
                self.descend(module, rest, depth)
            }
            name => {
                let here = self.all.get(at)?;
                let child = [at, std::slice::from_ref(first)].concat();
                let known = self.all.contains_key(&child)
                    || here.imports.contains_key(name)
                    || here.items.contains(name);
                if known { self.descend(at.to_vec(), path, depth) } else { None }
            }
        }
    }

    /// Follows `path` down from `module`, through its re-exports.
    fn descend(&self, module: ModulePath, path: &[String], depth: usize) -> Option<ModulePath> {
        let Some((first, rest)) = path.split_first() else { return Some(module) };
        let child = [&module[..], std::slice::from_ref(first)].concat();
        if self.all.contains_key(&child) {
            return self.descend(child, rest, depth);
        }
        let here = self.all.get(&module)?;
        if here.items.contains(first) {
            return Some(module);
        }
        if let Some(import) = here.imports.get(first) {
            // An import of the same name from another crate ends here.
            let target = [&import[..], rest].concat();
            return if import.first() == Some(first) {
                None
            } else {
                self.resolve(&module, &target, depth + 1)
            };
        }
        let through = here.globs.iter().find_map(|glob| {
            let found =
                self.resolve(&module, &[&glob[..], std::slice::from_ref(first)].concat(), depth + 1)?;
            self.all.get(&found)?.items.contains(first).then_some(found)
        });
        Some(through.unwrap_or(module))
    }

    /// The arrows between modules with the same parent: parent, user, used, and the two modules behind it.
    fn arrows(&self) -> BTreeMap<ModulePath, BTreeMap<(String, String), String>> {
        let mut arrows: BTreeMap<ModulePath, BTreeMap<(String, String), String>> = BTreeMap::new();
        for (at, module) in &self.all {
            let imported = module.imports.values().chain(&module.globs);
            for path in imported.chain(&module.paths) {
                let Some(target) = self.resolve(at, path, 0) else { continue };
                let shared = at.iter().zip(&target).take_while(|(a, b)| a == b).count();
                if let (Some(user), Some(used)) = (at.get(shared), target.get(shared)) {
                    let shown = format!("{} → {}", at.join("::"), target.join("::"));
                    let of_parent = arrows.entry(at[..shared].to_vec()).or_default();
                    of_parent.entry((user.clone(), used.clone())).or_insert(shown);
                }
            }
        }
        arrows
    }

    /// Every circle.
    pub(crate) fn circles(&self) -> Vec<Circle> {
        let mut circles = Vec::new();
        for (parent, arrows) in self.arrows() {
            let mut reached: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
            for (user, used) in arrows.keys() {
                reached.entry(user).or_default().insert(used);
            }
            // Modules per folder are few, so the closure may take its time.
            loop {
                let before: usize = reached.values().map(BTreeSet::len).sum();
                for user in reached.keys().copied().collect::<Vec<_>>() {
                    let through: BTreeSet<&str> = reached[user]
                        .iter()
                        .filter_map(|next| reached.get(next))
                        .flatten()
                        .copied()
                        .collect();
                    reached.entry(user).or_default().extend(through);
                }
                if reached.values().map(BTreeSet::len).sum::<usize>() == before {
                    break;
                }
            }
            let reaches = |a: &str, b: &str| reached.get(a).is_some_and(|all| all.contains(b));
            let mut seen: BTreeSet<&str> = BTreeSet::new();
            for &module in reached.keys().filter(|module| reaches(module, module)) {
                if seen.contains(module) {
                    continue;
                }
                let members: BTreeSet<&str> =
                    reached.keys().copied().filter(|m| reaches(module, m) && reaches(m, module)).collect();
                seen.extend(&members);
                let inside = arrows.iter().filter(|((user, used), _)| {
                    members.contains(user.as_str()) && members.contains(used.as_str())
                });
                let full = |name: &&str| [&parent[..], &[(*name).to_owned()]].concat().join("::");
                circles.push(Circle {
                    modules: members.iter().map(full).collect(),
                    arrows: inside.map(|(_, shown)| shown.clone()).collect(),
                });
            }
        }
        circles
    }
}

/// Collects what a module declares and mentions.
struct Reader<'ast> {
    module: Module,
    /// Inline modules, which are modules of their own.
    inner: Vec<(String, &'ast [syn::Item])>,
}

impl Reader<'_> {
    fn import(&mut self, tree: &syn::UseTree, before: &[String]) {
        match tree {
            syn::UseTree::Path(path) => {
                self.import(&path.tree, &[before, &[path.ident.to_string()]].concat());
            }
            syn::UseTree::Name(name) => {
                let name = name.ident.to_string();
                if name == "self" {
                    if let Some(last) = before.last() {
                        self.module.imports.insert(last.clone(), before.to_vec());
                    }
                } else {
                    self.module.imports.insert(name.clone(), [before, &[name]].concat());
                }
            }
            syn::UseTree::Rename(rename) => {
                let (name, path) = (rename.ident.to_string(), before.to_vec());
                let path = if name == "self" { path } else { [path, vec![name]].concat() };
                // `use Trait as _` names nothing, but uses the module all the same.
                if rename.rename == "_" {
                    self.module.paths.insert(path);
                } else {
                    self.module.imports.insert(rename.rename.to_string(), path);
                }
            }
            syn::UseTree::Glob(_) => self.module.globs.push(before.to_vec()),
            syn::UseTree::Group(group) => group.items.iter().for_each(|tree| self.import(tree, before)),
        }
    }

    /// Paths in the tokens of a macro call: names joined by `::`.
    fn tokens(&mut self, tokens: proc_macro2::TokenStream) {
        use proc_macro2::TokenTree;
        let mut path: Vec<String> = Vec::new();
        let mut colons = 0;
        for token in tokens {
            match token {
                TokenTree::Ident(name) => {
                    if colons != 2 {
                        self.mention(std::mem::take(&mut path));
                    }
                    path.push(name.to_string());
                    colons = 0;
                }
                TokenTree::Punct(mark) if mark.as_char() == ':' && !path.is_empty() => colons += 1,
                other => {
                    self.mention(std::mem::take(&mut path));
                    colons = 0;
                    if let TokenTree::Group(group) = other {
                        self.tokens(group.stream());
                    }
                }
            }
        }
        self.mention(path);
    }

    fn mention(&mut self, path: Vec<String>) {
        if !path.is_empty() {
            self.module.paths.insert(path);
        }
    }
}

/// Whether an item is there for tests alone.
fn is_for_tests(attributes: &[syn::Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        attribute.path().is_ident("test")
            || attribute.path().is_ident("cfg")
                && attribute.parse_args::<syn::Ident>().is_ok_and(|condition| condition == "test")
    })
}

/// Attributes and name of an item that has both.
fn head(item: &syn::Item) -> (&[syn::Attribute], Option<&syn::Ident>) {
    match item {
        syn::Item::Const(item) => (&item.attrs, Some(&item.ident)),
        syn::Item::Enum(item) => (&item.attrs, Some(&item.ident)),
        syn::Item::Fn(item) => (&item.attrs, Some(&item.sig.ident)),
        syn::Item::Impl(item) => (&item.attrs, None),
        syn::Item::Macro(item) => (&item.attrs, item.ident.as_ref()),
        syn::Item::Mod(item) => (&item.attrs, None),
        syn::Item::Static(item) => (&item.attrs, Some(&item.ident)),
        syn::Item::Struct(item) => (&item.attrs, Some(&item.ident)),
        syn::Item::Trait(item) => (&item.attrs, Some(&item.ident)),
        syn::Item::Type(item) => (&item.attrs, Some(&item.ident)),
        syn::Item::Union(item) => (&item.attrs, Some(&item.ident)),
        syn::Item::Use(item) => (&item.attrs, None),
        _ => (&[], None),
    }
}

impl<'ast> Visit<'ast> for Reader<'ast> {
    fn visit_item(&mut self, item: &'ast syn::Item) {
        let (attributes, name) = head(item);
        if is_for_tests(attributes) {
            return;
        }
        if let Some(name) = name {
            self.module.items.insert(name.to_string());
        }
        match item {
            syn::Item::Use(item) => self.import(&item.tree, &[]),
            syn::Item::Mod(item) => {
                if let Some((_, items)) = &item.content {
                    self.inner.push((item.ident.to_string(), items));
                }
            }
            item => syn::visit::visit_item(self, item),
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        self.mention(path.segments.iter().map(|segment| segment.ident.to_string()).collect());
        syn::visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, call: &'ast syn::Macro) {
        self.visit_path(&call.path);
        self.tokens(call.tokens.clone());
    }
}

#[cfg(test)]
mod tests {
    use super::{Circle, Modules};

    fn modules(sources: &[(&str, &str)]) -> Modules {
        let mut modules = Modules::default();
        for (path, source) in sources {
            let path: Vec<_> = path.split("::").filter(|name| !name.is_empty()).map(str::to_owned).collect();
            modules.add(&path, source).unwrap();
        }
        modules
    }

    fn names(circles: &[Circle]) -> Vec<String> {
        circles.iter().map(|circle| circle.modules.join(" ")).collect()
    }

    #[test]
    fn modules_that_use_each_other_are_a_circle() {
        let both = modules(&[
            ("", "mod a; mod b;"),
            ("a", "use crate::b::Beta; pub struct Alpha(Beta);"),
            ("b", "use super::a::Alpha; pub struct Beta(Box<Alpha>);"),
        ]);
        let circles = both.circles();
        assert_eq!(names(&circles), ["a b"]);
        assert_eq!(circles[0].arrows, ["a → b", "b → a"]);
        let one_way = modules(&[
            ("", "mod a; mod b;"),
            ("a", "use crate::b::Beta; pub struct Alpha(Beta);"),
            ("b", "pub struct Beta;"),
        ]);
        assert_eq!(one_way.circles(), []);
    }

    #[test]
    fn re_exports_lead_to_the_module_that_defines() {
        let source = [
            ("", "mod a; mod b; mod c; pub use a::Alpha; pub use b::*;"),
            ("a", "use crate::Beta; pub struct Alpha(Beta);"),
            ("b", "mod inside; pub use inside::Beta;"),
            ("b::inside", "use crate::Alpha; pub struct Beta(Box<Alpha>);"),
            ("c", "use crate::{Alpha, Beta}; pub fn c(_: Alpha, _: Beta) {}"),
        ];
        assert_eq!(names(&modules(&source).circles()), ["a b"]);
    }

    #[test]
    fn a_longer_way_round_is_found_and_children_of_another_parent_are_not_mixed_up() {
        let ring = modules(&[
            ("", "mod one; mod two; mod three;"),
            ("one", "mod a; mod b; fn f() { super::two::f(); }"),
            ("one::a", "fn f() { vec![crate::one::b::f()]; }"),
            ("one::b", "pub fn f() {}"),
            ("two", "pub fn f() { format!(\"{}\", crate::three::f()) }"),
            ("three", "pub fn f() { let _: crate::one::a::Thing; }"),
        ]);
        assert_eq!(names(&ring.circles()), ["one three two"]);
    }

    #[test]
    fn tests_parents_and_other_crates_are_no_arrows() {
        let fine = modules(&[
            ("", "mod a; mod b; pub fn root() { a::f(); }"),
            (
                "a",
                "use glam::Vec3; pub fn f() { crate::root(); } #[cfg(test)] mod tests { use crate::b::f; }",
            ),
            ("b", "use std::fmt; pub fn f() { crate::a::f(); } #[test] fn t() { crate::a::f(); }"),
        ]);
        assert_eq!(fine.circles(), []);
    }
}
