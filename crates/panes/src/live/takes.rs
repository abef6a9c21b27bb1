//! Panes that play takes of their own, at the time of the window.

use std::sync::Arc;
use std::time::SystemTime;

use lovelock_groom::Strands;
use lovelock_project::Project;
use lovelock_project::error::{Place, ProjectError};
use lovelock_project::files::{Access, FileRef};
use lovelock_session::snapshot::FrameSnapshot;
use lovelock_session::take::{CurveInputs, TakePlayer};

use crate::request::LiveRequest;

/// The open takes of panes.
#[derive(Default)]
pub(super) struct PaneTakes {
    held: Vec<Held>,
}

/// The source of an open take.
#[derive(PartialEq)]
struct Source {
    file: FileRef,
    access: Access,
    /// Size and modification time, to detect a replaced file.
    version: Option<(u64, SystemTime)>,
    /// Body and motion around curves.
    around: Option<CurveInputs>,
}

struct Held {
    pane: usize,
    source: Source,
    /// The player, or a sentence that says why the take cannot be played.
    player: Result<Box<TakePlayer>, String>,
    instant: Option<(f64, Arc<FrameSnapshot>)>,
    strands: Strands,
}

impl PaneTakes {
    /// The memory of the strands of the takes, bytes.
    pub(super) fn bytes(&self) -> u64 {
        self.held.iter().map(|held| held.strands.bytes()).sum()
    }

    /// Opens the takes of a request's panes and seeks to its time.
    pub(super) fn begin(&mut self, request: &LiveRequest) {
        let panes = &request.project.compare.panes;
        let wanted = |pane: usize| {
            let file = panes.get(pane)?.take.clone()?;
            let data = std::fs::metadata(&file.path).ok();
            let version = data.and_then(|data| Some((data.len(), data.modified().ok()?)));
            let around = CurveInputs::of(&file.path, &request.project);
            Some(Source { file, access: request.access.clone(), version, around })
        };
        self.held.retain(|held| wanted(held.pane).is_some_and(|source| source == held.source));
        for &pane in &request.panes {
            let Some(source) = wanted(pane) else { continue };
            if !self.held.iter().any(|held| held.pane == pane) {
                let player = open(&source, &request.project).map(Box::new).map_err(|error| error.to_string());
                self.held.push(Held { pane, source, player, instant: None, strands: Strands::default() });
            }
        }
        // A simulation that loops starts again; curves count on its first round.
        let simulated = request.project.take.file.is_none();
        let snapshot = &request.snapshot;
        let dance_secs = if simulated { snapshot.position_secs } else { snapshot.time_secs };
        for held in &mut self.held {
            if let Ok(player) = &mut held.player
                && player.set_surroundings(request.snapshot.scene.surroundings.clone(), Vec::new())
            {
                held.instant = None;
            }
            // A take starts with the window; curves belong to an instant of the dance.
            let secs = match &held.player {
                Ok(player) if player.is_cache() => dance_secs - player.header().start_secs,
                _ => snapshot.position_secs,
            };
            held.go_to(secs);
        }
    }

    /// The instant of a pane's own take with its strands; `None` if the pane shows the same hair as the window.
    ///
    /// # Errors
    /// A sentence if the take cannot be played.
    pub(super) fn instant(&self, pane: usize) -> Option<Result<(&Arc<FrameSnapshot>, &Strands), &str>> {
        let held = self.held.iter().find(|held| held.pane == pane)?;
        Some(match (&held.player, &held.instant) {
            (Err(why), _) => Err(why),
            (Ok(_), Some((_, snapshot))) => Ok((snapshot, &held.strands)),
            (Ok(_), None) => Err("the take has no frame at this time"),
        })
    }
}

impl Held {
    fn go_to(&mut self, secs: f64) {
        let Ok(player) = &mut self.player else { return };
        if self.instant.as_ref().is_some_and(|(at, _)| at.to_bits() == secs.to_bits()) {
            return;
        }
        match player.snapshot(secs) {
            Ok(snapshot) => {
                snapshot.interpolate(&mut self.strands);
                self.instant = Some((secs, snapshot));
            }
            Err(error) => self.player = Err(error.to_string()),
        }
    }
}

fn open(source: &Source, project: &Project) -> Result<TakePlayer, ProjectError> {
    let Source { file, access, .. } = source;
    let path = access.read(Place::Take, file).map_err(|problem| ProjectError::input(&file.path, problem))?;
    Ok(TakePlayer::open_for(&path, access, project)?.0)
}
