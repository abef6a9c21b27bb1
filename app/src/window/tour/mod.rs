//! The tour: steps that point at the controls of the window, one after the other.

mod steps;

use egui::{
    Align2, Area, Context, CornerRadius, Frame, Id, Key, LayerId, Modifiers, Order, Pos2, Rect, RichText,
    Stroke, StrokeKind, Vec2, vec2,
};

use super::control::point;
use super::page::Page;
use super::{Window, key_press, theme};
use steps::{STEPS, Target};

/// Width of the text, points.
const WIDTH: f32 = 300.0;
/// Distance of the text from what it points at, points.
const GAP: f32 = 16.0;

/// Where the tour is.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tour {
    step: Option<usize>,
    /// Whether the window was prepared for the step.
    is_prepared: bool,
    /// The size of the text in the last pass, and whether it pointed at something.
    size: Vec2,
    points: bool,
}

impl Tour {
    /// Begins at the first step.
    pub(super) fn begin(&mut self) {
        *self = Self { step: Some(0), ..Self::default() };
    }

    /// Whether it is shown.
    #[cfg(test)]
    pub(super) fn is_open(&self) -> bool {
        self.step.is_some()
    }

    /// Whether it points at a control.
    #[cfg(test)]
    pub(super) fn points(&self) -> bool {
        self.points
    }
}

impl Window {
    /// Shows the step of the tour. `image` is the area between the panels.
    pub(super) fn tour(&mut self, ctx: &Context, image: Rect) {
        let Some(at) = self.tour.step else { return };
        if self.holds_keys(ctx) {
            return;
        }
        let step = &STEPS[at];
        if !std::mem::replace(&mut self.tour.is_prepared, true) {
            self.layout.panels_hidden = false;
            if self.layout.page == Page::Wall {
                self.layout.page = Page::Image;
            }
            point::at(
                ctx,
                match step.target {
                    Target::Section(title) => Some(title),
                    Target::Image | Target::Command(_) => None,
                },
            );
            ctx.request_repaint();
        }
        let target = match &step.target {
            Target::Image => None,
            Target::Section(_) => point::place(ctx),
            Target::Command(command) => point::place_of_command(ctx, command),
        };
        self.tour.points = target.is_some();
        if let Some(rect) = target {
            let painter = ctx.layer_painter(LayerId::new(Order::Tooltip, Id::unique("tour mark")));
            painter.rect_stroke(
                rect.expand(3.0),
                CornerRadius::same(5),
                Stroke::new(2.0, theme::accent()),
                StrokeKind::Outside,
            );
        }
        let place = place_of_card(target, image, ctx.content_rect(), self.tour.size);
        let keymap = &self.layout.keys;
        let shown = Area::new(Id::unique("tour"))
            .order(Order::Foreground)
            .pivot(Align2::LEFT_TOP)
            .fixed_pos(place)
            .show(ctx, |ui| {
                Frame::popup(ui.style())
                    .inner_margin(12.0)
                    .stroke(Stroke::new(1.0, theme::accent()))
                    .show(ui, |ui| {
                        ui.set_width(WIDTH);
                        ui.label(RichText::new(step.title).strong().size(15.0));
                        ui.add_space(2.0);
                        ui.label(step.text(keymap));
                        ui.add_space(6.0);
                        ui.horizontal(|ui| {
                            let back = ui.add_enabled(at > 0, egui::Button::new("Back")).clicked();
                            let last = at + 1 == STEPS.len();
                            let next = ui.button(if last { "Done" } else { "Next" }).clicked();
                            let leaves = !last && ui.button("Leave the tour").clicked();
                            ui.label(
                                RichText::new(format!("{} of {}", at + 1, STEPS.len()))
                                    .small()
                                    .color(theme::quiet()),
                            );
                            (back, next, leaves)
                        })
                        .inner
                    })
                    .inner
            });
        let size = shown.response.rect.size();
        if size != self.tour.size {
            self.tour.size = size;
            ctx.request_repaint();
        }
        let (mut back, mut next, mut leaves) = shown.inner;
        if !ctx.text_edit_focused() && !ctx.any_popup_open() {
            next |= key_press::consume(ctx, Modifiers::NONE, Key::PageDown);
            back |= key_press::consume(ctx, Modifiers::NONE, Key::PageUp);
            leaves |= key_press::consume(ctx, Modifiers::NONE, Key::Escape);
        }
        let to = match (back, next, leaves) {
            (_, _, true) => None,
            (_, true, _) => Some(at + 1).filter(|to| *to < STEPS.len()),
            (true, ..) => Some(at.saturating_sub(1)),
            _ => return,
        };
        point::at(ctx, None);
        self.tour = Tour { step: to, size: self.tour.size, ..Tour::default() };
        ctx.request_repaint();
    }
}

/// Where the text stands: beside what it points at, toward the image, and within the window.
fn place_of_card(target: Option<Rect>, image: Rect, window: Rect, size: Vec2) -> Pos2 {
    let Some(target) = target else {
        return image.center_bottom() - vec2(0.5 * size.x, size.y + GAP);
    };
    let place = if target.right() + GAP + size.x < window.right()
        && target.center().x < image.center().x
        && target.left() < image.left()
    {
        egui::pos2(image.left() + GAP, target.top())
    } else if target.left() > image.right() - 1.0 {
        egui::pos2(image.right() - GAP - size.x, target.top())
    } else if target.center().y > window.center().y {
        egui::pos2(target.center().x - 0.5 * size.x, target.top() - GAP - size.y)
    } else {
        egui::pos2(target.center().x - 0.5 * size.x, target.bottom() + GAP)
    };
    let most = (window.max - size - Vec2::splat(8.0)).max(window.min);
    place.clamp(window.min + Vec2::splat(8.0), most)
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    #[test]
    fn the_text_stays_in_the_window_and_beside_its_control() {
        let window = Rect::from_min_max(pos2(0.0, 0.0), pos2(1024.0, 700.0));
        let image = Rect::from_min_max(pos2(312.0, 30.0), pos2(712.0, 560.0));
        let size = vec2(330.0, 140.0);
        let left = Rect::from_min_size(pos2(8.0, 650.0), vec2(290.0, 20.0));
        let right = Rect::from_min_size(pos2(720.0, 40.0), vec2(290.0, 20.0));
        let below = Rect::from_min_size(pos2(400.0, 600.0), vec2(24.0, 24.0));
        for target in [Some(left), Some(right), Some(below), None] {
            let card = Rect::from_min_size(place_of_card(target, image, window, size), size);
            assert!(window.contains_rect(card), "{target:?}: {card:?}");
            if let Some(target) = target {
                assert!(!card.intersects(target), "{target:?}: {card:?}");
            }
        }
    }
}
