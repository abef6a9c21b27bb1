//! The command palette: finds commands, layers and settings by what they are called and what they do.

use std::sync::LazyLock;

use super::command::{COMMANDS, Command, CommandInfo};
use crate::window::control::{HoverTooltip, titled_dialog};
use egui::{Layout, RichText, ScrollArea};
use lovelock_base::settings::{Info, Settings as _};
use lovelock_brush::BrushSettings;
use lovelock_project::project::settings_of;
use lovelock_style::{Kind, Operation};

use super::keymap::Keymap;
use super::picker::Picker;
use super::search::{Fit, best_first, fit};
use super::theme;

/// Size of the list, points. It does not follow the number of matches, so that nothing jumps.
const LIST: egui::Vec2 = egui::vec2(460.0, 320.0);

/// What the palette finds.
#[derive(Clone, Copy)]
pub(crate) enum Found {
    /// A command, which is run.
    Command(&'static CommandInfo),
    /// A kind of layer, which is added.
    Layer(&'static Kind),
    /// A setting with its path, whose control is shown.
    Setting(&'static str, &'static Info),
}

impl Found {
    fn name(&self) -> &'static str {
        match self {
            Self::Command(info) => info.label,
            Self::Layer(kind) => kind.label,
            Self::Setting(_, info) => info.label,
        }
    }

    fn text(&self) -> &'static str {
        match self {
            Self::Command(info) => info.tooltip,
            Self::Layer(kind) => kind.text,
            Self::Setting(_, info) => info.text,
        }
    }

    /// What stands at the right of its row.
    fn aside(&self, keymap: &Keymap) -> String {
        match self {
            Self::Command(info) => keymap.first(info).unwrap_or_default(),
            Self::Layer(_) => "add layer".to_owned(),
            Self::Setting(path, _) => place_of(path).unwrap_or_else(|| (*path).to_owned()),
        }
    }

    fn fit(&self, typed: &str, keymap: &Keymap) -> Option<Fit> {
        // Settings are also found by their paths, as the command line calls them.
        let path = if let Self::Setting(path, _) = self { *path } else { "" };
        fit(typed, self.name(), &[self.text(), &self.aside(keymap), path])
    }
}

/// Where the controls of settings are whose paths begin so, the first that fits. Settings of other paths are spread over several panels.
const PLACES: [(&str, &str); 25] = [
    ("brush.", "Brushes"),
    ("body.scalp.", "Scalp"),
    ("body.face.", "Face"),
    ("body.colliders.", "Colliders"),
    ("body.brows.", "Body and motion › Brows and lashes"),
    ("motion.", "Body and motion › Motion"),
    ("hair.ties.", "Ties and scissors"),
    ("hair.import.", "Hairstyle"),
    ("look.", "Look"),
    ("simulation.", "Simulation"),
    ("shadow.", "Shadow"),
    ("lights.", "Light"),
    ("sound.", "Sound"),
    ("recording.", "Recording"),
    ("reference.", "Picture › Reference picture"),
    ("picture.clusters.", "Picture › Clusters"),
    ("picture.body_look.", "Body look"),
    ("picture.map_view.", "Shadow › Map over the hair"),
    ("picture.background", "Picture › Background"),
    ("picture.ground", "Picture › Background"),
    ("picture.strands", "Look › Strands"),
    ("picture.strand_detail", "Look › Strands"),
    ("picture.strand_number", "Look › Strands"),
    ("picture.surroundings_turn", "Light"),
    ("picture.", "Picture"),
];

/// Where the control of the setting at a path is, if that is known.
fn place_of(path: &str) -> Option<String> {
    if let Some(name) = path.strip_prefix("hair.groom.") {
        return super::panels::hair::section_of(name).map(|section| format!("Hairstyle › {section}"));
    }
    PLACES.iter().find(|(begin, _)| path.starts_with(begin)).map(|(_, place)| (*place).to_owned())
}

/// The settings that have a control in the panels: those of a project and those of the brush.
static SETTINGS: LazyLock<Vec<(String, &'static Info)>> = LazyLock::new(|| {
    // Panes and the camera are set in the image itself.
    let in_panels = |path: &str| !["compare.", "camera."].iter().any(|start| path.starts_with(start));
    let project = settings_of("").into_iter().map(|entry| (entry.path, entry.info));
    let brush =
        BrushSettings::TABLE.iter().map(|setting| (format!("brush.{}", setting.info.name), &setting.info));
    project.chain(brush).filter(|(path, _)| in_panels(path)).collect()
});

/// The path of a setting of the project; the first one where several have the same entry.
pub(crate) fn path_of(info: &Info) -> Option<&'static str> {
    let same = |known: &Info| (known.name, known.label, known.text) == (info.name, info.label, info.text);
    SETTINGS.iter().find(|(_, known)| same(known)).map(|(path, _)| path.as_str())
}

/// The matches, the best first.
fn matches(typed: &str, keymap: &Keymap, enabled: impl Fn(&Command) -> bool) -> Vec<Found> {
    let commands =
        COMMANDS.iter().filter(|info| info.in_palette && enabled(&info.command)).map(Found::Command);
    // Without anything typed it is a list of commands.
    let others = !typed.trim().is_empty();
    let layers = Operation::KINDS.iter().filter(|kind| others && kind.id != "scissors").map(Found::Layer);
    let settings = SETTINGS.iter().filter(|_| others).map(|(path, info)| Found::Setting(path.as_str(), info));
    best_first(typed, commands.chain(layers).chain(settings), |typed, found| found.fit(typed, keymap))
}

/// The typed text and the selected match.
#[derive(Clone, Debug, Default)]
pub(crate) struct Palette {
    open: bool,
    picker: Picker,
}

impl Palette {
    /// Opens or closes the palette.
    pub(crate) fn toggle(&mut self) {
        *self = Self { open: !self.open, ..Self::default() };
    }

    /// Whether it is open.
    pub(crate) fn is_open(&self) -> bool {
        self.open
    }

    /// Shows the palette if it is open. Returns what was chosen.
    pub(crate) fn show(&mut self, ctx: &egui::Context, enabled: impl Fn(&Command) -> bool) -> Option<Found> {
        if !self.open {
            return None;
        }
        let mut result = None;
        let keymap = Keymap::of(ctx);
        let response = titled_dialog("palette", "Command palette").show(ctx, |ui| {
            ui.set_width(LIST.x);
            let name = "Find a command or a setting";
            let (field, picked) = self.picker.field(ui, name, f32::INFINITY, false);
            field.request_focus();
            let found = matches(&self.picker.typed, &keymap, enabled);
            self.picker.among(found.len());
            let list = ScrollArea::vertical().min_scrolled_height(LIST.y).max_height(LIST.y);
            list.auto_shrink(false).show(ui, |ui| {
                for (i, found) in found.iter().enumerate() {
                    let row = ui.horizontal(|ui| {
                        let label = ui.selectable_label(self.picker.is_chosen(i), found.name());
                        ui.with_layout(Layout::right_to_left(egui::Align::Center), |ui| {
                            // The scroll bar floats above the content.
                            ui.add_space(ui.spacing().scroll.bar_width);
                            let aside =
                                RichText::new(found.aside(&keymap)).monospace().small().color(theme::quiet());
                            ui.add(egui::Label::new(aside).truncate());
                        });
                        label.hover_tooltip(found.text())
                    });
                    self.picker.show(i, &row.response);
                    if row.inner.clicked() || (picked.entered && self.picker.is_chosen(i)) {
                        result = Some(*found);
                    }
                }
                if found.is_empty() {
                    ui.label(RichText::new("No command or setting matches.").color(theme::quiet()));
                }
            });
        });
        if result.is_some() || response.should_close() {
            self.open = false;
        }
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::shelf::Panels;

    fn names(typed: &str) -> Vec<&'static str> {
        matches(typed, &Keymap::default(), |_| true).iter().map(Found::name).collect()
    }

    #[test]
    fn words_in_any_order_find_a_command() {
        assert!(
            matches!(matches("hair frame", &Keymap::default(), |_| true)[0], Found::Command(info) if info.command == Command::FrameHair)
        );
        assert_eq!(names("no such thing"), [""; 0]);
        assert!(names("").len() > 10);
        assert!(
            matches("", &Keymap::default(), |_| true).iter().all(|found| matches!(found, Found::Command(_)))
        );
    }

    #[test]
    fn settings_of_one_name_say_where_they_are() {
        let keymap = Keymap::default();
        let found = matches("curl radius", &keymap, |_| true);
        let found = found.iter().filter(|found| found.name() == "Curl radius");
        let mut places: Vec<_> = found.map(|found| found.aside(&keymap)).collect();
        places.sort();
        assert_eq!(places, ["Brushes", "Hairstyle › Texture"]);
        for (begin, place) in PLACES {
            assert!(SETTINGS.iter().any(|(path, _)| path.starts_with(begin)), "{begin}: {place}");
            let panel = place.split(" › ").next().unwrap_or_default();
            assert!(Panels::usual().iter().flatten().any(|title| *title == panel), "{begin}: {place}");
        }
        for (path, place) in [
            ("picture.exposure_stops", "Picture"),
            ("picture.strand_opacity", "Picture"),
            ("picture.strand_number", "Look › Strands"),
            ("picture.background_top", "Picture › Background"),
            ("picture.map_view.slice", "Shadow › Map over the hair"),
        ] {
            assert!(SETTINGS.iter().any(|(known, _)| known == path), "{path}");
            assert_eq!(place_of(path).as_deref(), Some(place), "{path}");
        }
    }

    #[test]
    fn settings_and_layers_are_found_the_exact_name_first() {
        let curl = names("curl");
        assert_eq!(curl[0], "Curl", "{curl:?}");
        assert!(curl.contains(&"Curl radius"), "{curl:?}");
        // By its path, as the command line calls it.
        let wind = matches("simulation.wind.speed", &Keymap::default(), |_| true);
        assert!(matches!(wind[0], Found::Setting("simulation.wind.speed", _)));
        assert!(
            matches("brush radius", &Keymap::default(), |_| true)
                .iter()
                .any(|found| matches!(found, Found::Setting("brush.radius", _)))
        );
    }
}
