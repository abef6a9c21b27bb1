//! The folders of users' methods: which are known, what their files hold, and what is wrong with them.

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::SystemTime;

use super::definition::Definition;
use super::{UserMethod, UserSettings};
use crate::ShadowMethod;

/// The longest file that is read, bytes.
const MAX_FILE: u64 = 64 << 10;

/// The files of a method.
const DESCRIPTION: &str = "method.toml";

static SLOTS: Mutex<Vec<&'static Slot>> = Mutex::new(Vec::new());

/// Rises whenever a method has another version.
static REVISION: AtomicU64 = AtomicU64::new(0);

/// A folder that was named once, for the rest of the program's life.
pub(super) struct Slot {
    pub index: usize,
    pub id: String,
    pub folder: PathBuf,
    pub defaults: OnceLock<UserSettings>,
    /// Whether the user has named it, or allowed a project to name it: before, its files are not read.
    is_allowed: AtomicBool,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    /// Whether the files were read.
    is_read: bool,
    /// The version in use.
    current: Option<&'static Definition>,
    /// The version before it, should the device refuse this one.
    previous: Option<&'static Definition>,
    /// What is wrong with the files as they are.
    problem: Option<String>,
    /// The name of the shader that was read last.
    shader: String,
    stamps: [Stamp; 2],
}

/// When a file was changed, and its length.
type Stamp = Option<(SystemTime, u64)>;

fn stamp(path: &Path) -> Stamp {
    let data = fs::metadata(path).ok()?;
    Some((data.modified().ok()?, data.len()))
}

/// The text of a file.
fn text_of(path: &Path) -> Result<String, String> {
    let said = path.display();
    let refused = |error: std::io::Error| format!("{said}: cannot be read: {error}");
    // A pipe would never end.
    if !fs::metadata(path).map_err(refused)?.is_file() {
        return Err(format!("{said}: is no file"));
    }
    let mut bytes = Vec::new();
    fs::File::open(path).map_err(refused)?.take(MAX_FILE + 1).read_to_end(&mut bytes).map_err(refused)?;
    if bytes.len() as u64 > MAX_FILE {
        return Err(format!("{said}: is longer than {} KiB", MAX_FILE >> 10));
    }
    String::from_utf8(bytes)
        .map_err(|error| format!("{said}: byte {} is not UTF-8", error.utf8_error().valid_up_to()))
}

impl State {
    /// Reads the files again.
    fn read(&mut self, folder: &Path) {
        self.is_read = true;
        if self.shader.is_empty() {
            "method.wgsl".clone_into(&mut self.shader);
        }
        self.stamps = self.stamps_now(folder);
        let shader = &mut self.shader;
        let made = text_of(&folder.join(DESCRIPTION)).and_then(|toml| {
            Definition::new(folder, &toml, |name| {
                name.clone_into(shader);
                text_of(&folder.join(name))
            })
        });
        // The name of the shader may be another one now.
        self.stamps = self.stamps_now(folder);
        match made {
            Ok(definition) => {
                self.previous = self.current.replace(Box::leak(Box::new(definition)));
                self.problem = None;
                REVISION.fetch_add(1, Ordering::Relaxed);
            }
            Err(problem) => self.problem = Some(problem),
        }
    }

    fn stamps_now(&self, folder: &Path) -> [Stamp; 2] {
        [DESCRIPTION, &self.shader].map(|file| stamp(&folder.join(file)))
    }
}

impl Slot {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn read_state(&self) -> MutexGuard<'_, State> {
        let mut state = self.state();
        if !self.is_allowed.load(Ordering::Relaxed) {
            let folder = self.folder.display();
            state.problem = Some(format!(
                "{folder}: this project names a shadow method there; open the folder yourself to use it"
            ));
        } else if !state.is_read {
            state.read(&self.folder);
        }
        state
    }
}

/// An id for a folder: the letters, digits and dashes of its name, and a number if that is taken.
fn id_of(folder: &Path, slots: &[&'static Slot]) -> String {
    let name = folder.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
    let plain: String = name.chars().map(plain).take(40).collect();
    let plain = plain.trim_matches('-');
    let plain = if plain.is_empty() { "method" } else { plain };
    let taken = |id: &str| {
        id == "all"
            || ShadowMethod::ALL.iter().any(|method| method.id() == id)
            || slots.iter().any(|slot| slot.id == id)
    };
    let numbered = (2..).map(|number| format!("{plain}-{number}"));
    std::iter::once(plain.to_owned()).chain(numbered).find(|id| !taken(id)).unwrap_or_default()
}

impl UserMethod {
    /// The method of a folder. Its files are read when they are needed first, once [`UserMethod::allow`] was called.
    pub fn of_folder(folder: &Path) -> Self {
        let folder = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
        let mut slots = SLOTS.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(&known) = slots.iter().find(|slot| slot.folder == folder) {
            return Self(known);
        }
        let slot = Slot {
            index: slots.len(),
            id: id_of(&folder, &slots),
            folder,
            defaults: OnceLock::new(),
            is_allowed: AtomicBool::new(false),
            state: Mutex::default(),
        };
        let slot: &'static Slot = Box::leak(Box::new(slot));
        slots.push(slot);
        Self(slot)
    }

    /// Reads the method of a folder.
    ///
    /// # Errors
    /// A sentence, with file and line where it has one, if it cannot be used.
    pub fn load(folder: &Path) -> Result<Self, String> {
        let method = Self::opened(folder);
        method.0.state().read(&method.0.folder);
        match method.problem() {
            Some(problem) => Err(problem),
            None => Ok(method),
        }
    }

    /// The method of a folder that the user has named. Links are followed.
    pub fn opened(folder: &Path) -> Self {
        let method = Self::of_folder(&fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned()));
        method.allow();
        method
    }

    /// Allows its files to be read: the user has named the folder, or a project may read it.
    pub fn allow(self) {
        self.0.is_allowed.store(true, Ordering::Relaxed);
    }

    /// The file that describes it.
    pub fn description_file(self) -> PathBuf {
        self.0.folder.join(DESCRIPTION)
    }

    /// Every method whose folder was named so far.
    pub fn known() -> Vec<Self> {
        SLOTS.lock().unwrap_or_else(PoisonError::into_inner).iter().map(|&slot| Self(slot)).collect()
    }

    /// The method of that id, if it is known.
    pub(super) fn named(id: &str) -> Option<Self> {
        Self::known().into_iter().find(|method| method.0.id == id)
    }

    /// A number that changes when a method has another version: images that were drawn with the old one are out of date.
    pub fn revision() -> u64 {
        REVISION.load(Ordering::Relaxed)
    }

    /// Reads the files again if they were changed. Returns whether they were.
    pub fn follow(self) -> bool {
        let mut state = self.0.state();
        let changed = state.is_read && state.stamps != state.stamps_now(&self.0.folder);
        if changed {
            state.read(&self.0.folder);
        }
        changed
    }

    /// Its folder.
    pub fn folder(self) -> &'static Path {
        &self.0.folder
    }

    /// What is wrong with its files as they are, with file and line. The last version that worked stays in use.
    pub fn problem(self) -> Option<String> {
        self.0.read_state().problem.clone()
    }

    /// Whether there is a version that can be used.
    pub fn works(self) -> bool {
        self.0.read_state().current.is_some()
    }

    /// The version in use.
    ///
    /// # Errors
    /// Why there is none.
    pub(super) fn definition(self) -> Result<&'static Definition, String> {
        let state = self.0.read_state();
        let missing =
            || state.problem.clone().unwrap_or_else(|| format!("{}: was not read", self.0.folder.display()));
        state.current.ok_or_else(missing)
    }

    /// Takes the version in use out of use, because the graphics device was lost while this method was drawn. Saving it tries it again.
    pub fn distrust(self) {
        if let Ok(definition) = self.definition() {
            let problem = format!(
                "{}: the graphics device was lost while it was drawn; save it to try it again",
                self.0.folder.display()
            );
            self.refuse(definition.version, &problem);
        }
    }

    /// Takes a version out of use because of a problem, and returns to the one before it. Returns whether there is one.
    pub(super) fn refuse(self, version: u32, problem: &str) -> bool {
        let mut state = self.0.state();
        // Another version has taken its place already.
        if state.current.is_none_or(|current| current.version != version) {
            return state.current.is_some();
        }
        state.current = state.previous.take();
        state.problem = Some(problem.to_owned());
        REVISION.fetch_add(1, Ordering::Relaxed);
        state.current.is_some()
    }
}
