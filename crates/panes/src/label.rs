//! Labels of panes.

use std::fmt::Write as _;

use lovelock_project::project::Contender;

use crate::request::{LiveError, LivePane};

impl LivePane {
    /// [`Contender::settings_label`] with the backend that rendered the pane instead of the chosen one.
    pub fn settings_label(&self) -> String {
        Contender { backend: self.adapter.backend, ..self.contender.clone() }.settings_label()
    }

    /// [`Contender::label`] with the backend that rendered the pane instead of the chosen one.
    pub fn label(&self) -> String {
        Contender { backend: self.adapter.backend, ..self.contender.clone() }.label()
    }

    /// Cost and error, such as `12.3 ms CPU · 4.0 MiB · error 0.0210`. `ms` is the time to show.
    pub fn figures_label(&self, ms: f64) -> String {
        let backend = self.adapter.backend_label();
        let mut parts = vec![format!("{ms:.1} ms {backend}"), bytes_label(self.shadow_bytes)];
        parts.extend(self.error_label());
        parts.extend(self.flip.map(|flip| format!("FLIP {flip:.4}")));
        parts.join(" · ")
    }

    /// The error, such as `error 0.0210`; `None` if none was measured yet.
    pub fn error_label(&self) -> Option<String> {
        match &self.error {
            LiveError::NotMeasured => None,
            LiveError::Reference => Some("the reference".to_owned()),
            LiveError::Measured { rmse, .. } => Some(format!("error {rmse:.4}")),
            LiveError::Refused(_) => Some("no reference".to_owned()),
        }
    }

    /// What the numbers of [`LivePane::figures_label`] are, a paragraph each.
    pub fn figures_text(&self) -> String {
        let mut text = "Time: the median of the last images, with the shadow maps. Maps reused while nothing moves count \
                        with the time of their last build.\n\nMemory: the shadow maps of all lights."
            .to_owned();
        match &self.error {
            LiveError::NotMeasured => {}
            LiveError::Reference => text.push_str(
                "\n\nThe reference: errors of the other panes are differences from its transmittance.",
            ),
            LiveError::Measured { bias, p99, .. } => {
                let side = if *bias > 0.0 { "too bright" } else { "too dark" };
                let _ = write!(
                    text,
                    "\n\nError: root mean square difference of transmittance from Exact with the project's settings, for \
                     the first light that is on, over all points of strands, including those hidden from the camera. 0 is \
                     no error, 1 is full light against none. Mean {bias:+.4} ({side}), 99 of 100 points below {p99:.3}."
                );
            }
            LiveError::Refused(why) => {
                let _ = write!(text, "\n\nNo error: {why}");
            }
        }
        if self.flip.is_some() {
            text.push_str(
                "\n\nFLIP: mean perceived difference of the image from one that the same backend draws with exact shadows and transparency.",
            );
        }
        text
    }
}

/// Formats bytes for people.
pub fn bytes_label(bytes: u64) -> String {
    let kib = bytes as f64 / 1024.0;
    if kib < 1000.0 { format!("{kib:.0} KiB") } else { format!("{:.1} MiB", kib / 1024.0) }
}

#[cfg(test)]
mod tests {
    use lovelock_render::ShadowMethod;

    use super::*;

    #[test]
    fn every_method_has_a_size_label_and_numbers_are_short() {
        let mut contender = Contender::default();
        for &method in ShadowMethod::ALL {
            contender.shadow.method = method;
            assert_eq!(contender.size_label().is_empty(), method == ShadowMethod::None, "{method}");
        }
        contender.scale = 0.5;
        assert_eq!(contender.label(), "Exact · 512² · sorted · auto · 50 % size");
        let said = [0, 512 * 1024, 10 << 20].map(bytes_label);
        assert_eq!(said, ["0 KiB", "512 KiB", "10.0 MiB"]);
    }
}
