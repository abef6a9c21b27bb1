// The boundary sectors of clusters: twin of `Cell` and `ClusterHair::cell` in satf.

// For each cluster its macro-cluster and by how many ribs it is turned, then the boundary sectors of each macro-cluster.
@group(0) @binding(13) var<storage, read> cells: array<u32>;

// The boundary sector of a layer of a column at its lower section (0) or its upper one (1); of the layer's neighbour to the lower side
// for `side` 0, its own for 1, to the upper side for 2.
fn cell_of(column: u32, layer: u32, side: u32, section: u32) -> u32 {
    let around = clusters.around;
    let along = clusters.along;
    let all = column / along;
    let shape = cells[all / around];
    let rib = (all % around + side + around - 1u + shape % around) % around;
    let first = clusters.count + shape / around * (clusters.layers * around * (along + 1u));
    return cells[first + (layer * around + rib) * (along + 1u) + column % along + section];
}

fn strands_of(cell: u32) -> f32 {
    return unpack2x16float(cell).y;
}
