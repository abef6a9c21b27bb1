//! The mask of a layer: showing it, painting it, and its regions.

use egui::{RichText, Ui};
use egui_material_icons::icons::{ICON_BRUSH, ICON_CLOSE, ICON_VISIBILITY};
use lovelock_style::{Mask, MaskBrush, MaskPart, MaskRegion};

use super::LayersView;
use crate::window::command::Command;
use crate::window::control::HoverTooltip;
use crate::window::control::{note, settings};
use crate::window::pointer_tool::PointerTool;

pub(super) fn ui(ui: &mut Ui, mask: &mut Mask, view: &mut LayersView, tool: PointerTool) -> Option<Command> {
    let mut clicked = false;
    ui.horizontal(|ui| {
        let mut toggle = |icon: egui_material_icons::MaterialIcon, name: &str, on: bool, tip: &str| {
            let response = ui.add(egui::Button::selectable(on, (icon.rich_text(), name)));
            response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, on, name));
            response.hover_tooltip(tip).clicked()
        };
        let tip = "Shows the mask on hair and scalp: dark where the layer has no effect, yellow where it has full effect. Key: K";
        if toggle(ICON_VISIBILITY, "Show mask", view.show_mask, tip) {
            view.toggle_mask();
        }
        let tip = "Paints the mask in the image: drag over the head. Ctrl erases, Shift smooths, [ and ] change the radius. Key: \
                   Shift+K";
        clicked = toggle(ICON_BRUSH, "Paint", tool == PointerTool::Mask, tip);
    });
    if tool == PointerTool::Mask {
        painting(ui, mask, view);
    }
    parts(ui, mask);
    clicked.then_some(Command::Use(PointerTool::Mask))
}

/// The brush, and what changes the painted mask as a whole.
fn painting(ui: &mut Ui, mask: &mut Mask, view: &mut LayersView) {
    note(ui, "Drag over the head or its hair. Ctrl erases, Shift smooths.");
    let names = ["radius", "strength", "falloff", "mirror"];
    settings(ui, &names, &mut view.brush, &MaskBrush::default());
    ui.horizontal(|ui| {
        type Change = fn(f32) -> f32;
        let changes: [(&str, &str, Change); 3] = [
            ("Fill", "Paints the whole head.", |_| 1.0),
            ("Clear", "Erases everything that was painted.", |_| 0.0),
            ("Turn round", "Paints what is not painted, and erases what is.", |value| 1.0 - value),
        ];
        for (name, tip, change) in changes {
            if ui.button(name).hover_tooltip(tip).clicked()
                && let Some(part) = mask.painted_mut()
            {
                part.map.paint(|_, value| change(value));
            }
        }
    });
}

/// The regions of a mask.
fn parts(ui: &mut Ui, mask: &mut Mask) {
    let mut removed = None;
    for (i, part) in mask.parts.iter_mut().enumerate() {
        ui.push_id(i, |ui| {
            ui.separator();
            ui.horizontal(|ui| {
                let name = ui.label(RichText::new("Region"));
                let width = ui.available_width() - 30.0;
                let combo = egui::ComboBox::from_id_salt("region")
                    .selected_text(part.region.label().to_owned())
                    .width(width)
                    .height(320.0)
                    .show_ui(ui, |ui| {
                        for (region, _, label) in MaskRegion::ALL {
                            ui.selectable_value(&mut part.region, region, label);
                        }
                    });
                combo
                    .response
                    .labelled_by(name.id)
                    .hover_tooltip("The part of the head that the region covers.");
                let remove = ui.add(egui::Button::new(ICON_CLOSE).frame(false));
                remove.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "Remove"));
                if remove.hover_tooltip("Removes the region from the mask.").clicked() {
                    removed = Some(i);
                }
            });
            let default = MaskPart::default();
            if i > 0 {
                settings(ui, &["mix"], part, &default);
            }
            settings(ui, &["inverted"], part, &default);
            match part.region {
                MaskRegion::All | MaskRegion::Painted | MaskRegion::Unknown(_) => {}
                MaskRegion::Patch => settings(ui, &["centre", "radius", "softness"], part, &default),
                _ => settings(ui, &["border", "softness"], part, &default),
            }
        });
    }
    if let Some(i) = removed {
        mask.parts.remove(i);
    }
    ui.horizontal(|ui| {
        let full = mask.parts.len() >= Mask::MAX_PARTS;
        let add = ui.add_enabled(!full, egui::Button::new("Add region"));
        if add.hover_tooltip("Limits the layer to a region of the head.").clicked() {
            mask.parts.push(MaskPart::region(MaskRegion::Front));
        }
        ui.checkbox(&mut mask.inverted, "Invert all").hover_tooltip(
            "Inverts the whole mask: the layer acts on the rest of \
                                                                     the head.",
        );
    });
}
