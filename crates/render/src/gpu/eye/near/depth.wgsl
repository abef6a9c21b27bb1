// The nearest strand in each pixel that covers enough of it. Twin of `Nearest` in cpu/layers.rs.

// Twin of `Layers::LEAST_COVER`.
const LEAST_COVER: f32 = 1.0 / 255.0;

fn take(pixel: u32, fragment: Fragment) {
    if (opacity_of(fragment) >= LEAST_COVER) {
        atomicMax(&map[pixel], bitcast<u32>(fragment.depth));
    }
}
