//! Shows parts of the window on an off-screen display, for tests.

mod brushes;
mod compare;
mod dialogs;
mod docking;
mod focus;
mod health;
mod help;
mod keyboard;
mod keying;
mod memory;
mod monkey;
mod notices;
mod opening;
mod painting;
mod playback;
mod preferences;
mod recovery;
mod rows;
mod start;
mod styles;
mod takes;
mod timeline_height;
mod tools;
mod tracks;
mod up_axis;
mod wall;
mod whole;

use egui::accesskit::{Role, Toggled};
use egui::epaint::Shape;
use egui::{Color32, Event, Modifiers, Order, PointerButton, Pos2, Rect, Ui, Vec2};
use egui_kittest::kittest::{AccessKitNode, NodeT, Queryable};
use egui_kittest::{Harness, Node};

use super::theme;

/// Width in points into which every panel must fit.
pub(crate) const WIDTH: f32 = 300.0;

/// The state that is shown, and the area that it occupies.
pub(crate) struct Shown<S> {
    pub(crate) state: S,
    pub(crate) taken: Rect,
}

/// A screen of [`WIDTH`] with the style of the window; tooltips appear without delay.
pub(crate) fn screen<'a, S: 'a>(state: S, show: impl FnMut(&mut Ui, &mut S) + 'a) -> Harness<'a, Shown<S>> {
    screen_of(Vec2::new(WIDTH, 2400.0), state, show)
}

/// [`screen`] with another size.
pub(crate) fn screen_of<'a, S: 'a>(
    size: Vec2,
    state: S,
    mut show: impl FnMut(&mut Ui, &mut S) + 'a,
) -> Harness<'a, Shown<S>> {
    let shown = Shown { state, taken: Rect::NOTHING };
    Harness::builder()
        .with_size(size)
        .with_max_steps(64)
        // Short enough that four consecutive events are a double-click.
        .with_step_dt(1.0 / 30.0)
        .with_context_setup(dress)
        .build_ui_state(
            move |ui, shown| {
                show(ui, &mut shown.state);
                shown.taken = ui.min_rect();
            },
            shown,
        )
}

/// Applies the fonts, colours and spacing of the window, and shows tooltips without delay. Nothing is animated, so a control comes to rest in
/// the pass after it has changed.
pub(crate) fn dress(ctx: &egui::Context) {
    egui_material_icons::initialize(ctx);
    theme::apply(ctx);
    ctx.add_plugin(super::control::MenuKey::default());
    ctx.all_styles_mut(|style| {
        style.interaction.tooltip_delay = 0.0;
        style.interaction.show_tooltips_only_when_still = false;
        style.animation_time = 0.0;
        style.scroll_animation = egui::style::ScrollAnimation::none();
    });
}

/// Opens every section, including nested ones.
pub(crate) fn unfold<S>(harness: &mut Harness<'_, S>) {
    let folded = |node: &AccessKitNode<'_>| {
        node.role() == Role::DisclosureTriangle && node.data().is_expanded() == Some(false)
    };
    while harness.query_all_by(folded).next().is_some_and(|node| {
        node.click();
        true
    }) {
        harness.run();
    }
    harness.remove_cursor();
    harness.run();
}

/// The only control with that role and name.
pub(crate) fn control<'t, S>(harness: &'t Harness<'_, S>, role: Role, name: &'t str) -> Node<'t> {
    harness.get_by_role_and_label(role, name)
}

/// Centres of all controls of a role, from top to bottom, with their names.
pub(crate) fn controls<S>(harness: &Harness<'_, S>, role: Role) -> Vec<(String, Rect)> {
    harness
        .query_all_by_role(role)
        .map(|node| (node.accesskit_node().label().unwrap_or_default(), node.rect()))
        .collect()
}

/// Whether a check box is checked.
pub(crate) fn is_on(node: &Node<'_>) -> bool {
    node.accesskit_node().toggled() == Some(Toggled::True)
}

/// Presses or releases the primary button.
pub(crate) fn press<S>(harness: &Harness<'_, S>, pos: Pos2, pressed: bool) {
    let modifiers = Modifiers::NONE;
    harness.event(Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers });
}

/// One click.
pub(crate) fn click<S>(harness: &mut Harness<'_, S>, at: Pos2) {
    harness.hover_at(at);
    press(harness, at, true);
    press(harness, at, false);
    harness.run_ok();
}

/// One click in a window that repaints continuously.
pub(crate) fn click_at<S>(harness: &mut Harness<'_, S>, at: Pos2) {
    harness.hover_at(at);
    press(harness, at, true);
    press(harness, at, false);
    harness.run_steps(6);
}

/// Chooses an entry of a list in a popup with the pointer, and checks that the popup stays open.
pub(crate) fn choose_in_popup<S>(harness: &mut Harness<'_, S>, list: &str, entry: &str) {
    let at = control(harness, Role::ComboBox, list).rect().center();
    click_at(harness, at);
    let at = control(harness, Role::Button, entry).rect().center();
    click_at(harness, at);
    assert!(
        harness.query_by_role_and_label(Role::ComboBox, list).is_some(),
        "the list {list} closed the popup around it"
    );
}

/// A double-click.
pub(crate) fn double_click<S>(harness: &mut Harness<'_, S>, at: Pos2) {
    harness.hover_at(at);
    for _ in 0..2 {
        press(harness, at, true);
        press(harness, at, false);
    }
    harness.run_ok();
}

/// A drag in several moves, over many passes.
pub(crate) fn drag<S>(harness: &mut Harness<'_, S>, from: Pos2, to: Pos2) {
    harness.hover_at(from);
    press(harness, from, true);
    for i in 1..=8 {
        harness.hover_at(from + (to - from) * (i as f32 / 8.0));
    }
    press(harness, to, false);
    harness.run_ok();
}

/// Types a number into the field at a place, as a user does: click, type, Enter.
pub(crate) fn type_at<S>(harness: &mut Harness<'_, S>, at: Pos2, text: &str) {
    click(harness, at);
    harness.event(Event::Text(text.to_owned()));
    harness.run_ok();
    harness.key_press(egui::Key::Enter);
    harness.run_ok();
}

/// The text of the tooltip on the screen.
pub(crate) fn tooltip<S>(harness: &Harness<'_, S>) -> Option<String> {
    let layers: Vec<_> = harness.ctx.memory(|memory| {
        memory.areas().visible_layer_ids().into_iter().filter(|layer| layer.order == Order::Tooltip).collect()
    });
    let rects: Vec<Rect> =
        harness.ctx.memory(|memory| layers.iter().filter_map(|layer| memory.area_rect(layer.id)).collect());
    let texts = texts(harness);
    let said: Vec<String> = texts
        .into_iter()
        .filter(|(_, rect, _)| rects.iter().any(|tip| tip.contains_rect(rect.shrink(1.0))))
        .map(|(text, ..)| text)
        .collect();
    (!rects.is_empty()).then(|| said.join("\n"))
}

/// The tooltip at a position.
pub(crate) fn tooltip_at<S>(harness: &mut Harness<'_, S>, at: Pos2) -> Option<String> {
    harness.hover_at(at);
    harness.run_steps(3);
    let said = tooltip(harness);
    harness.remove_cursor();
    harness.step();
    said
}

/// Every text on the screen, its area, and the colour of its first letter.
pub(crate) fn texts<S>(harness: &Harness<'_, S>) -> Vec<(String, Rect, Color32)> {
    let mut found = Vec::new();
    for clipped in &harness.output().shapes {
        collect(&clipped.shape, &mut found);
    }
    found
}

fn collect(shape: &Shape, found: &mut Vec<(String, Rect, Color32)>) {
    match shape {
        Shape::Vec(shapes) => shapes.iter().for_each(|shape| collect(shape, found)),
        Shape::Text(text) => {
            let format = text.galley.job.sections.first().map_or(Color32::PLACEHOLDER, |s| s.format.color);
            let color = text.override_text_color.unwrap_or(format);
            found.push((text.galley.text().to_owned(), text.visual_bounding_rect(), color));
        }
        _ => {}
    }
}

/// The texts on the screen that are cut because there is no room for them.
pub(crate) fn cut_texts<S>(harness: &Harness<'_, S>) -> Vec<String> {
    fn collect(shape: &Shape, found: &mut Vec<String>) {
        match shape {
            Shape::Vec(shapes) => shapes.iter().for_each(|shape| collect(shape, found)),
            Shape::Text(text) if text.galley.elided => found.push(text.galley.text().to_owned()),
            _ => {}
        }
    }
    let mut found = Vec::new();
    harness.output().shapes.iter().for_each(|clipped| collect(&clipped.shape, &mut found));
    found
}

/// Whether a text on the screen has the colour that marks a changed value.
pub(crate) fn is_marked<S>(harness: &Harness<'_, S>, name: &str) -> bool {
    texts(harness).iter().any(|(text, _, color)| text == name && *color == theme::accent())
}
