//! For tests alone: image comparison, tiny scenes, a test device and negative controls.
