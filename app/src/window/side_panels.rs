//! Shows the panels beside the image, over it, and in the second window.

use egui::{Context, Ui};
use lovelock_motion::ColliderEdits;
use lovelock_project::Project;

use super::command::Command;
use super::dock::{self, Column};
use super::focus::{Area, Focus};
use super::health_view::facts;
use super::memory::kept_in_memory;
use super::page::Page;
use super::pointer_tool::PointerTool;
use super::readings::Readings;
use super::shelf::{Panels, Shelf, Side};
use super::{Window, keys};

impl Window {
    /// Shows the panels: at both sides of the image, over it, and in the second window. Returns what their controls ask for.
    pub(super) fn side_panels(&mut self, ui: &mut Ui, project: &mut Project) -> Vec<Command> {
        let ctx = ui.ctx().clone();
        let keys_are_held = self.holds_keys(&ctx);
        let Self { document, session, layout, pages, tools, panels, media, keyboard, display, .. } = self;
        let (document, pages_now, media, session_now) = (&*document, &*pages, &*media, &*session);
        let scene = session_now.scene.as_deref();
        let is_replaced = |edits: &ColliderEdits, at: usize| {
            let known = scene.and_then(|scene| Some((scene.fitted.get(at)?, scene)));
            known.is_some_and(|(fitted, scene)| edits.is_replaced(fitted, scene.field.as_deref()))
        };
        let facts = || [facts(session_now), kept_in_memory(session_now, pages_now, media, document)];
        let readings = Readings {
            tool: tools.active,
            problems: &session_now.problems,
            hair: &session_now.hair,
            body: &session_now.body,
            surroundings: &session_now.surroundings,
            take_notes: &session_now.take_notes,
            scalp: scene.map(|scene| &*scene.usual_scalp),
            has_skull: scene.is_none_or(|scene| scene.skull.is_some()),
            colliders: scene
                .iter()
                .flat_map(|scene| scene.fitted.iter().map(|of| of.name.as_str()))
                .collect(),
            is_replaced: &is_replaced,
            frame: session_now.frame.as_deref(),
            maps: session_now
                .painted
                .as_ref()
                .map(|painted| (painted.stats.shadow_bytes, painted.stats.shadow_fallbacks)),
            stages: &session_now.times.stages,
            passes: &session_now.times.passes,
            facts: &facts,
            pane: None,
            marked_gauge: tools.marked_gauge.as_ref().map(|gauge| gauge.kind),
            sound: media.soundtrack.loaded().map(|loaded| &**loaded),
            sound_problem: media.soundtrack.problem(),
            duration_secs: session_now.frame.as_ref().map_or(0.0, |frame| frame.duration_secs),
            recording: media.recorder.state(),
            film_frames: session_now.frames(project.recording.fps),
        };
        let pane =
            (layout.page == Page::Compare).then(|| pages_now.compare.reading(&layout.compare, project));
        let mut shelf = Shelf::new(panels, project, readings, pane);
        let (usual, dock) = (Panels::usual(), &mut layout.dock);
        let mut moves = Vec::new();
        if !layout.panels_hidden {
            let mut columns: [Column; 2] = Default::default();
            for ((side, area), titles) in
                [(Side::Left, Area::Left), (Side::Right, Area::Right)].into_iter().zip(dock.columns(usual))
            {
                let begin = Focus::begin_area(ui);
                columns[side as usize] = dock::column(ui, side, titles, &mut shelf, &mut moves);
                keyboard.focus.end_area(ui, area, begin);
            }
            let floating = dock.floating(usual);
            dock::floating(&ctx, floating, &mut shelf, &columns, &mut moves);
            moves.extend(dock::drop_held(&ctx, &columns));
        }
        let pressed = |ctx: &Context| keys::pressed(ctx, |_| !keys_are_held);
        let more = dock::second_window(&ctx, &mut display.second, dock, &mut shelf, &pressed);
        let mut commands = shelf.commands();
        commands.extend(more);
        for moved in moves {
            moved.apply(dock, &ctx);
        }
        let Panels { scalp, recording, statistics, .. } = panels;
        if !scalp.unfolded {
            tools.active.set(PointerTool::Scalp, false);
        }
        let film = &project.recording;
        pages.image.film = recording.unfolded.then_some([film.width, film.height]);
        session.view.measured = statistics.shows_passes;
        commands
    }
}
