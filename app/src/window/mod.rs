//! The window.

mod about;
mod actions;
mod aim;
mod begin;
mod brushes;
mod camera_control;
mod command;
mod compare;
mod control;
mod dialogs;
mod display;
mod dock;
mod files;
mod focus;
mod frame;
mod gesture;
mod glyphs;
mod health_view;
mod images;
mod key_press;
mod keying;
mod keymap;
mod keys;
mod light_sphere;
mod load_ends;
mod manual;
mod memory;
mod methods;
mod notices;
mod opening;
mod overlay;
mod page;
mod palette;
mod panel;
mod panels;
mod path_dialog;
mod pen;
mod picker;
mod pointer_tool;
mod preferences;
mod purpose;
mod ramp;
mod readings;
mod recorder;
mod reference;
mod safety;
mod scale;
mod screenshot;
mod search;
mod session;
mod shelf;
mod side_panels;
mod soundtrack;
mod start;
mod styles;

#[cfg(test)]
mod testing;
mod theme;
mod timeline;
mod tools;
mod tour;
mod up_axis;
mod viewport;
mod wall;
mod work;

use std::path::{Path, PathBuf};
use std::sync::Arc;

pub(crate) use begin::{Shows, open};
use command::Command;
use compare::{Compare, CompareLayout};
use display::Display;
use files::Files;
use gesture::Gestures;
use images::Textures;
use lovelock_project::Project;
use lovelock_project::animation::Moment;
use lovelock_project::document::Document;
use lovelock_project::error::ProjectError;
use lovelock_project::files::Access;
use lovelock_project::grants::Grants;
use lovelock_session::health::Gauge;
use lovelock_session::render_thread::ShownMask;
use lovelock_session::resolution;
use lovelock_session::window_device::WindowDevice;
use notices::Notices;
use opening::Aim;
use overlay::scissors::Scissors;
use page::Page;
use palette::Palette;
use pointer_tool::PointerTool;
use purpose::Purpose;
use recorder::Recorder;
use screenshot::Screenshot;
use serde::{Deserialize, Serialize};
use session::Session;
use shelf::Panels;
use viewport::Viewport;
use wall::{WallLayout, WallPage};

/// Key under which the layout is stored. The number changes with the format.
const LAYOUT_KEY: &str = "layout 1";

/// Number of recent projects in the menu.
const RECENT: usize = 10;

/// The state of the interface that is stored between runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
struct Layout {
    panels_hidden: bool,
    recent: Vec<PathBuf>,
    /// Other files that were opened, newest first.
    files: Vec<PathBuf>,
    /// The folder in which the last film, sequence or export was recorded.
    recordings: Option<PathBuf>,
    /// Rendered pixels per pixel of the screen; 0 is automatic.
    view_scale: f32,
    /// The rate that images keep while something moves if their size is automatic, images per second.
    view_rate: f32,
    page: Page,
    compare: CompareLayout,
    wall: WallLayout,
    timeline: timeline::Zoom,
    /// The height of the tracks on the timeline that the user set, points.
    tracks_height: Option<f32>,
    styles: styles::Kept,
    brushes: brushes::Kept,
    /// Where the panels are.
    dock: dock::Arrangement,
    keys: keymap::Keymap,
    theme: theme::Choice,
    /// Whether the start page is shown when the program starts without a project.
    starts_with_page: bool,
    /// The scale of the interface beside that of the system, a factor.
    scale: f32,
}

impl Default for Layout {
    fn default() -> Self {
        Self {
            panels_hidden: false,
            recent: Vec::new(),
            files: Vec::new(),
            recordings: None,
            view_scale: 0.0,
            view_rate: resolution::DEFAULT_RATE,
            page: Page::default(),
            compare: CompareLayout::default(),
            wall: WallLayout::default(),
            timeline: timeline::Zoom::default(),
            tracks_height: None,
            styles: styles::Kept::default(),
            brushes: brushes::Kept::default(),
            dock: dock::Arrangement::default(),
            keys: keymap::Keymap::default(),
            theme: theme::Choice::default(),
            starts_with_page: true,
            scale: 1.0,
        }
    }
}

/// What the window shows between its panels.
#[derive(Default)]
struct Pages {
    /// The single image.
    image: Viewport,
    compare: Compare,
    wall: WallPage,
}

/// The tool of the pointer in the image, with what all tools and marks there remember. What a panel also edits is in its panel.
#[derive(Default)]
struct Tools {
    /// The tool that has the pointer.
    active: PointerTool,
    /// Whether the button was pressed with keys for the camera, so that the drag is not the tool's.
    navigates: bool,
    scissors: Scissors,
    /// The stroke that paints a mask.
    mask_stroke: overlay::brush::Stroke,
    /// The mask that the image shows.
    shown_mask: Option<Arc<ShownMask>>,
    /// The gauge whose place is marked in the image, with its values when the mark was requested.
    marked_gauge: Option<Gauge>,
    gestures: Gestures,
    pen: pen::Pen,
}

/// What is made and played beside the image: sound, recordings, and the thumbnails of the timeline.
struct Media {
    soundtrack: soundtrack::Soundtrack,
    /// The picture over the image.
    reference: reference::Reference,
    recorder: Recorder,
    thumbnails: timeline::Thumbnails,
}

/// What takes keys before the image does.
#[derive(Default)]
struct Keyboard {
    palette: Palette,
    focus: focus::Focus,
    menu_keys: keys::MenuKeys,
}

/// What explains the program.
#[derive(Default)]
struct Help {
    manual: manual::Manual,
    what: manual::what::WhatIsThis,
    keys_shown: bool,
    about_shown: bool,
}

/// The window and its state.
pub(crate) struct Window {
    document: Document,
    session: Session,
    layout: Layout,
    pages: Pages,
    tools: Tools,
    panels: Panels,
    media: Media,
    files: Files,
    keyboard: Keyboard,
    help: Help,
    notices: Notices,
    safety: safety::Safety,
    preferences: preferences::Preferences,
    start: start::StartPage,
    tour: tour::Tour,
    display: Display,
}

impl Window {
    fn new(
        creation: &eframe::CreationContext,
        opened: begin::Opened,
        picture: Option<(PathBuf, f64)>,
    ) -> Result<Self, ProjectError> {
        let ctx = &creation.egui_ctx;
        egui_material_icons::initialize(ctx);
        theme::apply(ctx);
        glyphs::provide(ctx);
        // The program has its own commands for it.
        ctx.options_mut(|options| options.zoom_with_keyboard = false);
        ctx.add_plugin(control::MenuKey::default());
        let layout =
            creation.storage.and_then(|storage| eframe::get_value(storage, LAYOUT_KEY)).unwrap_or_default();
        let mut window = Self::start(ctx, layout, opened)?;
        let own = lovelock_jobs::presets::own_styles();
        let cache = lovelock_jobs::presets::thumbnail::cache_folder();
        let kept = std::mem::take(&mut window.panels.hair.styles.kept);
        window.panels.hair.styles = styles::Browser::new(own, cache, ctx);
        window.panels.hair.styles.kept = kept;
        window.ask_about_started_hair();
        // Pictures for documents are taken without a user.
        if picture.is_none() {
            window.begin_safety(ctx)?;
        }
        window.display.screenshot = picture.map(|(out, after_secs)| Screenshot::new(out, after_secs));
        Ok(window)
    }

    /// Starts the session behind the window.
    fn start(ctx: &egui::Context, layout: Layout, opened: begin::Opened) -> Result<Self, ProjectError> {
        let begin::Opened { project, project_path, picked, problems, part, strokes, refused } = opened;
        let mut access = Access::new();
        for path in &picked {
            access.pick(path);
        }
        access.set_project(project_path.as_deref());
        let take = project.take.file.as_ref().map(|file| file.path.as_path());
        for made in project_path.as_deref().into_iter().chain(take) {
            Grants::of_user().allow(made, &mut access);
        }
        let mut layout = layout;
        layout.dock.forget_unknown(Panels::usual());
        if let Some(path) = &project_path {
            remember(&mut layout.recent, path);
        }
        let framing = files::Framing::at_start(&project, project_path.as_ref());
        let mut document = Document::new(project, project_path);
        if let Some((place, file, before)) = part {
            document.try_part(place, &file, Arc::new(before));
        }
        let (device, textures) = (WindowDevice::default(), Textures::default());
        let session = Session::start(document.project(), access, ctx, &device)?;
        let thumbnails = timeline::Thumbnails::new(ctx, &device, &textures)?;
        let mut panels = Panels::default();
        panels.hair.styles.kept.clone_from(&layout.styles);
        panels.brushes.kept.clone_from(&layout.brushes);
        let mut window = Self {
            document,
            session,
            layout,
            pages: Pages::default(),
            tools: Tools::default(),
            panels,
            media: Media {
                soundtrack: soundtrack::Soundtrack::default(),
                reference: reference::Reference::default(),
                recorder: Recorder::default(),
                thumbnails,
            },
            files: Files::new(ctx, framing),
            keyboard: Keyboard::default(),
            help: Help::default(),
            notices: Notices::default(),
            safety: safety::Safety::default(),
            preferences: preferences::Preferences::default(),
            start: start::StartPage::default(),
            tour: tour::Tour::default(),
            display: Display::new(device, textures),
        };
        for problem in &problems {
            eprintln!("lovelock: {}", problem.message);
        }
        window.warn(problems.into_iter().map(|problem| problem.message));
        if let Some(path) = strokes {
            window.look_into_or_tell(&path, Aim::Start);
        }
        if let Some(why) = refused {
            eprintln!("lovelock: {why}");
            window.fail(why);
        }
        Ok(window)
    }

    /// What is stored between runs.
    fn stored_layout(&self) -> Layout {
        Layout {
            styles: self.panels.hair.styles.kept.clone(),
            brushes: self.panels.brushes.kept.clone(),
            ..self.layout.clone()
        }
    }

    /// Shows messages to the user.
    fn warn(&mut self, sentences: impl IntoIterator<Item = String>) {
        for sentence in sentences {
            tracing::warn!("{sentence}");
            self.notices.push(notices::Kind::Warning, sentence);
        }
    }

    /// Shows why something failed. The message stays until it is closed.
    fn fail(&mut self, sentence: impl Into<String>) {
        let sentence = sentence.into();
        tracing::warn!("{sentence}");
        self.notices.push(notices::Kind::Failed, sentence);
    }

    /// The project at the current time, with its tracks applied.
    fn seen(&mut self) -> Arc<Project> {
        self.document.at(self.now_secs())
    }

    /// The time of a change.
    fn moment(&self, ctx: &egui::Context) -> Moment {
        Moment {
            secs: self.now_secs(),
            playing: self.session.playing,
            held: ctx.input(|input| input.pointer.any_down()) || self.display.second.is_held,
            clock_secs: ctx.input(|input| input.time),
        }
    }

    /// Says that a control was moved although its track plays.
    fn report_refused(&mut self, control: Option<String>) {
        self.warn(control.map(|control| {
            format!(
                "{control} follows its track while the dance plays. Pause to set a key, press W to rewrite the track, or mute it \
                 on the timeline."
            )
        }));
    }

    /// Whether a command is available now.
    fn can(&self, command: &Command) -> bool {
        self.why_not(command).is_none()
    }

    /// Why a command is not available now; `None` if it is.
    fn why_not(&self, command: &Command) -> Option<&'static str> {
        let takes = self.document.project().take.file.is_some();
        let loaded = self.session.frame.is_some();
        let because = |holds: bool, why: &'static str| holds.then_some(why);
        match command {
            Command::Undo => because(self.document.history().undo_len() == 0, "There is nothing to undo."),
            Command::Redo => because(self.document.history().redo_len() == 0, "There is nothing to redo."),
            Command::PickFile(Purpose::Picture) if self.layout.page == Page::Wall => {
                Some("The wall cannot be saved as an image. Close it to save the image of the viewport.")
            }
            Command::PickFile(Purpose::Picture) if self.layout.page == Page::Compare => {
                because(!self.pages.compare.has_pictures(), "The panes are not rendered yet.")
            }
            Command::PickFile(Purpose::Picture) => {
                because(self.session.painted.is_none(), "There is no image yet.")
            }
            Command::RecordTake | Command::Use(PointerTool::Scissors) if takes => Some(TAKE_PLAYS),
            Command::RecordTake => because(!loaded, "There is no hair to record yet."),
            Command::PlayTake if takes => Some("A take is already playing."),
            Command::PlayTake => because(
                self.session.saved_take.is_none(),
                "No take has been recorded. Press R to record one, or Ctrl+O to open a saved one.",
            ),
            Command::LeaveTake | Command::PlayBackwards => because(!takes, "No take is playing."),
            Command::FrameHair => because(!loaded, "There is no hair to frame yet."),
            Command::Use(PointerTool::Mask) if self.tools.active == PointerTool::Mask => None,
            Command::Use(PointerTool::Mask) if takes => Some(TAKE_PLAYS),
            Command::ShowMask | Command::Use(PointerTool::Mask) => {
                because(self.panels.layers.selected.is_none(), NO_LAYER)
            }
            Command::BrushSmaller | Command::BrushLarger => because(
                !matches!(self.tools.active, PointerTool::Mask | PointerTool::Brush),
                "No brush is in use.",
            ),
            Command::PickFile(Purpose::Curves) => {
                because(self.media.recorder.is_running(), "A recording is already running.")
            }
            _ => None,
        }
    }
}

const TAKE_PLAYS: &str = "A take is playing: body and hair move as recorded. Leave the take (Shift+R) first.";
const NO_LAYER: &str = "No layer is selected. Select one in the Layers panel to show or paint its mask.";

/// Puts `path` first and removes duplicates.
fn remember(recent: &mut Vec<PathBuf>, path: &Path) {
    recent.retain(|known| known != path);
    recent.insert(0, path.to_owned());
    recent.truncate(RECENT);
}

/// The project as the panels edit it.
fn copy(project: &Arc<Project>) -> Project {
    (**project).clone()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recent_projects_are_few_and_newest_first() {
        let mut recent = Vec::new();
        for i in 0..20 {
            remember(&mut recent, Path::new(&format!("{}.ron", i % 13)));
        }
        assert_eq!(recent.len(), RECENT);
        assert_eq!(recent[0], Path::new("6.ron"));
    }
}
