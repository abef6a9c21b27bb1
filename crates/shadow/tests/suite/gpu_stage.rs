//! Compares the memory of occupancy maps, the voxel map and the exact method on the GPU with their definitions.

use std::collections::HashMap;

use crate::gpu::{Built, device};
use crate::grooms::Groom;
use glam::Vec3;
use lovelock_shadow::methods::exact::ExactMap;
use lovelock_shadow::methods::occupancy_maps::OccupancyMaps;
use lovelock_shadow::methods::texels::TexelFrame;
use lovelock_shadow::voxel_map::{MapExtent, VoxelDeposit, VoxelMap};
use lovelock_shadow::{CpuShadow, ShadowInput, ShadowMethod, ShadowSettings};

/// Depths have a precision of 2^-20 of the range.
const DEPTH_STEP: f32 = 1.0 / 1_048_576.0;

/// Lights and strands that comparisons must find out: the second one a texel aside.
fn aside<'a>(input: &ShadowInput<'a>, texel_size: f32) -> ShadowInput<'a> {
    ShadowInput { anchor: input.anchor + texel_size * input.light.y, ..*input }
}

/// The words of occupancy maps of `slices` and `slabs` that differ from those of the definition.
fn wrong_occupancy(cpu: &OccupancyMaps, words: &[u32], (slices, slabs): (u32, u32)) -> usize {
    let resolution = cpu.frame().expect("it was built").resolution;
    let len = (3 + slices / 32 + slabs / 2) as usize;
    assert_eq!(words.len(), (resolution * resolution) as usize * len);
    let wrong = |(texel, record): (usize, &[u32])| {
        let (column, row) = (texel as u32 % resolution, texel as u32 / resolution);
        let Some(defined) = cpu.record(column, row) else {
            return record.iter().filter(|word| **word != 0).count();
        };
        let [near, far] = [0, 1].map(|at| f32::from_bits(defined[at]));
        let ends = usize::from((f32::from_bits(record[0]) - near).abs() > DEPTH_STEP)
            + usize::from((f32::from_bits(record[1]) - far).abs() > DEPTH_STEP);
        ends + defined[3..].iter().zip(&record[3..]).filter(|(a, b)| a != b).count()
    };
    words.chunks_exact(len).enumerate().map(wrong).sum()
}

#[test]
fn occupancy_bits_and_counts_are_the_same() {
    let Some(gpu) = device() else { return };
    let mut built = Built::empty(gpu, ShadowMethod::OccupancyMaps);
    for groom in Groom::for_both_backends() {
        for of in [(128, 8), (256, 4), (512, 16)] {
            let mut settings = ShadowSettings::default();
            (settings.occupancy_maps.slices, settings.occupancy_maps.slabs) = of;
            let mut cpu = OccupancyMaps::default();
            cpu.build(&groom.input(), &settings).expect("it fits");
            built.build(0, &groom.input(), &settings).expect("it fits");
            assert_eq!(wrong_occupancy(&cpu, &built.words(), of), 0, "{}, {of:?}", groom.name);
            // Control: moved by a texel.
            let texel_size = cpu.frame().expect("it was built").texel_size;
            built.build(0, &aside(&groom.input(), 0.5 * texel_size), &settings).expect("it fits");
            assert!(wrong_occupancy(&cpu, &built.words(), of) > 0, "{}, {of:?}", groom.name);
        }
    }
}

fn wrong_faces(cpu: &VoxelMap, words: &[u32]) -> usize {
    let n = cpu.lattice().expect("it was built").resolution;
    assert_eq!(words.len(), (n * n * n) as usize);
    let defined = |at: usize| {
        let at = at as u32;
        let [front, back] = cpu.faces([at / (n * n), at / n % n, at % n]).expect("within the window");
        u32::from(front) | u32::from(back) << 16
    };
    words.iter().enumerate().filter(|(at, word)| defined(*at) != **word).count()
}

#[test]
fn faces_of_voxels_are_the_same() {
    let Some(gpu) = device() else { return };
    let mut built = Built::empty(gpu, ShadowMethod::VoxelMap);
    for groom in Groom::for_both_backends() {
        for (resolution, deposit, extent, extinction_scale) in [
            (128, VoxelDeposit::Length, MapExtent::Fit, 0.15),
            (72, VoxelDeposit::PointCount, MapExtent::Paper, 0.15),
            (48, VoxelDeposit::Isotropic, MapExtent::Fit, 0.15),
            // Cells that wrap around.
            (32, VoxelDeposit::Length, MapExtent::Fit, 1e6),
        ] {
            let mut settings = ShadowSettings::default();
            let input = ShadowInput { extinction_scale, ..groom.input() };
            settings.voxel_map.resolution = resolution;
            settings.voxel_map.deposit = deposit;
            settings.voxel_map.extent = extent;
            let mut cpu = VoxelMap::default();
            cpu.build(&input, &settings).expect("it fits");
            built.build(0, &input, &settings).expect("it fits");
            assert_eq!(wrong_faces(&cpu, &built.words()), 0, "{}, {resolution}", groom.name);
            // Control: moved by a fraction of a cell.
            let cell_size = cpu.lattice().expect("it was built").cell_size;
            built.build(0, &aside(&input, 0.5 * cell_size), &settings).expect("it fits");
            assert!(wrong_faces(&cpu, &built.words()) > 0, "{}, {resolution}", groom.name);
        }
    }
}

/// Depths, as their bits, and running sums of weights of the fragments of each texel.
type Lists = HashMap<(u32, u32), Vec<(u32, u32)>>;

/// The fragments of strands, by plain code that advances from one texel centre to the next.
fn walk(frame: &TexelFrame, input: &ShadowInput) -> Lists {
    let highest = (frame.resolution - 1) as f32 * (1.0 - f32::EPSILON);
    let centres_below = |c: f32| (c - 0.5).ceil() as i32;
    let mut lists = Lists::new();
    for ends in input.strands.first_point.windows(2) {
        let points = (ends[0] as usize..ends[1] as usize)
            .map(|i| frame.texel_from_world(input.strands.point(i)))
            .map(|p| Vec3::new(p.x.clamp(1.0, highest), p.y.clamp(1.0, highest), p.z.clamp(0.0, 1.0)));
        for pair in points.collect::<Vec<_>>().windows(2) {
            let d = pair[1] - pair[0];
            let by_row = d.y.abs() > d.x.abs();
            let long = |p: Vec3| if by_row { p.y } else { p.x };
            let short = |p: Vec3| if by_row { p.x } else { p.y };
            let (low, high) =
                if long(pair[0]) <= long(pair[1]) { (pair[0], pair[1]) } else { (pair[1], pair[0]) };
            let per_texel = 1.0 / (long(high) - long(low));
            let length = (d.x * d.x + d.y * d.y).sqrt() * per_texel;
            for at in centres_below(long(low))..centres_below(long(high)) {
                let t = (at as f32 + 0.5 - long(low)) * per_texel;
                let aside = short(low) + t * (short(high) - short(low));
                let aside = (aside as i32).clamp(1, frame.resolution as i32 - 2) as u32;
                let depth = (low.z + t * (high.z - low.z)).clamp(0.0, 1.0);
                let texel = if by_row { (aside, at as u32) } else { (at as u32, aside) };
                lists.entry(texel).or_default().push((depth.to_bits(), (length * 1024.0 + 0.5) as u32));
            }
        }
    }
    for list in lists.values_mut() {
        list.sort_unstable();
        let mut sum = 0;
        for fragment in list {
            sum += fragment.1;
            fragment.1 = sum;
        }
    }
    lists
}

/// The lists in the words of a map.
fn lists_of(words: &[u32], resolution: u32) -> Lists {
    let (texels, list) = words.split_at(2 * (resolution * resolution) as usize);
    let items: Vec<_> = list.chunks_exact(2).skip(2).map(|item| (item[0], item[1])).collect();
    let mut lists = Lists::new();
    for (texel, ends) in texels.chunks_exact(2).enumerate() {
        if ends[0] != ends[1] {
            let at = (texel as u32 % resolution, texel as u32 / resolution);
            lists.insert(at, items[ends[0] as usize..ends[1] as usize].to_vec());
        }
    }
    lists
}

#[test]
fn sorted_fragments_and_their_sums_are_the_same() {
    let Some(gpu) = device() else { return };
    let mut built = Built::empty(gpu, ShadowMethod::Exact);
    for groom in Groom::for_both_backends() {
        let settings = ShadowSettings::default();
        let mut cpu = ExactMap::default();
        cpu.build(&groom.input(), &settings).expect("it fits");
        let frame = *cpu.frame().expect("it was built");
        let walked = walk(&frame, &groom.input());
        built.build(0, &groom.input(), &settings).expect("it fits");
        let found = lists_of(&built.words(), frame.resolution);
        assert!(found == walked, "{}", groom.name);
        assert_eq!(built.shadow.report(0).samples, cpu.report().samples);
        // The same as the definition, except that weights are integers: half of 1/1024 each.
        let unit = groom.extinction_scale * groom.width / frame.texel_size / 1024.0;
        let mut texels = 0;
        for row in 0..frame.resolution {
            for column in 0..frame.resolution {
                let fragments = cpu.fragments(column, row);
                let list = walked.get(&(column, row)).map_or(&[][..], Vec::as_slice);
                texels += usize::from(!list.is_empty());
                assert_eq!(fragments.len(), list.len());
                for (count, (fragment, (depth, sum))) in fragments.iter().zip(list).enumerate() {
                    assert_eq!(fragment.depth().to_bits(), *depth);
                    let error = fragment.optical_depth() / unit - *sum as f32;
                    assert!(error.abs() < 0.51 * (count + 1) as f32 + 1e-6 * *sum as f32, "{error} of {sum}");
                }
            }
        }
        assert_eq!(texels, walked.len());
        // Control: moved by a fraction of a texel.
        let aside = aside(&groom.input(), 0.5 * frame.texel_size);
        built.build(0, &aside, &settings).expect("it fits");
        assert!(lists_of(&built.words(), frame.resolution) != walked, "{}", groom.name);
    }
}
