// Tone curve and sRGB encoding; twin of `color::tone_curve` and `color::srgb_encode`, which a test compares.

const SHOULDER: f32 = 0.6;

fn tone_curve(linear: vec3f) -> vec3f {
    let x = max(linear, vec3f(0.0));
    let room = 1.0 - SHOULDER;
    let curved = SHOULDER + room * (1.0 - exp(-(x - SHOULDER) / room));
    return select(curved, x, x <= vec3f(SHOULDER));
}

fn srgb_encode(linear: vec3f) -> vec3f {
    let curved = 1.055 * pow(max(linear, vec3f(0.0)), vec3f(1.0 / 2.4)) - 0.055;
    return select(curved, 12.92 * linear, linear <= vec3f(0.0031308));
}

// Returns a display value, dithered by less than one code with interleaved gradient noise (Jimenez 2014) against
// banding.
fn dithered(display: vec3f, at: vec2f) -> vec4f {
    let noise = fract(52.9829189 * fract(dot(at, vec2f(0.06711056, 0.00583715)))) - 0.5;
    return vec4f(display + noise * (0.9 / 255.0), 1.0);
}

// Returns the display value of a pixel, dithered.
fn encode_display(radiance: vec3f, at: vec2f) -> vec4f {
    return dithered(srgb_encode(tone_curve(radiance)), at);
}
