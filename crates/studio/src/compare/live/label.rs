//! What is said of a pane in a line.

use lovelock_render::{Backend, ShadowMethod};

use super::{LiveError, LivePane};
use crate::{Adapter, Contender};

impl Contender {
    /// The settings of the method that matter most: the size of its map, and what it keeps along the light.
    pub fn size_label(&self) -> String {
        let shadow = &self.shadow;
        match shadow.method {
            ShadowMethod::None => String::new(),
            ShadowMethod::VoxelMap => format!("{}³", shadow.voxel_map.resolution),
            ShadowMethod::OpacityMaps => {
                format!("{}² × {}", shadow.opacity_maps.resolution, shadow.opacity_maps.slices)
            }
            ShadowMethod::DeepOpacityMaps => {
                format!("{}² × {}", shadow.deep_opacity_maps.resolution, shadow.deep_opacity_maps.layers)
            }
            ShadowMethod::DensityClustering => {
                format!("{}² × {}", shadow.density_clustering.resolution, shadow.density_clustering.clusters)
            }
            ShadowMethod::OccupancyMaps => {
                format!("{}² × {}", shadow.occupancy_maps.resolution, shadow.occupancy_maps.slices)
            }
            ShadowMethod::Exact => format!("{}²", shadow.exact.resolution),
        }
    }

    /// What it is beside its method, such as `128³ · sorted · CPU`.
    pub fn settings_label(&self) -> String {
        let mut parts = vec![
            self.take_name().unwrap_or_default(),
            self.size_label(),
            self.transparency.id().to_owned(),
            backend_label(self.backend).to_owned(),
        ];
        if self.scale < 1.0 {
            parts.push(format!("{:.0} % size", 100.0 * self.scale));
        }
        parts.retain(|part| !part.is_empty());
        parts.join(" · ")
    }

    /// The name of the take that it shows.
    pub fn take_name(&self) -> Option<String> {
        let file = self.take.as_ref()?;
        Some(format!("take {}", file.path.file_stem().unwrap_or_default().to_string_lossy()))
    }

    /// All of it, such as `Voxel map · 128³ · sorted · CPU`.
    pub fn label(&self) -> String {
        format!("{} · {}", self.shadow.method.label(), self.settings_label())
    }
}

impl Adapter {
    /// The short name of its backend beside a time: `CPU` or `GPU`.
    pub const fn backend_label(&self) -> &'static str {
        backend_label(self.backend)
    }
}

impl LivePane {
    /// [`Contender::settings_label`] with the backend that drew it in place of the one that was chosen.
    pub fn settings_label(&self) -> String {
        Contender { backend: self.adapter.backend, ..self.contender.clone() }.settings_label()
    }

    /// [`Contender::label`] with the backend that drew it in place of the one that was chosen.
    pub fn label(&self) -> String {
        Contender { backend: self.adapter.backend, ..self.contender.clone() }.label()
    }

    /// What it costs and how right it is, such as `12.3 ms CPU · 4.0 MiB · error 0.0210`. `ms` is the time to show.
    pub fn figures_label(&self, ms: f64) -> String {
        let backend = self.adapter.backend_label();
        let mut parts = vec![format!("{ms:.1} ms {backend}"), bytes_label(self.shadow_bytes)];
        match &self.error {
            LiveError::NotMeasured => {}
            LiveError::Reference => parts.push("the reference".to_owned()),
            LiveError::Measured { rmse, .. } => parts.push(format!("error {rmse:.4}")),
            LiveError::Refused(_) => parts.push("no reference".to_owned()),
        }
        parts.extend(self.flip.map(|flip| format!("FLIP {flip:.4}")));
        parts.join(" · ")
    }
}

/// The short name of a backend beside a time.
const fn backend_label(backend: Backend) -> &'static str {
    match backend {
        Backend::Auto => "auto",
        Backend::Gpu => "GPU",
        Backend::Cpu => "CPU",
    }
}

/// Bytes as people read them.
pub fn bytes_label(bytes: u64) -> String {
    let kib = bytes as f64 / 1024.0;
    if kib < 1000.0 { format!("{kib:.0} KiB") } else { format!("{:.1} MiB", kib / 1024.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_says_its_size_and_numbers_are_short() {
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
