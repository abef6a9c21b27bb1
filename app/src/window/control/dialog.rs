//! Dialogs above everything else.

use egui::{Id, Modal};

/// A dialog that takes all input until it is answered. Screen readers call it `title`.
pub(crate) fn titled_dialog(id: &str, title: impl Into<String>) -> Modal {
    let id = Id::unique(id);
    Modal::new(id).area(Modal::default_area(id).accessible_name(title))
}
