// Every point receives all light.

// Whether points are projected before they are looked up.
override PROJECTED: bool = false;

fn hair_transmittance(world_position: vec3f) -> f32 {
    return 1.0;
}
