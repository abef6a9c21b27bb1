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
    let t = means;
    var moments: array<f32, 9>;
    moments[0] = 1.0;
    moments[1] = t[0];
    moments[2] = 0.5 + 0.5 * t[1];
    moments[3] = 0.75 * t[0] + 0.25 * t[2];
    moments[4] = 0.375 + 0.5 * t[1] + 0.125 * t[3];
    moments[5] = (10.0 * t[0] + 5.0 * t[2] + t[4]) * (1.0 / 16.0);
    moments[6] = (10.0 + 15.0 * t[1] + 6.0 * t[3] + t[5]) * (1.0 / 32.0);
    moments[7] = (35.0 * t[0] + 21.0 * t[2] + 7.0 * t[4] + t[6]) * (1.0 / 64.0);
    moments[8] = (35.0 + 56.0 * t[1] + 28.0 * t[3] + 8.0 * t[5] + t[7]) * (1.0 / 128.0);
    for (var k = 1u; k <= 2u * ORDER; k++) {
        moments[k] += (even_moment(k) - moments[k]) * texels.bias;
    }
    return moments;
}

// The mean products of the functions of `half_waves`, five numbers a row, with a share of hair that is even on the circle.
fn products_of(means: array<f32, 8>) -> array<f32, 25> {
    let rest = 1.0 - texels.bias;
    var cosines: array<f32, 5>;
    var sines: array<f32, 5>;
    cosines[0] = 1.0;
    for (var k = 0u; k < ORDER; k++) {
        cosines[k + 1u] = means[2u * k] * rest;
        sines[k + 1u] = means[2u * k + 1u] * rest;
    }
    var products: array<f32, 25>;
    for (var row = 0u; row <= ORDER; row++) {
        for (var column = 0u; column <= row; column++) {
            let difference = row / 2u - column / 2u;
            let sum = ORDER - row / 2u - column / 2u;
            var entry: f32;
            switch 2u * (row & 1u) + (column & 1u) {
                case 0u: { entry = cosines[sum] + cosines[difference]; }
                case 3u: { entry = cosines[difference] - cosines[sum]; }
                case 1u: { entry = sines[sum] + sines[difference]; }
                default: { entry = sines[sum] - sines[difference]; }
            }
            products[5u * row + column] = 0.5 * entry;
        }
    }
    return products;
}

// Cosine and sine of ORDER, ORDER − 2, … times half of an angle with this sine and cosine; the last is 1 if ORDER is even.
fn half_waves(place: vec2f) -> array<f32, 5> {
    let one = place.yx;
    let two = turn_on(one, one);
    if (ORDER == 2u) {
        return array(two.x, two.y, 1.0, 0.0, 0.0);
    }
    if (ORDER == 3u) {
        let three = turn_on(two, one);
        return array(three.x, three.y, one.x, one.y, 0.0);
    }
    let four = turn_on(two, two);
    return array(four.x, four.y, two.x, two.y, 1.0);
}
