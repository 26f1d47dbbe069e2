// Spreads light that was found at one pixel of each cell over the picture: each pixel takes from the four cells around
// as far as they lie on its own surface, by plane and normal, and keeps its own base colour.

@group(1) @binding(0) var gbuffer: texture_2d<u32>;
@group(1) @binding(1) var ids: texture_2d<u32>;
// Matte light, glossy light, normal, depth.
@group(2) @binding(0) var cells: texture_2d<u32>;

// Weight of a cell that lies on another surface: what is left where all four do.
const OTHER: f32 = 1e-4;

// Whether the picture shows the light on surfaces, in false colour.
override ILLUMINANCE: bool = false;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return fullscreen_corner(index);
}

@fragment
fn fragment(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(at.xy);
    let packed = textureLoad(gbuffer, pixel, 0).xyz;
    let id = textureLoad(ids, pixel, 0).xy;
    let depth = bitcast<f32>(id.y);
    let face = unpack_direction(packed.z);
    // Depth over a plane goes with the cosine between ray and normal.
    let here = dot(face, pixel_ray(at.xy));
    let scale = depth / select(here, 1e-6, abs(here) < 1e-6);
    let right = dot(face, frame.ray_right) * 2.0 / frame.size.x * scale;
    let down = -dot(face, frame.ray_up) * 2.0 / frame.size.y * scale;
    let normal = unpack2x16snorm(packed.x);
    let side = frame.cell_scale;
    let last = (vec2u(frame.size) - 1u) / side;
    let corner = pixel / side;
    let from_corner = vec2f(pixel - corner * side);
    let part = from_corner / f32(side);
    var matte = vec3f(0.0);
    var glossy = vec3f(0.0);
    var total = 0.0;
    for (var i = 0u; i < 4u; i++) {
        let step = vec2u(i & 1u, i >> 1u);
        let texel = textureLoad(cells, min(corner + step, last), 0);
        let offset = vec2f(step) * f32(side) - from_corner;
        let expected = depth + offset.x * right + offset.y * down;
        // Half a per cent of the distance, and a turn of some ten degrees.
        let aside = abs(bitcast<f32>(texel.w) - expected) > 0.005 * depth;
        let turned = unpack2x16snorm(texel.z) - normal;
        let other = aside || dot(turned, turned) > 0.015;
        let across = mix(1.0 - part, part, vec2f(step));
        let weight = (across.x * across.y + OTHER) * select(1.0, OTHER, other);
        matte += unpack_radiance(texel.x) * weight;
        glossy += unpack_radiance(texel.y) * weight;
        total += weight;
    }
    if ILLUMINANCE {
        return false_color(select(matte / total, vec3f(0.0), id.x == 0u));
    }
    let base = select(unpack_color(packed.y), vec3f(0.0), id.x == 0u);
    let radiance = select((base * matte + glossy) / total, frame.void_radiance, id.x == 0u);
    return shown(radiance, at.xy);
}
