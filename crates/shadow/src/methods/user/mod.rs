//! A shadow method of the user's own: a folder with `method.toml` and a shader, `method.wgsl`.
//!
//! The method is one with a record per texel. The program rasterises strands into the texels of the light and filters lookups, as for its
//! own methods; the user's functions make the record, and read an optical depth from it. It has no definition on the CPU: there it runs on
//! a graphics device of its own, a software one if there is one.
//!
//! What a shader can do is limited: it is compiled with checks of bounds, its loops end after a number of turns, and the version before it
//! comes back when it fails.

mod cpu;
mod definition;
mod description;
mod folder;
mod gpu;
mod template;
mod turns;

pub use template::new_method;

use std::borrow::Cow;
use std::cmp::Ordering;
use std::fmt;
use std::hash::{Hash, Hasher};
use std::path::Path;

use lovelock_base::field;
use lovelock_base::settings::{AnySettings, Info, Part, PartMut, Setting, Value};
use serde::{Deserialize, Serialize};

use self::cpu::UserOnDevice;
use self::definition::{number, of_number};
use self::folder::Slot;
use self::gpu::UserShadow;
use super::method::{MapKind, MapSize, Method};
use super::none::NoShadow;
use super::texels::{self, TexelFilter, TexelFrame};
use crate::{CpuShadow, ShadowMethod, ShadowSettings};

/// The most settings of a method.
const MAX_SETTINGS: usize = 8;

/// What the id of a method starts with in project files, before its folder.
const PREFIX: &str = "folder:";

/// What is the same for all methods of users. `gpu_shadow` and `cpu_shadow` make their maps.
pub(super) static METHOD: Method = Method {
    id: "user",
    label: "User's method",
    description: "A method of the user's own.",
    source: None,
    advice: "lower the map's resolution or the words of a record",
    map: MapKind::Texels,
    size: |settings| Some(MapSize { edge: settings.of_user().resolution, per_texel: None }),
    words: |settings| {
        let ShadowMethod::User(user) = settings.method else { return 0 };
        user.definition().map_or(0, |definition| {
            let values = definition.values(settings.of_user());
            definition.record.with(|at| f64::from(values[at]))
        })
    },
    marks: &[texels::ALL_HAIR],
    settings: |settings| Some(settings.of_user()),
    footprint: |input, settings, bounds| {
        TexelFrame::new(input, settings.of_user().clamped().resolution, bounds)
    },
    counts_points: |_| false,
    // What it does with strands is not known.
    sums_strands: false,
    in_world: false,
    cpu: || Box::new(NoShadow),
    gpu: UserShadow::boxed,
    shaders: Vec::new,
};

/// A shadow method of the user's own, by its folder.
///
/// Two are the same if their folders are; a method that was saved again is still the same one.
#[derive(Clone, Copy)]
pub struct UserMethod(&'static Slot);

impl UserMethod {
    /// Its id in reports and on the command line.
    pub fn id(self) -> &'static str {
        &self.0.id
    }

    /// Its name in menus.
    pub fn label(self) -> &'static str {
        self.definition().map_or(self.0.id.as_str(), |definition| definition.label)
    }

    /// One sentence: what it does.
    pub fn description(self) -> &'static str {
        self.definition()
            .map_or("A method of the user's own, whose files have a problem.", |definition| definition.text)
    }

    /// The method that the text of a project or an option names: by its folder after `folder:`, or one that is known by its id.
    pub(super) fn parse(text: &str) -> Option<Self> {
        let folder = text.strip_prefix(PREFIX).filter(|folder| !folder.is_empty());
        folder.map(|folder| Self::of_folder(Path::new(folder))).or_else(|| Self::named(text))
    }

    /// The text that names it in a project.
    pub(super) fn text(self) -> String {
        format!("{PREFIX}{}", self.folder().display())
    }

    /// An empty map where the program renders on the CPU: everything is lit until it is built.
    pub(super) fn on_device(self) -> Box<dyn CpuShadow + Send + Sync> {
        Box::new(UserOnDevice::new(self))
    }

    /// Its settings with their defaults.
    fn defaults(self) -> &'static UserSettings {
        self.0.defaults.get_or_init(|| UserSettings { method: Some(self), ..UserSettings::default() })
    }
}

impl fmt::Debug for UserMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("UserMethod").field(&self.0.id).finish()
    }
}

impl PartialEq for UserMethod {
    fn eq(&self, other: &Self) -> bool {
        self.0.index == other.0.index
    }
}

impl Eq for UserMethod {}

impl Hash for UserMethod {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.0.index.hash(state);
    }
}

impl PartialOrd for UserMethod {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for UserMethod {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.index.cmp(&other.0.index)
    }
}

/// The settings of the user's method that was changed last; another one has its defaults.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct UserSettings {
    /// The method.
    #[serde(with = "as_text")]
    pub method: Option<UserMethod>,
    /// The most texels along each edge; see [`TEXEL_RESOLUTIONS`](crate::TEXEL_RESOLUTIONS).
    pub resolution: u32,
    /// How a point reads the texels around it.
    pub filter: TexelFilter,
    /// The values of the method's own settings in their order; none where the default is used.
    pub values: [Option<f32>; MAX_SETTINGS],
}

/// A method as its text.
mod as_text {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use super::UserMethod;

    // The library passes fields by reference.
    #[allow(clippy::ref_option, clippy::trivially_copy_pass_by_ref)]
    pub fn serialize<S: Serializer>(method: &Option<UserMethod>, to: S) -> Result<S::Ok, S::Error> {
        method.map_or_else(String::new, UserMethod::text).serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Option<UserMethod>, D::Error> {
        String::deserialize(from).map(|text| UserMethod::parse(&text))
    }
}

impl Default for UserSettings {
    fn default() -> Self {
        Self {
            method: None,
            resolution: texels::DEFAULT_RESOLUTION,
            filter: TexelFilter::default(),
            values: [None; MAX_SETTINGS],
        }
    }
}

/// What every method has.
static GIVEN: [Setting<UserSettings>; 2] =
    [texels::resolution(field!(UserSettings, resolution)), texels::filter(field!(UserSettings, filter))];

impl UserSettings {
    /// Whether no method was set, so that projects need not hold it.
    pub(super) fn is_unused(&self) -> bool {
        *self == Self::default()
    }

    /// The same within their ranges.
    pub(crate) fn clamped(&self) -> Self {
        let mut settings = *self;
        AnySettings::clamp(&mut settings);
        settings
    }

    /// The table of the method's own settings.
    fn own(&self) -> &'static [Info] {
        self.method.and_then(|method| method.definition().ok()).map_or(&[], |definition| &definition.infos)
    }

    fn own_value(&self, at: usize) -> Option<(&'static Info, Value)> {
        let info = self.own().get(at)?;
        let default = self.method?.definition().ok()?.defaults.get(at)?;
        Some((info, of_number(info, self.values[at].unwrap_or(*default))))
    }
}

impl AnySettings for UserSettings {
    fn infos(&self) -> Vec<&'static Info> {
        GIVEN.iter().map(|setting| &setting.info).chain(self.own()).collect()
    }

    fn value(&self, name: &str) -> Option<(&'static Info, Value)> {
        let given = GIVEN.iter().find(|setting| setting.info.name == name);
        let given = given.map(|setting| (&setting.info, setting.get(self)));
        given.or_else(|| self.own_value(self.own().iter().position(|info| info.name == name)?))
    }

    fn assign(&mut self, name: &str, value: Value) {
        if let Some(setting) = GIVEN.iter().find(|setting| setting.info.name == name) {
            setting.set(self, value);
        } else if let Some(at) = self.own().iter().position(|info| info.name == name)
            && !value.numbers().is_empty()
        {
            self.values[at] = Some(number(value));
        }
    }

    fn clamp(&mut self) {
        let default = Self::default();
        for setting in &GIVEN {
            let clamped = setting.info.clamp(setting.get(self), setting.get(&default));
            setting.set(self, clamped);
        }
        for at in 0..MAX_SETTINGS {
            if self.values[at].is_some_and(|value| !value.is_finite()) {
                self.values[at] = None;
            }
            if let (Some((info, value)), true) = (self.own_value(at), self.values[at].is_some()) {
                self.values[at] = Some(number(info.clamp(value, value)));
            }
        }
    }

    fn children(&self) -> Vec<Part<'_>> {
        Vec::new()
    }

    fn children_mut(&mut self) -> Vec<PartMut<'_>> {
        Vec::new()
    }
}

impl ShadowSettings {
    /// The settings of the user's method in use.
    pub(crate) fn of_user(&self) -> &UserSettings {
        match self.method {
            ShadowMethod::User(method) if self.user.method != Some(method) => method.defaults(),
            _ => &self.user,
        }
    }

    /// The same of any user's method.
    pub(super) fn of_any_user(&self, method: UserMethod) -> &UserSettings {
        if self.user.method == Some(method) { &self.user } else { method.defaults() }
    }

    /// The same, to be changed.
    pub(super) fn of_any_user_mut(&mut self, method: UserMethod) -> &mut UserSettings {
        if self.user.method != Some(method) {
            self.user = *method.defaults();
        }
        &mut self.user
    }

    /// The part of the settings that belongs to a user's method, if there is one.
    pub(super) fn user_part(&self) -> Option<(Cow<'static, str>, &dyn AnySettings)> {
        let is_user = matches!(self.method, ShadowMethod::User(_)) || self.user.method.is_some();
        is_user.then(|| ("user".into(), self.of_user() as &dyn AnySettings))
    }
}
