//! The entrants of a comparison: each method with each value of the sweeps, what hair is drawn as, transparency and backend.

use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_project::project::Contender;
use lovelock_render::{Backend, HairDrawing, ShadowMethod, ShadowSettings, Transparency};

use super::sweep;
use super::sweep::Sweep;
use crate::report::MethodReport;

/// Maximum number of entrants.
const MAX: usize = 512;

/// One entrant and its entry in the report.
#[derive(Clone, Debug)]
pub(super) struct Entrant {
    pub contender: Contender,
    pub report: MethodReport,
}

/// The entrants of `methods`, what hair is drawn as, and transparencies, in the order of the report. `backends` contains no
/// [`Backend::Auto`].
///
/// # Errors
/// If no method has a setting, a value is invalid, or there are too many entrants.
pub(super) fn entrants(
    project: &Project,
    (methods, draws, transparencies): (&[ShadowMethod], &[HairDrawing], &[Transparency]),
    backends: &[Backend],
    sweeps: &[Sweep],
) -> Result<Vec<Entrant>, ProjectError> {
    let methods = without_repetition(methods, ShadowMethod::ALL);
    let draws = without_repetition(draws, &[project.picture.draw]);
    let transparencies = without_repetition(transparencies, &[project.picture.transparency]);
    let looks: Vec<_> = draws
        .iter()
        .flat_map(|&draw| transparencies.iter().map(move |&transparency| (draw, transparency)))
        .collect();
    for sweep in sweeps {
        let has = |method: &ShadowMethod| sweep::has_setting(*method, &sweep.setting);
        if !methods.iter().any(has) {
            return Err(unknown_setting(sweep, &methods));
        }
    }
    let mut all = Vec::new();
    for &method in &methods {
        for (shadow, swept) in runs(&ShadowSettings { method, ..project.shadow }, sweeps)? {
            for &(draw, transparency) in &looks {
                for &backend in backends {
                    let contender = Contender { shadow, draw, transparency, backend, scale: 1.0, take: None };
                    let changes = swept.iter().map(|(setting, value)| format!("{setting}={value}"));
                    let mut name: Vec<String> = [method.id().to_owned()].into_iter().chain(changes).collect();
                    name.extend((draws.len() > 1).then(|| draw.to_string()));
                    name.extend((transparencies.len() > 1).then(|| transparency.to_string()));
                    name.extend((backends.len() > 1).then(|| backend.to_string()));
                    let report = MethodReport {
                        id: method.id().to_owned(),
                        label: method.label().to_owned(),
                        name: name.join(" "),
                        draw: draw.to_string(),
                        transparency: transparency.id().to_owned(),
                        backend: backend.id().to_owned(),
                        settings: sweep::values(&shadow, method),
                        sweep: swept.clone(),
                        ..MethodReport::default()
                    };
                    all.push(Entrant { contender, report });
                }
            }
        }
        if all.len() > MAX {
            return Err(ProjectError::option(format!(
                "more than {MAX} to compare at once: choose fewer methods, backends or values of a sweep"
            )));
        }
    }
    Ok(all)
}

/// A file name for an entrant: letters, digits, dots and dashes.
pub(super) fn file_name(name: &str) -> String {
    let plain = |letter: char| if letter.is_ascii_alphanumeric() || letter == '.' { letter } else { '-' };
    name.chars().map(plain).collect()
}

/// The requested values without repetition, or `otherwise` if there are none.
fn without_repetition<T: Copy + PartialEq>(asked: &[T], otherwise: &[T]) -> Vec<T> {
    let mut once = Vec::new();
    for &one in if asked.is_empty() { otherwise } else { asked } {
        if !once.contains(&one) {
            once.push(one);
        }
    }
    once
}

/// Settings of a method, and the names and values changed by sweeps.
type Run = (ShadowSettings, Vec<(String, String)>);

/// The runs of one method: every combination of the values of sweeps that apply to it.
fn runs(settings: &ShadowSettings, sweeps: &[Sweep]) -> Result<Vec<Run>, ProjectError> {
    let mut runs = vec![(*settings, Vec::new())];
    for sweep in sweeps {
        let mut next: Vec<Run> = Vec::new();
        for (settings, swept) in &runs {
            for value in &sweep.values {
                match sweep::with_value(settings, &sweep.setting, value)? {
                    Some(changed) if next.iter().all(|(known, _)| *known != changed) => {
                        let change = (sweep.setting.clone(), value.clone());
                        next.push((changed, swept.iter().cloned().chain([change]).collect()));
                    }
                    Some(_) => {}
                    None => {
                        next.push((*settings, swept.clone()));
                        break;
                    }
                }
            }
            if next.len() > MAX {
                break;
            }
        }
        runs = next;
    }
    Ok(runs)
}

fn unknown_setting(sweep: &Sweep, methods: &[ShadowMethod]) -> ProjectError {
    let settings = ShadowSettings::default();
    let of_methods = methods.iter().filter_map(|method| settings.of_method(*method));
    let mut known: Vec<&str> =
        of_methods.flat_map(lovelock_base::settings::AnySettings::infos).map(|info| info.name).collect();
    known.sort_unstable();
    known.dedup();
    let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
    ProjectError::option(format!(
        "--sweep {}: the compared methods have no such setting; must be one of {known}",
        sweep.setting
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(
        methods: &[ShadowMethod],
        backends: &[Backend],
        sweeps: &[&str],
    ) -> Result<Vec<Entrant>, ProjectError> {
        let sweeps: Vec<Sweep> = sweeps.iter().map(|text| text.parse().expect("a sweep")).collect();
        entrants(&Project::default(), (methods, &[], &[]), backends, &sweeps)
    }

    fn names(entrants: &[Entrant]) -> Vec<&str> {
        entrants.iter().map(|entrant| entrant.report.name.as_str()).collect()
    }

    #[test]
    fn names_say_what_differs() {
        let all = of(&[], &[Backend::Cpu], &[]).expect("entrants");
        let ids: Vec<_> = ShadowMethod::ALL.iter().map(|method| method.id()).collect();
        assert_eq!(names(&all), ids);
        let (none, maps) = (ShadowMethod::None, ShadowMethod::OccupancyMaps);
        let both = [Backend::Cpu, Backend::Gpu];
        let swept = of(&[none, maps, none], &both, &["slabs=4,8", "resolution=64,128"]).expect("entrants");
        assert_eq!(names(&swept)[..3], ["none cpu", "none gpu", "occupancy-maps slabs=4 resolution=64 cpu"]);
        assert_eq!(swept.len(), 2 + 8);
        assert_eq!(swept[9].contender.shadow.occupancy_maps.slabs, 8);
        assert_eq!(swept[9].contender.shadow.occupancy_maps.resolution, 128);
        assert_eq!(file_name(names(&swept)[2]), "occupancy-maps-slabs-4-resolution-64-cpu");
    }

    #[test]
    fn what_hair_is_drawn_as_multiplies_the_entrants() {
        let methods = [ShadowMethod::None, ShadowMethod::OccupancyMaps];
        let draws = [HairDrawing::Strands, HairDrawing::Clusters, HairDrawing::Strands];
        let project = Project::default();
        let all = entrants(&project, (&methods, &draws, &[]), &[Backend::Cpu], &[]).expect("entrants");
        let expected = ["none strands", "none clusters", "occupancy-maps strands", "occupancy-maps clusters"];
        assert_eq!(names(&all), expected);
        assert_eq!((all[1].contender.draw, all[1].report.draw.as_str()), (HairDrawing::Clusters, "clusters"));
        let one = entrants(&project, (&methods, &draws[1..2], &[]), &[Backend::Cpu], &[]).expect("entrants");
        assert_eq!(
            (names(&one), one[0].contender.draw),
            (vec!["none", "occupancy-maps"], HairDrawing::Clusters)
        );
    }

    #[test]
    fn a_setting_that_nobody_has_is_refused_with_those_that_there_are() {
        let error =
            of(&[ShadowMethod::OccupancyMaps], &[Backend::Cpu], &["layers=3"]).expect_err("no layers");
        assert!(error.to_string().contains("slabs") && error.exit_code() == 2, "{error}");
        assert!(of(&[ShadowMethod::None], &[Backend::Cpu], &["slabs=4"]).is_err());
    }

    #[test]
    fn sweeps_do_not_grow_without_bound() {
        let many = |name: &str, step: usize| {
            let values: Vec<String> = (0..60).map(|i| (64 + step * i).to_string()).collect();
            format!("{name}={}", values.join(","))
        };
        let sweeps = [many("resolution", 16), many("slices", 1)];
        let sweeps: Vec<&str> = sweeps.iter().map(String::as_str).collect();
        let error = of(&[ShadowMethod::OpacityMaps], &[Backend::Cpu], &sweeps).expect_err("too many");
        assert!(error.exit_code() == 2 && error.to_string().contains("more than 512"), "{error}");
        assert_eq!(
            of(&[ShadowMethod::VoxelMap], &[Backend::Cpu], &["resolution=64,64"]).map(|e| e.len()).ok(),
            Some(1)
        );
    }
}
