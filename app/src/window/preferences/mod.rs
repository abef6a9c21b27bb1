//! The dialog of what the user sets once: theme, scale and keys.

mod keys;

use egui::{Context, RichText, Ui, WidgetInfo};
use egui_material_icons::icons::{ICON_ADD, ICON_REMOVE};

use super::control::{HoverTooltip, titled_dialog};
use super::{Layout, Window, scale, theme};

/// Width of the dialog, points.
const WIDTH: f32 = 560.0;

/// The state of the dialog.
#[derive(Default)]
pub(super) struct Preferences {
    open: bool,
    keys: keys::KeyEditor,
}

impl Preferences {
    /// Opens the dialog, or closes it.
    pub(super) fn toggle(&mut self) {
        *self = Self { open: !self.open, ..Self::default() };
    }

    /// Whether the dialog is open.
    pub(super) fn is_open(&self) -> bool {
        self.open
    }

    /// Whether the next key is taken as a key for a command.
    pub(super) fn takes_key(&self) -> bool {
        self.open && self.keys.takes_key()
    }
}

impl Window {
    /// Shows the dialog if it is open.
    pub(super) fn preferences(&mut self, ctx: &Context) {
        if !self.preferences.open {
            return;
        }
        let Self { preferences, layout, .. } = self;
        // Before anything else could take it.
        preferences.keys.take_key(ctx, &mut layout.keys);
        let room = ctx.content_rect().size();
        let modal = titled_dialog("preferences", "Preferences").show(ctx, |ui| {
            ui.set_width(WIDTH.min(room.x - 40.0));
            ui.heading("Preferences");
            ui.add_space(4.0);
            interface(ui, layout);
            ui.separator();
            preferences.keys.show(ui, &mut layout.keys, (room.y * 0.9 - 260.0).max(90.0));
            ui.add_space(4.0);
            ui.button("Close").clicked()
        });
        if modal.inner || (modal.should_close() && !preferences.keys.takes_key()) {
            preferences.open = false;
        }
    }
}

/// The controls of theme and scale.
fn interface(ui: &mut Ui, layout: &mut Layout) {
    ui.horizontal(|ui| {
        ui.label("Theme");
        for (choice, name) in theme::Choice::ALL {
            ui.radio_value(&mut layout.theme, choice, name);
        }
    });
    ui.horizontal(|ui| {
        ui.label("Scale of the interface");
        let wanted = scale::clamped(layout.scale);
        if step(ui, ICON_REMOVE, "Smaller", wanted > *scale::RANGE.start()) {
            layout.scale = scale::smaller(wanted);
        }
        let percent = format!("{:.0} %", 100.0 * wanted);
        ui.label(RichText::new(percent).color(if wanted == 1.0 { theme::quiet() } else { theme::accent() }));
        if step(ui, ICON_ADD, "Larger", wanted < *scale::RANGE.end()) {
            layout.scale = scale::larger(wanted);
        }
        if ui.add_enabled(wanted != 1.0, egui::Button::new("Reset")).clicked() {
            layout.scale = 1.0;
        }
        let now = ui.ctx().zoom_factor();
        if now < wanted - 0.02 {
            let text = format!("The window has room for {:.0} %.", 100.0 * now);
            ui.label(RichText::new(text).small().color(theme::watch()));
        }
    });
}

fn step(ui: &mut Ui, icon: egui_material_icons::MaterialIcon, name: &'static str, enabled: bool) -> bool {
    let button = ui.add_enabled(enabled, egui::Button::new(icon).small());
    button.widget_info(|| WidgetInfo::labeled(egui::Role::Button, enabled, name));
    button.hover_tooltip("Changes the size of text and controls, beside the scale of the system.").clicked()
}
