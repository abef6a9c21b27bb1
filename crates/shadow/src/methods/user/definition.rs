//! A version of a user's method: what its files say, composed with what the program gives, and checked.

use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering};

use lovelock_base::settings::{Field, Info, Setting, Value};
use lovelock_gpu::{ShaderPart, ShaderSource, check_shader};

use super::description::{self, Description, Words};
use super::turns::{MAX_TURNS, TURNS, bound_loops, declared};
use super::{MAX_SETTINGS, UserSettings};
use crate::gpu::{EXP, PointLookup, RAY, wgsl};
use crate::methods::texels::gpu as texels;

const GIVEN: ShaderPart = wgsl!("methods/user/", "given.wgsl");
const GIVEN_IN_QUERY: ShaderPart = wgsl!("methods/user/", "given_in_query.wgsl");

/// The function that every method has, and its parameters.
const QUERY: [&str; 2] = ["optical_depth", "(texel: u32, depth: f32) -> f32"];

/// Variables of the program that would let a method count its turns anew or write past its record.
const OF_THE_PROGRAM: [&str; 3] = ["turns", "fault", "map"];
/// Memory of the variables of the method per thread, bytes.
const MAX_VARIABLES: u64 = 16 << 10;

/// The versions of all methods so far.
static VERSIONS: AtomicU32 = AtomicU32::new(1);

/// One version of a method, which lives as long as the program: a few kilobytes for each time that its files were saved.
#[derive(Debug)]
pub(super) struct Definition {
    /// Its number among those of all methods, in 24 bits.
    pub version: u32,
    pub label: &'static str,
    pub text: &'static str,
    pub record: Words,
    pub scratch: Words,
    pub passes: Vec<UserPass>,
    /// The parts that define `depth_before`.
    pub query: Vec<ShaderPart>,
    pub infos: Vec<Info>,
    pub defaults: Vec<f32>,
    /// The path of the shader.
    shader: &'static str,
    /// The line of each loop.
    loops: Vec<usize>,
}

/// A pass with its shader.
#[derive(Debug)]
pub(super) struct UserPass {
    pub name: &'static str,
    pub source: ShaderSource,
    pub entry: &'static str,
    pub over_fragments: bool,
}

fn keep(text: String) -> &'static str {
    Box::leak(text.into_boxed_str())
}

impl Definition {
    /// Composes and checks a version.
    ///
    /// # Errors
    /// A sentence, with file and line where it has one.
    pub fn new(
        folder: &Path,
        toml: &str,
        shader: impl FnOnce(&str) -> Result<String, String>,
    ) -> Result<Self, String> {
        let said = folder.join("method.toml").display().to_string();
        let described = description::read(toml).map_err(|(line, why)| match line {
            Some(line) => format!("{said}, line {line}: {why}"),
            None => format!("{said}: {why}"),
        })?;
        let text = shader(&described.shader)?;
        let path = keep(folder.join(&described.shader).display().to_string());
        for pass in &described.passes {
            if declared(&text, &pass.function).is_none() {
                return Err(format!(
                    "{said}, line {}: there is no function {} in {path}",
                    pass.line, pass.function
                ));
            }
        }
        if declared(&text, QUERY[0]).is_none() {
            return Err(format!("{path}: there is no fn {}{}", QUERY[0], QUERY[1]));
        }
        let bounded = bound_loops(&text).map_err(|(line, why)| format!("{path}, line {line}: {why}"))?;
        let composed = Composed::new(&described, path, keep(bounded.text));
        composed.check(&text)?;
        let version = VERSIONS.fetch_add(1, Ordering::Relaxed) & 0xff_ffff;
        let infos = described.settings.iter().map(info).collect();
        Ok(Self {
            version,
            label: keep(described.name),
            text: keep(if described.text.is_empty() {
                format!("The method of {}.", folder.display())
            } else {
                described.text
            }),
            record: described.record,
            scratch: described.scratch,
            passes: composed.passes,
            query: composed.query,
            infos,
            defaults: described.settings.iter().map(|setting| setting.default as f32).collect(),
            shader: path,
            loops: bounded.lines,
        })
    }

    /// What a device reports of a failure, if it is one of this version: see turns.wgsl.
    pub fn fault(&self, word: u32) -> Option<String> {
        let line = self.loops.get((word & 0xff).checked_sub(1)? as usize)?;
        (word >> 8 == self.version).then(|| {
            format!(
                "{}, line {line}: this loop did not end after {MAX_TURNS} turns; a method may take no more in one call of a \
                 function",
                self.shader
            )
        })
    }

    /// The values of the settings: those that are set, within their ranges, and otherwise the defaults.
    pub fn values(&self, settings: &UserSettings) -> [f32; MAX_SETTINGS] {
        let mut values = [0.0; MAX_SETTINGS];
        for (at, ((value, default), info)) in
            values.iter_mut().zip(&self.defaults).zip(&self.infos).enumerate()
        {
            let set = settings.values[at].unwrap_or(*default);
            *value = number(info.clamp(of_number(info, set), of_number(info, *default)));
        }
        values
    }
}

/// The value of a setting as a number.
pub(super) fn number(value: Value) -> f32 {
    value.numbers().first().map_or(0.0, |value| *value as f32)
}

/// A number as the value of a setting.
pub(super) fn of_number(info: &Info, number: f32) -> Value {
    match info.kind {
        lovelock_base::settings::Kind::Count(_) => Value::Count(number as u64),
        _ => Value::Number(f64::from(number)),
    }
}

/// The table entry of a setting.
fn info(setting: &description::SettingOfUser) -> Info {
    // Values are read and written by name: `UserSettings` has no field for each.
    let field =
        Field::<UserSettings> { name: keep(setting.name.clone()), get: |_| Value::None, set: |_, _| () };
    let (label, text) = (keep(setting.label.clone()), keep(setting.text.clone()));
    if setting.is_count {
        Setting::count(field, setting.range.map(|end| end as u64), label, text).info
    } else {
        Setting::number(field, setting.range, label, text).info
    }
}

/// The shaders of a method.
struct Composed {
    passes: Vec<UserPass>,
    query: Vec<ShaderPart>,
    /// The path of the user's file, which is the name of its part.
    path: &'static str,
}

impl Composed {
    fn new(described: &Description, path: &'static str, text: &'static str) -> Self {
        let user = ShaderPart { name: path, text };
        let settings = ShaderPart { name: "settings of method.toml", text: keep(functions(described)) };
        // A call with other parameters is an error in the part that calls, so its name says what must be.
        let calls = |name: &str, parameters: &str, text: String| ShaderPart {
            name: keep(format!("{path}: fn {name} must have the parameters {parameters}")),
            text: keep(text),
        };
        let passes = described.passes.iter().map(|pass| {
            let name = &pass.function;
            let (call, entry, last) = if pass.over_fragments {
                let text = format!(
                    "fn put(texel: u32, depth: f32, weight: u32) {{ turns = 0u; {name}(texel, depth, weight); }}\n"
                );
                let parts = vec![texels::THIN_STEP, RAY, texels::LINES];
                (calls(name, "(texel: u32, depth: f32, weight: u32)", text), "draw", parts)
            } else {
                let text = format!("fn texel_pass(texel: u32) {{ turns = 0u; {name}(texel); }}\n");
                (calls(name, "(texel: u32)", text), "each_texel", vec![texels::EACH_TEXEL])
            };
            let given = [EXP, texels::FRAME, texels::BUILD, TURNS, GIVEN, settings];
            let parts: Vec<_> = given.into_iter().chain(last).chain([call, user]).collect();
            UserPass {
                name: keep(format!("shadow/{name}")),
                source: ShaderSource::new(&parts),
                entry,
                over_fragments: pass.over_fragments,
            }
        });
        let ask = format!(
            "fn depth_before(texel: u32, depth: f32) -> f32 {{ turns = 0u; return {}(texel, depth); }}\n",
            QUERY[0]
        );
        let ask = calls(QUERY[0], QUERY[1], ask);
        let query = vec![texels::FRAME, texels::LOOKUP, TURNS, GIVEN_IN_QUERY, settings, ask, user];
        Self { passes: passes.collect(), query, path }
    }

    /// Checks every shader. `text` is the user's own.
    fn check(&self, text: &str) -> Result<(), String> {
        let lookups = PointLookup::shaders(&self.query, true).into_iter().map(|(_, source)| source);
        for source in self.passes.iter().map(|pass| pass.source.clone()).chain(lookups) {
            let module = check_shader(&source).map_err(|error| self.in_own_file(&error.to_string(), text))?;
            self.check_variables(&module, &source)?;
        }
        Ok(())
    }

    /// An error of the compiler, at the user's line where it is about a name that the program has taken.
    fn in_own_file(&self, error: &str, text: &str) -> String {
        if error.starts_with(&format!("{}, line ", self.path)) {
            return error.to_owned();
        }
        if let Some(said) = error.strip_prefix(self.path).and_then(|rest| rest.strip_prefix(": fn ")) {
            let said = said.split(", line ").next().unwrap_or(said);
            let name = said.split(' ').next().unwrap_or_default();
            let line = declared(text, name).unwrap_or(1);
            return format!("{}, line {line}: fn {said}", self.path);
        }
        let name = error.split('`').nth(1).unwrap_or_default();
        match declared(text, name) {
            Some(line) if error.contains("redefinition") => {
                format!(
                    "{}, line {line}: the name `{name}` is taken by the program; choose another one",
                    self.path
                )
            }
            _ => error.to_owned(),
        }
    }

    /// Refuses resources of the user's own, and variables that need much memory in each thread.
    fn check_variables(&self, module: &naga::Module, source: &ShaderSource) -> Result<(), String> {
        let place = |span: naga::Span| {
            let (name, line) = source.locate(span.location(source.text()).line_number as usize);
            (name == self.path).then_some(line)
        };
        let bytes = |ty: naga::Handle<naga::Type>| {
            u64::from(module.types[ty].inner.try_size(module.to_ctx()).unwrap_or(u32::MAX))
        };
        let mut all = 0_u64;
        for (handle, variable) in module.global_variables.iter() {
            let Some(line) = place(module.global_variables.get_span(handle)) else { continue };
            let name = variable.name.as_deref().unwrap_or_default();
            if variable.space != naga::AddressSpace::Private {
                return Err(format!(
                    "{}, line {line}: `{name}` needs a resource of its own, and the program binds none for a method; use \
                     record_load and record_store, or var<private>",
                    self.path
                ));
            }
            all = all.saturating_add(bytes(variable.ty));
        }
        let functions =
            module.functions.iter().filter(|(handle, _)| place(module.functions.get_span(*handle)).is_some());
        for (_, function) in functions {
            for (_, variable) in function.local_variables.iter() {
                all = all.saturating_add(bytes(variable.ty));
            }
            for (at, expression) in function.expressions.iter() {
                let naga::Expression::GlobalVariable(variable) = *expression else { continue };
                let name = module.global_variables[variable].name.as_deref().unwrap_or_default();
                let is_own = place(module.global_variables.get_span(variable)).is_some();
                if !is_own && OF_THE_PROGRAM.contains(&name) {
                    let line = place(function.expressions.get_span(at)).unwrap_or_default();
                    return Err(format!(
                        "{}, line {line}: `{name}` is a variable of the program, which a method may not use",
                        self.path
                    ));
                }
            }
        }
        if all > MAX_VARIABLES {
            return Err(format!(
                "{}: its variables need {all} bytes in each thread; must be at most {MAX_VARIABLES}",
                self.path
            ));
        }
        Ok(())
    }
}

/// A function of WGSL for each setting: the uniform has room for 16 numbers.
fn functions(described: &Description) -> String {
    let function = |(at, setting): (usize, &description::SettingOfUser)| {
        let (name, from) = (&setting.name, format!("texels.starts[{}][{}]", at / 4, at % 4));
        if setting.is_count {
            format!("fn {name}() -> u32 {{ return u32({from}); }}\n")
        } else {
            format!("fn {name}() -> f32 {{ return {from}; }}\n")
        }
    };
    described.settings.iter().enumerate().map(function).collect()
}
