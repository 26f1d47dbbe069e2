// The passes of a still picture: its display values to linear ones that are averaged, and the average back to display
// values.

@group(0) @binding(0) var picture: texture_2d<f32>;

// Encodes the average for display.
override ENCODES: bool = false;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    // One triangle that covers the picture
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fragment(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let value = textureLoad(picture, vec2i(at.xy), 0).rgb;
    if ENCODES {
        return dithered(srgb_encode(value), at.xy);
    }
    let steep = pow((value + 0.055) / 1.055, vec3f(2.4));
    return vec4f(select(steep, value / 12.92, value <= vec3f(0.04045)), 1.0);
}
