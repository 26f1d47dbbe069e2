// The lighting pass: every pixel of the G-buffer under every light that reaches it.
//
// `fragment` lights each pixel. `cell` lights one pixel in nine or more for `resolve.wgsl`, which spreads it: a draft
// for rasterisers on a processor while something moves.

// Whether the picture leaves as scene-linear light or as it is shown.
override LINEAR: bool = false;
// Which families of lights there are: code for the others is left out.
override HAS_DELTA: bool = true;
override HAS_SPHERES: bool = true;
override HAS_RECTS: bool = true;
override HAS_DISCS: bool = true;
// Textures of the shadow mask in use, four lights each; 0 without shadows.
override MASKS: u32 = 0;
// Picture pixels a mask pixel, along each side.
override SCALE: u32 = 1;
// Whether each tile of the picture has its own list of lights.
override LISTED: bool = false;
// Whether a light is left out where it falls under 1/256 of display white.
override REACH: bool = true;
// Whether any light's modifier narrows its beam.
override HAS_BEAMS: bool = true;
// Whether the picture shows the light on surfaces, as on white ones without gloss.
override ILLUMINANCE: bool = false;
// Whether gloss is Blinn and Phong's.
override BLINN_PHONG: bool = false;

@group(1) @binding(0) var gbuffer: texture_2d<u32>;
@group(1) @binding(1) var ids: texture_2d<u32>;
@group(2) @binding(0) var masks: texture_2d_array<u32>;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return fullscreen_corner(index);
}

// Of each light at the pixel: how much passes.
var<private> shadows: array<vec4f, 4>;

// Light that leaves a pixel: for each unit of its base colour, and the rest.
struct Lit {
    matte: vec3f,
    glossy: vec3f,
}

// Highlight of an emitter with a size. What has none of its light above the horizon gives no highlight either.
fn seen_highlight(s: Shading, a: Arrival, round: bool) -> vec3f {
    if ILLUMINANCE {
        return vec3f(0.0);
    }
    if BLINN_PHONG {
        return blinn_phong(s, a.centre) * a.irradiance;
    }
    return select(vec3f(0.0), highlight(s, a, round), a.irradiance > 0.0);
}

// Part of a light that comes to the body, to the mean over all directions; all of it where only the light is asked for.
fn body_share(s: Shading, cosine: f32, wide: f32) -> f32 {
    if ILLUMINANCE {
        return 1.0;
    }
    return entering(s.material, cosine, wide);
}

// Shadows of four lights at a pixel. A mask of a part of the size is read at the four pixels around, as far as they lie
// on the pixel's own plane.
fn shadow(mask: u32, at: vec2f, depth: f32, face: vec3f) -> vec4f {
    if SCALE == 1u {
        return unpack4x8unorm(textureLoad(masks, vec2i(at), mask, 0).x);
    }
    let last = vec2i(textureDimensions(masks)) - 1;
    let place = floor(at) / f32(SCALE);
    let corner = vec2i(place);
    let part = fract(place);
    let here = dot(face, pixel_ray(at));
    let scale = depth / select(here, 1e-6, abs(here) < 1e-6);
    var sum = vec4f(0.0);
    var total = 0.0;
    for (var i = 0; i < 4; i++) {
        let step = vec2i(i & 1, i >> 1);
        let cell = min(corner + step, last);
        let texel = textureLoad(masks, cell, mask, 0).xy;
        let expected = dot(face, pixel_ray(vec2f(cell * i32(SCALE)) + 0.5)) * scale;
        let same = abs(bitcast<f32>(texel.y) - expected) <= 0.01 * expected;
        let across = mix(1.0 - part, part, vec2f(step));
        let weight = (across.x * across.y + 1e-3) * select(1e-3, 1.0, same);
        sum += unpack4x8unorm(texel.x) * weight;
        total += weight;
    }
    return sum / total;
}

// Shadow of a light: four lights a mask, the rest are lit.
fn lit_by(light: u32) -> f32 {
    if MASKS == 0u {
        return 1.0;
    }
    if MASKS == 1u {
        return select(1.0, shadows[0][light & 3u], light < 4u);
    }
    return select(1.0, shadows[(light >> 2u) & 3u][light & 3u], light < 4u * MASKS);
}

// The G-buffer at a pixel, and where it stands.
struct Sample {
    packed: vec4u,
    id: vec2u,
    at: vec2f,
}

fn sample_at(pixel: vec2u) -> Sample {
    return Sample(textureLoad(gbuffer, pixel, 0), textureLoad(ids, pixel, 0).xy, vec2f(pixel) + 0.5);
}

fn read_shadows(p: Sample) {
    let face = unpack_direction(p.packed.z);
    for (var mask = 0u; mask < MASKS; mask++) {
        shadows[mask] = shadow(mask, p.at, max(bitcast<f32>(p.id.y), 1e-9), face);
    }
}

// The loops test at their end: there is at least one light of a family, and a rasteriser on a processor pays for the
// turn that a test at the start would leave at once.
fn lit(p: Sample) -> Lit {
    let depth = max(bitcast<f32>(p.id.y), 1e-9);
    let ray = pixel_ray(p.at);
    let gloss = unpack_gloss(p.packed.w);
    let position = frame.eye + ray * (frame.near_m / depth);
    let s = shading(position, unpack_direction(p.packed.x), -normalize(ray), unpack_color(p.packed.y), gloss);
    var matte = ambient(s.normal);
    if ILLUMINANCE {
        matte = vec3f(0.0);
    }
    var glossy = environment(position, reflect(-s.view, s.normal), gloss.x) * s.material.reflectance;

    let tile = tile_at(p.at);
    if HAS_DELTA {
        var k = 0u;
        loop {
            let light = listed_light(tile, k);
            let a = delta_arrival(light, position);
            let color = lights[light].color * (a.w * lit_by(light) * present(k, deltas_end(tile)));
            let cosine = max(dot(s.normal, a.xyz), 0.0);
            matte += color * (cosine * body_share(s, cosine, 0.0));
            if BLINN_PHONG {
                glossy += blinn_phong(s, a.xyz) * max(dot(s.normal, a.xyz), 0.0) * color;
            } else {
                glossy += glint(s, a.xyz, lights[light].radius) * color;
            }
            k++;
            continuing {
                break if k >= deltas_end(tile);
            }
        }
    }
    if HAS_SPHERES {
        var k = deltas_end(tile);
        loop {
            let light = listed_light(tile, k);
            let a = sphere_arrival(light, position, s.normal);
            let color = lights[light].color * (lit_by(light) * present(k, spheres_end(tile)) * reach(light, a.centre) * a.passed);
            matte += color * (a.irradiance * body_share(s, a.cosine, a.irradiance / PI));
            glossy += color * seen_highlight(s, a, true);
            k++;
            continuing {
                break if k >= spheres_end(tile);
            }
        }
    }
    if HAS_RECTS {
        var k = spheres_end(tile);
        loop {
            let light = listed_light(tile, k);
            let a = panel_arrival(light, position, s.normal, false);
            let color = lights[light].color * (lit_by(light) * present(k, rects_end(tile)) * panel_reach(light, a.centre) * a.passed);
            matte += color * (a.irradiance * body_share(s, a.cosine, a.irradiance / PI));
            glossy += color * seen_highlight(s, a, false);
            k++;
            continuing {
                break if k >= rects_end(tile);
            }
        }
    }
    if HAS_DISCS {
        var k = rects_end(tile);
        loop {
            let light = listed_light(tile, k);
            let a = panel_arrival(light, position, s.normal, true);
            let color = lights[light].color * (lit_by(light) * present(k, discs_end(tile)) * panel_reach(light, a.centre) * a.passed);
            matte += color * (a.irradiance * body_share(s, a.cosine, a.irradiance / PI));
            glossy += color * seen_highlight(s, a, true);
            k++;
            continuing {
                break if k >= discs_end(tile);
            }
        }
    }
    if ILLUMINANCE {
        return Lit(matte / PI, vec3f(0.0));
    }
    matte *= s.material.matte / PI;
    // Kinds: 1 lit and glowing, 2 an emitter's front.
    let kind = p.packed.y >> 30u;
    if kind != 0u {
        glossy = select(glossy, vec3f(0.0), kind == 2u) + surfaces[(p.id.x & MARK_NUMBER) - 1u].emission;
    }
    glossy = select(glossy, frame.void_radiance, p.id.x == 0u);
    return Lit(matte, glossy);
}

@fragment
fn fragment(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let p = sample_at(vec2u(at.xy));
    read_shadows(p);
    let out = lit(p);
    if ILLUMINANCE {
        let white = select(out.matte, vec3f(0.0), p.id.x == 0u);
        if LINEAR {
            return vec4f(white, 1.0);
        }
        return false_color(white);
    }
    let radiance = select(unpack_color(p.packed.y), vec3f(0.0), p.id.x == 0u) * out.matte + out.glossy;
    if LINEAR {
        return vec4f(radiance, 1.0);
    }
    return shown(radiance, at.xy);
}

// One pixel of a cell: matte and glossy light, normal, depth.
@fragment
fn cell(@builtin(position) at: vec4f) -> @location(0) vec4u {
    let p = sample_at(min(vec2u(at.xy) * frame.cell_scale, vec2u(frame.size) - 1u));
    read_shadows(p);
    let out = lit(p);
    return vec4u(pack_radiance(out.matte), pack_radiance(out.glossy), p.packed.x, p.id.y);
}
