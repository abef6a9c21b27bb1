// Tone mapping: exposure, AgX, sRGB.
//
// AgX is Troy Sobotka's; the polynomial for its curve and the matrices are Benjamin Wrensch's fit (2023).

fn agx(linear: vec3f) -> vec3f {
    let inset = mat3x3f(
        vec3f(0.842479062253094, 0.0423282422610123, 0.0423756549057051),
        vec3f(0.0784335999999992, 0.878468636469772, 0.0784336),
        vec3f(0.0792237451477643, 0.0791661274605434, 0.879142973793104),
    );
    let outset = mat3x3f(
        vec3f(1.19687900512017, -0.0528968517574562, -0.0529716355144438),
        vec3f(-0.0980208811401368, 1.15190312990417, -0.0980434501171241),
        vec3f(-0.0990297440797205, -0.0989611768448433, 1.15107367264116),
    );
    let low = -12.47393;
    let high = 4.026069;
    let stops = clamp(log2(max(inset * linear, vec3f(1e-10))), vec3f(low), vec3f(high));
    let x = (stops - low) / (high - low);
    let x2 = x * x;
    let x4 = x2 * x2;
    var y = 15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x - 0.00232;
    // A little contrast and saturation, so that natural hair colours do not turn grey.
    y = pow(max(y, vec3f(0.0)), vec3f(1.08));
    let grey = dot(y, vec3f(0.2126, 0.7152, 0.0722));
    y = max(grey + 1.18 * (y - grey), vec3f(0.0));
    return pow(clamp(outset * y, vec3f(0.0), vec3f(1.0)), vec3f(2.2));
}

fn srgb(linear: vec3f) -> vec3f {
    let low = linear * 12.92;
    let high = 1.055 * pow(max(linear, vec3f(0.0)), vec3f(1.0 / 2.4)) - 0.055;
    return select(high, low, linear <= vec3f(0.0031308));
}

// Light as sRGB-encoded numbers.
fn tone_curve(light: vec3f) -> vec3f {
    return srgb(agx(max(light, vec3f(0.0)) * frame.exposure));
}

// Ordered dither of up to half a step, so that smooth gradients do not band.
fn dithered(color: vec3f, pixel: vec2u) -> vec3f {
    let noise = fract(52.9829189 * fract(dot(vec2f(pixel), vec2f(0.06711056, 0.00583715)))) - 0.5;
    return color + noise / 255.0;
}

// A pixel as sRGB-encoded numbers.
fn tone_map(light: vec3f, pixel: vec2u) -> vec3f {
    return dithered(tone_curve(light), pixel);
}
