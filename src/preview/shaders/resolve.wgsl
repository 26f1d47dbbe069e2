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
    let pixel = vec2i(at.xy);
    let packed = textureLoad(gbuffer, pixel, 0).xyz;
    let id = textureLoad(ids, pixel, 0).xy;
    let depth = bitcast<f32>(id.y);
    // Depth over a plane goes with the cosine between ray and normal, whatever the normal's length.
    let face = octahedral(packed.z);
    let across_face = vec2f(dot(face, frame.ray_right), -dot(face, frame.ray_up));
    let pixel_size = 2.0 / frame.size;
    let here = dot(face, frame.ray_centre) + dot(at.xy * pixel_size - 1.0, across_face);
    let slope = across_face * pixel_size * (depth / select(here, 1e-6, abs(here) < 1e-6));
    let normal = unpack2x16snorm(packed.x);
    let side = f32(frame.cell_scale);
    // A little over, so that a whole quotient does not fall short.
    let place = floor(at.xy) * (1.0 / side) + 1e-4;
    let corner = vec2i(place);
    let part = fract(place);
    let last = vec2i((frame.size - 0.5) / side);
    var matte = vec3f(0.0);
    var glossy = vec3f(0.0);
    var total = 0.0;
    for (var i = 0; i < 4; i++) {
        let step = vec2i(i & 1, i >> 1);
        let texel = textureLoad(cells, min(corner + step, last), 0);
        let towards = vec2f(step) - part;
        // Half a per cent of the distance, and a turn of some ten degrees.
        let aside = abs(bitcast<f32>(texel.w) - depth - side * dot(towards, slope)) > 0.005 * depth;
        let turned = unpack2x16snorm(texel.z) - normal;
        let other = aside || dot(turned, turned) > 0.015;
        let across = 1.0 - abs(towards);
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
