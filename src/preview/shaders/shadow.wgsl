// How much of a light reaches a point: percentage-closer soft shadows (Fernando 2005) with a receiver plane.
//
// Depth is affine in the map's coordinates across any plane, for both projections (near / distance, and parallel), so
// the receiver's own plane gives the exact depth at every tap: a flat receiver never shadows itself, however wide the
// kernel, and needs next to no bias.

@group(2) @binding(0) var shadow_maps: texture_depth_2d_array;
@group(2) @binding(1) var shadow_sampler: sampler;

// Taps of the two steps; each reads four texels.
const SEARCH_TAPS: u32 = 6u;
const FILTER_TAPS: u32 = 8u;
const GOLDEN_ANGLE: f32 = 2.39996323;
// Nothing blocks a light closer to the receiver than this, as a part of the distance.
const RELATIVE_BIAS: f32 = 5e-4;

// Even pseudo-random number of a pixel (Jimenez 2014, interleaved gradient noise).
fn pixel_noise(pixel: vec2f) -> f32 {
    return fract(52.9829189 * fract(dot(pixel, vec2f(0.06711056, 0.00583715))));
}

fn view_of(light: u32, offset: vec3f) -> u32 {
    let first = lights[light].first_view;
    if lights[light].view_count == 1u {
        return first;
    }
    let size = abs(offset);
    if size.x >= size.y && size.x >= size.z {
        return first + select(1u, 0u, offset.x > 0.0);
    }
    if size.y >= size.z {
        return first + select(3u, 2u, offset.y > 0.0);
    }
    return first + select(5u, 4u, offset.z > 0.0);
}

struct Receiver {
    uv: vec2f,
    depth: f32,
    // Change of depth over the map, along u and v.
    slope: vec2f,
    layer: u32,
}

fn depth_at(r: Receiver, uv: vec2f) -> f32 {
    return r.depth + dot(r.slope, uv - r.uv);
}

// Fraction of the light that passes: 1 lit, 0 in full shadow.
fn visibility(light: u32, position: vec3f, face: vec3f, pixel: vec2f) -> f32 {
    if frame.shadows == 0u || lights[light].view_count == 0u {
        return 1.0;
    }
    let layer = view_of(light, position - lights[light].position);
    let near = shadow_views[layer].near_m;
    // A step off the surface hides the texels' rounding on curved receivers.
    let lifted = position + face * 5e-4;
    let clip = shadow_views[layer].clip_from_world * vec4f(lifted, 1.0);
    if clip.w <= 0.0 {
        return 1.0;
    }
    let ndc = clip.xyz / clip.w;
    if max(abs(ndc.x), abs(ndc.y)) >= 1.0 {
        return 1.0;
    }
    var r: Receiver;
    r.layer = layer;
    r.uv = vec2f(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y);
    r.depth = ndc.z;
    // The tangent plane in clip space; planes go by the transposed inverse.
    let plane = vec4f(face, -dot(face, lifted)) * shadow_views[layer].world_from_clip;
    let steepest = 40.0 * max(ndc.z, 0.02);
    let steep = abs(plane.z) * steepest < max(abs(plane.x), abs(plane.y));
    r.slope = select(vec2f(-plane.x, plane.y) * 2.0 / plane.z, vec2f(0.0), steep || abs(plane.z) < 1e-20);

    let field = shadow_views[layer].field;
    let parallel = near == 0.0;
    let distance = near / ndc.z;
    let bias = select(ndc.z * RELATIVE_BIAS, 1e-3 / shadow_views[layer].range_m, parallel);
    r.depth += bias;
    let texel = 1.0 / f32(textureDimensions(shadow_maps).x);
    let softness = lights[light].softness / field;
    let turn = pixel_noise(pixel) * 2.0 * PI;

    var radius = vec2f(0.0);
    if max(softness.x, softness.y) > 0.0 {
        // Blockers are sought where the emitter's outline falls for one half-way to the light.
        let search = clamp(softness * select(1.0 / distance, 1.5, parallel), vec2f(texel), vec2f(0.15));
        let blocker = mean_blocker(r, search, turn);
        if blocker <= 0.0 {
            return 1.0;
        }
        let gap = select((blocker / near - 1.0 / distance), (blocker - ndc.z) * shadow_views[layer].range_m, parallel);
        radius = clamp(softness * max(gap, 0.0), vec2f(0.0), vec2f(0.2));
    }
    if max(radius.x, radius.y) < 0.75 * texel {
        return smooth_tap(r, r.uv, texel);
    }
    return filtered(r, max(radius, vec2f(0.75 * texel)), turn, texel);
}

// Mean depth of what stands before the receiver's plane; 0 if nothing does.
fn mean_blocker(r: Receiver, search: vec2f, turn: f32) -> f32 {
    var sum = 0.0;
    var count = 0.0;
    for (var i = 0u; i < SEARCH_TAPS; i++) {
        let angle = f32(i) * GOLDEN_ANGLE + turn;
        let reach = sqrt((f32(i) + 0.5) / f32(SEARCH_TAPS));
        let uv = r.uv + vec2f(cos(angle), sin(angle)) * reach * search;
        let depth = textureGather(shadow_maps, shadow_sampler, uv, r.layer);
        let blocks = vec4f(depth > vec4f(depth_at(r, uv)));
        sum += dot(blocks, depth);
        count += dot(blocks, vec4f(1.0));
    }
    return select(0.0, sum / max(count, 1.0), count > 0.0);
}

fn filtered(r: Receiver, radius: vec2f, turn: f32, texel: f32) -> f32 {
    var lit = 0.0;
    for (var i = 0u; i < FILTER_TAPS; i++) {
        let angle = f32(i) * GOLDEN_ANGLE + turn;
        let reach = sqrt((f32(i) + 0.5) / f32(FILTER_TAPS));
        lit += smooth_tap(r, r.uv + vec2f(cos(angle), sin(angle)) * reach * radius, texel);
    }
    return lit / f32(FILTER_TAPS);
}

// Four comparisons around a point, blended by where it lies between the texels.
fn smooth_tap(r: Receiver, uv: vec2f, texel: f32) -> f32 {
    let depth = textureGather(shadow_maps, shadow_sampler, uv, r.layer);
    let place = uv / texel - 0.5;
    let part = fract(place);
    let low = (floor(place) + 0.5) * texel;
    // Gather order: lower left, lower right, upper right, upper left.
    let base = depth_at(r, low);
    let du = r.slope.x * texel;
    let dv = r.slope.y * texel;
    let plane = vec4f(base + dv, base + du + dv, base + du, base);
    let lit = vec4f(depth <= plane);
    let bottom = mix(lit.x, lit.y, part.x);
    let top = mix(lit.w, lit.z, part.x);
    return mix(top, bottom, part.y);
}
