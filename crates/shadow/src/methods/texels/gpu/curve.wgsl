// Curves of transmittance over depth. The map starts with two words per texel: where the list of its fragments starts and ends, and
// once its curve is made the count of nodes and 0. Behind those of all texels are the curves: depths, then transmittances.
// Twin of curve.rs.

// Nodes of a curve.
override NODES: u32 = 8u;

const MAX_NODES: u32 = 32u;
// The most steps from which a curve is made.
const MAX_STEPS: u32 = 512u;

fn curve_of(texel: u32) -> u32 {
    return 2u * texels.count + texel * 2u * NODES;
}
