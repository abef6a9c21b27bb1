//! The choice between GPU and CPU.

use std::fmt;
use std::str::FromStr;

use lovelock_base::settings::Choices;
use serde::{Deserialize, Serialize};

/// The device that renders.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Backend {
    /// The GPU; the CPU if there is no GPU or only a software adapter.
    #[default]
    Auto,
    /// An adapter of wgpu; a software adapter if there is no other.
    Gpu,
    /// The CPU, without a graphics driver.
    Cpu,
}

impl Backend {
    /// All backends, in the order of menus.
    pub const ALL: [Self; 3] = [Self::Auto, Self::Gpu, Self::Cpu];

    /// The stable name of the command line, of projects and of reports.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Gpu => "gpu",
            Self::Cpu => "cpu",
        }
    }

    /// The name in menus.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Auto => "Automatic",
            Self::Gpu => "Graphics card",
            Self::Cpu => "CPU",
        }
    }
}

impl Choices for Backend {
    const ALL: &'static [Self] = &Self::ALL;

    fn names(self) -> (&'static str, &'static str) {
        (self.id(), self.label())
    }
}

impl fmt::Display for Backend {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.id())
    }
}

/// An unknown name of a backend.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown backend `{found}`: must be auto, gpu or cpu")]
pub struct UnknownBackend {
    /// The name that was given.
    pub found: String,
}

impl FromStr for Backend {
    type Err = UnknownBackend;

    fn from_str(id: &str) -> Result<Self, Self::Err> {
        let found = Self::ALL.into_iter().find(|backend| backend.id() == id);
        found.ok_or_else(|| UnknownBackend { found: id.to_owned() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_read_back_and_others_are_refused() {
        for backend in Backend::ALL {
            assert_eq!(backend.id().parse(), Ok(backend));
        }
        let error = "metal".parse::<Backend>().unwrap_err().to_string();
        assert_eq!(error, "unknown backend `metal`: must be auto, gpu or cpu");
    }
}
