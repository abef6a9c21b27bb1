// What the samples of a body without materials have besides those of samples.wgsl: nothing.

struct More {
    none: u32,
}

fn more_at(pixel: vec2u, k: i32) -> More {
    return More(0u);
}

fn are_alike(a: More, b: More) -> bool {
    return true;
}

fn added(a: More, b: More) -> More {
    return a;
}

// What a group shows, at a position.
fn surface_of(group: Group, world: vec3f) -> Surface {
    return Surface(world, group.sum.normal, group.sum.color_scalp / group.count, group.sum.hair / group.count);
}
