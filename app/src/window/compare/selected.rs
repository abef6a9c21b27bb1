//! The pane that the panels edit.

use lovelock_groom::HairShading;
use lovelock_project::Project;
use lovelock_project::project::Contender;

use super::CompareLayout;

/// The project's own settings, while those of a pane are in their place so that the panels edit the pane.
pub(in crate::window) struct PaneEdit {
    pane: usize,
    own: Contender,
    shading: HairShading,
}

impl PaneEdit {
    /// Puts the settings of a pane in place of the project's; `None` if there is no such pane.
    pub(in crate::window) fn begin(project: &mut Project, pane: usize) -> Option<Self> {
        let edited = project.compare.panes.get(pane)?.clone();
        let edit = Self { pane, own: Contender::of(project), shading: project.look.shading };
        edited.apply_to(project);
        project.look.shading = project.compare.shading;
        Some(edit)
    }

    /// Gives the pane what was edited, and the project its own settings.
    pub(in crate::window) fn end(self, project: &mut Project) {
        project.compare.shading = project.look.shading;
        project.look.shading = self.shading;
        let Contender { shadow, draw, transparency, backend, .. } = Contender::of(project);
        self.own.apply_to(project);
        if let Some(pane) = project.compare.panes.get_mut(self.pane) {
            (pane.shadow, pane.draw, pane.transparency, pane.backend) = (shadow, draw, transparency, backend);
        }
    }
}

/// The pane to edit out of `panes`: the selected one, or the first one on the screen if that is not.
pub(super) fn of(layout: &CompareLayout, selected: usize, panes: usize) -> usize {
    let visible = layout.visible(panes);
    if visible.contains(&selected) { selected } else { visible.first().copied().unwrap_or_default() }
}

#[cfg(test)]
mod tests {
    use lovelock_render::ShadowMethod;

    use super::*;

    #[test]
    fn the_panels_edit_one_pane_and_what_all_share() {
        let before = Project::default();
        let mut project = before.clone();
        let edit = PaneEdit::begin(&mut project, 2).expect("a pane");
        assert_eq!(Contender { scale: 1.0, ..Contender::of(&project) }, before.compare.panes[2]);
        project.shadow.method = ShadowMethod::DensityClustering;
        project.look.extinction_scale *= 0.5;
        edit.end(&mut project);
        let mut wanted = before.clone();
        wanted.compare.panes[2].shadow.method = ShadowMethod::DensityClustering;
        wanted.look.extinction_scale *= 0.5;
        assert_eq!(project, wanted, "nothing else");

        let mut untouched = before.clone();
        PaneEdit::begin(&mut untouched, 1).expect("a pane").end(&mut untouched);
        assert_eq!(untouched, before);
        assert!(PaneEdit::begin(&mut untouched, 99).is_none() && untouched == before);
    }

    #[test]
    fn a_pane_that_is_not_on_the_screen_is_not_edited() {
        let mut layout = CompareLayout::default();
        assert_eq!([of(&layout, 2, 4), of(&layout, 7, 4)], [2, 0]);
        (layout.wipe, layout.pair) = (true, [1, 3]);
        assert_eq!([of(&layout, 3, 4), of(&layout, 2, 4)], [3, 1]);
    }
}
