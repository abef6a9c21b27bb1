//! Scattering of light by hair fibres.
