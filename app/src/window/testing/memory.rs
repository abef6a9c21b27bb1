//! What the window gives back: pages when they are left, and everything of a project that is closed.

use std::sync::{Arc, Weak};

use egui::{Key, Modifiers};

use super::whole::{CTRL, key, of, press_button, project, wait, window};

#[test]
fn pages_give_back_what_they_held_when_they_are_left() {
    let mut harness = window();
    wait(&mut harness, "an image", |window| window.session.painter().held_bytes() > 0);
    for (page, what) in [(Key::C, "the panes"), (Key::N, "the wall")] {
        key(&mut harness, Modifiers::NONE, page);
        wait(&mut harness, what, |window| {
            let (panes, cells) = (window.session.live().held_bytes(), window.pages.wall.held_bytes());
            let is_shown = if page == Key::C {
                window.pages.compare.has_pictures()
            } else {
                window.pages.wall.has_pictures()
            };
            is_shown && (if page == Key::C { panes } else { cells }) > 0
        });
        wait(&mut harness, "the single image to rest", |window| window.session.painter().held_bytes() == 0);
        let pane = of(&harness).pages.compare.pane(0).map_or_else(Weak::new, Arc::downgrade);
        key(&mut harness, Modifiers::NONE, page);
        wait(&mut harness, "the page to rest", |window| {
            window.session.live().held_bytes() == 0 && window.pages.wall.held_bytes() == 0
        });
        assert!(!of(&harness).pages.compare.has_pictures() && !of(&harness).pages.wall.has_pictures());
        assert_eq!(pane.strong_count(), 0);
        wait(&mut harness, "the image again", |window| window.session.painter().held_bytes() > 0);
    }
}

#[test]
fn a_new_project_drops_what_the_old_one_held() {
    for page in [None, Some(Key::C)] {
        let mut harness = window();
        wait(&mut harness, "an image", |window| window.session.painted.is_some());
        if let Some(page) = page {
            key(&mut harness, Modifiers::NONE, page);
            wait(&mut harness, "the panes", |window| window.pages.compare.has_pictures());
        }
        let hair = Arc::downgrade(&of(&harness).session.scene.as_ref().expect("a scene").style);
        let old: Weak<_> = Arc::downgrade(&project(&harness));
        harness.state_mut().state.as_mut().expect("a window").change("length", |project| {
            project.hair.groom.length *= 0.9;
        });
        harness.run_steps(2);
        assert!(old.strong_count() > 0, "undo returns to it");
        key(&mut harness, CTRL, Key::N);
        press_button(&mut harness, "Discard changes");
        wait(&mut harness, "the hair of the old project to go", |_| hair.strong_count() == 0);
        wait(&mut harness, "the old project to go", |_| old.strong_count() == 0);
    }
}
