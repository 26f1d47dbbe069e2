// How much of each light reaches a pixel, four lights at a time: percentage-closer soft shadows (Fernando 2005) with a
// receiver plane.
//
// Depth is affine in the map's coordinates across any plane, for both projections (near / distance, and parallel), so
// the receiver's own plane gives the exact depth at every texel: a flat receiver never shadows itself, however wide the
// kernel, and needs next to no bias.
//
// Everything is straight-line code with fixed taps: a processor that rasterises runs all branches anyway.

// One light's view; twin of `GpuShadowSlot`.
struct Slot {
    position: vec3f,
    layer: u32,
    right: vec3f,
    // 0 no shadow, 1 perspective, 2 parallel, 3 cube.
    kind: u32,
    up: vec3f,
    // Depth is near over distance; in a parallel view the depth of the field.
    near_m: f32,
    forward: vec3f,
    // Distance of depth 0 in a parallel view.
    far_m: f32,
    // Corner and size of the map's field: tangents, or metres in a parallel view.
    low: vec2f,
    field: vec2f,
    // Half axes of the emitter: metres, or tangents in a parallel view.
    softness: vec2f,
    unused: vec2f,
}

@group(1) @binding(0) var gbuffer: texture_2d<u32>;
@group(1) @binding(1) var ids: texture_2d<u32>;
@group(2) @binding(0) var shadow_maps: texture_depth_2d_array;
@group(3) @binding(0) var<uniform> slots: array<Slot, 4>;

// Picture pixels a mask pixel, along each side.
override SCALE: u32 = 1;

const SEARCH_TAPS: u32 = 8u;
const FILTER_TAPS: u32 = 12u;
const GOLDEN_ANGLE: f32 = 2.39996323;
// Nothing blocks a light closer to the receiver than this part of the distance, and metres in a parallel view.
const RELATIVE_BIAS: f32 = 5e-4;
const PARALLEL_BIAS_M: f32 = 1e-3;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return fullscreen_corner(index);
}

struct Receiver {
    // In texels.
    at: vec2f,
    depth: f32,
    // Change of depth a texel.
    slope: vec2f,
    layer: i32,
    inside: bool,
    resolution: f32,
}

// Where a point falls on a light's map, and the depth of its tangent plane around.
fn receiver(slot: u32, position: vec3f, face: vec3f) -> Receiver {
    let offset = position - slots[slot].position;
    var right = slots[slot].right;
    var up = slots[slot].up;
    var forward = slots[slot].forward;
    var layer = slots[slot].layer;
    if slots[slot].kind == 3u {
        // The faces in the order +X, -X, +Y, -Y, +Z, -Z, turned as `shadow_views` turns them.
        let size = abs(offset);
        let by_x = size.x >= size.y && size.x >= size.z;
        let by_y = !by_x && size.y >= size.z;
        let positive = select(select(offset.z, offset.y, by_y), offset.x, by_x) > 0.0;
        let sign = select(-1.0, 1.0, positive);
        forward = select(select(vec3f(0.0, 0.0, sign), vec3f(0.0, sign, 0.0), by_y), vec3f(sign, 0.0, 0.0), by_x);
        right = select(select(vec3f(-sign, 0.0, 0.0), vec3f(1.0, 0.0, 0.0), by_y), vec3f(0.0, 0.0, sign), by_x);
        up = select(vec3f(0.0, 1.0, 0.0), vec3f(0.0, 0.0, sign), by_y);
        layer += select(select(4u, 2u, by_y), 0u, by_x) + select(1u, 0u, positive);
    }
    let local = vec3f(dot(right, offset), dot(up, offset), dot(forward, offset));
    let normal = vec3f(dot(right, face), dot(up, face), dot(forward, face));
    let height = dot(normal, local);
    let near = slots[slot].near_m;
    let parallel = slots[slot].kind == 2u;
    let resolution = f32(textureDimensions(shadow_maps).x);
    let low = slots[slot].low;
    let texels = resolution / slots[slot].field;
    var r: Receiver;
    let plane_point = select(local.xy / local.z, local.xy, parallel);
    r.at = vec2f(plane_point.x - low.x, slots[slot].field.y - (plane_point.y - low.y)) * texels;
    let parallel_depth = (slots[slot].far_m + PARALLEL_BIAS_M - local.z) / near;
    r.depth = select(near / local.z * (1.0 + RELATIVE_BIAS), parallel_depth, parallel);
    let slope = select(near * normal.xy / height, normal.xy / (normal.z * near), parallel) / texels;
    // A plane seen edge-on has no slope to speak of, and is dark anyway.
    let usable = max(abs(slope.x), abs(slope.y)) < 0.02 * select(abs(r.depth), 1.0, parallel);
    r.slope = select(vec2f(0.0), vec2f(slope.x, -slope.y), usable);
    r.inside = (parallel || local.z > 0.0) && all(r.at > vec2f(0.0)) && all(r.at < vec2f(resolution));
    r.layer = i32(layer);
    r.resolution = resolution;
    return r;
}

fn disc_tap(i: u32, count: u32) -> vec2f {
    let angle = f32(i) * GOLDEN_ANGLE;
    return vec2f(cos(angle), sin(angle)) * sqrt((f32(i) + 0.5) / f32(count));
}

// Fraction of a light that passes: 1 lit, 0 in full shadow. `turn` rotates the taps.
fn visibility(slot: u32, position: vec3f, face: vec3f, turn: vec2f) -> f32 {
    let r = receiver(slot, position, face);
    let parallel = slots[slot].kind == 2u;
    let near = slots[slot].near_m;
    let softness = slots[slot].softness * (r.resolution / slots[slot].field);
    // Blockers are sought where the emitter's outline falls for one half-way to the light.
    let reach = 0.15 * r.resolution;
    let search = clamp(softness * select(r.depth / near, 1.5, parallel), vec2f(1.0), vec2f(reach));
    var depth_sum = 0.0;
    var blockers = 0.0;
    for (var i = 0u; i < SEARCH_TAPS; i++) {
        let tap = disc_tap(i, SEARCH_TAPS);
        let texel = floor(r.at + vec2f(tap.x * turn.x - tap.y * turn.y, tap.x * turn.y + tap.y * turn.x) * search);
        let depth = textureLoad(shadow_maps, vec2i(texel), r.layer, 0);
        let blocks = select(0.0, 1.0, depth > r.depth + dot(r.slope, texel + 0.5 - r.at));
        depth_sum += blocks * depth;
        blockers += blocks;
    }
    let blocker = depth_sum / max(blockers, 1.0);
    let gap = max(blocker - r.depth, 0.0) * select(1.0 / near, near, parallel);
    let radius = clamp(softness * gap, vec2f(0.7), vec2f(0.2 * r.resolution));
    var lit = 0.0;
    for (var i = 0u; i < FILTER_TAPS; i++) {
        let tap = disc_tap(i, FILTER_TAPS);
        let texel = floor(r.at + vec2f(tap.x * turn.x - tap.y * turn.y, tap.x * turn.y + tap.y * turn.x) * radius);
        let depth = textureLoad(shadow_maps, vec2i(texel), r.layer, 0);
        lit += select(1.0, 0.0, depth > r.depth + dot(r.slope, texel + 0.5 - r.at));
    }
    let whole = !r.inside || slots[slot].kind == 0u;
    return select(lit / f32(FILTER_TAPS), 1.0, whole);
}

@fragment
fn fragment(@builtin(position) at: vec4f) -> @location(0) vec2u {
    let cell = vec2u(at.xy);
    let pixel = min(cell * SCALE, vec2u(frame.size) - 1u);
    let depth = textureLoad(ids, pixel, 0).y;
    let face = unpack_direction(textureLoad(gbuffer, pixel, 0).z);
    let ray = pixel_ray(vec2f(pixel) + 0.5);
    // A step off the surface hides the map's rounding on curved receivers.
    let position = frame.eye + ray * (frame.near_m / max(bitcast<f32>(depth), 1e-9)) + face * 5e-4;
    // Nine rotations in every three by three pixels, which the blur that follows evens out.
    let angle = f32((cell.x % 3u) * 3u + cell.y % 3u) * (2.0 * PI / 9.0);
    let turn = vec2f(cos(angle), sin(angle));
    let lit = vec4f(
        visibility(0u, position, face, turn),
        visibility(1u, position, face, turn),
        visibility(2u, position, face, turn),
        visibility(3u, position, face, turn),
    );
    return vec2u(pack4x8unorm(lit), depth);
}
