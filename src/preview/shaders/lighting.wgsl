// The lighting pass: every pixel of the G-buffer under every light.

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

@group(1) @binding(0) var gbuffer: texture_2d<u32>;
@group(1) @binding(1) var ids: texture_2d<u32>;
@group(2) @binding(0) var masks: texture_2d_array<u32>;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return fullscreen_corner(index);
}

fn shown(radiance: vec3f, at: vec2f) -> vec4f {
    if LINEAR {
        return vec4f(radiance, 1.0);
    }
    // Less than one code of noise (Jimenez 2014, interleaved gradient noise), so that soft backdrops show no bands.
    let noise = fract(52.9829189 * fract(dot(at, vec2f(0.06711056, 0.00583715)))) - 0.5;
    return vec4f(srgb_encode(tone_curve(radiance)) + noise * (0.9 / 255.0), 1.0);
}

// An emitter with a size. What has none of its light above the horizon gives no highlight either.
fn reflected(s: Shading, light: u32, a: Arrival, round: bool) -> vec3f {
    let diffuse = s.material.diffuse * (a.irradiance / PI);
    let glossy = highlight(s, a, round);
    return (diffuse + select(vec3f(0.0), glossy, a.irradiance > 0.0)) * lights[light].color * a.passed;
}

// Shadows of four lights at a pixel. A mask of half the size is read at the four pixels around, as far as they lie on
// the pixel's own plane.
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

@fragment
fn fragment(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let pixel = vec2i(at.xy);
    let id = textureLoad(ids, pixel, 0).xy;
    let packed = textureLoad(gbuffer, pixel, 0);
    let kind = packed.y >> 30u;
    let depth = max(bitcast<f32>(id.y), 1e-9);
    let ray = pixel_ray(at.xy);
    let gloss = unpack_gloss(packed.w);
    let face = unpack_direction(packed.z);
    let position = frame.eye + ray * (frame.near_m / depth);
    let s = shading(position, unpack_direction(packed.x), -normalize(ray), unpack_color(packed.y), gloss);

    var lit: array<vec4f, 4>;
    for (var mask = 0u; mask < MASKS; mask++) {
        lit[mask] = shadow(mask, at.xy, depth, face);
    }
    var radiance = s.material.diffuse * ambient(s.normal) / PI;
    radiance += environment(position, reflect(-s.view, s.normal), gloss.x) * s.material.reflectance;

    // The loops test at their end: there is at least one light of a family, and a rasteriser on a processor pays for
    // the turn that a test at the start would leave at once.
    if HAS_DELTA {
        var light = 0u;
        loop {
            let a = delta_arrival(light, position);
            let glossy = glint(s, a.xyz, lights[light].radius);
            let diffuse = s.material.diffuse * (max(dot(s.normal, a.xyz), 0.0) / PI);
            radiance += (diffuse + glossy) * lights[light].color * (a.w * lit_by(&lit, light));
            light++;
            continuing {
                break if light >= frame.light_ends.x;
            }
        }
    }
    if HAS_SPHERES {
        var light = frame.light_ends.x;
        loop {
            let a = sphere_arrival(light, position, s.normal);
            radiance += reflected(s, light, a, true) * lit_by(&lit, light);
            light++;
            continuing {
                break if light >= frame.light_ends.y;
            }
        }
    }
    if HAS_RECTS {
        var light = frame.light_ends.y;
        loop {
            let a = panel_arrival(light, position, s.normal, false);
            radiance += reflected(s, light, a, false) * lit_by(&lit, light);
            light++;
            continuing {
                break if light >= frame.light_ends.z;
            }
        }
    }
    if HAS_DISCS {
        var light = frame.light_ends.z;
        loop {
            let a = panel_arrival(light, position, s.normal, true);
            radiance += reflected(s, light, a, true) * lit_by(&lit, light);
            light++;
            continuing {
                break if light >= frame.light_ends.w;
            }
        }
    }
    // Kinds: 1 lit and glowing, 2 an emitter's front.
    if kind != 0u {
        radiance = select(radiance, vec3f(0.0), kind == 2u) + surfaces[(id.x & MARK_NUMBER) - 1u].emission;
    }
    return shown(select(radiance, frame.void_radiance, id.x == 0u), at.xy);
}

// Shadow of a light: four lights a mask, the rest are lit.
fn lit_by(lit: ptr<function, array<vec4f, 4>>, light: u32) -> f32 {
    if MASKS == 0u {
        return 1.0;
    }
    if MASKS == 1u {
        return select(1.0, (*lit)[0][light & 3u], light < 4u);
    }
    return select(1.0, (*lit)[(light >> 2u) & 3u][light & 3u], light < 4u * MASKS);
}
