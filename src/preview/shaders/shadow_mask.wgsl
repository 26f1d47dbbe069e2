// How much of each light reaches a pixel, four lights at a time: percentage-closer soft shadows (Fernando 2005) with a
// receiver plane.
//
// Depth is affine in the map's coordinates across any plane, for both projections (near / distance, and parallel), so
// the receiver's own plane gives the exact depth at every texel: a flat receiver never shadows itself, however wide the
// kernel, and needs next to no bias.
//
// A processor that rasterises runs both sides of every branch; only a loop's end saves it work. So what the search has
// settled ends the filter's loop, whose end must not be known when the shader is compiled, lest it be unrolled.

// View of a light or of a part of it; twin of `GpuShadowSlot`.
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

const MOST_PARTS: u32 = 4u;
// Whether any light is taken in several parts: a rasteriser on a processor pays for a loop as such.
override IN_PARTS: bool = true;

// Four lights, each in one part or several; twin of `GpuShadows`.
struct Shadows {
    counts: vec4u,
    slots: array<Slot, 16>,
}

@group(1) @binding(0) var gbuffer: texture_2d<u32>;
@group(1) @binding(1) var ids: texture_2d<u32>;
@group(2) @binding(0) var shadow_maps: texture_depth_2d_array;
@group(3) @binding(0) var<uniform> shadows: Shadows;

const SEARCH_TAPS: u32 = 6u;
const FILTER_TAPS: u32 = 10u;
const DRAFT_TAPS: u32 = 6u;
// Turn by the golden angle, from one tap to the next.
const GOLDEN_TURN: mat2x2f = mat2x2f(-0.737368878, 0.675490294, -0.675490294, -0.737368878);
// Nothing blocks a light closer to the receiver than this part of the distance; in a parallel view, than so many texels
// and metres.
const RELATIVE_BIAS: f32 = 5e-4;
const PARALLEL_BIAS: f32 = 0.5;
const MOST_PARALLEL_BIAS_M: f32 = 1e-3;

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
    // How much of the emitter's width and height shows in this direction.
    foreshortening: vec2f,
}

// A vector (right, up, forward) of the cube in the frame of one of its faces.
fn turned(v: vec3f, by_x: bool, by_y: bool, sign: f32) -> vec3f {
    let to_x = vec3f(-sign * v.z, v.y, sign * v.x);
    let to_y = vec3f(v.x, -sign * v.z, sign * v.y);
    let to_z = vec3f(-sign * v.x, v.y, -sign * v.z);
    return select(select(to_z, to_y, by_y), to_x, by_x);
}

// Where a point falls on a light's map, and the depth of its tangent plane around.
fn receiver(slot: u32, position: vec3f, face: vec3f, draw: f32) -> Receiver {
    let texel = shadows.slots[slot].field.x / f32(textureDimensions(shadow_maps).x);
    let to_light = shadows.slots[slot].position - position;
    let distance = select(length(to_light), 1.0, shadows.slots[slot].kind == 2u);
    // A step off the surface by the map's rounding: more where the light grazes, next to none where it faces.
    let facing = select(dot(face, to_light) / max(distance, 1e-6), -dot(face, shadows.slots[slot].forward), shadows.slots[slot].kind == 2u);
    let offset = face * (5e-4 + 0.25 * texel * distance * (1.0 - abs(facing))) - to_light;
    var local = vec3f(
        dot(shadows.slots[slot].right, offset),
        dot(shadows.slots[slot].up, offset),
        dot(shadows.slots[slot].forward, offset),
    );
    var normal = vec3f(dot(shadows.slots[slot].right, face), dot(shadows.slots[slot].up, face), dot(shadows.slots[slot].forward, face));
    var layer = shadows.slots[slot].layer;
    var r: Receiver;
    r.foreshortening = vec2f(1.0);
    if shadows.slots[slot].kind == 3u {
        // The faces in the order +X, -X, +Y, -Y, +Z, -Z, turned as `shadow_views` turns them. Forward is -Z.
        let size = abs(local);
        let by_x = size.x >= size.y && size.x >= size.z;
        let by_y = !by_x && size.y >= size.z;
        let positive = select(select(-local.z, local.y, by_y), local.x, by_x) > 0.0;
        let sign = select(-1.0, 1.0, positive);
        local = turned(local, by_x, by_y, sign);
        normal = turned(normal, by_x, by_y, sign);
        // From the side an emitter is seen edge-on.
        r.foreshortening = select(select(vec2f(1.0), vec2f(1.0, 0.3), by_y), vec2f(0.3, 1.0), by_x);
        layer += select(select(4u, 2u, by_y), 0u, by_x) + select(1u, 0u, positive);
    }
    let height = dot(normal, local);
    let near = shadows.slots[slot].near_m;
    let parallel = shadows.slots[slot].kind == 2u;
    let resolution = f32(textureDimensions(shadow_maps).x);
    let low = shadows.slots[slot].low;
    let texels = resolution / shadows.slots[slot].field;
    let plane_point = select(local.xy / local.z, local.xy, parallel);
    r.at = vec2f(plane_point.x - low.x, shadows.slots[slot].field.y - (plane_point.y - low.y)) * texels;
    let parallel_bias = min(PARALLEL_BIAS * texel, MOST_PARALLEL_BIAS_M);
    let parallel_depth = (shadows.slots[slot].far_m + parallel_bias - local.z) / near;
    r.depth = select(near / local.z * (1.0 + RELATIVE_BIAS), parallel_depth, parallel);
    let slope = select(near * normal.xy / height, normal.xy / (normal.z * near), parallel) / texels;
    // A plane seen edge-on is dark anyway; its slope must stay finite.
    let steepest = 0.25 * select(abs(r.depth), 1.0, parallel);
    r.slope = clamp(vec2f(slope.x, -slope.y), vec2f(-steepest), vec2f(steepest));
    r.inside = (parallel || local.z > 0.0) && all(r.at > vec2f(0.0)) && all(r.at < vec2f(resolution));
    // Two maps a view. Solids' far sides give dark and sharp contacts. Their near sides serve receivers that turn away
    // from the emitter's middle and see at most its edge: for them the body itself stands in the way. Over the
    // terminator the choice is drawn, and the blur makes it a blend.
    let near_side = draw < saturate(1.0 - 6.0 * facing);
    r.layer = i32(2u * layer + select(1u, 0u, near_side));
    r.resolution = resolution;
    return r;
}

// How far before the receiver (in depth) what stands in the light's way at a tap is (x), and whether it does (y). It
// does if it lies before the receiver's plane and inside the cone from the receiver to the emitter's outline: what is
// merely beside, like the rise of a hollow, takes nothing. `spread` is the cone's growth in texels for each unit of
// depth.
fn blocker_at(r: Receiver, tap: vec2f, spread: vec2f) -> vec2f {
    let texel = floor(r.at + tap);
    let offset = texel + 0.5 - r.at;
    let depth = textureLoad(shadow_maps, vec2i(texel), r.layer, 0);
    let before = depth > r.depth + dot(r.slope, offset);
    // A texel and a half of grace: the smallest kernel reaches 1.2 texels.
    let aside = max(abs(offset) - 1.5, vec2f(0.0)) / spread;
    let gap = depth - r.depth;
    let inside = dot(aside, aside) <= gap * gap;
    return vec2f(max(gap, 0.0), select(0.0, 1.0, before && inside));
}

// Fraction of a light that passes, or of a part of it: 1 lit, 0 in full shadow. `turn` rotates the taps, `draw` lies
// evenly in 0..1.
fn part_visibility(slot: u32, position: vec3f, face: vec3f, turn: vec2f, draw: f32) -> f32 {
    let r = receiver(slot, position, face, draw);
    let parallel = shadows.slots[slot].kind == 2u;
    let near = shadows.slots[slot].near_m;
    // The emitter lies wholly below the horizon of the face.
    let to_light = shadows.slots[slot].position - position;
    let height = select(dot(face, to_light), -dot(face, shadows.slots[slot].forward), parallel);
    let below = height < -length(shadows.slots[slot].softness) && shadows.slots[slot].kind != 0u;
    // Nothing to look for.
    let settled = !r.inside || shadows.slots[slot].kind == 0u || below;
    let softness = max(shadows.slots[slot].softness * r.foreshortening, vec2f(1e-5)) * (r.resolution / shadows.slots[slot].field);
    let spread = softness * select(1.0 / near, near, parallel);
    // Blockers are sought as far as the emitter's outline falls for one half-way to the light, and more densely near
    // the middle, where those that touch the receiver are.
    let reach = 0.35 * r.resolution;
    let search = clamp(softness * select(r.depth / near, 1.5, parallel), vec2f(1.0), vec2f(reach));
    let least = select(0.02 * r.depth, 0.01, parallel);
    // Mean gap to the blockers; each counts by how much of the emitter it can cover from there.
    var found = vec2f(0.0);
    var hits = 0u;
    var tap = turn;
    for (var i = 0u; i < SEARCH_TAPS; i++) {
        let part = f32(i) / f32(SEARCH_TAPS - 1u);
        let blocker = blocker_at(r, tap * (part * part) * search, spread);
        let apart = blocker.x + least;
        found += vec2f(blocker.x, 1.0) * (blocker.y / (apart * apart));
        hits += u32(blocker.y);
        tap = GOLDEN_TURN * tap;
    }
    let gap = found.x / max(found.y, 1e-6);
    let radius = clamp(spread * gap, vec2f(0.7), vec2f(reach));
    var blocked = 0.0;
    tap = turn;
    var i = 0u;
    // No blocker at all, or nothing but blockers as far as the emitter's outline falls.
    let whole = hits == SEARCH_TAPS && all(radius <= search);
    let known = settled || hits == 0u || whole;
    let taps = select(FILTER_TAPS, DRAFT_TAPS, frame.mask_scale > 2u);
    let filter_taps = select(taps, 1u, known);
    loop {
        blocked += blocker_at(r, tap * sqrt((f32(i) + 0.5) / f32(taps)) * radius, spread).y;
        tap = GOLDEN_TURN * tap;
        i++;
        continuing {
            break if i >= filter_taps;
        }
    }
    let searched = select(1.0 - blocked / f32(taps), select(1.0, 0.0, whole), known);
    return select(searched, select(1.0, 0.0, below), settled);
}

// What a part of an emitter sends to a surface with this normal, as a factor. A part whose middle is below the horizon
// sees the surface from behind and knows nothing of its shadow: next to nothing, unless no other knows more.
fn part_weight(slot: u32, position: vec3f, normal: vec3f) -> f32 {
    let to_part = shadows.slots[slot].position - position;
    let squared = max(dot(to_part, to_part), 1e-6);
    let height = dot(normal, to_part);
    let axes = vec2f(dot(normal, shadows.slots[slot].right), dot(normal, shadows.slots[slot].up));
    let extent = max(length(axes * shadows.slots[slot].softness), 1e-6);
    let above = max(height, 0.0) + 1e-3 * max(height + extent, 0.0);
    return above * max(-dot(to_part, shadows.slots[slot].forward), 0.0) / (squared * squared);
}

// Fraction of a light that passes.
fn visibility(light: u32, position: vec3f, normal: vec3f, face: vec3f, turn: vec2f, draw: f32) -> f32 {
    let count = shadows.counts[light];
    var sum = 0.0;
    var total = 0.0;
    var part = 0u;
    loop {
        let slot = MOST_PARTS * light + part;
        var weight = 1.0;
        if IN_PARTS {
            weight = select(1.0, part_weight(slot, position, normal), count > 1u);
        }
        sum += weight * part_visibility(slot, position, face, turn, draw);
        total += weight;
        part++;
        continuing {
            break if !IN_PARTS || part >= count;
        }
    }
    return select(sum / total, 1.0, total <= 0.0);
}

@fragment
fn fragment(@builtin(position) at: vec4f) -> @location(0) vec2u {
    let cell = vec2u(at.xy);
    let pixel = min(cell * frame.mask_scale, vec2u(frame.size) - 1u);
    let depth = textureLoad(ids, pixel, 0).y;
    let packed = textureLoad(gbuffer, pixel, 0).xz;
    let normal = unpack_direction(packed.x);
    let face = unpack_direction(packed.y);
    let ray = pixel_ray(vec2f(pixel) + 0.5);
    let position = frame.eye + ray * (frame.near_m / max(bitcast<f32>(depth), 1e-9));
    // Nine rotations in every three by three pixels, which the blur that follows evens out.
    let ninth = f32((cell.x % 3u) * 3u + cell.y % 3u);
    let angle = ninth * (2.0 * PI / 9.0);
    // Another order than the angle's, so that the two do not go together.
    let draw = (f32((u32(ninth) * 4u) % 9u) + 0.5) / 9.0;
    let turn = vec2f(cos(angle), sin(angle));
    let lit = vec4f(
        visibility(0u, position, normal, face, turn, draw),
        visibility(1u, position, normal, face, turn, draw),
        visibility(2u, position, normal, face, turn, draw),
        visibility(3u, position, normal, face, turn, draw),
    );
    return vec2u(pack4x8unorm(lit), depth);
}
