// The blur of the shadow mask: the mean of 3 x 3 mask pixels on the same plane, which averages the nine tap rotations.
// Fibres, whose depths are negative in the mask, and surfaces are kept apart.

@group(1) @binding(0) var gbuffer: texture_2d<u32>;
@group(1) @binding(1) var ids: texture_2d<u32>;
@group(2) @binding(0) var mask: texture_2d<u32>;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return fullscreen_corner(index);
}

@fragment
fn fragment(@builtin(position) at: vec4f) -> @location(0) vec2u {
    let mask_pixel = vec2i(at.xy);
    let last = vec2i(textureDimensions(mask)) - 1;
    let own = textureLoad(mask, mask_pixel, 0).y;
    let pixel = min(vec2u(mask_pixel) * frame.mask_scale, vec2u(frame.size) - 1u);
    let geometric_normal = unpack_direction(textureLoad(gbuffer, pixel, 0).z);
    // Depth is affine in screen space over the plane
    let here = dot(geometric_normal, pixel_ray(vec2f(pixel) + 0.5));
    let right = dot(geometric_normal, frame.ray_right) * 2.0 * f32(frame.mask_scale) / frame.size.x;
    let down = -dot(geometric_normal, frame.ray_up) * 2.0 * f32(frame.mask_scale) / frame.size.y;
    let scale = bitcast<f32>(own) / select(here, 1e-6, abs(here) < 1e-6);
    var sum = vec4f(0.0);
    var count = 0.0;
    for (var y = -1; y <= 1; y++) {
        for (var x = -1; x <= 1; x++) {
            let texel = textureLoad(mask, clamp(mask_pixel + vec2i(x, y), vec2i(0), last), 0).xy;
            let expected = (here + f32(x) * right + f32(y) * down) * scale;
            let on_plane = abs(bitcast<f32>(texel.y) - expected) <= 0.01 * abs(expected) || (x == 0 && y == 0);
            let weight = select(0.0, 1.0, on_plane);
            sum += unpack4x8unorm(texel.x) * weight;
            count += weight;
        }
    }
    return vec2u(pack4x8unorm(sum / count), own);
}
