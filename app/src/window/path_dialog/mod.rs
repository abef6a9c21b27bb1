//! The dialog for a path: a text field with a list of what is in the folder, and the system's own dialog if there is one.

mod folder;
mod list;
#[cfg(test)]
mod tests;

use std::path::{MAIN_SEPARATOR, Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};

use egui::text::{CCursor, CCursorRange};
use egui::{Align, Id, Key, Layout, Modifiers, RichText, Ui, vec2};
use lovelock_base::clock::Stopwatch;

use super::purpose::{Purpose, Replaces};
use super::theme;
use crate::window::control::{HoverTooltip, titled_dialog};
use folder::Folder;

/// A dialog that returns sooner than this without a path was never shown, seconds: no user closes a dialog so quickly, and the
/// system's answer is the same in both cases.
const NO_DIALOG_SECS: f64 = 0.5;
/// Width of the dialog, points.
const WIDTH: f32 = 520.0;
/// Height of the lines below the list, which hold an error, a warning or a question: the buttons stay where they are.
const SAID: f32 = 38.0;
/// The longest path that is shown in a line, characters.
const LONGEST: usize = 76;

/// What the dialog does at present.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Stage {
    /// The user types.
    Types,
    /// The user is asked whether this file is replaced.
    Asks(PathBuf),
    /// This file is being looked into.
    Waits(PathBuf),
}

/// An open dialog for a path.
#[derive(Debug)]
pub(crate) struct PathDialog {
    purpose: Purpose,
    /// The folder in which a name lies that is typed without one.
    base: PathBuf,
    typed: String,
    /// Whether the text was changed since the dialog suggested it.
    is_edited: bool,
    /// The characters that are selected in the next pass.
    select: Option<[usize; 2]>,
    /// Describes the file that will be written.
    about: Option<String>,
    /// The file of the project, which saving replaces without a question.
    own: Option<PathBuf>,
    /// Files that were used before.
    recent: Vec<PathBuf>,
    folder: Folder,
    /// The row of the list that the keys have chosen.
    chosen: Option<usize>,
    /// The row that was clicked last.
    clicked: Option<folder::Entry>,
    stage: Stage,
    /// Why the path was refused.
    error: Option<String>,
    /// The answer of the system's dialog, and when it was opened.
    browsed: Option<(Receiver<Option<PathBuf>>, Stopwatch)>,
    /// Whether the system appears to have no dialog.
    no_dialog: bool,
}

/// The state of the dialog after a pass.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Answer {
    /// It is still open.
    Pending,
    /// It was closed without a path.
    Closed,
    /// This path was chosen. The dialog stays until it is closed or told that the path is refused.
    Path(Purpose, PathBuf),
}

impl PathDialog {
    /// Opens the dialog in the folder of `suggestion`, with its name in the field, selected up to its extension. A path that ends in a
    /// separator suggests a folder alone.
    pub(crate) fn new(purpose: Purpose, suggestion: &Path) -> Self {
        let is_folder = suggestion.as_os_str().is_empty()
            || suggestion.as_os_str().to_string_lossy().ends_with(std::path::is_separator);
        let absolute = std::path::absolute(suggestion).unwrap_or_else(|_| suggestion.to_owned());
        let (base, name) = match (absolute.parent(), absolute.file_name()) {
            (Some(parent), Some(name)) if !is_folder => (parent.to_owned(), name.to_owned()),
            _ => (absolute, std::ffi::OsString::new()),
        };
        let typed = name.to_string_lossy().into_owned();
        let mut dialog = Self {
            purpose,
            base,
            typed,
            is_edited: false,
            select: None,
            about: None,
            own: None,
            recent: Vec::new(),
            folder: Folder::default(),
            chosen: None,
            clicked: None,
            stage: Stage::Types,
            error: None,
            browsed: None,
            no_dialog: false,
        };
        dialog.select_name();
        dialog
    }

    /// Adds a line that describes the file that will be written.
    pub(crate) fn about(self, text: String) -> Self {
        Self { about: Some(text), ..self }
    }

    /// Sets the file of the project, which saving replaces without a question.
    pub(crate) fn own(self, own: Option<PathBuf>) -> Self {
        Self { own, ..self }
    }

    /// Offers files that were used before, as far as they fit.
    pub(crate) fn recent(self, recent: impl IntoIterator<Item = PathBuf>) -> Self {
        let purpose = self.purpose;
        let mut fitting: Vec<PathBuf> = Vec::new();
        for path in recent.into_iter().filter(|path| purpose.opens() && purpose.lists(path)) {
            if !fitting.contains(&path) {
                fitting.push(path);
            }
        }
        Self { recent: fitting, ..self }
    }

    /// Says that the file is being looked into, until [`PathDialog::refuse`] or the end of the dialog.
    pub(crate) fn wait(&mut self, path: &Path) {
        self.stage = Stage::Waits(path.to_owned());
    }

    /// The file that is being looked into, if one is.
    pub(crate) fn waiting(&self) -> Option<&Path> {
        match &self.stage {
            Stage::Waits(path) => Some(path),
            Stage::Types | Stage::Asks(_) => None,
        }
    }

    /// Shows why the path cannot be used. The text stays, so that it can be corrected.
    pub(crate) fn refuse(&mut self, error: String) {
        self.stage = Stage::Types;
        self.error = Some(error);
    }

    /// Shows the dialog.
    pub(crate) fn show(&mut self, ctx: &egui::Context) -> Answer {
        if let Some((receiver, since)) = &self.browsed {
            match receiver.try_recv() {
                // The system has asked already whether the file is replaced.
                Ok(Some(path)) => {
                    self.browsed = None;
                    self.set(path.display().to_string());
                    return self.accept(path);
                }
                Ok(None) | Err(TryRecvError::Disconnected) => {
                    self.no_dialog = since.secs() < NO_DIALOG_SECS;
                    self.browsed = None;
                }
                Err(TryRecvError::Empty) => {}
            }
        }
        let (at, prefix) = self.place();
        self.folder.show(&at, self.purpose, ctx);
        let mut answer = Answer::Pending;
        let response = titled_dialog("path", self.purpose.title()).show(ctx, |ui| {
            ui.set_width(WIDTH);
            ui.heading(self.purpose.title());
            if let Some(about) = &self.about {
                ui.label(RichText::new(about).color(theme::quiet()));
            }
            let types = self.stage == Stage::Types;
            let rows = self.rows(&prefix);
            let mut entered = false;
            ui.add_enabled_ui(types, |ui| {
                entered = self.field(ui, &rows);
                self.target(ui);
                if let Some(list::Chosen { entry, is_twice }) =
                    list::show(ui, &rows, self.chosen, &self.folder)
                {
                    // The first click has changed the rows: the second one means the row of the first.
                    if let Some(first) = self.clicked.take().filter(|_| is_twice) {
                        entered |= !first.is_folder;
                    } else {
                        self.take(&entry);
                        self.clicked = Some(entry);
                    }
                }
            });
            ui.allocate_ui_with_layout(vec2(WIDTH, SAID), Layout::top_down(Align::Min), |ui| {
                ui.set_min_height(SAID);
                self.said(ui);
            });
            answer = ui.horizontal(|ui| self.buttons(ui, entered)).inner;
        });
        if response.should_close() && answer == Answer::Pending {
            answer = match &self.stage {
                // Escape takes back the question and not the whole dialog.
                Stage::Asks(_) => {
                    self.stage = Stage::Types;
                    self.select_name();
                    Answer::Pending
                }
                Stage::Types | Stage::Waits(_) => Answer::Closed,
            };
        }
        answer
    }

    /// The text field; whether Enter confirms it.
    fn field(&mut self, ui: &mut Ui, rows: &[list::Row]) -> bool {
        let id = Id::unique("path field");
        let has_focus = ui.memory(|memory| memory.has_focus(id));
        let mut entered = false;
        if has_focus {
            let pressed = |ui: &Ui, key| ui.input_mut(|input| input.consume_key(Modifiers::NONE, key));
            let last = rows.len().checked_sub(1);
            if pressed(ui, Key::ArrowDown) {
                self.chosen = last.map(|last| self.chosen.map_or(0, |at| (at + 1).min(last)));
            }
            if pressed(ui, Key::ArrowUp) {
                self.chosen = self.chosen.and_then(|at| at.checked_sub(1));
            }
            if ui.input_mut(|input| input.consume_key(Modifiers::SHIFT, Key::Tab)) {
                ui.memory_mut(|memory| memory.move_focus(egui::FocusDirection::Previous));
            } else if pressed(ui, Key::Tab) && !self.complete(rows) {
                ui.memory_mut(|memory| memory.move_focus(egui::FocusDirection::Next));
            }
            entered = pressed(ui, Key::Enter);
            if let Some(row) = self.chosen.and_then(|at| rows.get(at)).filter(|_| entered) {
                // A file that is opened is confirmed by the same key; a name to save under can still be changed.
                entered = self.purpose.opens() && !row.entry.is_folder;
                self.take(&row.entry.clone());
            }
        }
        let select = self.select.take();
        let field = ui.horizontal(|ui| {
            let label = ui.label("Path");
            let edit = egui::TextEdit::singleline(&mut self.typed)
                .id(id)
                .lock_focus(true)
                .hint_text(if self.purpose.is_folder() { "Name of a folder" } else { "Name of a file" })
                .desired_width(390.0);
            let field = ui.add(edit).labelled_by(label.id);
            let browse = ui.add_enabled(self.browsed.is_none(), egui::Button::new("Browse…"));
            if browse.hover_tooltip("Opens the system's file dialog.").clicked() {
                self.browse(ui.ctx());
            }
            field
        });
        let field = field.inner;
        if let Some([from, to]) = select {
            let mut state = egui::TextEdit::load_state(ui.ctx(), id).unwrap_or_default();
            state.cursor.set_char_range(Some(CCursorRange::two(CCursor::new(from), CCursor::new(to))));
            state.store(ui.ctx(), id);
            field.request_focus();
        } else if self.stage == Stage::Types && ui.memory(|memory| memory.focused().is_none()) {
            field.request_focus();
        }
        if field.changed() {
            self.is_edited = true;
            (self.chosen, self.error) = (None, None);
            self.drop_second_extension();
        }
        entered
    }

    /// Removes the extension of the suggestion behind a whole name that was typed over its selected part.
    fn drop_second_extension(&mut self) {
        let typed = Path::new(&self.typed);
        if let Some(name) = self.before_second_extension(typed) {
            let surplus = typed.file_name().unwrap_or_default().len() - name.len();
            self.typed.truncate(self.typed.len() - surplus);
        }
    }

    /// The name of `path` without its extension, if what remains has an extension of this purpose too.
    fn before_second_extension<'p>(&self, path: &'p Path) -> Option<&'p std::ffi::OsStr> {
        let name = path.file_stem().filter(|name| self.purpose.lists(Path::new(name)))?;
        (self.purpose.extension().is_some() && self.purpose.lists(path)).then_some(name)
    }

    /// The line with the whole path that the text means.
    fn target(&self, ui: &mut Ui) {
        let path = self.path().unwrap_or_else(|| self.place().0);
        let whole = path.display().to_string();
        let count = whole.chars().count();
        let shown = match count.checked_sub(LONGEST) {
            Some(surplus) if surplus > 0 => format!("…{}", whole.chars().skip(surplus).collect::<String>()),
            _ => whole.clone(),
        };
        ui.add(egui::Label::new(RichText::new(shown).small().color(theme::quiet())).truncate())
            .hover_tooltip(whole);
    }

    /// The lines that hold an error, a warning or a question.
    fn said(&self, ui: &mut Ui) {
        let name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let mut say = |text: String, color: egui::Color32| {
            let label = egui::Label::new(RichText::new(&text).color(color)).wrap();
            ui.add(label);
        };
        match &self.stage {
            Stage::Waits(path) => return say(format!("Opening {}", name(path)), theme::quiet()),
            Stage::Asks(path) => {
                let what = match self.purpose {
                    Purpose::SaveStrokes => "contains other strokes. Replace them?".to_owned(),
                    purpose => format!("is another {}. Replace it?", purpose.replaced()),
                };
                return say(format!("{} {what}", name(path)), theme::accent());
            }
            Stage::Types => {}
        }
        if let Some(error) = &self.error {
            return say(error.clone(), theme::wrong());
        }
        if self.no_dialog {
            return say(
                "The system has no file dialog. Type the path, or choose it in the list.".to_owned(),
                theme::wrong(),
            );
        }
        let Some(path) = self.path() else { return };
        if self.purpose.replaces(&path, self.own.as_deref()) != Replaces::Nothing {
            let kind = self.purpose.replaced();
            let text = match self.purpose {
                Purpose::Sequence => "The images in this folder will be replaced.".to_owned(),
                Purpose::SaveStrokes => "The strokes with this name will be replaced.".to_owned(),
                _ => format!("The {kind} with this name will be replaced."),
            };
            say(text, theme::accent());
        }
    }

    fn buttons(&mut self, ui: &mut Ui, entered: bool) -> Answer {
        if let Stage::Asks(path) = &self.stage {
            let path = path.clone();
            let replace = ui.button("Replace").clicked();
            let cancel = ui.button("Cancel");
            // Enter does not replace what cannot be brought back.
            if ui.memory(|memory| memory.focused().is_none()) {
                cancel.request_focus();
            }
            if replace {
                self.stage = Stage::Types;
                return Answer::Path(self.purpose, path);
            }
            if cancel.clicked() {
                self.stage = Stage::Types;
                self.select_name();
            }
            return Answer::Pending;
        }
        let types = self.stage == Stage::Types;
        let path = self.path();
        let go = ui.add_enabled(types && path.is_some(), egui::Button::new(self.purpose.button()));
        if ui.button("Cancel").clicked() {
            return Answer::Closed;
        }
        match path.filter(|_| types && (go.clicked() || entered)) {
            Some(path) => self.confirm(path, ui),
            None => Answer::Pending,
        }
    }

    /// Uses the path, or asks first, or says why it cannot be used.
    fn confirm(&mut self, path: PathBuf, ui: &Ui) -> Answer {
        if !self.purpose.is_folder() && path.is_dir() {
            self.enter(&path);
            return Answer::Pending;
        }
        if self.purpose.replaces(&path, self.own.as_deref()) == Replaces::Asks {
            self.stage = Stage::Asks(path);
            if let Some(focused) = ui.memory(egui::Memory::focused) {
                ui.memory_mut(|memory| memory.surrender_focus(focused));
            }
            return Answer::Pending;
        }
        self.accept(path)
    }

    fn accept(&mut self, path: PathBuf) -> Answer {
        self.error = None;
        if self.purpose.opens() && !path.exists() {
            self.refuse(format!("{}: not found; must be an existing file", path.display()));
            return Answer::Pending;
        }
        Answer::Path(self.purpose, path)
    }

    /// Replaces the text, with the name selected.
    fn set(&mut self, text: String) {
        (self.typed, self.is_edited, self.chosen, self.error) = (text, false, None, None);
        self.select_name();
    }

    /// Selects the name without its extension.
    fn select_name(&mut self) {
        let start = self.typed.rfind(std::path::is_separator).map_or(0, |at| at + 1);
        let name = &self.typed[start..];
        let stem = match self.purpose.extension() {
            Some(_) => name.rfind('.').filter(|at| *at > 0).unwrap_or(name.len()),
            None => name.len(),
        };
        let before = self.typed[..start].chars().count();
        self.select = Some([before, before + name[..stem].chars().count()]);
    }

    /// The typed text as a path: in the folder of the dialog if it names none.
    fn whole(&self) -> PathBuf {
        let typed = self.typed.trim();
        let home = typed
            .strip_prefix('~')
            .filter(|rest| rest.is_empty() || rest.starts_with(std::path::is_separator));
        match (home, std::env::home_dir()) {
            (Some(rest), Some(home)) => home.join(rest.trim_start_matches(std::path::is_separator)),
            _ => self.base.join(typed),
        }
    }

    /// The folder that is listed, and what its entries begin with.
    fn place(&self) -> (PathBuf, String) {
        let (whole, typed) = (self.whole(), self.typed.trim());
        if typed.is_empty() || typed.ends_with(std::path::is_separator) {
            return (whole, String::new());
        }
        let prefix =
            whole.file_name().filter(|_| self.is_edited).unwrap_or_default().to_string_lossy().into_owned();
        let folder = whole.parent().unwrap_or(&whole).to_owned();
        (folder, prefix)
    }

    /// The typed path, with the extension of its purpose.
    fn path(&self) -> Option<PathBuf> {
        let typed = self.typed.trim();
        if typed.is_empty() || (!self.purpose.is_folder() && typed.ends_with(std::path::is_separator)) {
            return None;
        }
        let mut path = self.whole();
        let Some(extension) = self.purpose.extension() else { return Some(path) };
        if path.is_dir() {
            return Some(path);
        }
        if let Some(name) = self.before_second_extension(&path) {
            path = path.with_file_name(name);
        }
        if !self.purpose.lists(&path) && path.extension().is_none_or(|found| !looks_like_extension(found)) {
            let mut name = path.file_name()?.to_owned();
            name.push(".");
            name.push(extension);
            path = path.with_file_name(name);
        }
        Some(path)
    }

    /// The rows of the list: the folder above, folders and files that begin as the text does, and recent files.
    fn rows(&self, prefix: &str) -> Vec<list::Row> {
        let mut rows = Vec::new();
        let (folder, _) = self.place();
        if prefix.is_empty()
            && let Some(above) = folder.parent()
        {
            rows.push(list::Row::above(above));
        }
        rows.extend(self.folder.beginning(prefix).into_iter().map(list::Row::of));
        let typed = self.typed.trim().to_lowercase();
        let fits =
            |path: &&PathBuf| !self.is_edited || path.to_string_lossy().to_lowercase().contains(&typed);
        rows.extend(self.recent.iter().filter(fits).map(|path| list::Row::recent(path)));
        rows
    }

    /// Takes a row of the list: enters a folder, or writes the name of a file into the field.
    fn take(&mut self, entry: &folder::Entry) {
        if entry.is_folder {
            self.enter(&entry.path);
        } else {
            self.set(self.shown(&entry.path));
        }
    }

    /// Lists another folder. The name that a file is saved under stays.
    fn enter(&mut self, folder: &Path) {
        let typed = self.typed.trim();
        let is_name =
            !typed.is_empty() && !typed.ends_with(std::path::is_separator) && !self.whole().is_dir();
        let name = if is_name && !self.purpose.opens() && !self.purpose.is_folder() {
            self.whole().file_name().unwrap_or_default().to_string_lossy().into_owned()
        } else {
            String::new()
        };
        let mut text = folder.display().to_string();
        if !text.ends_with(std::path::is_separator) {
            text.push(MAIN_SEPARATOR);
        }
        let at = text.chars().count();
        text.push_str(&name);
        self.set(text);
        if name.is_empty() {
            self.select = Some([at, at]);
        }
    }

    /// Completes the text as far as the rows agree; returns whether there was anything to complete.
    fn complete(&mut self, rows: &[list::Row]) -> bool {
        if let Some(row) = self.chosen.and_then(|at| rows.get(at)) {
            self.take(&row.entry.clone());
            return true;
        }
        let (_, prefix) = self.place();
        let found = self.folder.beginning(&prefix);
        if !self.is_edited || found.is_empty() {
            return false;
        }
        if let [only] = &found[..] {
            let is_done = !only.is_folder && only.name == prefix;
            self.take(&only.clone());
            self.is_edited = true;
            let end = self.typed.chars().count();
            self.select = Some([end, end]);
            return !is_done;
        }
        let common = folder::common_start(&found);
        // The text may mean a folder by another name: `~` and `.` do.
        let kept = self.typed.trim().strip_suffix(prefix.as_str()).unwrap_or_default().to_owned();
        let is_whole = kept.len() + prefix.len() == self.typed.trim().len();
        let longer = is_whole && common.chars().count() > prefix.chars().count();
        if longer {
            self.typed = format!("{kept}{common}");
            let end = self.typed.chars().count();
            self.select = Some([end, end]);
        }
        // Where several go on differently, Tab chooses the first; the arrow keys go on from there.
        if !longer {
            self.chosen = Some(0);
        }
        true
    }

    /// A path as the field shows it: without the folder of the dialog.
    fn shown(&self, path: &Path) -> String {
        path.strip_prefix(&self.base).unwrap_or(path).display().to_string()
    }

    /// Opens the system's dialog. A thread waits for its answer, so that the window stays responsive.
    fn browse(&mut self, ctx: &egui::Context) {
        let mut dialog = rfd::AsyncFileDialog::new().set_title(self.purpose.title());
        let (folder, _) = self.place();
        if folder.is_dir() {
            dialog = dialog.set_directory(folder);
        }
        if let Some(name) = self.path().as_deref().and_then(Path::file_name) {
            dialog = dialog.set_file_name(name.to_string_lossy());
        }
        let (sender, receiver) = sync_channel(1);
        let ctx = ctx.clone();
        let (kind, extensions) = self.purpose.files();
        if !extensions.is_empty() {
            dialog = dialog.add_filter(kind, &extensions);
        }
        // Some systems require that the dialog is created on the window's thread.
        let future: std::pin::Pin<Box<dyn Future<Output = Option<rfd::FileHandle>> + Send>> =
            if self.purpose.opens() {
                Box::pin(dialog.pick_file())
            } else if self.purpose.is_folder() {
                Box::pin(dialog.pick_folder())
            } else {
                Box::pin(dialog.save_file())
            };
        let spawned = std::thread::Builder::new().name("file dialog".to_owned()).spawn(move || {
            let picked = pollster::block_on(future).map(|file| file.path().to_owned());
            let _ = sender.send(picked);
            ctx.request_repaint();
        });
        self.no_dialog = spawned.is_err();
        self.browsed = spawned.is_ok().then_some((receiver, Stopwatch::start()));
    }
}

/// Whether the text after the last point is an extension: `v1.2` and `bob. short` have none.
fn looks_like_extension(ending: &std::ffi::OsStr) -> bool {
    let ending = ending.to_string_lossy();
    !ending.is_empty()
        && ending.chars().count() <= 5
        && ending.chars().all(char::is_alphanumeric)
        && ending.chars().any(char::is_alphabetic)
}
