//! Messages in the corner of the window.

use egui::accesskit::Role;
use egui::{Id, LayerId, Order, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

use super::{Shown, screen_of, texts};
use crate::window::notices::{Kind, Notices};

fn corner(sentences: &[&str]) -> Harness<'static, Shown<Notices>> {
    let mut notices = Notices::default();
    for sentence in sentences {
        notices.push(Kind::Warning, *sentence);
    }
    let mut harness = screen_of(vec2(640.0, 400.0), notices, |ui, notices: &mut Notices| {
        let image = ui.max_rect();
        notices.show(ui.ctx(), image);
    });
    harness.run_steps(2);
    harness
}

#[test]
fn a_long_message_fits_into_the_window() {
    let path = "/a/folder/of/a/long/name".repeat(12);
    let harness = corner(&[&format!("{path}: there is no such file; pick another one")]);
    let told =
        texts(&harness).into_iter().find(|(text, ..)| text.contains("no such file")).expect("the sentence");
    assert!(told.1.left() >= 0.0 && told.1.right() <= 640.0 && told.1.bottom() <= 400.0, "{:?}", told.1);
    assert!(told.1.height() > 30.0, "it takes several lines");
}

#[test]
fn a_message_disappears_or_is_closed() {
    let mut harness = corner(&["one", "two", "one"]);
    assert_eq!(harness.query_all_by_label("one").count(), 1, "said twice, shown once");
    harness.query_all_by_role(Role::Button).next().expect("a button").click();
    harness.run_steps(6);
    assert!(harness.query_by_label("two").is_none() && harness.query_by_label("one").is_some());
    // Twenty seconds in passes of a thirtieth of a second, far longer than a short message is shown.
    harness.run_steps(30 * 20);
    assert!(harness.query_by_label("one").is_none());
}

#[test]
fn messages_lie_below_windows() {
    let mut notices = Notices::default();
    notices.push(Kind::Failed, "broken");
    let mut harness = screen_of(vec2(640.0, 400.0), notices, |ui, notices: &mut Notices| {
        let image = ui.max_rect();
        notices.show(ui.ctx(), image);
        egui::Window::new("Manual").default_pos([20.0, 20.0]).show(ui.ctx(), |ui| ui.label("text"));
    });
    harness.run_steps(4);
    let layers: Vec<LayerId> = harness
        .ctx
        .memory(|memory| memory.layer_ids().filter(|layer| layer.order == Order::Middle).collect());
    assert_eq!(layers.first(), Some(&LayerId::new(Order::Middle, Id::unique("notices"))));
    assert_eq!(layers.len(), 2, "{layers:?}");
}

#[test]
fn messages_do_not_fill_the_window() {
    let sentences: Vec<String> = (0..20).map(|i| format!("sentence {i}")).collect();
    let sentences: Vec<&str> = sentences.iter().map(String::as_str).collect();
    let harness = corner(&sentences);
    assert!(harness.query_all_by_label_contains("sentence").count() <= 5);
    assert!(harness.query_by_label("sentence 19").is_some(), "the newest is there");
    harness.check_accessibility();
    assert!(harness.query_all_by_role_and_label(Role::Button, "Close message").count() > 0);
}

#[test]
fn an_error_stays_until_it_is_closed_and_others_wait_for_it() {
    let mut notices = Notices::default();
    for number in 0..8 {
        notices.push(Kind::Failed, format!("broken {number}"));
    }
    notices.push(Kind::Warning, "passing");
    let mut harness = screen_of(vec2(640.0, 400.0), notices, |ui, notices: &mut Notices| {
        let image = ui.max_rect();
        notices.show(ui.ctx(), image);
    });
    // Twenty seconds: the warning is gone, the errors are not.
    harness.run_steps(30 * 20);
    assert!(harness.query_by_label("passing").is_none());
    assert!(harness.query_by_label("broken 0").is_some() && harness.query_by_label("3 more").is_some());
    harness.query_all_by_role_and_label(Role::Button, "Close message").next().expect("a button").click();
    harness.run_steps(2);
    assert!(harness.query_by_label("broken 0").is_none() && harness.query_by_label("broken 5").is_some());
    harness.get_by_role_and_label(Role::Button, "Close all").click();
    harness.run_steps(2);
    assert!(harness.state().state.errors().is_empty());
}

#[test]
fn a_written_file_can_be_opened_and_shown_in_its_folder() {
    let mut notices = Notices::default();
    notices.push_written("Recorded dance.mp4", "/films/out/dance.mp4".into());
    notices.push(Kind::Done, "Saved");
    let state = (notices, Vec::new());
    let mut harness =
        screen_of(vec2(640.0, 400.0), state, |ui, (notices, opened): &mut (Notices, Vec<_>)| {
            let image = ui.max_rect();
            opened.extend(notices.show(ui.ctx(), image));
        });
    harness.run_steps(2);
    assert_eq!(harness.query_all_by_label("Open").count(), 1, "only of what was written");
    for button in ["Open", "Show in folder"] {
        harness.get_by_label(button).click();
        harness.run_steps(3);
    }
    let opened: Vec<_> = harness.state().state.1.iter().map(|path| path.display().to_string()).collect();
    assert_eq!(opened, ["/films/out/dance.mp4", "/films/out"]);
}
