//! The table and the figures.

use super::figures::{Figures, mean, noise};
use super::images::LinearImage;
use super::scenes::{Scene, Scenes};
use serde::Serialize;
use serde_json::Value;
use std::fmt::Write;

/// Everything that was measured.
#[derive(Debug, Serialize)]
pub(super) struct Report {
    /// Pixels.
    size: [u32; 2],
    /// Paths per pixel of the path tracer.
    samples: u32,
    /// Stops by which both images were brightened before they were compared.
    exposure_stops: f32,
    /// Settings of all our images.
    settings: Vec<String>,
    /// Our ways of shading, in the order of the lists below.
    variants: Vec<VariantEntry>,
    /// What the path tracer told: its version, the furnace, and times of images that were not there yet.
    path_tracer: Value,
    scenes: Vec<SceneEntry>,
}

#[derive(Debug, Serialize)]
struct VariantEntry {
    name: String,
    settings: Vec<String>,
}

#[derive(Debug, Serialize)]
struct SceneEntry {
    name: String,
    strands: u64,
    /// Mean of FLIP between two halves of the path tracer's samples: what noise alone amounts to.
    flip_noise: f64,
    /// For each variant.
    figures: Vec<Figures>,
}

impl Report {
    pub(super) fn new(
        arguments: &super::Arguments,
        samples: u32,
        variants: &[super::Variant],
        scenes: &Scenes,
        path_tracer: Value,
    ) -> Self {
        let entry = |variant: &super::Variant| VariantEntry {
            name: variant.name.clone(),
            settings: variant.settings.clone(),
        };
        Self {
            size: [scenes.width, scenes.height],
            samples,
            exposure_stops: arguments.exposure,
            settings: arguments.set.clone(),
            variants: variants.iter().map(entry).collect(),
            path_tracer,
            scenes: Vec::new(),
        }
    }

    /// Compares the images of the variants with the mean of two halves of the reference.
    pub(super) fn add(
        &mut self,
        scene: &Scene,
        images: &[LinearImage],
        reference: &LinearImage,
        [a, b]: [&LinearImage; 2],
    ) -> anyhow::Result<()> {
        let toward_light = scene.toward_light();
        let figures = images.iter().map(|image| Figures::of(image, reference, toward_light));
        self.scenes.push(SceneEntry {
            name: scene.name.clone(),
            strands: scene.strands,
            flip_noise: noise(a, b)?,
            figures: figures.collect::<anyhow::Result<_>>()?,
        });
        Ok(())
    }

    /// A table in Markdown: a row per scene and their means, and for each variant FLIP, FLIP at the brightness of the reference, ratios
    /// of luminance and the correlation of rows.
    pub(super) fn markdown(&self) -> String {
        let mut text = String::from("| scene | noise |");
        for variant in &self.variants {
            let name = &variant.name;
            // Writing to a string does not fail.
            let _ = write!(text, " {name}: FLIP | equally bright | hair | lit | shadow | rows |");
        }
        let _ = writeln!(text, "\n|---|---|{}", "---|".repeat(6 * self.variants.len()));
        for scene in &self.scenes {
            let _ = write!(text, "| {} | {:.3} |", scene.name, scene.flip_noise);
            for of in &scene.figures {
                row(
                    &mut text,
                    of.flip,
                    of.flip_equally_bright,
                    [of.hair, of.lit, of.shadow].map(|b| b.ratio),
                    of.row_correlation,
                );
            }
            text.push('\n');
        }
        let _ = write!(text, "| **mean** | {:.3} |", mean(self.scenes.iter().map(|scene| scene.flip_noise)));
        for i in 0..self.variants.len() {
            let all = || self.scenes.iter().filter_map(|scene| scene.figures.get(i));
            let known = |of: fn(&Figures) -> Option<f64>| {
                let values: Vec<f64> = all().filter_map(of).collect();
                (!values.is_empty()).then(|| mean(values.into_iter()))
            };
            // Ratios are averaged as factors: half and double are 1.
            let factor = |of: fn(&Figures) -> Option<f64>| {
                let values: Vec<f64> =
                    all().filter_map(of).filter(|ratio| *ratio > 0.0).map(f64::ln).collect();
                (!values.is_empty()).then(|| mean(values.into_iter()).exp())
            };
            let ratios =
                [factor(|of| of.hair.ratio), factor(|of| of.lit.ratio), factor(|of| of.shadow.ratio)];
            let flip = mean(all().map(|of| of.flip));
            row(
                &mut text,
                flip,
                mean(all().map(|of| of.flip_equally_bright)),
                ratios,
                known(|of| of.row_correlation),
            );
        }
        text.push('\n');
        text
    }
}

/// The columns of a variant.
fn row(text: &mut String, flip: f64, equally_bright: f64, ratios: [Option<f64>; 3], rows: Option<f64>) {
    let _ = write!(text, " {flip:.3} | {equally_bright:.3} |");
    for ratio in ratios.into_iter().chain([rows]) {
        let _ = match ratio {
            Some(ratio) if ratio.abs() >= 9.995 => write!(text, " {ratio:.1} |"),
            Some(ratio) => write!(text, " {ratio:.2} |"),
            None => write!(text, " – |"),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::super::scenes::tests::scene;
    use super::*;

    #[test]
    fn a_table_has_a_row_per_scene_and_their_mean() {
        let image =
            |light: f32| LinearImage { width: 12, height: 12, pixels: vec![[light, light, light, 1.0]; 144] };
        let mut report = Report {
            size: [12, 12],
            samples: 2,
            exposure_stops: 0.0,
            settings: Vec::new(),
            variants: ["old", "new"]
                .map(|name| VariantEntry { name: name.to_owned(), settings: Vec::new() })
                .into(),
            path_tracer: Value::Null,
            scenes: Vec::new(),
        };
        for (name, light) in [("a", 0.2), ("b", 0.05)] {
            let scene: Scene = serde_json::from_value(scene(name)).expect("a scene");
            let theirs = image(0.1);
            report.add(&scene, &[image(light), image(0.1)], &theirs, [&theirs, &theirs]).expect("figures");
        }
        let text = report.markdown();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 5, "{text}");
        let cells = |line: &str| line.matches('|').count();
        assert!(lines.iter().all(|line| cells(line) == cells(lines[0])), "{text}");
        // Twice as bright and half as bright; at the same brightness nothing is left.
        assert!(
            lines[2].starts_with("| a | 0.000 |") && lines[2].contains("| 0.000 | 2.00 | 2.00 | 2.00 | – |"),
            "{text}"
        );
        assert!(lines[3].contains("| 0.50 | 0.50 | 0.50 |"), "{text}");
        assert!(lines[4].contains("| 1.00 | 1.00 | 1.00 |"), "{text}");
        assert!(lines[2].ends_with("| 0.000 | 0.000 | 1.00 | 1.00 | 1.00 | – |"), "{text}");
    }
}
