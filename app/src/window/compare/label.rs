//! What is said of a pane in a line.

use lovelock_studio::render::{ShadowMethod, ShadowSettings};
use lovelock_studio::{Contender, LiveError, LivePane};

/// The settings of the method that matter most.
pub(crate) fn detail(shadow: &ShadowSettings) -> String {
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

/// What a pane is beside its method.
pub(crate) fn rest(contender: &Contender) -> String {
    let mut parts = vec![detail(&contender.shadow)];
    parts.push(contender.transparency.id().to_owned());
    parts.push(contender.backend.id().to_owned());
    if contender.scale < 1.0 {
        parts.push(format!("{:.0} % of the pixels' edge", 100.0 * contender.scale));
    }
    parts.retain(|part| !part.is_empty());
    parts.join(" · ")
}

/// All of it in a line.
pub(crate) fn whole(contender: &Contender) -> String {
    format!("{} · {}", contender.shadow.method.label(), rest(contender))
}

/// Bytes as people read them.
pub(crate) fn bytes(bytes: u64) -> String {
    let kib = bytes as f64 / 1024.0;
    if kib < 1000.0 { format!("{kib:.0} KiB") } else { format!("{:.1} MiB", kib / 1024.0) }
}

/// An error of transmittance, short.
pub(crate) fn error(error: &LiveError) -> Option<String> {
    match error {
        LiveError::NotMeasured => None,
        LiveError::Reference => Some("the reference".to_owned()),
        LiveError::Measured { rmse, .. } => Some(format!("error {rmse:.4}")),
        LiveError::Refused(_) => Some("no reference".to_owned()),
    }
}

/// How old a pane is.
pub(crate) fn age(secs: f64) -> Option<String> {
    match secs {
        // A step of the simulation is no age.
        secs if secs < 0.025 => None,
        secs if secs < 0.95 => Some(format!("{:.0} ms old", 1e3 * secs)),
        secs => Some(format!("{secs:.1} s old")),
    }
}

/// What a pane costs and how right it is. `ms` is the median of its last pictures.
pub(crate) fn figures(pane: &LivePane, ms: f64, age_secs: f64) -> String {
    let mut parts = vec![format!("{ms:.1} ms"), bytes(pane.shadow_bytes)];
    parts.extend(error(&pane.error));
    parts.extend(pane.flip.map(|flip| format!("FLIP {flip:.4}")));
    parts.extend(age(age_secs));
    parts.join(" · ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_says_its_size_and_numbers_are_short() {
        for &method in ShadowMethod::ALL {
            let shadow = ShadowSettings { method, ..ShadowSettings::default() };
            assert_eq!(detail(&shadow).is_empty(), method == ShadowMethod::None, "{method}");
        }
        assert_eq!(
            (bytes(0), bytes(512 * 1024), bytes(10 << 20)),
            ("0 KiB".into(), "512 KiB".into(), "10.0 MiB".into())
        );
        assert_eq!(
            (age(0.0), age(0.12), age(2.0)),
            (None, Some("120 ms old".into()), Some("2.0 s old".into()))
        );
        assert_eq!(age(-1.0), None, "the timeline was set back");
    }
}
