//! One picture: strands, shading, transparency, body, ground and tone mapping.
