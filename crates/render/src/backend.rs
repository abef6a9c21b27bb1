//! What draws.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// What draws a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Backend {
    /// The graphics card, and the processor where there is none or where the adapter is itself software.
    #[default]
    Auto,
    /// A graphics adapter by wgpu, a software one where there is nothing else.
    Gpu,
    /// The processor alone, without any driver.
    Cpu,
}

impl Backend {
    /// All of them, in the order of menus.
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
            Self::Cpu => "Processor",
        }
    }
}

impl fmt::Display for Backend {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.id())
    }
}

/// A name that is no backend's.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown backend `{found}`: expected auto, gpu or cpu")]
pub struct UnknownBackend {
    /// The name that was asked for.
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
        assert_eq!(error, "unknown backend `metal`: expected auto, gpu or cpu");
    }
}
