//! Names and colours of methods on the page.

use std::fmt::Write as _;

use lovelock_render::ShadowMethod;

use super::words::escaped;
use crate::report::{CompareReport, MethodReport};

/// Colours that can be distinguished on white, also by colour-blind readers: one per method, in the order of the menu.
const COLORS: [&str; 16] = [
    "#7d8590", "#0072b2", "#c98500", "#d1490f", "#a8467f", "#00825f", "#6b4fa0", "#8a6d1f", "#4b9fd6",
    "#7a3b1d", "#4f7a1c", "#b3367a", "#3d5a80", "#202124", "#c2185b", "#00838f",
];

/// Colours that are left for methods of users.
const OF_USERS: usize = COLORS.len() - ShadowMethod::ALL.len();

/// The colour of a method, the same in every plot of every report.
pub(super) fn color(method: &MethodReport) -> &'static str {
    // Those of users are told apart as far as colours are left.
    let of_user = || ShadowMethod::ALL.len() + method.id.bytes().map(usize::from).sum::<usize>() % OF_USERS;
    let index = ShadowMethod::ALL.iter().position(|known| known.id() == method.id).unwrap_or_else(of_user);
    COLORS[index % COLORS.len()]
}

/// Names of the methods of one report, as short as possible while still unique.
pub(super) struct Names {
    backends: bool,
    pub(super) draws: bool,
    transparencies: bool,
    /// Names that methods with other ids have too, such as those of users.
    repeated: Vec<String>,
}

impl Names {
    pub(super) fn of(report: &CompareReport) -> Self {
        let differ = |key: fn(&MethodReport) -> &str| {
            report.methods.windows(2).any(|pair| key(&pair[0]) != key(&pair[1]))
        };
        let is_repeated = |method: &MethodReport| {
            report.methods.iter().any(|other| other.label == method.label && other.id != method.id)
        };
        let repeated = report.methods.iter().filter(|method| is_repeated(method));
        Self {
            repeated: repeated.map(|method| method.label.clone()).collect(),
            backends: differ(|method| &method.backend),
            draws: differ(|method| &method.draw),
            transparencies: differ(|method| &method.transparency),
        }
    }

    /// The name, with everything that distinguishes it from the others.
    pub(super) fn full(&self, method: &MethodReport) -> String {
        let mut name = self.within_group(method);
        if self.draws {
            let _ = write!(name, " · {}", method.draw);
        }
        if self.transparencies {
            let _ = write!(name, " · {}", method.transparency);
        }
        if self.backends {
            let _ = write!(name, " · {}", backend(&method.backend));
        }
        name
    }

    /// The name among those of one backend, drawing and transparency.
    pub(super) fn within_group(&self, method: &MethodReport) -> String {
        let mut name = if method.label.is_empty() { method.id.clone() } else { method.label.clone() };
        if !method.label.is_empty() && self.repeated.contains(&method.label) {
            let _ = write!(name, " ({})", method.id);
        }
        for (setting, value) in &method.sweep {
            let _ = write!(name, " · {} {value}", setting.replace('_', " "));
        }
        name
    }

    /// The table cell with the name of a method.
    pub(super) fn cell(&self, method: &MethodReport) -> String {
        format!(
            "<th scope=\"row\"><i class=\"swatch\" style=\"background:{}\"></i>{}</th>",
            color(method),
            escaped(&self.within_group(method))
        )
    }
}

/// Methods with comparable costs: those with the same backend, adapter, drawing and transparency, in the order of the report.
pub(super) struct Group<'a> {
    /// Backend, adapter, drawing and transparency, for a heading.
    pub(super) title: String,
    /// The backend: CPU or GPU.
    pub(super) backend: &'static str,
    /// The methods with their positions in the report.
    pub(super) methods: Vec<(usize, &'a MethodReport)>,
}

/// The groups of a report, in order of appearance.
pub(super) fn groups<'a>(report: &'a CompareReport, names: &Names) -> Vec<Group<'a>> {
    let key =
        |method: &'a MethodReport| (&method.backend, &method.adapter, &method.draw, &method.transparency);
    let mut groups: Vec<Group<'a>> = Vec::new();
    for (index, method) in report.methods.iter().enumerate() {
        if let Some(group) = groups.iter_mut().find(|group| key(group.methods[0].1) == key(method)) {
            group.methods.push((index, method));
            continue;
        }
        let mut title = format!("On the {}", backend(&method.backend));
        if !method.adapter.is_empty() {
            let _ = write!(title, ": {}", method.adapter);
        }
        if names.draws {
            let _ = write!(title, ", drawn as {}", method.draw);
        }
        if names.transparencies {
            let _ = write!(title, ", transparency {}", method.transparency);
        }
        groups.push(Group { title, backend: backend(&method.backend), methods: vec![(index, method)] });
    }
    groups
}

/// The label of a backend.
pub(super) fn backend(id: &str) -> &'static str {
    match id {
        "cpu" => "CPU",
        "gpu" => "GPU",
        _ => "device",
    }
}
