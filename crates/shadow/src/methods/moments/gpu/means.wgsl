// The functions of depth whose means a record holds, and the moments that follow from them. Twin of means.rs.

// The angle of z = 1, in turns.
const LAST_TURN: f32 = 0.45;
// The cosine of half of the angle at which the wrapping zone begins.
const WRAPPING: f32 = 0.15643446;
// The largest integer of 16 bits.
const MOST: f32 = 65535.0;

fn to_short(mean: f32) -> u32 {
    return u32(clamp(mean * 0.5 + 0.5, 0.0, 1.0) * MOST + 0.5);
}

fn from_short(bits: u32) -> f32 {
    return f32(bits) * (2.0 / MOST) - 1.0;
}

// The power moment of even hair with this number, an even one.
fn even_moment(number: u32) -> f32 {
    switch 16u * ORDER + number {
        case 0x22u, 0x24u: { return 0.375; }
        case 0x32u: { return 0.48; }
        case 0x34u: { return 0.451; }
        case 0x36u: { return 0.45; }
        case 0x42u: { return 0.75; }
        case 0x44u: { return 0.6766667; }
        case 0x46u: { return 0.63; }
        case 0x48u: { return 0.600303; }
        default: { return 0.0; }
    }
}

// Sine and cosine of half of the angle of `z`.
fn half_turn(z: f32) -> vec2f {
    return turn(z * (0.5 * LAST_TURN)).yx;
}

// The means of the powers of z, with a share of even hair.
fn power_moments(means: array<f32, 8>) -> array<f32, 9> {
    var row: array<f32, 9>;
    row[0] = 1.0;
    for (var k = 0u; k < 2u * ORDER; k++) {
        row[k + 1u] = means[k];
    }
    var moments: array<f32, 9>;
    moments[0] = 1.0;
    for (var j = 1u; j <= 2u * ORDER; j++) {
        var before = row[1];
        for (var k = 0u; k <= 2u * ORDER - j; k++) {
            let value = 0.5 * (row[k + 1u] + before);
            before = row[k];
            row[k] = value;
        }
        moments[j] = row[0] + (even_moment(j) - row[0]) * texels.bias;
    }
    return moments;
}

// The means of powers of sine and cosine of half of the angle, with a share of hair that is even on the circle.
fn turned_moments(means: array<f32, 8>) -> array<f32, 9> {
    let rest = 1.0 - texels.bias;
    var cosines: array<f32, 6>;
    var sines: array<f32, 6>;
    cosines[0] = 1.0;
    for (var k = 0u; k < ORDER; k++) {
        cosines[k + 1u] = means[2u * k] * rest;
        sines[k + 1u] = means[2u * k + 1u] * rest;
    }
    var even: array<f32, 5>;
    var odd: array<f32, 5>;
    even[0] = 1.0;
    for (var j = 0u; j < ORDER; j++) {
        odd[j] = 0.5 * sines[1];
        var before = vec2f(cosines[1], 0.0);
        for (var k = 0u; k < ORDER - j; k++) {
            let cosine = 0.5 * cosines[k] + 0.25 * (cosines[k + 1u] + before.x);
            let sine = 0.5 * sines[k] + 0.25 * (sines[k + 1u] + before.y);
            before = vec2f(cosines[k], sines[k]);
            cosines[k] = cosine;
            sines[k] = select(sine, 0.0, k == 0u);
        }
        even[j + 1u] = cosines[0];
    }
    var moments: array<f32, 9>;
    for (var j = 0u; j < ORDER; j++) {
        moments[2u * j] = even[ORDER - j];
        moments[2u * j + 1u] = odd[ORDER - 1u - j];
        for (var i = 0u; i < ORDER - j; i++) {
            even[i] -= even[i + 1u];
            odd[i] -= odd[i + 1u];
        }
    }
    moments[2u * ORDER] = even[0];
    return moments;
}
