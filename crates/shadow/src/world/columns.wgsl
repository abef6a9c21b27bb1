// The transmittance of all hair, at points behind it. A method's query defines `hair_transmittance`. Twin of columns.rs.

struct ColumnView {
    // The corner of the map: a point of the world, or a vector from the light.
    origin: vec3f,
    // Texels along each edge.
    size: u32,
    // The step from column to column, and from row to row.
    across: vec3f,
    // How far behind a light that stands somewhere the points are, metres; 0 for a directional light.
    far: f32,
    more: vec3f,
    // Where the light stands.
    position: vec3f,
}

@group(0) @binding(6) var<uniform> view: ColumnView;

fn column_count() -> u32 {
    return view.size;
}

fn behind_column(at: vec2u) -> f32 {
    // The border is lit.
    if (any(at == vec2u(0u)) || any(at + 1u == vec2u(view.size))) {
        return 1.0;
    }
    let place = vec2f(at) + 0.5;
    let p = view.origin + place.x * view.across + place.y * view.more;
    if (view.far > 0.0) {
        return hair_transmittance(view.position + view.far * normalize(p));
    }
    return hair_transmittance(p);
}
