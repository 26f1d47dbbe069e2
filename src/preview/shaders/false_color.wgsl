// False colour of illuminance in thirds of a stop; twin of `photo::false_color`.

const FALSE_LOW: f32 = -6.0;
const FALSE_COLORS: array<vec3f, 10> = array<vec3f, 10>(
    vec3f(0.05, 0.03, 0.10),
    vec3f(0.20, 0.08, 0.36),
    vec3f(0.23, 0.22, 0.66),
    vec3f(0.13, 0.43, 0.78),
    vec3f(0.10, 0.62, 0.70),
    vec3f(0.16, 0.70, 0.42),
    vec3f(0.55, 0.78, 0.22),
    vec3f(0.95, 0.83, 0.16),
    vec3f(0.97, 0.53, 0.12),
    vec3f(0.85, 0.15, 0.16),
);

// Returns the false colour for the radiance of a white surface; 1 is the exposure that the camera is set for.
fn false_color(white: vec3f) -> vec4f {
    let stops = log2(max(dot(white, vec3f(0.2126, 0.7152, 0.0722)), 1e-6));
    let thirds = clamp(round(3.0 * stops) / 3.0 - FALSE_LOW, 0.0, 9.0);
    var colors = FALSE_COLORS;
    let place = min(u32(thirds), 8u);
    return vec4f(mix(colors[place], colors[place + 1u], thirds - f32(place)), 1.0);
}
