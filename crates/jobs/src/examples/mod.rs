//! Examples that show what the program is: projects made from what is shipped. Files that they read are written when an example is opened.

mod groom;
mod motion;
mod sound;

use std::path::{Path, PathBuf};

use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_project::files::write_whole;
use lovelock_project::project::BodySource;
use lovelock_project::styles::{StyleParts, shipped};

/// An example.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Example {
    /// A hairstyle that dances.
    Dance,
    /// Shadow methods beside each other.
    Comparison,
    /// Hair from a file.
    Groom,
    /// Motion from a file, with sound.
    Motion,
}

/// A project of an example.
#[derive(Debug)]
pub struct Made {
    /// The project, which has no file.
    pub project: Project,
    /// The files that it reads.
    pub files: Vec<PathBuf>,
    /// Whether it is shown as a comparison.
    pub compares: bool,
}

impl Example {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Dance, Self::Comparison, Self::Groom, Self::Motion];

    /// The name.
    pub fn label(self) -> &'static str {
        match self {
            Self::Dance => "Red curls, dancing",
            Self::Comparison => "Shadow methods compared",
            Self::Groom => "Hair from a file",
            Self::Motion => "Captured motion with sound",
        }
    }

    /// What it shows.
    pub fn text(self) -> &'static str {
        match self {
            Self::Dance => "A hairstyle on the shipped dancer. Every control acts while she dances.",
            Self::Comparison => "Four methods on the same frame, each with its error and its cost.",
            Self::Groom => "Strands of an OBJ file, seated on the head and simulated.",
            Self::Motion => "A BVH file moves another figure, and the beat plays in step.",
        }
    }

    /// Its picture, a JPEG file.
    pub fn picture(self) -> &'static [u8] {
        match self {
            Self::Dance => include_bytes!("../../../../assets/examples/dance.jpg"),
            Self::Comparison => include_bytes!("../../../../assets/examples/comparison.jpg"),
            Self::Groom => include_bytes!("../../../../assets/examples/groom.jpg"),
            Self::Motion => include_bytes!("../../../../assets/examples/motion.jpg"),
        }
    }

    /// Makes the project. Files go into `folder`, which is made if need be, and replace those of earlier times. Takes a second or two.
    ///
    /// # Errors
    /// If the folder cannot be written.
    pub fn make(self, folder: &Path) -> Result<Made, ProjectError> {
        let mut made = Made { project: Project::default(), files: Vec::new(), compares: false };
        match self {
            Self::Dance => style(&mut made.project, "curly"),
            Self::Comparison => {
                style(&mut made.project, "long-waves");
                made.compares = true;
            }
            Self::Groom => {
                let path = write(folder, "groom.obj", groom::strands()?.as_bytes())?;
                made.project.set_hair_file(&path);
                made.files.push(path);
            }
            Self::Motion => {
                made.project.body.switch(BodySource::Woman, None);
                style(&mut made.project, "coils");
                let clip = write(folder, "dance.bvh", motion::clip()?.as_bytes())?;
                made.project.set_motion_file(&clip);
                let beat = write(folder, "beat.wav", &sound::beat())?;
                made.project.set_sound_file(&beat);
                made.files.extend([clip, beat]);
            }
        }
        Ok(made)
    }
}

/// The folder for the files of examples; `None` where the system has no folder for data.
pub fn folder() -> Option<PathBuf> {
    Some(dirs::data_dir()?.join("lovelock").join("examples"))
}

fn style(project: &mut Project, id: &str) {
    if let Some(shipped) = shipped::by_id(id) {
        project.apply_style(&shipped.style, StyleParts::ALL);
    }
}

/// Writes a file and returns its path.
fn write(folder: &Path, name: &str, bytes: &[u8]) -> Result<PathBuf, ProjectError> {
    std::fs::create_dir_all(folder).map_err(|error| {
        ProjectError::work(format!("{}: could not be created: {error}", folder.display()))
    })?;
    let path = folder.join(name);
    write_whole(&path, bytes)?;
    Ok(path)
}

#[cfg(test)]
mod tests {
    use lovelock_project::error::ProblemKind;
    use lovelock_project::files::Access;
    use lovelock_session::scene::SceneLoader;

    use super::*;

    #[test]
    fn every_example_loads_without_problems() {
        let folder = tempfile::tempdir().expect("a folder");
        for example in Example::ALL {
            let made = example.make(folder.path()).expect("is made");
            let mut access = Access::new();
            for file in &made.files {
                assert!(file.is_file());
                access.pick(file);
            }
            let (scene, problems) = SceneLoader::new().load_now(&made.project, &access).expect("loads");
            let failed: Vec<_> = problems.iter().filter(|known| known.kind != ProblemKind::Note).collect();
            assert!(failed.is_empty(), "{example:?}: {failed:?}");
            assert!(scene.style.strands.first_point.len() > 500, "{example:?}");
            assert!(scene.clip.is_some(), "{example:?}");
            // A picture of every example is shipped.
            assert_eq!(&example.picture()[..2], [0xFF, 0xD8]);
        }
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_told() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("file");
        std::fs::write(&file, b"x").expect("writes");
        let error = Example::Motion.make(&file.join("below")).expect_err("cannot be made");
        assert!(error.to_string().contains("file"), "{error}");
    }
}
