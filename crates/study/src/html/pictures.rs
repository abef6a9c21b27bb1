//! Images and maps: a wipe between two, and all of one kind beside each other.

use super::names::{Names, backend, color};
use super::words::{address, escaped};
use crate::report::{CompareReport, MethodFiles, ReferencePicture};
use std::fmt::Write as _;

/// Selects the file of one kind from those of a method.
type File = fn(&MethodFiles) -> &Option<String>;

/// Kinds of images: identifier in the page, label of the button, and file of a method.
const KINDS: [(&str, &str, File); 6] = [
    ("picture", "Picture", |files| &files.picture),
    ("transmittance-error", "Transmittance error", |files| &files.transmittance_error),
    ("picture-error", "Picture error (FLIP)", |files| &files.picture_error),
    ("swim", "Swim", |files| &files.swim),
    ("pop", "Pop", |files| &files.pop),
    ("flicker", "Flicker", |files| &files.flicker),
];

/// The wipe between any two images of one kind, and below it all images of that kind. Empty if there are no images.
pub(super) fn section(report: &CompareReport, names: &Names) -> String {
    let mut buttons = String::new();
    let mut cards = String::new();
    for (kind, title, file) in KINDS {
        let mut of_kind = String::new();
        for (name, file) in references(report).into_iter().filter(|_| kind == "picture") {
            of_kind += &card(kind, file, &name, "#202124");
        }
        for method in &report.methods {
            if let Some(file) = file(&method.files) {
                of_kind += &card(kind, file, &names.full(method), color(method));
            }
        }
        if !of_kind.is_empty() {
            let says =
                report.legends.iter().find(|legend| legend.of == kind).map_or("", |legend| &legend.title);
            let _ = write!(
                buttons,
                "<button type=\"button\" data-kind=\"{kind}\" title=\"{}\">{title}</button>",
                escaped(says)
            );
            cards += &of_kind;
        }
    }
    if cards.is_empty() {
        return String::new();
    }
    let first = if report.reference.picture.is_some() { "the reference" } else { "the first" };
    format!(
        "<div class=\"controls\"><div class=\"kinds\" role=\"group\" aria-label=\"Kind of image\">{buttons}</div>\
         <label>Left <select id=\"left\"></select></label><label>Right <select id=\"right\"></select></label>\
         <label>Zoom <select id=\"zoom\"><option>1</option><option>2</option><option>4</option></select></label></div>\
         <div class=\"box\"><div id=\"wipe\" tabindex=\"0\" role=\"slider\" aria-label=\"Split between left and right\" \
         aria-valuemin=\"0\" aria-valuemax=\"100\" aria-valuenow=\"50\"><img id=\"under\" alt=\"\" draggable=\"false\">\
         <img id=\"over\" alt=\"\" draggable=\"false\"><i id=\"split\"></i></div></div>\
         <p class=\"note\" id=\"hint\">Drag the line, or move it with the arrow keys; hold F to see the left picture alone. At first \
         {first} is on the left.</p>\
         <div id=\"cards\" class=\"cards\" data-kind=\"picture\">{cards}</div>"
    )
}

/// The reference images with their names, which contain the backend if there are several.
fn references(report: &CompareReport) -> Vec<(String, &str)> {
    let reference = &report.reference;
    if reference.pictures.len() < 2 {
        return reference.picture.iter().map(|file| ("Reference".to_owned(), file.as_str())).collect();
    }
    let named = |picture: &'_ ReferencePicture| format!("Reference · {}", backend(&picture.backend));
    reference.pictures.iter().map(|picture| (named(picture), picture.file.as_str())).collect()
}

fn card(kind: &str, file: &str, name: &str, color: &str) -> String {
    let (file, name) = (escaped(&address(file)), escaped(name));
    format!(
        "<figure data-kind=\"{kind}\" data-name=\"{name}\"><img src=\"{file}\" alt=\"{name}\"><figcaption>\
         <i class=\"swatch\" style=\"background:{color}\"></i>{name}</figcaption></figure>"
    )
}
