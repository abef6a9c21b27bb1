//! The bar of tools over the image.

use egui::{Area, Button, Context, Frame, Id, LayerId, Order, Rect, Ui, vec2};
use egui_material_icons::MaterialIcon;
use egui_material_icons::icons::{
    ICON_AC_UNIT, ICON_AIR, ICON_BRUSH, ICON_CALL_SPLIT, ICON_COMPRESS, ICON_CONTENT_CUT, ICON_CYCLONE,
    ICON_DELETE, ICON_GESTURE, ICON_HORIZONTAL_RULE, ICON_OPEN_IN_FULL, ICON_PAN_TOOL, ICON_PINCH,
    ICON_TORNADO, ICON_TRENDING_DOWN, ICON_TRENDING_UP, ICON_WAVES,
};
use lovelock_base::settings::Choices as _;
use lovelock_brush::Tool;

use super::Brushes;
use crate::window::control::HoverTooltip;
use crate::window::theme;

/// Size of a button, points.
const BUTTON: f32 = 28.0;
/// Distance of the bar from the edges of the image, points.
const AIR: f32 = 10.0;

/// The icon of a tool.
fn icon(tool: Tool) -> MaterialIcon {
    match tool {
        Tool::Comb => ICON_BRUSH,
        Tool::Smooth => ICON_WAVES,
        Tool::Straighten => ICON_HORIZONTAL_RULE,
        Tool::Puff => ICON_AIR,
        Tool::Flatten => ICON_COMPRESS,
        Tool::Pinch => ICON_PINCH,
        Tool::Spread => ICON_OPEN_IN_FULL,
        Tool::Twist => ICON_TORNADO,
        Tool::Curl => ICON_CYCLONE,
        Tool::Attract => ICON_GESTURE,
        Tool::Grow => ICON_TRENDING_UP,
        Tool::Shrink => ICON_TRENDING_DOWN,
        Tool::Cut => ICON_CONTENT_CUT,
        Tool::Part => ICON_CALL_SPLIT,
        Tool::Place => ICON_PAN_TOOL,
        Tool::Remove => ICON_DELETE,
        Tool::Freeze => ICON_AC_UNIT,
    }
}

/// What a tool does and its inverse, for tooltips.
pub(super) fn tooltip(tool: Tool) -> String {
    let (_, name) = tool.names();
    let inverse = tool.inverse_text().map_or_else(String::new, |text| format!("\n\nWith Ctrl: {text}"));
    format!("{name}. {}{inverse}\n\nShift smooths.", tool.text())
}

fn bar_layer() -> LayerId {
    LayerId::new(Order::Middle, Id::unique("brush tools"))
}

/// The part of the image that the bar leaves free.
pub(in crate::window) fn beside_bar(ctx: &Context, image: Rect) -> Rect {
    let layer = bar_layer();
    let bar = ctx.memory(|memory| memory.area_rect(layer.id).filter(|_| memory.areas().is_visible(&layer)));
    bar.map_or(image, |bar| image.with_min_x(image.left().max(bar.right())))
}

impl Brushes {
    /// Shows the bar over the image at `place`.
    pub(super) fn bar(&mut self, ui: &Ui, place: Rect) {
        let rows = (((place.height() - 4.0 * AIR) / (BUTTON + 2.0)) as usize).clamp(4, Tool::ALL.len());
        let layer = bar_layer();
        Area::new(layer.id)
            .order(layer.order)
            .fixed_pos(place.left_top() + vec2(AIR, AIR + 24.0))
            .constrain_to(place)
            .show(ui.ctx(), |ui| {
                Frame::popup(ui.style()).fill(theme::panel().gamma_multiply(0.92)).inner_margin(3.0).show(
                    ui,
                    |ui| {
                        ui.spacing_mut().item_spacing = vec2(2.0, 2.0);
                        ui.horizontal_top(|ui| {
                            for column in Tool::ALL.chunks(rows) {
                                ui.vertical(|ui| column.iter().for_each(|tool| self.button(ui, *tool)));
                            }
                        });
                    },
                );
            });
    }

    fn button(&mut self, ui: &mut Ui, tool: Tool) {
        let on = self.tool == tool;
        let (_, name) = tool.names();
        let button = Button::selectable(on, icon(tool).rich_text().size(16.0)).min_size(vec2(BUTTON, BUTTON));
        let response = ui.add(button);
        response.widget_info(|| egui::WidgetInfo::selected(egui::Role::RadioButton, true, on, name));
        if response.hover_tooltip(tooltip(tool)).clicked() {
            self.tool = tool;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tool_has_an_icon_of_its_own() {
        let icons: std::collections::BTreeSet<_> =
            Tool::ALL.iter().map(|tool| icon(*tool).codepoint).collect();
        assert_eq!(icons.len(), Tool::ALL.len());
        assert!(Tool::ALL.iter().all(|tool| tooltip(*tool).len() > 20));
    }
}
