//! Jumps to the control of a setting: unfolds the sections around it, scrolls to it, focuses it and lets it flash.
//!
//! No table says in which section a control is. A pass that is not shown walks through all sections and notes where the control is.

use egui::{Align, Context, CornerRadius, Id, Rect, Response, Stroke, StrokeKind, Ui};
use lovelock_base::settings::Info;

use crate::window::theme;

/// Time for which the control flashes, seconds.
const FLASH_SECS: f64 = 1.6;
/// Time for which the scroll areas follow the control while its sections unfold, seconds.
const FOLLOW_SECS: f64 = 0.4;
/// Passes after which a control that does not appear is given up.
const PASSES: u32 = 60;

/// A setting whose control is looked for or shown.
#[derive(Clone, Debug)]
struct Reveal {
    info: &'static Info,
    /// The titles of the sections that are around the place of this pass, from the outermost.
    around: Vec<String>,
    stage: Stage,
}

#[derive(Clone, Debug, PartialEq)]
enum Stage {
    /// It was asked for in this pass, whose panels may have been shown already.
    Asked,
    /// A pass through all sections, folded or not. `found` has those around the control.
    Looking { found: Option<Vec<String>> },
    /// Those sections are unfolded.
    Unfolding { sections: Vec<String>, passes: u32 },
    /// The control is shown since that time, seconds.
    Shown { since_secs: f64, is_focused: bool },
}

fn key() -> Id {
    Id::unique("revealed setting")
}

fn get(ctx: &Context) -> Option<Reveal> {
    ctx.data(|data| data.get_temp(key()))
}

fn put(ctx: &Context, reveal: Reveal) {
    ctx.data_mut(|data| data.insert_temp(key(), reveal));
}

/// Whether two settings have the same entry of a table.
fn is_same(a: &Info, b: &Info) -> bool {
    (a.name, a.label, a.text) == (b.name, b.label, b.text)
}

/// Looks for the control of a setting in the next pass, in which the panels must be shown.
pub(crate) fn reveal(ctx: &Context, info: &'static Info) {
    put(ctx, Reveal { info, around: Vec::new(), stage: Stage::Asked });
    ctx.request_repaint();
}

/// Whether this pass walks through all sections, also those that are not visible, to find a control.
pub(crate) fn is_looking(ctx: &Context) -> bool {
    get(ctx).is_some_and(|reveal| matches!(reveal.stage, Stage::Looking { .. }))
}

/// The title of the outermost section that holds the control to be shown, once it is known and until the control is shown.
pub(crate) fn section(ctx: &Context) -> Option<String> {
    match get(ctx)?.stage {
        Stage::Unfolding { sections, .. } => sections.first().cloned(),
        Stage::Asked | Stage::Looking { .. } | Stage::Shown { .. } => None,
    }
}

/// How a section is shown while a control is looked for.
pub(super) enum Section {
    /// As the user left it.
    Usual,
    /// Its contents without its header, in a pass that is not shown.
    Through,
    /// Unfolded.
    Unfolded,
}

/// Enters a section. [`leave`] must follow.
pub(super) fn enter(ctx: &Context, title: &str) -> Section {
    let Some(mut reveal) = get(ctx) else { return Section::Usual };
    reveal.around.push(title.to_owned());
    let how = match &reveal.stage {
        Stage::Unfolding { sections, .. } if sections.starts_with(&reveal.around) => Section::Unfolded,
        Stage::Looking { .. } => Section::Through,
        Stage::Asked | Stage::Unfolding { .. } | Stage::Shown { .. } => Section::Usual,
    };
    put(ctx, reveal);
    how
}

/// Leaves the section that was entered last.
pub(super) fn leave(ctx: &Context) {
    if let Some(mut reveal) = get(ctx) {
        reveal.around.pop();
        put(ctx, reveal);
    }
}

/// Tells that the control of a setting is shown by `response`.
pub(crate) fn shown(ui: &Ui, info: &Info, response: &Response) {
    let ctx = ui.ctx();
    let Some(mut reveal) = get(ctx).filter(|reveal| is_same(reveal.info, info)) else { return };
    let now = ui.input(|input| input.time);
    match &mut reveal.stage {
        Stage::Asked => {}
        Stage::Looking { found } => {
            found.get_or_insert_with(|| reveal.around.clone());
        }
        Stage::Unfolding { sections, .. } => {
            // Another control of the same setting elsewhere is passed by.
            if *sections != reveal.around {
                return;
            }
            reveal.stage = Stage::Shown { since_secs: now, is_focused: false };
            response.scroll_to_me(Some(Align::Center));
        }
        Stage::Shown { since_secs, is_focused } => {
            let age = now - *since_secs;
            if !*is_focused {
                response.request_focus();
                *is_focused = true;
            }
            if age < FOLLOW_SECS {
                response.scroll_to_me_animation(Some(Align::Center), egui::style::ScrollAnimation::none());
            }
            let strength = (1.0 - age / FLASH_SECS).clamp(0.0, 1.0) as f32;
            let columns = ui.max_rect().x_range();
            let rect = Rect::from_x_y_ranges(columns, response.rect.y_range()).expand2([0.0, 3.0].into());
            let color = theme::accent().gamma_multiply(strength);
            let painter = ui.painter();
            painter.rect_filled(rect, CornerRadius::same(4), color.gamma_multiply(0.25));
            painter.rect_stroke(rect, CornerRadius::same(4), Stroke::new(1.5, color), StrokeKind::Inside);
            ctx.request_repaint();
        }
    }
    put(ctx, reveal);
}

/// Ends the pass. Returns the setting if no control of it is shown with this project.
pub(crate) fn end_pass(ctx: &Context) -> Option<&'static Info> {
    let mut reveal = get(ctx)?;
    let now = ctx.input(|input| input.time);
    reveal.around.clear();
    match &mut reveal.stage {
        Stage::Asked => reveal.stage = Stage::Looking { found: None },
        Stage::Looking { found } => {
            // What this pass shows is not laid out as the user knows it.
            ctx.request_discard("looked for a control");
            let Some(sections) = found.take() else {
                ctx.data_mut(|data| data.remove::<Reveal>(key()));
                return Some(reveal.info);
            };
            reveal.stage = Stage::Unfolding { sections, passes: 0 };
        }
        Stage::Unfolding { passes, .. } if *passes >= PASSES => {
            ctx.data_mut(|data| data.remove::<Reveal>(key()));
            return Some(reveal.info);
        }
        Stage::Unfolding { passes, .. } => *passes += 1,
        Stage::Shown { since_secs, .. } if now - *since_secs > FLASH_SECS => {
            ctx.data_mut(|data| data.remove::<Reveal>(key()));
            return None;
        }
        Stage::Shown { .. } => {}
    }
    put(ctx, reveal);
    ctx.request_repaint();
    None
}
