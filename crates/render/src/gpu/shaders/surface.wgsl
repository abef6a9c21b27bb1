// The attributes of the body for each sample of a pixel. picture.wgsl shades only what is visible through hair.

struct Vertex {
    @location(0) position: vec4f,
    // Transmittance of hair toward four lights, 8 bits each.
    @location(1) hair: u32,
    @location(2) normal: vec3f,
    // Linear sRGB; w is 1 where hair grows.
    @location(3) color_scalp: vec4f,
}

struct Seen {
    @builtin(position) position: vec4f,
    // Inside the triangle, even if it covers only a corner of the pixel.
    @location(1) @interpolate(perspective, centroid) normal: vec3f,
    @location(2) @interpolate(perspective, centroid) color_scalp: vec4f,
    @location(3) @interpolate(perspective, centroid) hair: vec4f,
}

@vertex
fn surface(in: Vertex) -> Seen {
    var out: Seen;
    out.position = frame.clip_from_world * vec4f(in.position.xyz, 1.0);
    out.normal = in.normal;
    out.color_scalp = in.color_scalp;
    out.hair = unpack4x8unorm(in.hair);
    return out;
}

struct Sample {
    // Octahedral normal and four 8-bit transmittances, all in 16-bit components.
    @location(0) normal_hair: vec4u,
    @location(1) color_scalp: vec4f,
}

@fragment
fn sample_surface(in: Seen) -> Sample {
    let n = in.normal / max(abs(in.normal.x) + abs(in.normal.y) + abs(in.normal.z), 1e-9);
    let folded = (1.0 - abs(n.yx)) * select(vec2f(-1.0), vec2f(1.0), n.xy >= vec2f(0.0));
    let flat_normal = pack2x16snorm(select(folded, n.xy, n.z >= 0.0));
    let hair = pack4x8unorm(in.hair);
    return Sample(vec4u(flat_normal & 0xffffu, flat_normal >> 16u, hair & 0xffffu, hair >> 16u), in.color_scalp);
}
