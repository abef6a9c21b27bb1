//! What the program is, and what the manual says about a control that the user asks about.

use egui::{Context, Grid, RichText};
use lovelock_base::settings::Info;
use lovelock_project::project::changed_settings;

use super::command::COMMANDS;
use super::control::{HoverTooltip, titled_dialog};
use super::manual::what::Asked;
use super::manual::{place_of_control, place_of_setting};
use super::notices::Kind;
use super::{Window, manual, palette, theme};

impl Window {
    /// Shows version, licence and adapter while they are asked for.
    pub(super) fn about(&mut self, ctx: &Context) {
        if !self.help.about_shown {
            return;
        }
        let rows = self.versions();
        let modal = titled_dialog("about", "About Lovelock").show(ctx, |ui| {
            ui.set_width(380.0);
            ui.heading("Lovelock");
            ui.label(env!("CARGO_PKG_DESCRIPTION"));
            ui.add_space(6.0);
            Grid::new("about").num_columns(2).spacing([16.0, 4.0]).show(ui, |ui| {
                for (name, value) in &rows {
                    ui.label(RichText::new(*name).color(theme::quiet()));
                    ui.add(egui::Label::new(value.as_str()).wrap());
                    ui.end_row();
                }
            });
            ui.add_space(6.0);
            ui.horizontal(|ui| {
                if ui.button("Copy").hover_tooltip("Copies this and the changed settings.").clicked() {
                    ui.copy_text(self.problem_report());
                }
                ui.button("Close").clicked()
            })
            .inner
        });
        self.help.about_shown = !(modal.inner || modal.should_close());
    }

    /// Copies what a report of a problem needs, and says so.
    pub(super) fn report_problem(&mut self, ctx: &Context) {
        ctx.copy_text(self.problem_report());
        let text = "Version, graphics card and changed settings are copied. Paste them into your report and add what you did, what \
                    happened and what you expected.";
        self.notices.push(Kind::Done, text.to_owned());
    }

    /// Version, licence, what draws, and the system.
    fn versions(&self) -> [(&'static str, String); 4] {
        let adapter = self.session.painter().adapter();
        let adapter = adapter.map_or_else(
            || "nothing yet".to_owned(),
            |adapter| {
                let software = if adapter.software { ", software" } else { "" };
                format!("{} ({}{software})", adapter.name, adapter.backend_label())
            },
        );
        [
            ("Version", env!("LOVELOCK_VERSION").to_owned()),
            ("Licence", env!("CARGO_PKG_LICENSE").to_owned()),
            ("Rendered by", adapter),
            ("System", format!("{} {}", std::env::consts::OS, std::env::consts::ARCH)),
        ]
    }

    /// The versions and the settings that differ from the default project, as text. Names of files are left out.
    fn problem_report(&self) -> String {
        let versions = self.versions().map(|(name, value)| format!("{name}: {value}"));
        let changed = changed_settings(self.document.project());
        let changed = if changed.is_empty() { vec!["none".to_owned()] } else { changed };
        format!("Lovelock\n{}\nChanged settings:\n{}\n", versions.join("\n"), changed.join("\n"))
    }

    /// Explains the control that has the focus, or the one that is clicked next.
    pub(super) fn what_is_this(&mut self, ctx: &Context) {
        self.help.what.toggle(ctx);
    }

    /// Opens what the manual says about a control.
    pub(super) fn explain(&mut self, asked: &Asked) {
        let of_setting = asked.info.and_then(|info| place_of_setting(palette::path_of(info)?));
        if let Some(place) = of_setting.or_else(|| place_of_control(&asked.name)) {
            self.help.manual.show_place(place);
            return;
        }
        // What has no place in the manual has a sentence of its own.
        let name = asked.name.trim();
        let keymap = &self.layout.keys;
        let command = COMMANDS.iter().find(|info| {
            name == info.label || keymap.keys(info).iter().any(|key| name == format!("{} {key}", info.label))
        });
        let text = match (asked.info, command) {
            (Some(info), _) => format!("{}: {}", info.label, info.tooltip()),
            (None, Some(info)) => format!("{}: {}", info.label, info.tooltip),
            (None, None) if name.is_empty() => "There is no control at this place.".to_owned(),
            (None, None) => {
                format!("The manual does not mention {name}. Press F1 to search it with other words.")
            }
        };
        self.notices.push(Kind::Done, text);
    }

    /// Tells why a setting cannot be shown, and shows what the manual says about it.
    pub(super) fn explain_missing(&mut self, info: &'static Info) {
        let text = format!("{} has no control now, because this project does not use it.", info.label);
        self.notices.push(Kind::Warning, text);
        if let Some(place) = palette::path_of(info).and_then(manual::place_of_setting) {
            self.help.manual.show_place(place);
        }
    }
}
