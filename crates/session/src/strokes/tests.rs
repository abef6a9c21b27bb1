//! Strokes on moving hair.
