// The shadow mask: the visibility of four lights per pixel, by percentage-closer soft shadows (PCSS, Fernando 2005)
// with receiver plane depth.
//
// Depth is affine in the map's coordinates over any plane, for both projections (near / distance, and parallel), so
// that the receiver's plane gives the exact depth at every texel: a flat receiver never shadows itself, however wide
// the kernel, and needs almost no bias.
//
// CPU rasterisers execute both sides of every branch; only loop bounds save work. So the blocker search sets the bound
// of the filter loop, which must not be a constant, or the loop would be unrolled.

// The shadow map of a light or of a part of its emitter; twin of `GpuShadowSlot`.
struct Slot {
    position: vec3f,
    layer: u32,
    right: vec3f,
    // 0 no shadow, 1 perspective, 2 parallel, 3 cube, 4 cube without the face behind.
    kind: u32,
    up: vec3f,
    // Near distance, metres: depth is near over distance. In a parallel view, the depth range of the map.
    near_m: f32,
    forward: vec3f,
    // Distance of depth 0 in a parallel view, metres.
    far_m: f32,
    // Lower corner and size of the map in its image plane: tangents, or metres in a parallel view.
    low: vec2f,
    field: vec2f,
    // Half axes of the emitter: metres, or tangents in a parallel view.
    softness: vec2f,
    unused: vec2f,
}

const MAX_PARTS: u32 = 4u;
// An emitter is subdivided into parts. CPU rasterisers pay for the loop as such.
override SUBDIVIDED: bool = true;

// The slots of four lights, one per part of the emitter; twin of `GpuShadows`.
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
const DRAFT_FILTER_TAPS: u32 = 6u;
// Rotation by the golden angle, from one tap to the next.
const GOLDEN_TURN: mat2x2f = mat2x2f(-0.737368878, 0.675490294, -0.675490294, -0.737368878);
// Depth bias relative to the distance, and in texels of more than a millimetre: lids and lashes that a coarse map does not
// resolve would keep all light from an eye. In a parallel view in texels, up to a maximum in metres.
const RELATIVE_BIAS: f32 = 5e-4;
const COARSE_TEXEL_BIAS: f32 = 0.8;
const FINE_TEXEL_M: f32 = 1e-3;
const PARALLEL_BIAS: f32 = 0.5;
const MOST_PARALLEL_BIAS_M: f32 = 1e-3;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return fullscreen_corner(index);
}

struct Receiver {
    // Position on the map, texels.
    at: vec2f,
    depth: f32,
    // Depth gradient of the receiver plane per texel.
    slope: vec2f,
    layer: i32,
    // The light has a map there, and the receiver lies on it.
    inside: bool,
    resolution: f32,
    // Half axes of the emitter along those of the map, as seen from here: metres, or tangents in a parallel view.
    softness: vec2f,
    // Height of the ends of these half axes over the receiver plane, from the emitter's centre.
    rise: vec2f,
    // Metres per unit of depth at the receiver; 0 for all but fibres.
    hair_m: f32,
    is_parallel: bool,
}

// Extinction of light among strands of a head of hair, per metre. Fitted to the tracer's pictures of heads of hair: half
// of what some 1000 strands of 0.15 mm a square centimetre would block if they did not lie in clumps.
const HAIR_EXTINCTION: f32 = 700.0;

// Rotates a vector (right, up, forward) of the cube into the frame of one of its faces.
fn to_face(v: vec3f, by_x: bool, by_y: bool, sign: f32) -> vec3f {
    let to_x = vec3f(-sign * v.z, v.y, sign * v.x);
    let to_y = vec3f(v.x, -sign * v.z, sign * v.y);
    let to_z = vec3f(-sign * v.x, v.y, -sign * v.z);
    return select(select(to_z, to_y, by_y), to_x, by_x);
}

// Projects a shading point onto a shadow map, with the depth gradient of its plane.
fn receiver(slot: u32, position: vec3f, geometric_normal: vec3f, is_fibre: bool, dither: f32) -> Receiver {
    let texel = shadows.slots[slot].field.x / f32(textureDimensions(shadow_maps).x);
    let to_light = shadows.slots[slot].position - position;
    let distance = select(length(to_light), 1.0, shadows.slots[slot].kind == 2u);
    // Offset the point along the geometric normal by the texel size, growing towards grazing light (normal offset)
    let facing_point = dot(geometric_normal, to_light) / max(distance, 1e-6);
    let facing_sun = -dot(geometric_normal, shadows.slots[slot].forward);
    let facing = select(facing_point, facing_sun, shadows.slots[slot].kind == 2u);
    let offset = geometric_normal * (5e-4 + 0.25 * texel * distance * (1.0 - abs(facing))) - to_light;
    var local = vec3f(
        dot(shadows.slots[slot].right, offset),
        dot(shadows.slots[slot].up, offset),
        dot(shadows.slots[slot].forward, offset),
    );
    var normal = vec3f(
        dot(shadows.slots[slot].right, geometric_normal),
        dot(shadows.slots[slot].up, geometric_normal),
        dot(shadows.slots[slot].forward, geometric_normal),
    );
    var layer = shadows.slots[slot].layer;
    var r: Receiver;
    r.softness = shadows.slots[slot].softness;
    var has_map = true;
    if shadows.slots[slot].kind >= 3u {
        // Select the cube face: +X, -X, +Y, -Y, -Z (forwards), +Z, oriented as in `shadows/views.rs`
        let size = abs(local);
        let by_x = size.x >= size.y && size.x >= size.z;
        let by_y = !by_x && size.y >= size.z;
        let positive = select(select(-local.z, local.y, by_y), local.x, by_x) > 0.0;
        let sign = select(-1.0, 1.0, positive);
        local = to_face(local, by_x, by_y, sign);
        normal = to_face(normal, by_x, by_y, sign);
        // Side faces see a panel edge-on
        r.softness *= select(select(vec2f(1.0), vec2f(1.0, 0.3), by_y), vec2f(0.3, 1.0), by_x);
        let face = select(select(4u, 2u, by_y), 0u, by_x) + select(0u, 1u, positive == !(by_x || by_y));
        has_map = face < 5u || shadows.slots[slot].kind == 3u;
        layer += face;
    }
    r.rise = vec2f(normal.x, -normal.y) * r.softness;
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
    let bias = RELATIVE_BIAS + COARSE_TEXEL_BIAS * max(texel - FINE_TEXEL_M / max(distance, 1e-6), 0.0);
    r.depth = select(near / local.z * (1.0 + bias), parallel_depth, parallel);
    let slope = select(near * normal.xy / height, normal.xy / (normal.z * near), parallel) / texels;
    // Clamp the slope of planes that the light sees edge-on; they are dark
    let steepest = 0.25 * select(abs(r.depth), 1.0, parallel);
    r.slope = clamp(vec2f(slope.x, -slope.y), vec2f(-steepest), vec2f(steepest));
    r.inside = has_map && (parallel || local.z > 0.0) && all(r.at > vec2f(0.0)) && all(r.at < vec2f(resolution));
    // Choose the side of the map. The far side of solids gives tight contact shadows. The near side serves receivers
    // that face away from the emitter's centre, which the body itself occludes. Across the terminator the choice is
    // dithered, and the blur turns it into a blend. Fibres take the near side: what occludes lashes and brows from behind
    // is the whole head, whose far side they lie on
    let near_side = is_fibre || dither < saturate(1.0 - 6.0 * facing);
    r.layer = i32(2u * layer + select(1u, 0u, near_side));
    r.resolution = resolution;
    return r;
}

// Returns the depth gap between the receiver and the surface at a tap (x), and its opacity if that surface is a blocker
// (y): it lies in front of the receiver's plane and inside the cone from the receiver to the emitter's outline. The cone
// test keeps concave receivers from shadowing themselves. What blocks a fibre is mostly hair, of which there is the more
// the longer the way: 1 / (1 + x + x^2 / 2) is close to exp(-x). `spread` is the cone's growth in texels per unit of depth.
fn blocker_at(r: Receiver, tap: vec2f, spread: vec2f) -> vec2f {
    let texel = floor(r.at + tap);
    let offset = texel + 0.5 - r.at;
    let depth = textureLoad(shadow_maps, vec2i(texel), r.layer, 0);
    let before = depth > r.depth + dot(r.slope, offset);
    // Tolerance of 1.5 texels: the smallest kernel extends to 1.2 texels
    let aside = max(abs(offset) - 1.5, vec2f(0.0)) / spread;
    let gap = depth - r.depth;
    let inside = dot(aside, aside) <= gap * gap;
    let thickness = HAIR_EXTINCTION * r.hair_m * max(gap, 0.0) / select(max(depth, 1e-9), 1.0, r.is_parallel);
    let opacity = 1.0 - 1.0 / (1.0 + thickness * (1.0 + 0.5 * thickness));
    return vec2f(max(gap, 0.0), select(0.0, select(1.0, opacity, r.hair_m > 0.0), before && inside));
}

// Returns the visibility through one slot: 1 lit, 0 in full shadow. `turn` rotates the taps, `dither` is uniform in
// 0..1.
fn slot_visibility(slot: u32, position: vec3f, geometric_normal: vec3f, is_fibre: bool, turn: vec2f, dither: f32) -> f32 {
    var r = receiver(slot, position, geometric_normal, is_fibre, dither);
    let parallel = shadows.slots[slot].kind == 2u;
    let near = shadows.slots[slot].near_m;
    // The gap in metres is near / receiver - near / blocker in perspective, and linear in a parallel view
    r.is_parallel = parallel;
    r.hair_m = select(0.0, select(near / r.depth, near, parallel), is_fibre);
    // Skip receivers that face away from the whole emitter, and points outside of the map
    let to_light = shadows.slots[slot].position - position;
    let height = select(dot(geometric_normal, to_light), -dot(geometric_normal, shadows.slots[slot].forward), parallel);
    let below = height < -length(shadows.slots[slot].softness) && shadows.slots[slot].kind != 0u;
    let decided = !r.inside || shadows.slots[slot].kind == 0u || below;
    let softness = max(r.softness, vec2f(1e-5)) * (r.resolution / shadows.slots[slot].field);
    let spread = softness * select(1.0 / near, near, parallel);
    // Blocker search: the radius is the projection of the emitter through a blocker half-way to the light. Taps are
    // denser near the centre, where blockers in contact with the receiver are
    let reach = 0.35 * r.resolution;
    let search = clamp(softness * select(r.depth / near, 1.5, parallel), vec2f(1.0), vec2f(reach));
    let min_gap = select(0.02 * r.depth, 0.01, parallel);
    // Average the gap to the blockers, weighted by the solid angle of the emitter that each can cover
    var found = vec2f(0.0);
    var hits = 0u;
    var tap = turn;
    for (var i = 0u; i < SEARCH_TAPS; i++) {
        let part = f32(i) / f32(SEARCH_TAPS - 1u);
        let blocker = blocker_at(r, tap * (part * part) * search, spread);
        let apart = blocker.x + min_gap;
        found += vec2f(blocker.x, 1.0) * (blocker.y / (apart * apart));
        hits += select(0u, 1u, blocker.y > 0.0);
        tap = GOLDEN_TURN * tap;
    }
    // Estimate the penumbra radius from the mean gap
    let gap = found.x / max(found.y, 1e-6);
    let radius = clamp(spread * gap, vec2f(0.7), vec2f(reach));
    var blocked = 0.0;
    var total = 0.0;
    tap = turn;
    var i = 0u;
    // Skip the filter where the search found no blocker, or only blockers over the whole penumbra
    let fully_blocked = hits == SEARCH_TAPS && all(radius <= search) && r.hair_m == 0.0;
    let skip_filter = decided || hits == 0u || fully_blocked;
    let taps = select(FILTER_TAPS, DRAFT_FILTER_TAPS, frame.mask_scale > 2u);
    let filter_taps = select(taps, 1u, skip_filter);
    // Percentage-closer filter over the penumbra. Each tap stands for a point of the emitter and is weighted by its height
    // over the receiver's horizon, as in shading. Points below count only where all are
    let least_weight = 1e-3 * length(r.softness) + 1e-6;
    loop {
        let at = tap * sqrt((f32(i) + 0.5) / f32(taps));
        let weight = max(height + dot(r.rise, at), 0.0) + least_weight;
        blocked += weight * blocker_at(r, at * radius, spread).y;
        total += weight;
        tap = GOLDEN_TURN * tap;
        i++;
        continuing {
            break if i >= filter_taps;
        }
    }
    let searched = select(1.0 - blocked / total, select(1.0, 0.0, fully_blocked), skip_filter);
    return select(searched, select(1.0, 0.0, below), decided);
}

// Returns the irradiance weight of a part of an emitter at a surface. A part whose centre is below the horizon sees the
// surface from behind and its map holds no valid shadow there: its weight is tiny, unless all parts are below. It is never
// zero, so that a surface below all parts, whose visibility its neighbours read, too, has their mean.
fn slot_weight(slot: u32, position: vec3f, normal: vec3f) -> f32 {
    let to_part = shadows.slots[slot].position - position;
    let squared = max(dot(to_part, to_part), 1e-6);
    let height = dot(normal, to_part);
    let axes = vec2f(dot(normal, shadows.slots[slot].right), dot(normal, shadows.slots[slot].up));
    let extent = max(length(axes * shadows.slots[slot].softness), 1e-6);
    let above = max(height, 0.0) + 1e-3 * max(height + extent, 0.0);
    return above * max(-dot(to_part, shadows.slots[slot].forward), 0.0) / (squared * squared) + 1e-9;
}

// Returns the plane that a fibre receives light with: it faces the light.
fn facing_light(slot: u32, position: vec3f) -> vec3f {
    let towards = select(shadows.slots[slot].position - position, -shadows.slots[slot].forward, shadows.slots[slot].kind == 2u);
    return towards * inverseSqrt(max(dot(towards, towards), 1e-12));
}

// Returns the visibility of a light: the weighted mean over the parts of its emitter.
fn visibility(light: u32, position: vec3f, surface_normal: vec3f, plane: vec3f, is_fibre: bool, turn: vec2f, dither: f32) -> f32 {
    let count = shadows.counts[light];
    var sum = 0.0;
    var total = 0.0;
    var part = 0u;
    loop {
        let slot = MAX_PARTS * light + part;
        let towards = facing_light(slot, position);
        let normal = select(surface_normal, towards, is_fibre);
        let geometric_normal = select(plane, towards, is_fibre);
        var weight = 1.0;
        if SUBDIVIDED {
            weight = select(1.0, slot_weight(slot, position, normal), count > 1u);
        }
        sum += weight * slot_visibility(slot, position, geometric_normal, is_fibre, turn, dither);
        total += weight;
        part++;
        continuing {
            break if !SUBDIVIDED || part >= count;
        }
    }
    return sum / total;
}

@fragment
fn fragment(@builtin(position) at: vec4f) -> @location(0) vec2u {
    let mask_pixel = vec2u(at.xy);
    let pixel = min(mask_pixel * frame.mask_scale, vec2u(frame.size) - 1u);
    let depth = textureLoad(ids, pixel, 0).y;
    let texel = textureLoad(gbuffer, pixel, 0).xyz;
    let packed = texel.xz;
    let is_fibre = is_fibre_color(texel.y);
    let normal = unpack_direction(packed.x);
    let geometric_normal = unpack_direction(packed.y);
    let ray = pixel_ray(vec2f(pixel) + 0.5);
    let position = frame.eye + ray * (frame.near_m / max(bitcast<f32>(depth), 1e-9));
    // Rotate the taps by one of nine angles in each 3 x 3 block, which the blur averages
    let ninth = f32((mask_pixel.x % 3u) * 3u + mask_pixel.y % 3u);
    let angle = ninth * (2.0 * PI / 9.0);
    // Order the dither values differently from the angles to decorrelate them
    let dither = (f32((u32(ninth) * 4u) % 9u) + 0.5) / 9.0;
    let turn = vec2f(cos(angle), sin(angle));
    let lit = vec4f(
        visibility(0u, position, normal, geometric_normal, is_fibre, turn, dither),
        visibility(1u, position, normal, geometric_normal, is_fibre, turn, dither),
        visibility(2u, position, normal, geometric_normal, is_fibre, turn, dither),
        visibility(3u, position, normal, geometric_normal, is_fibre, turn, dither),
    );
    return vec2u(pack4x8unorm(lit), depth | select(0u, MASK_FIBRE, is_fibre));
}
