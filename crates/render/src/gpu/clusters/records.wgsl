// Reading records of the database: twin of satf/src/lookup.rs and of satf/src/layout.rs.

const ANGLES: u32 = 16u;
const RECORD_BYTES: u32 = 64u;
const DEPTHS: u32 = 16u;
const FINEST_TEXELS: u32 = 32u;
const LAST_MIP: f32 = 5.0;

// One byte per value: `[sector][view][texel]` and `[sector][view][light][texel]`.
@group(0) @binding(1) var<storage, read> opacities: array<u32>;
@group(0) @binding(2) var<storage, read> reflectances: array<u32>;

// Whether the nearest records are read, as published.
override NEAREST: bool = false;

// Two neighbours on a circle, and where between them a position is.
struct Between { low: u32, high: u32, fraction: f32 }

fn around_circle(position: f32, count: u32) -> Between {
    let shifted = clamp(position + 1024.0 + select(0.0, 0.5, NEAREST), 0.0, 2048.0);
    let low = u32(shifted);
    let fraction = select(shifted - f32(low), 0.0, NEAREST);
    return Between(low & (count - 1u), (low + 1u) & (count - 1u), fraction);
}

// The texels of a record that are read: of two levels of detail.
struct Texels { fine: Between, coarse: Between, level: f32 }

// First texel of a level within a record.
fn first_of(level: u32) -> u32 {
    return RECORD_BYTES - (RECORD_BYTES >> level);
}

fn texels_at(u: f32, mip: f32) -> Texels {
    let fine_level = u32(mip);
    let coarse_level = min(fine_level + 1u, u32(LAST_MIP));
    let fine_count = FINEST_TEXELS >> fine_level;
    let coarse_count = FINEST_TEXELS >> coarse_level;
    var fine = around_circle(u * f32(fine_count) - 0.5, fine_count);
    var coarse = around_circle(u * f32(coarse_count) - 0.5, coarse_count);
    fine.low += first_of(fine_level);
    fine.high += first_of(fine_level);
    coarse.low += first_of(coarse_level);
    coarse.high += first_of(coarse_level);
    return Texels(fine, coarse, mip - f32(fine_level));
}

fn opacity_byte(record: u32, texel: u32) -> f32 {
    let at = record * RECORD_BYTES + texel;
    return f32((opacities[at >> 2u] >> ((at & 3u) * 8u)) & 255u);
}

fn reflectance_byte(record: u32, texel: u32) -> f32 {
    let at = record * RECORD_BYTES + texel;
    return f32((reflectances[at >> 2u] >> ((at & 3u) * 8u)) & 255u);
}

fn opacity_in(record: u32, texels: Texels) -> f32 {
    let fine = between(opacity_byte(record, texels.fine.low), opacity_byte(record, texels.fine.high), texels.fine.fraction);
    let coarse = between(opacity_byte(record, texels.coarse.low), opacity_byte(record, texels.coarse.high), texels.coarse.fraction);
    return between(fine, coarse, texels.level);
}

fn reflectance_in(record: u32, texels: Texels) -> f32 {
    let fine = between(reflectance_byte(record, texels.fine.low), reflectance_byte(record, texels.fine.high), texels.fine.fraction);
    let coarse = between(reflectance_byte(record, texels.coarse.low), reflectance_byte(record, texels.coarse.high), texels.coarse.fraction);
    return between(fine, coarse, texels.level);
}

// The reflectance toward the azimuth number `view`.
fn reflectance_toward(sector: u32, view: u32, light: Between, texels: Texels) -> f32 {
    let first = (sector * ANGLES + view) * ANGLES;
    return between(reflectance_in(first + light.low, texels), reflectance_in(first + light.high, texels), light.fraction);
}

// A sector and how it is read: the sector of the database, and -1 if it is mirrored.
struct Sector { index: u32, side: f32 }

fn sector_of(cell: u32) -> Sector {
    return Sector(cell & 0x7fffu, select(1.0, -1.0, (cell & 0x8000u) != 0u));
}

// The optical depth of the sectors in a bin.
fn depth_of_bin(sector: u32) -> f32 {
    return 0.02 * exp2(8.6438562 * f32(sector % DEPTHS) / f32(DEPTHS - 1u));
}

// Where a sector is read at `u` of its arc: mirrored sectors from the other end.
fn texels_of(sector: Sector, u: f32, mip: f32) -> Texels {
    return texels_at(select(u, 1.0 - u, sector.side < 0.0), mip);
}

fn azimuth_of(sector: Sector, angle: f32) -> Between {
    return around_circle(sector.side * angle * (f32(ANGLES) / TAU), ANGLES);
}

// The opacity as it is stored.
fn stored_opacity(sector: Sector, angle: f32, texels: Texels) -> f32 {
    let view = azimuth_of(sector, angle);
    let first = sector.index * ANGLES;
    return between(opacity_in(first + view.low, texels), opacity_in(first + view.high, texels), view.fraction) / 255.0;
}

// The reflectance as it is stored, for azimuths of the eye and of a light.
fn stored_reflectance(sector: Sector, angles: vec2f, texels: Texels) -> f32 {
    let view = azimuth_of(sector, angles.x);
    let light = azimuth_of(sector, angles.y);
    let reflected = between(
        reflectance_toward(sector.index, view.low, light, texels),
        reflectance_toward(sector.index, view.high, light, texels),
        view.fraction,
    );
    return reflected / 255.0;
}

// Opacity and reflectance as their means over all azimuths of view, for an eye that looks along the strands.
fn stored_any_view(sector: Sector, light_angle: f32, texels: Texels) -> vec2f {
    let light = azimuth_of(sector, light_angle);
    var sum = vec2f(0.0);
    for (var view = 0u; view < ANGLES; view++) {
        sum += vec2f(
            opacity_in(sector.index * ANGLES + view, texels),
            reflectance_toward(sector.index, view, light, texels),
        );
    }
    return sum / (255.0 * f32(ANGLES));
}

// The optical depth of an opacity that is stored in eight bits.
fn depth_of_opacity(opacity: f32) -> f32 {
    return -log(max(1.0 - opacity, 0.5 / 255.0));
}
