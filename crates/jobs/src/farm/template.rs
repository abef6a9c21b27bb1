//! The job itself: <https://github.com/OpenJobDescription/openjd-specifications>, `jobtemplate-2023-09`.

use std::ops::Range;
use std::path::PathBuf;

use serde_json::{Value, json};

use super::TAKE;

/// The source of the frames.
pub(super) enum Source {
    /// The project in the folder, simulated once.
    Project,
    /// An existing take, with the size of its images.
    Take(PathBuf, [u32; 2]),
}

pub(super) struct Template {
    pub(super) name: String,
    pub(super) source: Source,
    pub(super) frames: Range<u64>,
    pub(super) fps: f64,
    pub(super) chunk: u64,
    /// The first simulated frame, because a shutter may open before the first rendered one.
    pub(super) simulated_from: u64,
}

impl Template {
    pub(super) fn steps(&self) -> Vec<&'static str> {
        match self.source {
            Source::Project => vec!["Simulate", "Draw", "Assemble"],
            Source::Take(..) => vec!["Draw", "Assemble"],
        }
    }

    /// Frame ranges in command-line syntax, one per task.
    fn ranges(&self) -> Vec<String> {
        let Range { start, end } = self.frames;
        let starts = (start..end).step_by(self.chunk as usize);
        starts.map(|first| format!("{first}..{}", (first + self.chunk).min(end))).collect()
    }

    pub(super) fn json(&self) -> Value {
        // Job names have at most 128 characters and no control characters.
        let name: String = self.name.chars().filter(|letter| !letter.is_control()).take(100).collect();
        // Double braces would be read as a substitution.
        let name = name.replace("{{", "(").replace("}}", ")");
        let mut parameters = vec![
            json!({
                "name": "Folder",
                "type": "PATH",
                "objectType": "DIRECTORY",
                "dataFlow": "INOUT",
                "default": ".",
                "description": "The folder of this job, at a path that every machine can reach; images go into its folder frames.",
            }),
            json!({
                "name": "Lovelock",
                "type": "STRING",
                "default": "lovelock",
                "description": "The program: a name on the search path, or its path on the rendering machines.",
            }),
            json!({
                "name": "Backend",
                "type": "STRING",
                "default": "cpu",
                "allowedValues": ["cpu", "gpu", "auto"],
                "description": "The rendering backend. The CPU renders the same bytes on every machine.",
            }),
        ];
        let take = match &self.source {
            Source::Project => format!("{{{{Param.Folder}}}}/{TAKE}"),
            Source::Take(path, _) => {
                parameters.push(json!({
                    "name": "Take",
                    "type": "PATH",
                    "objectType": "FILE",
                    "dataFlow": "IN",
                    "default": path.to_string_lossy(),
                    "description": "The take to render. The files that it was made from must be at the paths that it names.",
                }));
                "{{Param.Take}}".to_owned()
            }
        };
        let Range { start, end } = self.frames;
        let fps = self.fps.to_string();
        let simulate = json!({
            "name": "Simulate",
            "description": "Simulates the frames once, after the pre-roll, into a take.",
            "script": run(&[
                "record", "{{Param.Folder}}/project.lovelock", "-o", &take,
                "--frames", &format!("{}..{end}", self.simulated_from), "--fps", &fps,
                // A task that a farm runs again replaces what it left.
                "--force",
            ]),
        });
        let frames = "{{Param.Folder}}/parts/{{Task.Param.Frames}}/";
        let mut drawing = vec!["record", &take, "-o", frames, "--frames", "{{Task.Param.Frames}}"];
        drawing.extend(["--fps", &fps, "--backend", "{{Param.Backend}}"]);
        if matches!(self.source, Source::Project) {
            // The take starts at the job's first frame.
            drawing.push("--dance-time");
        }
        // A project contains its size.
        let size = match &self.source {
            Source::Project => None,
            Source::Take(_, [width, height]) => Some(format!("{width}x{height}")),
        };
        drawing.extend(size.iter().flat_map(|size| ["--size", size]));
        let mut draw = json!({
            "name": "Draw",
            "description": "Renders ranges of frames, in any order and on any number of machines.",
            "parameterSpace": {
                "taskParameterDefinitions": [{ "name": "Frames", "type": "STRING", "range": self.ranges() }],
            },
            "script": run(&drawing),
        });
        let assemble = json!({
            "name": "Assemble",
            "description": "Joins the parts into one sequence with its manifest.",
            "dependencies": [{ "dependsOn": "Draw" }],
            "script": run(&[
                "assemble", "{{Param.Folder}}/parts", "-o", "{{Param.Folder}}/frames",
                "--frames", &format!("{start}..{end}"),
            ]),
        });
        let mut steps = Vec::new();
        if matches!(self.source, Source::Project) {
            draw["dependencies"] = json!([{ "dependsOn": "Simulate" }]);
            steps.push(simulate);
        }
        steps.extend([draw, assemble]);
        json!({
            "specificationVersion": "jobtemplate-2023-09",
            "name": format!("Lovelock {name}"),
            "description": format!("Frames {start}..{end} at {fps} per second, {} per task.", self.chunk),
            "parameterDefinitions": parameters,
            "steps": steps,
        })
    }
}

fn run(arguments: &[&str]) -> Value {
    json!({ "actions": { "onRun": { "command": "{{Param.Lovelock}}", "args": arguments } } })
}
