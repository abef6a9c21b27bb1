//! Tooltips: beside what they explain, after the pointer has rested, and never while one of its buttons is down.

use egui::accesskit::Role;
use egui::{Context, Id, Order, Rect, RectAlign, Response, Tooltip, Ui, WidgetText};

/// Tooltips of a widget that leave the controls around it visible. They replace egui's own, which open below the widget and stay
/// open while it is dragged.
pub(crate) trait HoverTooltip: Sized {
    /// Shows `text` while the pointer rests on the widget, if it is enabled.
    fn hover_tooltip(self, text: impl Into<WidgetText>) -> Self;
    /// Shows `text` while the pointer rests on the widget, if it is disabled.
    fn disabled_hover_tooltip(self, text: impl Into<WidgetText>) -> Self;
}

impl HoverTooltip for Response {
    fn hover_tooltip(self, text: impl Into<WidgetText>) -> Self {
        let text = text.into();
        describe(&self, text.text());
        show(&self, self.rect, Tooltip::for_enabled, text);
        self
    }

    fn disabled_hover_tooltip(self, text: impl Into<WidgetText>) -> Self {
        show(&self, self.rect, Tooltip::for_disabled, text.into());
        self
    }
}

/// Gives a widget the text of its tooltip as the description for screen readers, and as its name if it has none, as egui's own tooltips
/// do.
fn describe(response: &Response, text: &str) {
    if !response.ctx.has_accesskit_node(response.id) {
        return;
    }
    response.ctx.accesskit_node_builder(response.id, |node| {
        if node.description().is_none() {
            let value =
                node.value().filter(|value| !value.is_empty() && is_said_with_description(node.role()));
            let description = value.map_or_else(|| text.to_owned(), |value| format!("{value}. {text}"));
            node.set_description(description);
        }
        let has_name = node.role() == Role::Label
            || !node.labelled_by().is_empty()
            || node.label().is_some_and(|label| !label.is_empty());
        if !has_name {
            node.set_label(text);
        }
    });
}

/// Whether the text of a control's value belongs to its description, because screen readers do not get it otherwise: on Linux they get
/// that of text fields alone.
fn is_said_with_description(role: Role) -> bool {
    cfg!(target_os = "linux") && matches!(role, Role::ComboBox | Role::Slider | Role::SpinButton)
}

/// Shows `text` beside `whole`, of which `response` is a part, whether the part is enabled or not.
pub(super) fn beside(response: &Response, whole: Rect, text: &str) {
    let of: fn(&Response) -> Tooltip<'static> =
        if response.enabled() { Tooltip::for_enabled } else { Tooltip::for_disabled };
    describe(response, text);
    show(response, whole, of, text.into());
}

fn show(response: &Response, whole: Rect, of: fn(&Response) -> Tooltip<'static>, text: WidgetText) {
    // A tooltip that is open when a drag begins would otherwise stay.
    if response.ctx.input(|input| input.pointer.any_down()) {
        return;
    }
    let mut tooltip = of(response);
    if !tooltip.popup.is_open() {
        return;
    }
    let (anchor, aligns) = place(&response.ctx, response.layer_id.order, whole);
    tooltip.popup = tooltip.popup.anchor(anchor).align(aligns[0]).align_alternatives(&aligns[1..]);
    tooltip.show(|ui| {
        ui.set_max_width(ui.spacing().tooltip_width);
        ui.label(text);
    });
}

fn free_area() -> Id {
    Id::unique("area between the panels")
}

/// Notes that the rest of `ui`, between the panels, has no controls that a tooltip could cover.
pub(crate) fn keep_free_area(ui: &Ui) {
    let rest = ui.available_rect_before_wrap();
    ui.data_mut(|data| data.insert_temp(free_area(), rest));
}

/// What the tooltip of a widget at `rect` is aligned with, and the alignments to try, best first: controls of a panel have their
/// tooltips beside the panel.
fn place(ctx: &Context, order: Order, rect: Rect) -> (Rect, &'static [RectAlign]) {
    const ASIDE: [RectAlign; 6] = [
        RectAlign::RIGHT_START,
        RectAlign::RIGHT_END,
        RectAlign::LEFT_START,
        RectAlign::LEFT_END,
        RectAlign::BOTTOM_START,
        RectAlign::TOP_START,
    ];
    const LEFT: [RectAlign; 4] =
        [RectAlign::LEFT_START, RectAlign::LEFT_END, RectAlign::BOTTOM_END, RectAlign::TOP_END];
    const ABOVE: [RectAlign; 3] = [RectAlign::TOP_START, RectAlign::TOP_END, RectAlign::BOTTOM_START];
    const BELOW: [RectAlign; 4] =
        [RectAlign::BOTTOM_START, RectAlign::BOTTOM_END, RectAlign::TOP_START, RectAlign::TOP_END];
    let free: Option<Rect> = ctx.data(|data| data.get_temp(free_area()));
    match (order, free) {
        (Order::Background, Some(free)) => {
            let mut anchor = rect;
            if rect.right() <= free.left() {
                anchor.max.x = free.left();
                (anchor, &ASIDE)
            } else if rect.left() >= free.right() {
                anchor.min.x = free.right();
                (anchor, &LEFT)
            } else if rect.top() >= free.bottom() {
                anchor.min.y = free.bottom();
                (anchor, &ABOVE)
            } else {
                (anchor, &BELOW)
            }
        }
        // Menus and lists: the next entry stays visible.
        (Order::Background | Order::Foreground, _) => (rect, &ASIDE),
        _ => (rect, &BELOW),
    }
}
