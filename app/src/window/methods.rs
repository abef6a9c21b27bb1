//! Shadow methods of the user's own: opened by dropping their folders, and read again when their files are saved.

use std::path::{Path, PathBuf};
use std::time::Duration;

use lovelock_base::clock::Stopwatch;
use lovelock_project::Project;
use lovelock_project::project::{CompareSection, Contender};
use lovelock_render::{ShadowMethod, UserMethod};

use super::page::Page;
use super::{Window, notices};

/// Time from one look at the files of methods to the next.
const LOOKS: Duration = Duration::from_secs(1);

/// What is known of the files of methods.
#[derive(Default)]
pub(super) struct Methods {
    looked: Option<Stopwatch>,
    /// [`UserMethod::revision`] of the images that were asked for last.
    revision: u64,
}

/// The folder of a method, if `path` is one or the description in one.
fn folder_of(path: &Path) -> Option<PathBuf> {
    let is_method = |folder: &Path| folder.join("method.toml").is_file();
    if path.is_dir() {
        return is_method(path).then(|| path.to_owned());
    }
    let is_part = path.file_name().is_some_and(|name| name == "method.toml")
        || path.extension().is_some_and(|extension| extension == "wgsl");
    path.parent().filter(|folder| is_part && is_method(folder)).map(Path::to_owned)
}

/// Gives a project a pane with a method, or the method itself where it is not compared.
pub(super) fn show(project: &mut Project, method: UserMethod, in_pane: bool) {
    let method = ShadowMethod::User(method);
    if !in_pane {
        project.shadow.method = method;
        return;
    }
    let mut pane = Contender::of(project);
    pane.shadow.method = method;
    let panes = &mut project.compare.panes;
    if panes.iter().any(|pane| pane.shadow.method == method) {
        return;
    }
    if panes.len() >= CompareSection::MAX_PANES {
        panes.pop();
    }
    panes.push(pane);
}

impl Window {
    /// Opens a method of the user's own if the path is one. One whose files have a problem is opened too, so that it can be mended.
    pub(super) fn open_method(&mut self, path: &Path) -> bool {
        let Some(folder) = folder_of(path) else { return false };
        let method = UserMethod::load(&folder).unwrap_or_else(|_| UserMethod::opened(&folder));
        self.session.pick(&method.description_file());
        let in_pane = self.layout.page == Page::Compare;
        self.change("shadow method", |project| show(project, method, in_pane));
        self.tell_of(method);
        true
    }

    /// Reads methods again whose files were saved, and asks for new images where a method has another version.
    pub(super) fn follow_methods(&mut self, ctx: &egui::Context) {
        let named = self.document.project().user_methods();
        if named.is_empty() {
            return;
        }
        let methods = &mut self.files.methods;
        if methods.looked.as_ref().is_none_or(|looked| looked.elapsed() >= LOOKS) {
            methods.looked = Some(Stopwatch::start());
            for method in named.into_iter().filter(|method| method.follow()) {
                self.tell_of(method);
            }
        }
        let revision = UserMethod::revision();
        if std::mem::replace(&mut self.files.methods.revision, revision) != revision {
            self.pages.compare.ask_again();
            self.session.ask_again();
        }
        ctx.request_repaint_after(LOOKS);
    }

    /// Says how reading a method ended.
    fn tell_of(&mut self, method: UserMethod) {
        match method.problem() {
            Some(problem) => self.warn([problem]),
            None => {
                self.notices.push(notices::Kind::Done, format!("{}: was read and compiles.", method.label()));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_method_is_known_by_its_description() {
        let dir = tempfile::tempdir().expect("a folder");
        let folder = dir.path().join("my fog");
        lovelock_render::new_method(&folder).expect("written");
        let found = ["", "method.toml", "method.wgsl"].map(|name| folder_of(&folder.join(name)));
        assert!(
            found.iter().all(|found| found.as_deref().is_some_and(|found| found.ends_with("my fog"))),
            "{found:?}"
        );
        assert_eq!(folder_of(dir.path()), None);
        std::fs::write(dir.path().join("other.wgsl"), "").expect("a file");
        assert_eq!(folder_of(&dir.path().join("other.wgsl")), None);
        let method = UserMethod::load(&folder).expect("the template");
        let mut project = Project::default();
        assert!(project.user_methods().is_empty());
        let panes = project.compare.panes.len();
        for _ in 0..2 {
            show(&mut project, method, true);
        }
        assert_eq!(
            (project.compare.panes.len(), project.user_methods()),
            (panes + 1, vec![method]),
            "one pane"
        );
        show(&mut project, method, false);
        assert_eq!(project.shadow.method, ShadowMethod::User(method));
    }
}
