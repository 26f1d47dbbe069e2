// The resolve pass of drafts: upsamples coarse lighting with a joint bilateral filter. Each pixel interpolates the four
// coarse pixels around it that match its plane and normal, and applies its own base colour.

@group(1) @binding(0) var gbuffer: texture_2d<u32>;
@group(1) @binding(1) var ids: texture_2d<u32>;
// Diffuse light, specular light, normal, depth.
@group(2) @binding(0) var coarse: texture_2d<u32>;

// Weight of a coarse pixel on another surface; it only matters where all four are.
const OFF_SURFACE_WEIGHT: f32 = 1e-4;

// Writes the irradiance in false colour.
override ILLUMINANCE: bool = false;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return fullscreen_corner(index);
}

@fragment
fn fragment(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let pixel = vec2i(at.xy);
    let packed = textureLoad(gbuffer, pixel, 0).xyz;
    let id = textureLoad(ids, pixel, 0).xy;
    let depth = bitcast<f32>(id.y);
    // Depth (near over distance) is affine in screen space over the pixel's plane: compute its slope per pixel
    let geometric_normal = octahedral(packed.z);
    let across_face = vec2f(dot(geometric_normal, frame.ray_right), -dot(geometric_normal, frame.ray_up));
    let pixel_size = 2.0 / frame.size;
    let here = dot(geometric_normal, frame.ray_centre) + dot(at.xy * pixel_size - 1.0, across_face);
    let slope = across_face * pixel_size * (depth / select(here, 1e-6, abs(here) < 1e-6));
    let normal = unpack2x16snorm(packed.x);
    let side = f32(frame.coarse_scale);
    // The offset keeps exact quotients from rounding down
    let coarse_uv = floor(at.xy) * (1.0 / side) + 1e-4;
    let corner = vec2i(coarse_uv);
    let part = fract(coarse_uv);
    let last = vec2i((frame.size - 0.5) / side);
    var diffuse = vec3f(0.0);
    var specular = vec3f(0.0);
    var total = 0.0;
    for (var i = 0; i < 4; i++) {
        let step = vec2i(i & 1, i >> 1);
        let texel = textureLoad(coarse, min(corner + step, last), 0);
        let towards = vec2f(step) - part;
        // Reject by 0.5 % of the depth and by about ten degrees between the normals
        let off_plane = abs(bitcast<f32>(texel.w) - depth - side * dot(towards, slope)) > 0.005 * depth;
        let normal_difference = unpack2x16snorm(texel.z) - normal;
        let off_surface = off_plane || dot(normal_difference, normal_difference) > 0.015;
        let across = 1.0 - abs(towards);
        let weight = (across.x * across.y + OFF_SURFACE_WEIGHT) * select(1.0, OFF_SURFACE_WEIGHT, off_surface);
        diffuse += unpack_radiance(texel.x) * weight;
        specular += unpack_radiance(texel.y) * weight;
        total += weight;
    }
    if ILLUMINANCE {
        return false_color(select(diffuse / total, vec3f(0.0), id.x == 0u));
    }
    let base = select(unpack_color(packed.y), vec3f(0.0), id.x == 0u);
    let radiance = select((base * diffuse + specular) / total, frame.void_radiance, id.x == 0u);
    return encode_display(radiance, at.xy);
}
