//! Comparison with an earlier run, by multiples of the yardstick.

use std::io::Read as _;
use std::path::Path;

use lovelock_project::error::ProjectError;
use lovelock_render::HairDrawing;
use serde::Deserialize;

use super::comparison::{Comparison, SLOWER, SlowerStage};
use super::report::{BenchReport, SceneReport};
use super::yardstick::Yardstick;

/// The largest file that is read as a baseline, bytes. A run of all scenes has 0.1 MB.
const MAX_BYTES: u64 = 16 << 20;

/// An earlier run: the part of `lovelock bench --json` that is compared.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Baseline {
    machine: String,
    yardstick: Yardstick,
    scenes: Vec<EarlierScene>,
}

/// A scene of an earlier run, with what identifies it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
struct EarlierScene {
    scene: String,
    backend: String,
    shadow: String,
    /// Runs before clusters were drawn have none.
    #[serde(default = "strands")]
    draw: String,
    transparency: String,
    width: u32,
    height: u32,
    points: u64,
    stages: Vec<EarlierStage>,
}

#[derive(Clone, Debug, PartialEq, Deserialize)]
struct EarlierStage {
    name: String,
    multiple: Option<f64>,
}

/// What hair is drawn as where an earlier run does not say.
fn strands() -> String {
    HairDrawing::Strands.to_string()
}

impl Baseline {
    /// Reads the output of `lovelock bench --json`.
    ///
    /// # Errors
    /// The file cannot be read, or is not such an output; in one line that names the file.
    pub fn read(file: &Path) -> Result<Self, ProjectError> {
        let name = file.display();
        let refuse = |found: String| {
            ProjectError::input(
                file,
                format!("{name}: found {found}; must be the output of `lovelock bench --json`"),
            )
        };
        let read = |file: &Path| -> std::io::Result<Vec<u8>> {
            let mut bytes = Vec::new();
            std::fs::File::open(file)?.take(MAX_BYTES + 1).read_to_end(&mut bytes)?;
            Ok(bytes)
        };
        let bytes = read(file).map_err(|error| ProjectError::input(file, format!("{name}: {error}")))?;
        if bytes.len() as u64 > MAX_BYTES {
            return Err(refuse(format!("more than {} MiB", MAX_BYTES >> 20)));
        }
        let baseline: Self = serde_json::from_slice(&bytes).map_err(|error| refuse(error.to_string()))?;
        if !baseline.yardstick.is_usable() {
            return Err(refuse("a yardstick that is not positive".to_owned()));
        }
        let mut multiples =
            baseline.scenes.iter().flat_map(|scene| &scene.stages).filter_map(|stage| stage.multiple);
        match multiples.find(|multiple| !(multiple.is_finite() && *multiple >= 0.0)) {
            Some(wrong) => Err(refuse(format!("the multiple {wrong}"))),
            None => Ok(baseline),
        }
    }

    /// Whether the earlier run measured this scene.
    pub fn has_scene(&self, id: &str) -> bool {
        self.scenes.iter().any(|earlier| earlier.scene == id)
    }

    /// The ids of the earlier scenes, each once.
    pub fn scenes(&self) -> Vec<&str> {
        let mut ids: Vec<_> = self.scenes.iter().map(|earlier| earlier.scene.as_str()).collect();
        ids.dedup();
        ids
    }

    /// Sets the change of every stage that both runs have, and adds the comparison to the report.
    pub fn compare(&self, report: &mut BenchReport) {
        let (mut compared, mut new, mut slower) = (0, 0, Vec::new());
        for scene in &mut report.scenes {
            let earlier = self.scenes.iter().find(|earlier| earlier.is_of(scene));
            for stage in &mut scene.stages {
                let Some(now) = stage.multiple else { continue };
                let before = earlier
                    .and_then(|earlier| earlier.stages.iter().find(|other| other.name == stage.name))
                    .and_then(|other| other.multiple)
                    .filter(|before| *before > 0.0);
                let Some(before) = before else {
                    new += 1;
                    continue;
                };
                compared += 1;
                stage.change = Some(now / before);
                if now > SLOWER * before {
                    slower.push(SlowerStage {
                        scene: scene.scene.clone(),
                        backend: scene.backend.clone(),
                        stage: stage.name.clone(),
                        before,
                        now,
                    });
                }
            }
        }
        slower.sort_by(|a, b| (b.now / b.before).total_cmp(&(a.now / a.before)));
        report.comparison = Some(Comparison {
            machine: self.machine.clone(),
            yardstick: self.yardstick,
            compared,
            new,
            slower,
        });
    }
}

impl EarlierScene {
    fn is_of(&self, scene: &SceneReport) -> bool {
        let key = (&self.scene, &self.backend, &self.shadow, &self.draw, &self.transparency);
        key == (&scene.scene, &scene.backend, &scene.shadow, &scene.draw, &scene.transparency)
            && (self.width, self.height, self.points) == (scene.width, scene.height, scene.points)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::report::tests::report;

    fn baseline(multiple: f64) -> Baseline {
        let mut report = report();
        for stage in report.scenes.iter_mut().flat_map(|scene| &mut scene.stages) {
            stage.multiple = Some(multiple);
        }
        serde_json::from_value(serde_json::to_value(report).expect("plain data")).expect("its own output")
    }

    #[test]
    fn a_stage_is_marked_from_a_tenth_on() {
        for (now, marked) in [(90.0, 0), (100.0, 0), (109.9, 0), (110.1, 1), (300.0, 1)] {
            let mut report = report();
            report.scenes[0].stages[0].multiple = Some(now);
            report.scenes[1].stages[0].multiple = None;
            baseline(100.0).compare(&mut report);
            let comparison = report.comparison.as_ref().expect("a comparison");
            assert_eq!((comparison.compared, comparison.new), (1, 0));
            assert_eq!(comparison.slower.len(), marked, "{now}");
            assert_eq!(report.scenes[0].stages[0].change, Some(now / 100.0));
            let text = report.to_string();
            assert_eq!(text.contains("slower: smooth on cpu, draw: 100"), marked > 0, "{text}");
        }
    }

    #[test]
    fn earlier_runs_that_do_not_say_drew_strands() {
        let mut value = serde_json::to_value(report()).expect("plain data");
        value["scenes"][0].as_object_mut().expect("a scene").remove("draw");
        let earlier: Baseline = serde_json::from_value(value).expect("an earlier output");
        assert!(earlier.scenes[0].is_of(&report().scenes[0]));
    }

    #[test]
    fn only_the_same_scene_is_compared() {
        let earlier = baseline(100.0);
        let changes: [fn(&mut SceneReport); 6] = [
            |scene| scene.scene = "curly".to_owned(),
            |scene| scene.shadow = "exact".to_owned(),
            |scene| scene.draw = "clusters".to_owned(),
            |scene| scene.transparency = "exact".to_owned(),
            |scene| scene.width += 1,
            |scene| scene.points += 1,
        ];
        for change in changes {
            let mut report = report();
            report.scenes.truncate(1);
            report.scenes[0].stages[0].multiple = Some(1e6);
            change(&mut report.scenes[0]);
            earlier.compare(&mut report);
            let comparison = report.comparison.expect("a comparison");
            assert_eq!((comparison.compared, comparison.new, comparison.slower.len()), (0, 1, 0));
        }
    }

    #[test]
    fn other_files_are_refused_in_one_line_with_their_name() {
        let folder = tempfile::tempdir().expect("a folder");
        let whole = serde_json::to_string(&report()).expect("plain data");
        let cut = &whole[..whole.len() / 2];
        let negative = whole.replace("\"copy_gb_per_s\":10.0", "\"copy_gb_per_s\":-1.0");
        assert_ne!(negative, whole);
        for (contents, found) in [
            (cut, "EOF"),
            ("", "EOF"),
            ("scene,backend\n", "expected value"),
            ("{\"machine\": \"m\"}", "missing field `yardstick`"),
            ("{\"error\": {}}", "missing field"),
            (&negative, "not positive"),
        ] {
            let file = folder.path().join("before.json");
            std::fs::write(&file, contents).expect("written");
            let error = Baseline::read(&file).expect_err(found);
            let text = error.to_string();
            assert!(text.contains("before.json: found ") && text.contains(found), "{text}");
            assert!(text.contains("must be the output of `lovelock bench --json`"), "{text}");
            assert_eq!((text.lines().count(), error.exit_code()), (1, 2), "{text}");
        }
        let missing = Baseline::read(&folder.path().join("none.json")).expect_err("no such file");
        assert!(missing.to_string().contains("none.json") && missing.exit_code() == 2, "{missing}");
        let file = folder.path().join("before.json");
        std::fs::write(&file, &whole).expect("written");
        assert_eq!(Baseline::read(&file).expect("whole").scenes(), ["smooth"]);
    }
}
