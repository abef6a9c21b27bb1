//! Hairstyles: scalp, wisps, guides, strands; growing, styling, interpolation and hair files.
