use super::*;

fn dialog(purpose: Purpose, suggestion: &str, typed: &str) -> PathDialog {
    let mut dialog = PathDialog::new(purpose, Path::new(suggestion));
    (dialog.typed, dialog.is_edited) = (typed.to_owned(), true);
    dialog
}

#[test]
fn a_name_gets_the_folder_and_the_extension_that_it_lacks() {
    let path = |purpose, typed: &str| dialog(purpose, "/a b/out/dance.mp4", typed).path();
    assert_eq!(path(Purpose::Film, "dance"), Some(PathBuf::from("/a b/out/dance.mp4")));
    assert_eq!(path(Purpose::Film, "ü/v1.2"), Some(PathBuf::from("/a b/out/ü/v1.2.mp4")));
    assert_eq!(path(Purpose::Film, "/other/dance.mp4"), Some(PathBuf::from("/other/dance.mp4")));
    // Typed over the selected name, in front of the extension of the suggestion.
    assert_eq!(path(Purpose::Film, "dance.mp4.mp4"), Some(PathBuf::from("/a b/out/dance.mp4")));
    assert_eq!(path(Purpose::Curves, "x.glb.usdc"), Some(PathBuf::from("/a b/out/x.glb")));
    // Another extension is refused by what writes the file, and not hidden.
    assert_eq!(path(Purpose::Film, "dance.avi"), Some(PathBuf::from("/a b/out/dance.avi")));
    assert_eq!(path(Purpose::Sequence, "frames"), Some(PathBuf::from("/a b/out/frames")));
    for nothing in ["", "  ", "folder/"] {
        assert_eq!(path(Purpose::Open, nothing), None, "{nothing:?}");
    }
}

#[test]
fn a_whole_name_typed_over_the_selected_part_has_one_extension() {
    let typed = |purpose, typed: &str| {
        let mut dialog = dialog(purpose, "/a/dance.mp4", typed);
        dialog.drop_second_extension();
        dialog.typed
    };
    assert_eq!(typed(Purpose::Film, "ü.mp4.mp4"), "ü.mp4");
    assert_eq!(typed(Purpose::Film, "b/x.mp4.mp4"), "b/x.mp4");
    assert_eq!(typed(Purpose::Curves, "x.glb.usdc"), "x.glb");
    for whole in ["x.mp4", "v1.2.mp4", ".mp4", "", "b/"] {
        assert_eq!(typed(Purpose::Film, whole), whole);
    }
    assert_eq!(typed(Purpose::Sequence, "a.png.png"), "a.png.png", "a folder may be called anything");
}

#[test]
fn the_name_is_selected_when_the_dialog_opens() {
    let selected = |purpose, suggestion: &str| {
        let dialog = PathDialog::new(purpose, Path::new(suggestion));
        (dialog.typed.clone(), dialog.select)
    };
    assert_eq!(selected(Purpose::Film, "/a/ü dance.mp4"), ("ü dance.mp4".to_owned(), Some([0, 7])));
    assert_eq!(selected(Purpose::Sequence, "/a/v1.2"), ("v1.2".to_owned(), Some([0, 4])));
    assert_eq!(selected(Purpose::Open, "/a/"), (String::new(), Some([0, 0])));
}

#[test]
fn only_work_is_asked_for_before_it_is_replaced() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a");
    let all = [
        Purpose::SaveProject,
        Purpose::ExportStyle,
        Purpose::SaveStrokes,
        Purpose::Film,
        Purpose::Preview,
        Purpose::Curves,
        Purpose::Picture,
        Purpose::Open,
    ];
    for purpose in all {
        assert_eq!(purpose.replaces(&path, None), Replaces::Nothing, "{purpose:?}");
    }
    std::fs::write(&path, b"x").expect("a file");
    let found: Vec<_> = all.iter().map(|purpose| purpose.replaces(&path, None)).collect();
    let (asks, tells) = (Replaces::Asks, Replaces::Tells);
    assert_eq!(found, [asks, asks, asks, tells, tells, tells, tells, Replaces::Nothing]);
    assert_eq!(Purpose::SaveProject.replaces(&path, Some(&path)), Replaces::Nothing, "it is saved again");
    assert_eq!(Purpose::Sequence.replaces(folder.path(), None), Replaces::Nothing);
    std::fs::write(folder.path().join(lovelock_record::MANIFEST_NAME), b"{}").expect("a file");
    assert_eq!(Purpose::Sequence.replaces(folder.path(), None), tells);
}

#[test]
fn a_folder_that_is_entered_keeps_the_name_that_is_saved() {
    let mut saves = PathDialog::new(Purpose::SaveProject, Path::new("/a/hair.lovelock"));
    saves.enter(Path::new("/b c"));
    assert_eq!((saves.typed.as_str(), saves.select), ("/b c/hair.lovelock", Some([5, 9])));
    assert_eq!(saves.path(), Some(PathBuf::from("/b c/hair.lovelock")));
    let mut opens = dialog(Purpose::Open, "/a/", "ha");
    opens.enter(Path::new("/b c"));
    assert_eq!(opens.typed, "/b c/");
    assert_eq!(opens.place(), (PathBuf::from("/b c/"), String::new()));
}

#[test]
fn a_text_that_means_a_folder_by_another_name_is_not_completed_beyond_it() {
    let above = tempfile::tempdir().expect("a folder");
    for name in ["output-1", "output-2"] {
        std::fs::create_dir(above.path().join(name)).expect("a folder");
    }
    // The folder that is suggested does not exist yet.
    let suggestion = above.path().join("out").join("dance.mp4");
    let mut dialog = PathDialog::new(Purpose::Film, &suggestion);
    let ctx = egui::Context::default();
    let mut complete = |typed: &str| {
        (dialog.typed, dialog.is_edited, dialog.chosen) = (typed.to_owned(), true, None);
        let (at, _) = dialog.place();
        dialog.folder.show(&at, Purpose::Film, &ctx);
        while dialog.folder.is_reading() {
            dialog.folder.show(&at, Purpose::Film, &ctx);
        }
        assert!(dialog.complete(&[]));
        (dialog.typed.clone(), dialog.chosen)
    };
    assert_eq!(complete("."), (".".to_owned(), Some(0)));
    let whole = above.path().join("out").display().to_string();
    assert_eq!(complete(&whole), (format!("{whole}put-"), None));
}
