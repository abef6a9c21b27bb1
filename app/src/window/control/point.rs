//! Controls that something points at: sections of panels by their titles, and buttons by their commands.

use egui::{Align, Context, Id, Rect, Response};

use crate::window::command::Command;

/// The section that is pointed at.
#[derive(Clone, Copy, Debug)]
struct Pointed {
    title: &'static str,
    /// Passes since it was asked for, in which it is unfolded and scrolled to.
    passes: u32,
    place: Option<(Rect, u64)>,
}

/// Passes in which a section is unfolded and scrolled to.
const PASSES: u32 = 12;

fn key() -> Id {
    Id::unique("section pointed at")
}

/// Points at the section of that title, or at none.
pub(crate) fn at(ctx: &Context, title: Option<&'static str>) {
    ctx.data_mut(|data| {
        if let Some(title) = title {
            data.insert_temp(key(), Pointed { title, passes: 0, place: None });
        } else {
            data.remove::<Pointed>(key());
        }
    });
}

fn get(ctx: &Context) -> Option<Pointed> {
    ctx.data(|data| data.get_temp(key()))
}

/// Whether a section shall be unfolded because something begins to point at it.
pub(super) fn unfolds(ctx: &Context, title: &str) -> bool {
    get(ctx).is_some_and(|pointed| pointed.title == title && pointed.passes < PASSES)
}

/// Notes where the heading of a section is, and scrolls to it at first.
pub(super) fn heading(title: &str, header: &Response) {
    let ctx = &header.ctx;
    let Some(mut pointed) = get(ctx).filter(|pointed| pointed.title == title) else { return };
    if pointed.passes < PASSES {
        header.scroll_to_me_animation(Some(Align::TOP), egui::style::ScrollAnimation::none());
        pointed.passes += 1;
        ctx.request_repaint();
    }
    // Nothing can point at a heading that is scrolled out of sight.
    if header.interact_rect.height() > 0.5 * header.rect.height() {
        pointed.place = Some((header.rect, ctx.cumulative_pass_nr()));
    }
    ctx.data_mut(|data| data.insert_temp(key(), pointed));
}

/// Where the section is; `None` if it is not shown.
pub(crate) fn place(ctx: &Context) -> Option<Rect> {
    let (rect, pass) = get(ctx)?.place?;
    (pass + 1 >= ctx.cumulative_pass_nr()).then_some(rect)
}

fn command_key(id: &str) -> Id {
    Id::unique("button of command").with(id)
}

/// Notes where the button of a command is.
pub(crate) fn note_command(response: &Response, command: &Command) {
    if let Some(info) = command.info() {
        let ctx = &response.ctx;
        let place = (response.rect, ctx.cumulative_pass_nr());
        ctx.data_mut(|data| data.insert_temp(command_key(info.id), place));
    }
}

/// Where the button of a command is; `None` if it is not shown.
pub(crate) fn place_of_command(ctx: &Context, command: &Command) -> Option<Rect> {
    let id = command_key(command.info()?.id);
    let (rect, pass) = ctx.data(|data| data.get_temp::<(Rect, u64)>(id))?;
    (pass + 1 >= ctx.cumulative_pass_nr()).then_some(rect)
}
