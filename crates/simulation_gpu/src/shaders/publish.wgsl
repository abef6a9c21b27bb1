// The guides of a step in world space and in their order, for renderers on the same device. Twin of `Simulation::frame`.

// Twin of `Publish` in publish.rs.
struct Publish {
    // The place of the head, to which positions are relative.
    place: vec3f,
    slots: u32,
    points: u32,
    // Points of all guides.
    guide_points: u32,
}

@group(0) @binding(0) var<uniform> publish_of: Publish;
@group(0) @binding(1) var<storage, read> moved: array<f32>;
// The guide in each slot.
@group(0) @binding(2) var<storage, read> guide_in: array<u32>;
// All x, then all y, then all z.
@group(0) @binding(3) var<storage, read_write> guides: array<f32>;

const SLOTS = 16u;
const NO_GUIDE = 0xffffffffu;

/// One thread per point and slot.
@compute @workgroup_size(64)
fn publish(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let at = id.x + id.y * groups.x * 64u;
    if at >= publish_of.slots * publish_of.points {
        return;
    }
    // Numbers of points and slots alternate as in `place_of` of step.wgsl.
    let row = at / SLOTS;
    let lane = at % SLOTS;
    let guide = guide_in[row / publish_of.points * SLOTS + lane];
    if guide == NO_GUIDE {
        return;
    }
    let to = guide * publish_of.points + row % publish_of.points;
    let n = publish_of.guide_points;
    let source = row * (3u * SLOTS) + lane;
    guides[to] = moved[source] + publish_of.place.x;
    guides[n + to] = moved[source + SLOTS] + publish_of.place.y;
    guides[2u * n + to] = moved[source + 2u * SLOTS] + publish_of.place.z;
}
