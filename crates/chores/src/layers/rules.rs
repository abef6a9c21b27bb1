//! The arrows of docs/architecture.md, and what breaks them.

use super::graph::Graph;
use super::modules::Circle;

/// Who may use whom, each crate by its name without `lovelock-`.
const ARROWS: [(&str, &[&str]); 30] = [
    (
        "app",
        &[
            "jobs",
            "study",
            "panes",
            "session",
            "project",
            "render",
            "satf",
            "brush",
            "style",
            "simulation",
            "motion",
            "groom",
            "record",
            "sound",
            "appearance",
            "metrics",
            "glyphs",
            "base",
        ],
    ),
    (
        "jobs",
        &[
            "study",
            "panes",
            "session",
            "project",
            "render",
            "shadow",
            "satf",
            "simulation",
            "motion",
            "groom",
            "record",
            "sound",
            "appearance",
            "metrics",
            "base",
        ],
    ),
    ("study", &["panes", "session", "project", "render", "shadow", "groom", "record", "metrics", "base"]),
    ("panes", &["session", "project", "render", "shadow", "groom", "metrics", "base"]),
    (
        "session",
        &[
            "project",
            "render",
            "brush",
            "style",
            "simulation-gpu",
            "simulation",
            "motion",
            "groom",
            "record",
            "appearance",
            "base",
        ],
    ),
    ("project", &["picture", "shadow", "style", "simulation", "motion", "groom", "record", "base"]),
    ("render", &["picture", "shadow", "satf", "gpu", "groom", "motion", "appearance", "base"]),
    ("picture", &["satf", "base"]),
    ("shadow", &["gpu", "groom", "base"]),
    ("satf", &["groom", "base"]),
    ("brush", &["style", "groom", "base"]),
    ("style", &["groom", "base"]),
    ("simulation-gpu", &["gpu", "simulation", "motion", "groom", "base"]),
    ("simulation", &["groom", "motion", "base"]),
    ("record", &["groom", "motion", "alembic", "gltf", "base"]),
    ("motion", &["gltf", "usd", "base"]),
    ("groom", &["appearance", "alembic", "gltf", "usd", "base"]),
    ("alembic", &[]),
    ("gltf", &["base"]),
    ("usd", &["base"]),
    ("sound", &["base"]),
    ("gpu", &["base"]),
    ("appearance", &["base"]),
    ("glyphs", &[]),
    ("metrics", &["glyphs", "base"]),
    ("base", &[]),
    ("testkit", &["metrics", "base"]),
    (
        "benchmarks",
        &[
            "jobs",
            "session",
            "project",
            "render",
            "shadow",
            "simulation",
            "motion",
            "groom",
            "record",
            "base",
        ],
    ),
    ("xtask", &[]),
    ("chores", &["xtask", "metrics", "gltf", "base"]),
];

/// Crates that any other may use for its tests.
const FOR_TESTS: &str = "testkit";

/// Crates that build and test without a graphics library, so that their tests stay quick on a small machine.
const WITHOUT_WGPU: [&str; 19] = [
    "alembic",
    "appearance",
    "base",
    "brush",
    "gltf",
    "glyphs",
    "groom",
    "motion",
    "picture",
    "satf",
    "simulation",
    "sound",
    "style",
    "record",
    "metrics",
    "usd",
    "testkit",
    "xtask",
    "chores",
];

/// Libraries that only some crates may name: how their packages' names start, and who may.
const LIBRARIES: [(&[&str], &[&str]); 3] = [
    (&["egui", "eframe", "epaint", "emath"], &["app"]),
    (&["clap"], &["app", "xtask", "chores"]),
    (&["wgpu", "naga"], &["gpu", "shadow", "render", "app"]),
];

/// One sentence for every arrow that may not be.
pub(crate) fn faults(graph: &Graph) -> Vec<String> {
    let mut faults = Vec::new();
    for member in &graph.members {
        let crate_name = short(member);
        let Some((_, allowed)) = ARROWS.iter().find(|(name, _)| *name == crate_name) else {
            faults.push(format!("{member}: the crate has no row in the table of arrows"));
            continue;
        };
        let all = graph.used_by(member).map(|used| (used, false));
        for (used, in_tests) in all.chain(graph.used_by_tests_of(member).map(|used| (used, true))) {
            let used_name = short(used);
            if graph.members.contains(used) {
                let fine = allowed.contains(&used_name) || in_tests && used_name == FOR_TESTS;
                if !fine && used != member {
                    let whom =
                        if allowed.is_empty() { "none of the others".into() } else { allowed.join(", ") };
                    faults.push(format!("{member} → {used}: {crate_name} may use {whom}"));
                }
                continue;
            }
            for (starts, users) in LIBRARIES {
                if starts.iter().any(|start| used.starts_with(start)) && !users.contains(&crate_name) {
                    faults.push(format!("{member} → {used}: only {} may use it", users.join(", ")));
                }
            }
        }
        if WITHOUT_WGPU.contains(&crate_name)
            && let Some(way) = graph.way(member, |name| name == "wgpu" || name == "wgpu-core")
        {
            faults.push(format!("{}: {crate_name} builds and tests without wgpu", way.join(" → ")));
        }
    }
    faults
}

/// Circles that stand, each with its crate, its modules and the reason.
const CIRCLES: [(&str, &[&str], &str); 7] = [
    ("gpu", &["device", "shader"], "a device compiles shaders, whose faults are device errors"),
    ("jobs", &["record::curves", "record::request"], "a request says which curves it exports"),
    (
        "panes",
        &["live::probes", "live::reference", "live::round"],
        "a round measures against the reference and the probes, which read the round's strands",
    ),
    ("project", &["tracks::curve", "tracks::section"], "a track evaluates the curve through its keys"),
    ("render", &["cpu", "layers"], "layers are an output of the CPU renderer, whose tone mapping they use"),
    (
        "shadow",
        &["area", "bounds", "cpu", "error", "gpu", "light", "methods", "perspective", "world"],
        "a method is a folder with its CPU and GPU parts, the registry of methods dispatches to them, and lights are projected, sampled over their areas, and followed in the world below all of them",
    ),
    (
        "study",
        &["batch::light_sweep", "batch::sequence", "batch::stability", "batch::swim", "batch::work"],
        "the work of a study hands itself to each measurement",
    ),
];

/// One sentence for every circle among the modules of a package that is not one of [`CIRCLES`].
pub(crate) fn circles(package: &str, circles: &[Circle]) -> Vec<String> {
    let crate_name = short(package);
    let stands = |circle: &Circle| {
        CIRCLES.iter().any(|(of, modules, _)| *of == crate_name && circle.modules.iter().eq(modules.iter()))
    };
    let circles = circles.iter().filter(|circle| !stands(circle));
    circles
        .map(|Circle { modules, arrows }| {
            format!("{package}: {} use each other: {}", modules.join(", "), arrows.join("; "))
        })
        .collect()
}

/// The crate's name in the architecture.
pub(super) fn short(package: &str) -> &str {
    match package {
        "lovelock" => "app",
        _ => package.strip_prefix("lovelock-").unwrap_or(package),
    }
}

#[cfg(test)]
mod tests {
    use super::{Graph, faults};

    /// A graph of `user → used` for what is built and `user ⇢ used` for tests.
    fn graph(arrows: &[&str]) -> Graph {
        let mut graph = Graph::default();
        for arrow in arrows {
            let (user, used, to) = if let Some((user, used)) = arrow.split_once(" → ") {
                (user, used, &mut graph.uses)
            } else {
                let (user, used) = arrow.split_once(" ⇢ ").unwrap();
                (user, used, &mut graph.tests_use)
            };
            to.entry(user.to_owned()).or_default().insert(used.to_owned());
            let own = [user, used].into_iter().filter(|name| name.starts_with("lovelock"));
            graph.members.extend(own.map(str::to_owned));
        }
        graph
    }

    const GOOD: [&str; 18] = [
        "lovelock → lovelock-jobs",
        "lovelock → lovelock-render",
        "lovelock → egui",
        "lovelock → clap",
        "lovelock-xtask → clap",
        "lovelock-jobs → lovelock-panes",
        "lovelock-panes → lovelock-session",
        "lovelock-session → lovelock-project",
        "lovelock-session → lovelock-simulation",
        "lovelock-render → lovelock-gpu",
        "lovelock-shadow → lovelock-groom",
        "lovelock-simulation → lovelock-motion",
        "lovelock-record → lovelock-groom",
        "lovelock-gpu → wgpu",
        "lovelock-groom → glam",
        "lovelock-groom ⇢ lovelock-testkit",
        "lovelock-testkit → lovelock-metrics",
        "lovelock-study → lovelock-metrics",
    ];

    #[test]
    fn the_arrows_of_the_architecture_are_fine() {
        assert_eq!(faults(&graph(&GOOD)), Vec::<String>::new());
    }

    fn wrong_user(arrow: &str) -> &str {
        arrow.split_once(' ').map_or(arrow, |(user, _)| user)
    }

    #[test]
    fn every_wrong_arrow_is_named() {
        for (wrong, word) in [
            ("lovelock → lovelock-gpu", "app may use jobs, study"),
            ("lovelock-project → lovelock-session", "project may use picture"),
            ("lovelock-session → lovelock-jobs", "session may use project"),
            ("lovelock-groom → lovelock-motion", "groom may use appearance, alembic, gltf, usd, base"),
            ("lovelock-record → lovelock-session", "record may use groom, motion, alembic, gltf, base"),
            ("lovelock-shadow → lovelock-motion", "shadow may use gpu, groom, base"),
            ("lovelock-groom → lovelock-testkit", "groom may use"),
            ("lovelock-render ⇢ lovelock-metrics", "render may use"),
            ("lovelock-base → lovelock-groom", "none of the others"),
            ("lovelock-groom ⇢ lovelock-simulation", "groom may use"),
            ("lovelock-panes → egui_plot", "only app"),
            ("lovelock-render ⇢ eframe", "only app"),
            ("lovelock-jobs → clap_builder", "only app, xtask, chores"),
            ("lovelock-simulation → wgpu-types", "only gpu"),
            ("lovelock-new → glam", "no row"),
        ] {
            let found = faults(&graph(&[&GOOD[..], &[wrong]].concat()));
            // A wrong arrow may also open a way to wgpu, which is a fault of its own.
            assert!(
                found.iter().any(|fault| fault.starts_with(wrong_user(wrong)) && fault.contains(word)),
                "{found:?}"
            );
        }
    }

    #[test]
    fn wgpu_is_found_behind_other_packages() {
        let hidden =
            ["lovelock-groom → some-viewer", "some-viewer → deeper", "deeper → some-viewer", "deeper → wgpu"];
        let found = faults(&graph(&[&GOOD[..], &hidden].concat()));
        // groom itself, and everyone above it who promises the same: simulation does not use it here, record does.
        assert_eq!(found.len(), 2, "{found:?}");
        assert!(found[0].starts_with("lovelock-groom → some-viewer → deeper → wgpu"), "{found:?}");
        assert!(found[1].starts_with("lovelock-record → lovelock-groom → "), "{found:?}");
        // The same package where wgpu is allowed is fine.
        let allowed = ["lovelock-render → some-viewer", "some-viewer → wgpu"];
        assert_eq!(faults(&graph(&[&GOOD[..], &allowed].concat())), Vec::<String>::new());
    }
}
